"""A case that cuts on a machine passes on what was noted where its machine file was read."""

import re

import numpy as np
import pytest

from chatter import Case
from chatter.compile.linearised_machine import FittedModes, machine_structure
from chatter.compile.real_modes import largest_misfit
from chatter.simulation.setup import set_up
from dynamics.modal.modes import Mode, receptance_matrix
from tests.cases import tool_of_922_hertz
from tests.chatter.simulation.on_machine.coupled_machines import body, spring, written


@pytest.fixture
def case(tmp_path) -> Case:
    springs = spring("head", "ground", x=8e7, y=1.4e8)
    springs["positions"] = [springs.pop("at")]
    machine = {
        "tool_point": "tip",
        "damping_ratio": 0.03,
        "body": {"head": body(20.0)},
        "connector": {"springs": springs},
        "point": {"tip": {"on": "head", "at": [0.0, 0.0, 0.0]}},
    }
    file = written(tmp_path, machine, "head.toml")
    file.write_text(file.read_text().replace("positions =", "places ="))
    return tool_of_922_hertz().patch(
        {"structure": {"machine": str(file)}, "simulation.revolutions": 1}
    )


def test_old_keys_are_noted(case):
    for notes in (machine_structure(case).notes, set_up(case).notes):
        assert any("head.toml" in note and "positions" in note for note in notes)


def test_a_machine_without_a_drive_has_no_closed_loops(case):
    (note,) = (note for note in machine_structure(case).notes if note.startswith("dynamics of"))
    assert note.endswith("head.toml, linearised, no axis under control")


def test_what_modes_miss_is_told_where_the_structure_resonates():
    """A mode of 20 Hz, far below those of the structure, is missed; those of the structure less."""
    lines = np.linspace(5.0, 200.0, 1951)
    slow = Mode(20.0, 0.05, 300.0, (1.0, 0.0, 0.0))
    own = Mode(100.0, 0.05, 10.0, (1.0, 0.0, 0.0))
    receptance = receptance_matrix((slow, own), lines)
    above = lines >= 70.0
    fitted = FittedModes(
        (own,),
        70.0,
        largest_misfit((own,), lines[above], receptance[above]),
        largest_misfit((own,), lines, receptance),
    )
    # peaks 1 / (2 zeta k): that of the slow mode, and what its mass line leaves at 100 Hz
    peak_slow, peak = (1.0 / (0.1 * m * (2.0 * np.pi * f) ** 2) for m, f in ((300, 20), (10, 100)))
    (note,) = fitted.notes
    told = [float(one) / 100.0 for one in re.findall(r"([\d.]+)%", note)]
    assert told[1] == pytest.approx(peak_slow / max(peak, peak_slow), rel=0.02)
    left = 1.0 / (300.0 * (2.0 * np.pi) ** 2 * (70.0**2 - 20.0**2))
    assert told[0] == pytest.approx(left / peak, abs=6e-4)  # told to a tenth of a percent
    assert "above 70 Hz" in note


def test_a_machine_without_a_workpiece_is_said_to_have_none(case):
    (note,) = [one for one in machine_structure(case).notes if "no workpiece" in one]
    assert "the work is taken as rigid" in note
    file = case.machine_file().patch(
        {"workpiece": "tip", "point.floor": {"on": "head", "at": [0.0, 0.0, 0.1]}}
    )
    with_work = case.with_machine(file.patch({"workpiece": "floor"}))
    assert not any("no workpiece" in one for one in machine_structure(with_work).cut.notes)
