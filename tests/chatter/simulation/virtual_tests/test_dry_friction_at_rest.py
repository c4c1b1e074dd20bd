"""FRFs at rest say where dry friction clamps an axis; bristles, and what slides, give way."""

import pytest

from chatter.description.machine.machine_file import load_machine
from chatter.simulation.virtual_tests.from_file import frf
from tests.chatter.simulation.virtual_tests.conftest import FILE

DRY = {"law": "coulomb-stribeck", "on": {"axis": "Y"}, "coulomb": "100 N"}
BRISTLES = {
    **DRY, "law": "lugre", "static": "130 N", "stribeck_velocity": "5 mm/s",
    "bristle_stiffness": "5 N/um",
}  # fmt: skip


@pytest.fixture
def machine(tmp_path):
    (tmp_path / "small.toml").write_text(FILE, encoding="utf-8")
    return load_machine(tmp_path / "small.toml").patch({"frf.linear.friction": True})


@pytest.mark.parametrize(
    ("changes", "clamped"),
    [
        ({"friction.guide": DRY}, True),
        ({"friction.guide": DRY, "frf.linear.amplitude": "10 um"}, False),
        ({"friction.guide": DRY, "frf.linear.moving": {"Y": "1 m/min"}}, False),
        ({"friction.guide": DRY, "frf.linear.friction": False}, False),
        ({"friction.guide": BRISTLES}, False),
    ],
)
def test_dry_friction_at_rest_is_noted(machine, changes, clamped):
    notes = frf(machine.patch(changes), ["linear"]).notes
    assert any("dry friction at rest (guide) holds like a clamp" in note for note in notes) is (
        clamped
    )
