"""Numbers that a case may have, yet no machine is likely to: asked about in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from chatter.description.formatting import to_digits
from chatter.description.unit_system import METRIC, units_of

if TYPE_CHECKING:
    from chatter.description.case import Case
    from chatter.description.usual_units import UsualUnit


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
_CUTTING_SPEED = _Usual(0.01, 170.0, "m/min", 60.0, "milling cutters")
_EDGE = _Usual(0.5e3, 500e3, "N/mm", 1e-3, "edges in metals and plastics")
_RUNOUT = _Usual(0.0, 0.2e-3, "mm", 1e3, "tools in their holders")
#: viscous coefficient C of C b/V; wide: below, nothing is felt beside the damping of any tool
_PROCESS_DAMPING = _Usual(1e2, 1e8, "N/m", 1.0, "edges in metals")
_AMPLITUDE = _Usual(1e-9, 0.2e-3, "um", 1e6, "axes that vibrate in a cut")
_DIAMETER = _Usual(0.02e-3, 1.0, "mm", 1e3, "milling cutters")
#: diameters beyond which a depth of cut is asked about, and those that common flutes are long
LONGEST_FLUTES, _COMMON_FLUTES = 8.0, 3.0
#: Young's modulus of cemented carbide, the upper end, Pa; factor beyond which a tool is questioned
_CARBIDE, _STIFFER = 650e9, 1.5
#: feed per tooth over the diameter, and radial or axial over tangential cutting pressure, beyond
#: which they are asked about
_LARGEST_FEED, _LARGEST_RADIAL = 0.05, 2.0
#: coefficients whose ratio to the tangential one is asked about, and what is usual
_BESIDE_TANGENTIAL = (("Krc", "radial", "0.1 to 1"), ("Kac", "axial", "less than 1"))
#: angle of a tool axis from the normal of the surface beyond which it is asked about, rad
_LARGEST_LEAN = math.radians(60.0)
#: growth of vibration from tooth to tooth beyond which the input is in doubt
_MOST_GROWTH = 1e3


def questions(case: Case) -> list[str]:
    """Sentences on values of a case that are far from what is usual."""
    asked: list[str] = []
    for index, mode in enumerate(case.structure.mode if case.structure else ()):
        path = f"structure.mode[{index}]"
        stiffness = mode.modal_mass * (2.0 * math.pi * mode.frequency) ** 2
        asked += _question(f"{path}.stiffness", stiffness, _STIFFNESS, case)
        asked += _question(f"{path}.damping", mode.damping, _DAMPING)
    if case.structure is not None and case.structure.friction_amplitude:
        given = case.structure.friction_amplitude
        asked += _question("structure.friction_amplitude", given, _AMPLITUDE, case)
    asked += _question_of_stiff_tool(case)
    asked += _questions_of_material(case)
    if case.process_damping is not None and case.process_damping.coefficient:
        given = case.process_damping.coefficient
        asked += _question("process_damping.coefficient", given, _PROCESS_DAMPING)
    if case.cut is not None and case.tool is not None:
        speed = 0.5 * case.tool.diameter * case.cut.spindle_speed
        asked += _question("cutting speed", speed, _CUTTING_SPEED, case)
        asked += _question("tool.diameter", case.tool.diameter, _DIAMETER, case)
        asked += _question_of_depth(case)
        asked += _question_of_feed(case)
        asked += _question_of_lean(case)
        asked += _question_of_serration(case)
        if case.tool.runout is not None:
            asked += _question("tool.runout.offset", case.tool.runout.offset, _RUNOUT, case)
    return asked


def _questions_of_material(case: Case) -> list[str]:
    """Ask about coefficients that no metal has, such as those in another unit than meant."""
    material = case.material
    if material is None:
        return []
    asked: list[str] = []
    if material.Ktc:
        asked += _question("material.Ktc", material.Ktc, _PRESSURE, case)
    for key in ("Kte", "Kre"):
        value = getattr(material, key)
        if value and value > 0.0:
            asked += _question(f"material.{key}", value, _EDGE, case)
    for key, direction, usual in _BESIDE_TANGENTIAL:
        value = getattr(material, key)
        if material.Ktc and value and abs(value) > _LARGEST_RADIAL * material.Ktc:
            asked.append(
                f"material.{key}: is {units_of(case).pressure.text(value)} meant? the {direction} "
                f"coefficient is {value / material.Ktc:.2g} times the tangential one; most "
                f"metals have {usual}"
            )
    return asked


def _question_of_feed(case: Case) -> list[str]:
    """Ask about a chip that no edge of a tool of its diameter takes."""
    feed, diameter = case.cut.feed_per_tooth, case.tool.diameter
    if feed <= _LARGEST_FEED * diameter:
        return []
    units = units_of(case)
    return [
        f"cut.feed_per_tooth: is {units.length.text(feed, '.3g')} meant? that is "
        f"{feed / diameter:.0%} of the diameter, {units.feed_rate.text(case.feed_speed, '.0f')}"
    ]


def _question_of_depth(case: Case) -> list[str]:
    """Ask about a cut deeper than any tool of its diameter cuts."""
    depth, diameter = case.cut.axial_depth, case.tool.diameter
    if depth <= LONGEST_FLUTES * diameter:
        return []
    length = units_of(case).length
    return [
        f"cut.axial_depth: is {length.text(depth)} meant? flutes of a tool of "
        f"{length.text(diameter)} are hardly longer than {length.text(LONGEST_FLUTES * diameter)}"
    ]


def _question_of_lean(case: Case) -> list[str]:
    """Ask about a tool axis that lies so flat that the holder would meet the work."""
    cut = case.cut
    lean = math.acos(math.cos(cut.lead) * math.cos(cut.tilt))
    if lean <= _LARGEST_LEAN:
        return []
    key = max(("lead", "tilt"), key=lambda one: abs(getattr(cut, one)))
    return [
        f"cut.{key}: is {math.degrees(getattr(cut, key)):.4g} deg meant? the tool axis lies "
        f"{90.0 - math.degrees(lean):.4g} deg above the surface; whether its holder clears the "
        f"workpiece is not computed (beyond {math.degrees(_LARGEST_LEAN):.0f} deg from the normal "
        "few do)"
    ]


def _question_of_serration(case: Case) -> list[str]:
    """Ask about a wave that is deeper than long, as one in another unit."""
    wave, length = case.tool.serration, units_of(case).length
    if wave is None or wave.depth <= wave.wavelength:
        return []
    return [
        f"tool.serration.depth: is {length.text(wave.depth)} meant? that is "
        f"{wave.depth / wave.wavelength:.2g} times tool.serration.wavelength, "
        f"{length.text(wave.wavelength)}; waves of roughing tools are less deep than long"
    ]


def question_of_flutes(case: Case, depth: float) -> list[str]:
    """Sentence on a depth of a result, m, that the tool may not reach; none if its length is known.

    `depth` is a limit, a pocket or an optimum; a depth of inf is none.
    """
    tool = case.tool
    stated = math.isfinite(tool.depth_that_tool_allows)
    if stated or not math.isfinite(depth) or depth <= _COMMON_FLUTES * tool.diameter:
        return []
    return [
        f"{units_of(case).length.text(depth, '.3g')} are {depth / tool.diameter:.2g} "
        "diameters of the tool: state tool.flute_length, and no depth goes beyond it"
    ]


def question_of_search(case: Case, depth: float) -> list[str]:
    """Sentence on a search, to a depth in m, that no key of the case ends; none where one does."""
    stated = case.lobes is not None and case.lobes.depths is not None
    if stated or not question_of_flutes(case, depth):
        return []
    length = units_of(case).length
    return [
        f"the maximum axial depth searched is {length.text(depth, '.3g')}, "
        f"{depth / case.tool.diameter:.2g} diameters of the tool: state tool.flute_length, or the "
        "height of a wall as lobes.depths.to, and no depth goes beyond it"
    ]


def _question_of_stiff_tool(case: Case) -> list[str]:
    """Ask where the modes of the tool are stiffer than its own stick-out as solid carbide."""
    tool, structure = case.tool, case.structure
    if tool is None or tool.stick_out is None or structure is None:
        return []
    solid = 1.0 / stick_out_compliance(
        tool.diameter, tool.stick_out, tool.flute_length, tool.shank_diameter
    )
    for axis, name in enumerate("xy"):
        compliance = sum(
            mode.direction[axis] ** 2 / (mode.modal_mass * (2.0 * math.pi * mode.frequency) ** 2)
            for mode in structure.mode
            if mode.side == "tool"
        )
        if compliance and 1.0 / compliance > _STIFFER * solid:
            (unit, factor), length = units_of(case).stiffness, units_of(case).length
            given, most = (to_digits(factor * one, 3) for one in (1.0 / compliance, solid))
            return [
                f"structure.mode: are {given} {unit} along {name} meant? a solid "
                f"carbide tool of {length.text(tool.diameter, 'g')} that stands out "
                f"{length.text(tool.stick_out, 'g')} (tool.stick_out) has at most {most} {unit}"
            ]
    return []


def stick_out_compliance(
    diameter: float,
    stick_out: float,
    flute_length: float | None = None,
    shank_diameter: float | None = None,
) -> float:
    """Compliance at the tip of a stepped round cantilever of cemented carbide, m/N.

    1/k = integral of x^2/(E I) from the tip, I = pi d^4/64 (Gere and Goodno, Mechanics of
    Materials, 2013, section 9.3); the flutes are taken as solid, so that a tool is softer.

    Parameters
    ----------
    diameter, stick_out, flute_length, shank_diameter : float
        m; without a flute length or a shank the diameter goes all along.
    """
    flutes = stick_out if flute_length is None else min(flute_length, stick_out)
    shank = diameter if shank_diameter is None else shank_diameter
    thirds = flutes**3 / diameter**4 + (stick_out**3 - flutes**3) / shank**4
    return 64.0 * thirds / (3.0 * math.pi * _CARBIDE)


def _end(value: float, read: UsualUnit) -> str:
    """End of a usual range: round as it stands, to two digits in another unit."""
    return f"{value:g}" if read.factor == 1.0 else to_digits(value, 2)


def _question(name: str, value: float, usual: _Usual, case: Case | None = None) -> list[str]:
    """Ask about a value that is not usual, in the units of a case, if given."""
    if usual.low <= value <= usual.high:
        return []
    units = METRIC if case is None else units_of(case)
    read = units.instead_of(usual.unit)
    unit, factor = read.name, usual.factor * read.factor
    ends = f"{_end(usual.low * factor, read)} to {_end(usual.high * factor, read)} {unit}".rstrip()
    given = f"{to_digits(value * factor, 3)} {unit}".rstrip()
    return [f"{name}: is {given} meant? {usual.of} have {ends}"]


def question_of_spectral_radius(spectral_radius: float) -> list[str]:
    """Sentence on a vibration that grows faster than any cut lets it; radius of a tooth period."""
    if spectral_radius <= _MOST_GROWTH:
        return []
    return [
        f"vibration would grow {spectral_radius:.2g} times from tooth to tooth: the depth is "
        "far beyond the limit, or a stiffness or a coefficient is in the wrong unit"
    ]
