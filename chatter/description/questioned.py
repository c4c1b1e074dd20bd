"""Numbers that a case may have, yet no machine is likely to: asked about in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from chatter.description.case import Case


class _Usual(NamedTuple):
    """Range of what is usual, and the unit that it is read in."""

    low: float  # SI
    high: float  # SI
    unit: str
    factor: float  # of the unit, from SI
    of: str


_STIFFNESS = _Usual(0.05e6, 1e10, "N/um", 1e-6, "modes of tools, spindles and thin walls")
_DAMPING = _Usual(5e-4, 0.3, "", 1.0, "damping ratios of machines and tools")
_PRESSURE = _Usual(50e6, 1e10, "MPa", 1e-6, "metals and plastics")
_CUTTING_SPEED = _Usual(0.01, 170.0, "m/min", 60.0, "milling")
#: growth of vibration from tooth to tooth beyond which the input is in doubt
_MOST_GROWTH = 1e3


def questions(case: Case) -> list[str]:
    """Sentences on values of a case that are far from what is usual."""
    asked = []
    for index, mode in enumerate(case.structure.mode if case.structure else ()):
        path = f"structure.mode[{index}]"
        stiffness = mode.modal_mass * (2.0 * math.pi * mode.frequency) ** 2
        asked += _question(f"{path}.stiffness", stiffness, _STIFFNESS)
        asked += _question(f"{path}.damping", mode.damping, _DAMPING)
    if case.material is not None and case.material.Ktc:
        asked += _question("material.Ktc", case.material.Ktc, _PRESSURE)
    if case.cut is not None and case.tool is not None:
        speed = 0.5 * case.tool.diameter * case.cut.spindle_speed
        asked += _question("cutting speed", speed, _CUTTING_SPEED)
    return asked


def _question(name: str, value: float, usual: _Usual) -> list[str]:
    if usual.low <= value <= usual.high:
        return []
    ends = f"{usual.low * usual.factor:g} to {usual.high * usual.factor:g} {usual.unit}".rstrip()
    given = f"{value * usual.factor:.3g} {usual.unit}".rstrip()
    return [f"{name}: is {given} meant? {usual.of} have {ends}"]


def question_of_spectral_radius(spectral_radius: float) -> list[str]:
    """Sentence on a vibration that grows faster than any cut lets it."""
    if spectral_radius <= _MOST_GROWTH:
        return []
    return [
        f"vibration would grow {spectral_radius:.2g} times from tooth to tooth: the depth is far "
        "beyond the limit, or a stiffness or a coefficient is in the wrong unit"
    ]
