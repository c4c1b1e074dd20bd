"""What no known effect explains is described freely, in explanation.json and in the report."""

import json

import numpy as np
import pytest

from chatter.explain.explanation import explain
from chatter.explain.measurement_file import read_measurement

MASS, VISCOUS, NOISE = 100.0, 500.0, 1.0
PLACE, WIDTH, PUSH = 0.05, 0.006, 60.0


@pytest.fixture(scope="module")
def pushed_at_a_place(tmp_path_factory):
    """Moves of an axis that something pushes back at one place."""
    folder = tmp_path_factory.mktemp("pushed")
    (folder / "case.toml").write_text(
        '[axis]\nmoving_mass = "103 kg"\nviscous_friction = "485 N*s/m"\n'
    )
    lines = ['kind = "axis"', 'case = "case.toml"', 'title = "pushed at a place"']
    rng = np.random.default_rng(7)
    time = np.arange(0.0, 5.0, 1e-3)
    for number in range(6):
        travel, turns = rng.uniform(0.06, 0.1), rng.uniform(0.2, 0.6)
        angle = 2.0 * np.pi * turns * time
        position = travel * (1.0 - np.cos(angle)) / 2.0
        velocity = travel * np.pi * turns * np.sin(angle)
        acceleration = travel * 2.0 * (np.pi * turns) ** 2 * np.cos(angle)
        force = MASS * acceleration + VISCOUS * velocity
        force += PUSH * np.exp(-(((position - PLACE) / WIDTH) ** 2))
        columns = np.column_stack(
            [time, 1e3 * position, 1e3 * velocity, force + NOISE * rng.standard_normal(time.size)]
        )
        np.savetxt(
            folder / f"move{number}.csv", columns, fmt="%.6f", delimiter=",", comments="",
            header="time [s],position [mm],velocity [mm/s],force [N]",
        )  # fmt: skip
        lines += ["[[run]]", f'file = "move{number}.csv"']
    (folder / "measurement.toml").write_text("\n".join(lines) + "\n")
    return folder


def test_a_push_at_a_place_is_told_as_such(pushed_at_a_place, tmp_path):
    result = explain(read_measurement(pushed_at_a_place))
    assert result.verdict == "unexplained"
    result.save(tmp_path)
    summary = json.loads((tmp_path / "explanation.json").read_text())
    lead = summary["signature"]["residual_dependence"]
    assert lead["significant"]
    assert "position" in lead["over"]
    assert lead["table"]["rows"]
    if lead["over"] == ["position"]:
        place, push = np.array(lead["table"]["rows"])[:, :2].T
        assert place[np.argmax(push)] == pytest.approx(1e3 * PLACE, abs=1e3 * WIDTH)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Residual dependence" in page
    assert lead["description"][:30] in page
    assert "Something is missing that none of the effects known here explains" in page
