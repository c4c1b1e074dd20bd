"""Refuse numbers that no milling cut can have, before they overflow in a kernel."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from chatter.description.errors import InputError
from chatter.description.unit_system import units_of
from chatter.description.usual_units import of_dimension

if TYPE_CHECKING:
    from chatter.description.case import Case

#: path -> lowest and highest, SI, and dimension: wide enough for machines from dental to ship yard
PLAUSIBLE: dict[str, tuple[float, float, str]] = {
    "tool.diameter": (1e-6, 20.0, "length"),
    "material.Ktc": (1e3, 1e13, "pressure"),
    "cut.spindle_speed": (0.1, 1e6, "angular_speed"),
    "cut.feed_per_tooth": (1e-10, 1.0, "length"),
    "cut.axial_depth": (1e-9, 10.0, "length"),
    "lobes.speeds.from": (0.1, 1e6, "angular_speed"),
    "lobes.speeds.to": (0.1, 1e6, "angular_speed"),
    "lobes.depths.to": (1e-9, 10.0, "length"),
    "process_damping.coefficient": (0.0, 1e12, "line_force"),
}
PLAUSIBLE_MODE: dict[str, tuple[float, float, str]] = {
    "frequency": (0.01, 1e6, "frequency"),
    "damping": (1e-6, 1.0, "number"),
    "modal_mass": (1e-9, 1e9, "mass"),
}
#: tangential coefficient times axial depth over the stiffness of a mode: a stable cut has hardly
#: more than one, and what is far beyond takes methods for hours
_STIFFEST_CUT = 1e4
#: the top of the edge trails its tip by at most this, rad
_LARGEST_LAG = 200.0
#: waves of a serrated edge within the depth of cut
_MOST_WAVES = 200.0


def check_plausible(case: Case) -> None:
    """Raise InputError naming every value of the case that is out of any plausible range."""
    problems = []
    for path, bounds in PLAUSIBLE.items():
        section = path.partition(".")[0]
        value = _value(case, path) if getattr(case, section) is not None else None
        problems += _problem(case.name, path, value, bounds)
    for index, mode in enumerate(case.structure.mode if case.structure else ()):
        for key, bounds in PLAUSIBLE_MODE.items():
            path = f"structure.mode[{index}].{key.removeprefix('modal_')}"
            problems += _problem(case.name, path, getattr(mode, key), bounds)
    problems += _softest_mode(case)
    helix = case.tool.helix
    angles = helix if isinstance(helix, tuple) else (helix,)
    deepest = max(case.cut.axial_depth, _value(case, "lobes.depths.to") or 0.0)
    where = "cut.axial_depth" if deepest == case.cut.axial_depth else "lobes.depths.to"
    lag = max(abs(math.tan(angle)) for angle in angles) * deepest / (0.5 * case.tool.diameter)
    if not problems and lag > _LARGEST_LAG:
        length = units_of(case).length
        problems.append(
            f"{case.name}: {where}: within {length.text(deepest, 'g')} the edge winds "
            f"{lag / (2.0 * math.pi):.3g} times around the tool, with its tool.diameter and "
            f"tool.helix; at most {_LARGEST_LAG / (2.0 * math.pi):.0f} are allowed; a bare number "
            "is in m"
        )
    wave = case.tool.serration
    if not problems and wave is not None and deepest > _MOST_WAVES * wave.wavelength:
        length = units_of(case).length
        problems.append(
            f"{case.name}: tool.serration.wavelength: {length.text(wave.wavelength, 'g')} makes "
            f"{deepest / wave.wavelength:.3g} waves within {length.text(deepest, 'g')}; at most "
            f"{_MOST_WAVES:.0f} are allowed"
        )
    if problems:
        raise InputError(problems)


def _softest_mode(case: Case) -> list[str]:
    """Say which mode is softer by far than the cut, as one whose stiffness is in another unit."""
    if case.material is None or not case.material.Ktc or case.structure is None:
        return []
    cut = case.material.Ktc * case.cut.axial_depth
    problems = []
    for index, mode in enumerate(case.structure.mode):
        stiffness = mode.modal_mass * (2.0 * math.pi * mode.frequency) ** 2
        in_plane = math.hypot(mode.direction[0], mode.direction[1]) ** 2
        if cut * in_plane > _STIFFEST_CUT * stiffness:
            units = units_of(case)
            problems.append(
                f"{case.name}: structure.mode[{index}].stiffness: "
                f"{units.stiffness.text(stiffness, '.3g')} is {cut * in_plane / stiffness:.2g} "
                f"times less than a cut of {units.length.text(case.cut.axial_depth, 'g')} has "
                f"(material.Ktc times cut.axial_depth); at most {_STIFFEST_CUT:g} times is "
                "allowed; a bare number is in N/m"
            )
    return problems


def _value(case: Case, path: str) -> float | None:
    item = case
    for key in path.split("."):
        item = getattr(item, "from_" if key == "from" else key, None)
    return item


def _problem(
    name: str, path: str, value: float | None, bounds: tuple[float, float, str]
) -> list[str]:
    lowest, highest, dimension = bounds
    if value is None or lowest <= value <= highest:
        return []
    unit, factor = of_dimension(dimension)
    return [
        f"{name}: {path}: {f'{value * factor:.4g} {unit}'.rstrip()} is out of any plausible range, "
        f"{lowest * factor:.3g} to {highest * factor:.3g} {unit}".rstrip()
    ]
