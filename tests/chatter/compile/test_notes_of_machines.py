"""A case that cuts on a machine passes on what was noted where its machine file was read."""

import pytest

from chatter import Case
from chatter.compile.linearised_machine import machine_structure
from chatter.simulation.setup import set_up
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
