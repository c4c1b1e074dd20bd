"""The reference itself against published and exact multipliers (validation 2.1, 2.2, 3.2)."""

import math

import pytest

from tests.validation.reference.milling import MillingCase, multipliers, spectral_radius


def insperger_tool(immersion, mode, rpm, depth_mm, dof=1, diameter=16e-3, helix_deg=0.0):
    """The 922 Hz tool of Insperger and Stepan and of Ding et al."""
    arc = math.acos(1.0 - 2.0 * immersion)
    entry, leave = (0.0, arc) if mode == "up" else (math.pi - arc, math.pi)
    modes = tuple(
        (922.0, 0.011, 0.03993, direction) for direction in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))[:dof]
    )
    return MillingCase(
        2,
        diameter,
        math.radians(helix_deg),
        entry,
        leave,
        (600e6, 200e6, 0.0),
        modes,
        rpm * math.pi / 30.0,
        depth_mm * 1e-3,
    )


@pytest.mark.parametrize(
    ("case", "expected"),
    [
        (insperger_tool(1.0, "down", 5000, 0.2), 0.81974278427),
        (insperger_tool(1.0, "down", 5000, 1.0), 1.40647352539),
        (insperger_tool(0.05, "up", 5000, 1.0), 0.8127274085),
        (insperger_tool(0.1, "down", 10000, 2.0), 0.6490664467),
        (insperger_tool(0.05, "down", 20000, 5.0, dof=2), 1.3010108332),
        (insperger_tool(0.5, "down", 15000, 2.0, dof=2), 2.1027785910),
        (insperger_tool(0.05, "down", 15000, 3.0, helix_deg=30.0), 0.6734927299),
    ],
)
def test_published_multipliers(case, expected):
    assert spectral_radius(case) == pytest.approx(expected, rel=3e-9)


def test_free_vibration_decays_as_it_must():
    # w -> 0: |mu| -> exp(-zeta omega T)
    case = insperger_tool(0.5, "down", 9000, 1e-9)
    period = 30.0 / 9000.0
    expected = math.exp(-0.011 * 2 * math.pi * 922.0 * period)
    assert spectral_radius(case) == pytest.approx(expected, rel=1e-9)


def test_one_mode_at_45_degrees_is_turned_turning():
    # a rotated pair of equal modes is the same structure
    base = insperger_tool(0.3, "down", 12000, 0.8, dof=2)
    s = math.sqrt(0.5)
    turned = MillingCase(
        *(getattr(base, name) for name in ("teeth", "diameter", "helix", "entry", "exit")),
        base.coefficients,
        ((922.0, 0.011, 0.03993, (s, s, 0.0)), (922.0, 0.011, 0.03993, (-s, s, 0.0))),
        base.speed,
        base.depth,
    )
    pair = abs(multipliers(turned)[0]), abs(multipliers(base)[0])
    assert pair[0] == pytest.approx(pair[1], rel=1e-9)
