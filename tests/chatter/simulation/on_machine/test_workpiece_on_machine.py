"""A carved workpiece and friction on the same machine."""

import numpy as np
import pytest

from chatter.simulation.simulate import simulate
from tests.chatter.simulation.on_machine.coupled_machines import cut_case, written
from tests.chatter.simulation.on_machine.test_feed import turned

RUN = {"revolutions": 10}
BLOCK = {"x": ["12 mm", "60 mm"], "y": ["-20 mm", "-2 mm"], "z": ["0 mm", "1.5 mm"]}


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return written(tmp_path_factory.mktemp("carved"), turned(np.eye(3)))


@pytest.fixture(scope="module")
def delayed(machine):
    return simulate(cut_case({"machine": str(machine), "settling": 0.4}, **RUN))


def test_dexels_agree_with_the_delayed_chip(machine, delayed):
    structure = {"machine": str(machine), "settling": 0.4}
    carved = simulate(cut_case(structure, chip="dexel", resolution="20 um", **RUN))
    settled = delayed.settled
    for name in ("force", "displacement"):
        one, other = getattr(carved, name)[settled], getattr(delayed, name)[settled]
        size = np.sqrt(np.mean(np.sum(other**2, axis=1)))
        apart = np.sqrt(np.mean(np.sum((one - other) ** 2, axis=1)))
        assert apart < 0.05 * size, name
    dip = [np.mean(314.159265 - run.spindle_speed[settled]) for run in (carved, delayed)]
    assert dip[0] == pytest.approx(dip[1], rel=0.03)


def test_the_spindle_dips_and_the_drive_pushes_when_the_tool_enters(machine):
    """The tool starts in the air, a fifth of a second before the block."""
    case = cut_case(
        {"machine": str(machine), "settling": 0.4, "feed": [1, 0, 0]},
        chip="dexel",
        resolution="50 um",
        duration=0.7,
    ).patch({"stock": {"box": [BLOCK]}})
    result = simulate(case)
    inside = np.flatnonzero(np.abs(result.force).max(axis=1) > 0.0)[0]
    entry = result.time[inside]
    # teeth reach 8 mm ahead of the axis
    assert 0.1 < entry < 0.25
    dip = 314.159265 - result.spindle_speed
    before, after = slice(0, inside), slice(-800, None)
    assert np.abs(dip[before]).max() < 1e-3 * dip[after].mean()
    assert dip[after].mean() == pytest.approx(result.torque[after].mean() / 3.0, rel=0.02)
    pushed = result.torque_of("X")
    assert np.abs(pushed[before]).max() < 0.1 * abs(pushed[after].mean())
    assert pushed[after].mean() == pytest.approx(result.force[after, 0].mean(), rel=0.05)


def test_friction_adds_to_the_drive_what_it_takes(tmp_path, delayed):
    """Coulomb friction of the table: the drive bears it on top of the cut, against the motion."""
    machine = turned(np.eye(3))
    machine["friction"] = {
        "guide": {
            "law": "tanh-hysteresis", "coulomb": 60.0, "viscous": 0.0, "low_speed_viscous": 0.0,
            "low_speed_decay": 1.0, "hysteresis_slope": 1e4, "on": {"axis": "X"},
        }
    }  # fmt: skip
    path = written(tmp_path, machine)
    structure = {"machine": str(path), "settling": 0.4}
    rubbing = simulate(cut_case(structure, **RUN))
    free = simulate(cut_case({**structure, "friction": False}, **RUN))
    settled = delayed.settled
    assert np.abs(free.displacement - delayed.displacement).max() < 1e-9
    extra = rubbing.torque_of("X")[settled].mean() - free.torque_of("X")[settled].mean()
    # the table moves along -x: its guide pulls along +x, so the drive pushes along -x
    assert extra == pytest.approx(-60.0, rel=0.03)
    mean = free.force[settled].mean(axis=0)
    assert rubbing.force[settled].mean(axis=0) == pytest.approx(mean, rel=0.02)
