"""Sliders of a case: paths with units and ranges, and a check of the values that a page sends."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from chatter.app.stated_units import stated_dimension
from chatter.compile.cutter import force_law
from chatter.description.case import MACHINE_PATH, Case
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.units import rpm, unit_factor

#: lowest friction of a slider, as a share of what the case has
_LEAST_FRICTION = 0.01
#: modes with sliders of their own
_MOST_MODES = 6
_MOST_TEETH = 12
#: heading of what a cut and a machine dampen by
PROCESS = "Process damping, wear, friction"


@dataclass(frozen=True)
class Slider:
    """A slider."""

    path: str  # into the case
    group: str  # heading that it stands under
    label: str  # its name there
    unit: str  # of value, low and high; empty for pure numbers
    value: float
    low: float
    high: float
    whole: bool = False  # only whole numbers
    logarithmic: bool = False  # scale of the slider
    view: bool = False  # a range of the diagram, no part of the cut

    def text(self, value: float) -> Any:
        """Value as it is written in a case file."""
        if self.whole:
            return int(value)
        return f"{value:.7g} {self.unit}" if self.unit else float(f"{value:.7g}")


def diagram_sliders(speeds: tuple[float, float], depth: float) -> tuple[Slider, ...]:
    """Ranges of the diagram: speeds in rad/s, depth in m."""
    low, high = (_rounded(rpm(speed)) for speed in speeds)
    deep, unit = _rounded(depth * 1e3), "rpm"
    group = "Diagram"
    return (
        Slider("lobes.speeds.from", group, "lowest speed", unit, low, 0.2 * low, high, view=True),
        Slider("lobes.speeds.to", group, "highest speed", unit, high, low, 2.0 * high, view=True),
        Slider("lobes.depths.to", group, "deepest", "mm", deep, 0.05 * deep, 5.0 * deep, view=True),
    )


def case_sliders(case: Case) -> tuple[Slider, ...]:
    """Sliders for what the case, of tool, material, cut and structure, has."""
    return (
        *_of_cut(case),
        *_of_tool(case),
        *_of_material(case),
        *_of_structure(case),
        *_of_process(case),
    )


def _of_cut(case: Case) -> Iterator[Slider]:
    cut, group = case.cut, "Cut"
    speed, depth = _rounded(rpm(cut.spindle_speed)), _rounded(cut.axial_depth * 1e3)
    yield Slider(
        "cut.spindle_speed", group, "spindle speed", "rpm", speed, 0.1 * speed, 4.0 * speed
    )
    yield Slider("cut.axial_depth", group, "axial depth", "mm", depth, 0.02 * depth, 8.0 * depth)
    if cut.radial_depth is not None:
        width, widest = _rounded(cut.radial_depth * 1e3), _rounded(case.tool.diameter * 1e3)
        yield Slider("cut.radial_depth", group, "radial depth", "mm", width, 0.01 * widest, widest)
    if _feed_matters(case):
        feed = _rounded(cut.feed_per_tooth * 1e3)
        most = min(5.0 * feed, 20.0)
        yield Slider("cut.feed_per_tooth", group, "feed per tooth", "mm", feed, 0.1 * feed, most)
    if cut.speed_variation is not None:
        varied, path = cut.speed_variation, "cut.speed_variation"
        yield Slider(
            f"{path}.amplitude", group, "speed variation", "", varied.amplitude, 0.001, 0.5
        )
        yield _around(
            f"{path}.frequency", group, "its frequency", "Hz", varied.frequency, factor=4.0
        )


def _feed_matters(case: Case) -> bool:
    """Whether the limit depends on the feed: through the force law or which teeth cut."""
    given = case.process_damping
    ploughs = given is not None and given.indentation_force is not None
    uneven = case.tool.runout is not None or case.tool.radial_error is not None
    return force_law(case, 0.0).slope_power.lowest_exponent != 0.0 or ploughs or uneven


def _of_tool(case: Case) -> Iterator[Slider]:
    tool, group = case.tool, "Tool"
    listed = (tool.pitch, tool.radial_error, tool.axial_error)
    each_alike = all(given is None for given in listed) and not isinstance(tool.helix, tuple)
    if each_alike:
        most = max(_MOST_TEETH, 2 * tool.teeth)
        yield Slider("tool.teeth", group, "teeth", "", tool.teeth, 1, most, whole=True)
    if not isinstance(tool.helix, tuple) and tool.kind != "inserted":
        angle = _rounded(math.degrees(tool.helix))
        low, high = min(0.0, angle), max(60.0, angle)
        yield Slider("tool.helix", group, "helix", "deg", angle, low, high)
    if tool.runout is not None:
        offset = tool.runout.offset * 1e6
        yield _from_zero("tool.runout.offset", group, "runout", "um", offset, 20.0)


def _of_material(case: Case) -> Iterator[Slider]:
    material, group = case.material, "Material"
    if material.law == "oblique":
        yield _around("material.shear_stress", group, "shear stress", "MPa", material.shear_stress)
        for key, low, high in (("friction_angle", 0.0, 60.0), ("shear_angle", 5.0, 60.0)):
            angle = _rounded(math.degrees(getattr(material, key)))
            label = key.replace("_", " ")
            ends = min(low, angle), max(high, angle)
            yield Slider(f"material.{key}", group, label, "deg", angle, *ends)
        return
    if material.Ktc is None:
        return
    tangential = _rounded(material.Ktc * 1e-6)
    yield _around("material.Ktc", group, "Ktc", "MPa", material.Ktc)
    radial = _rounded(material.Krc * 1e-6)
    low, high = min(0.0, 2.0 * radial), max(tangential, 2.0 * radial)
    yield Slider("material.Krc", group, "Krc", "MPa", radial, low, high)
    if material.exponent is not None:
        yield Slider("material.exponent", group, "exponent", "", material.exponent, 0.1, 1.0)


def _of_structure(case: Case) -> Iterator[Slider]:
    for index, mode in enumerate(case.structure.mode[:_MOST_MODES]):
        path, group = f"structure.mode[{index}]", f"Mode {index + 1}, {_direction(mode)}"
        yield _around(f"{path}.frequency", group, "frequency", "Hz", mode.frequency, factor=2.0)
        damping = _rounded(mode.damping)
        low, high = 0.2 * damping, min(5.0 * damping, 0.9)
        high = max(high, damping)
        yield Slider(
            f"{path}.damping", group, "damping ratio", "", damping, low, high, logarithmic=True
        )
        if mode.stiffness is not None:
            yield _around(f"{path}.stiffness", group, "stiffness", "N/um", mode.stiffness)
        else:
            yield _around(f"{path}.mass", group, "modal mass", "kg", mode.mass)


def _direction(mode: Any) -> str:
    """Axis that the mode moves along, for its heading."""
    named = [axis for axis, part in zip("xyz", mode.direction, strict=True) if abs(part) > 0.999]
    along = named[0] if named else ", ".join(f"{part:.2g}" for part in mode.direction)
    return f"{mode.side} {along}"


def _of_process(case: Case) -> Iterator[Slider]:
    """What a case may lack, such as process damping, begins at zero: what if it were there."""
    given, contact, group = case.process_damping, case.contact, PROCESS
    if given is None or given.coefficient is not None:
        value, path = (0.0 if given is None else given.coefficient) * 1e-3, "coefficient"
        yield _from_zero(f"process_damping.{path}", group, "process damping", "N/mm", value, 100.0)
    if given is not None:
        most = max(1.0, given.friction)
        yield Slider(
            "process_damping.friction", group, "ploughing friction", "", given.friction, 0.0, most
        )
    yield from _of_wear(case, group)
    if case.on_machine and case.structure.friction is not False:
        value, path = case.structure.amplitude_at_frictions * 1e6, "structure.friction_amplitude"
        yield _from_zero(path, group, "vibration at the machine's frictions", "um", value, 20.0)
        yield from _of_machine_frictions(case, group)
    if given is not None and given.indentation_force is not None:
        path = "process_damping.indentation_force"
        yield _around(path, group, "indentation force", "N/mm^3", given.indentation_force)
    if contact is not None:
        value, path = contact.stiffness * 1e-6, "contact.stiffness"
        yield _from_zero(path, group, "contact stiffness", "N/um", value, 1.0)


def _of_wear(case: Case, group: str) -> Iterator[Slider]:
    worn = _rounded((case.tool.flank_wear or 0.0) * 1e3)
    yield _from_zero("tool.flank_wear", group, "flank wear", "mm", worn, 0.3)
    if case.wear is not None:
        spent = _rounded((case.cut.cut_time or 0.0) / 60.0)
        yield _from_zero("cut.cut_time", group, "cutting time", "min", spent, 60.0)
    for name, law in case.friction.items():
        if law.coulomb is not None:
            path = f"friction.{name}.coulomb"
            yield _friction(path, group, f"friction {name}", "N", law.coulomb, 100.0)


def _friction(path: str, group: str, label: str, unit: str, value: float, least: float) -> Slider:
    """Slider of a Coulomb friction; some laws require one above zero."""
    slider = _from_zero(path, group, label, unit, value, least)
    return replace(slider, low=_LEAST_FRICTION * slider.value)


def _of_machine_frictions(case: Case, group: str) -> Iterator[Slider]:
    """Coulomb friction of the guides, motors and bearings of the machine."""
    for name, law in case.machine_file().friction.items():
        if law.coulomb is None:
            continue
        path = f"{MACHINE_PATH}friction.{name}.coulomb"
        label = f"friction {name} of the machine"
        if stated_dimension(case, path) == "torque":
            yield _friction(path, group, label, "N*m", law.coulomb, 0.1)
        else:
            yield _friction(path, group, label, "N", law.coulomb, 10.0)


def why_no_friction_slider(case: Case) -> str:
    """Say where friction is stated, where a case has none of its own; empty where it has."""
    if any(law.coulomb is not None for law in case.friction.values()):
        return ""
    if case.on_machine and case.structure.friction is False:
        return "friction: that of the machine is left out, by structure.friction = false"
    if case.on_machine:
        name = Path(case.structure.machine).name
        stated = any(law.coulomb is not None for law in case.machine_file().friction.values())
        return (
            f"friction of the machine: Sliders into the case saves another machine beside {name}"
            if stated
            else f"friction: none is stated in {name}"
        )
    return "friction: the case has none; Add a section, in the view Case, gives a mode one"


#: unit -> dimension, for the factor to SI
_DIMENSION = {
    "MPa": "pressure",
    "Hz": "frequency",
    "kg": "mass",
    "N/um": "stiffness",
    "N/mm^3": "pressure_gradient",
}


def _around(
    path: str, group: str, label: str, unit: str, value: float, factor: float = 4.0
) -> Slider:
    """Slider on a logarithmic scale from 1/factor to factor times a value in SI."""
    shown_value = _rounded(value / unit_factor(unit, _DIMENSION[unit]))
    low, high = shown_value / factor, shown_value * factor
    return Slider(path, group, label, unit, shown_value, low, high, logarithmic=True)


def _from_zero(path: str, group: str, label: str, unit: str, value: float, least: float) -> Slider:
    """Slider from zero to four times a value in its unit, and to no less than the least."""
    value = _rounded(value)
    return Slider(path, group, label, unit, value, 0.0, max(4.0 * value, least))


def _rounded(value: float) -> float:
    return float(f"{value:.7g}")


def checked_values(given: Any, sliders: Mapping[str, Slider]) -> dict[str, float]:
    """Values that a page sent, by path.

    InputError if they are no table of known paths and numbers in range; all problems are in it.
    """
    if not isinstance(given, dict):
        raise InputError("values: a table of paths and numbers is required")
    values, problems = {}, []
    for path, value in given.items():
        slider = sliders.get(path)
        if slider is None:
            problems.append(f"{formatted(path)} is no slider of this page")
            continue
        problem = _problem(slider, value)
        if problem:
            problems.append(problem)
        else:
            values[path] = float(value)
    if problems:
        raise InputError(problems[:10])
    return values


def _problem(slider: Slider, value: Any) -> str:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number or not abs(value) < 1e300:
        return f"{slider.path}: {formatted(value)} is not a number"
    slack = 1e-6 * max(abs(slider.low), abs(slider.high))
    if not slider.low - slack <= value <= slider.high + slack:
        unit = f" {slider.unit}" if slider.unit else ""
        return (
            f"{slider.path}: {value:g}{unit} is out of range; "
            f"{slider.low:g} to {slider.high:g}{unit} is allowed"
        )
    if slider.whole and value != int(value):
        return f"{slider.path}: {value:g} is not a whole number"
    return ""
