"""What a study computes at a point: numbers, curves for the picture, and words."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.units import rpm
from chatter.io.result_files import finite_or_none
from chatter.studies.frf_units import frf_unit

if TYPE_CHECKING:
    from chatter.simulation.finish import Finish
    from chatter.simulation.result import SimulationResult
    from chatter.studies.model import Model

_DRAWN_REVOLUTIONS = 2.0
_POINTS_PER_REVOLUTION = 720
_PROFILE_REVOLUTIONS = 12.0
_SIGNIFICANT = 7


@dataclass(frozen=True)
class Curve:
    """A line of the picture."""

    panel: str  # label of the vertical axis; panels with the same label are one
    name: str  # which of several of a point
    x: list[float | None]  # None leaves a gap
    y: list[float | None]  # None leaves a gap
    across: str  # label of the horizontal axis


@dataclass(frozen=True)
class Outcome:
    """Result at a point."""

    numbers: Mapping[str, float | None] = field(default_factory=dict)
    words: Mapping[str, str] = field(default_factory=dict)  # such as the verdict
    curves: tuple[Curve, ...] = ()
    failure: str = ""  # why there is no result; empty where there is one
    #: of numbers whose quantity leaves the unit open
    units: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Quantity:
    """A number that a study can show."""

    title: str  # in a sentence; "{speed}" stands for the speed of the cut
    unit: str
    beyond: str = ""  # number that it lies above where it is None
    at_zero: str = ""  # what is said in the place of 0
    most: float = math.inf  # beyond which it tells nothing but that
    bounds: str = ""  # number that it is a bound of, beside which it is said only where it differs
    read_as: str = ""  # of `UnitSystem`, where its unit does not tell


@dataclass(frozen=True)
class Measure:
    """A kind of result."""

    name: str
    quantities: Mapping[str, Quantity]  # the first is the main one
    #: of model, method and names, returns an Outcome
    evaluate: Callable[[Model, str | None, tuple[str, ...]], Outcome]
    logarithmic: bool = False  # scale of the curves


def _numbers(values: Array) -> list[float | None]:
    return [
        float(f"{value:.{_SIGNIFICANT}g}") if math.isfinite(value) else None
        for value in np.asarray(values, dtype=np.float64)
    ]


def _verdict(operating: Mapping[str, Any]) -> str:
    """Verdict on the operating point of a diagram, as `chatter check` says it."""
    if not operating["certain"]:
        return "not certain"
    return "stable" if operating["stable"] else "chatter"


def _lobes(case: Case, method: str | None, only: tuple[str, ...]) -> Outcome:
    del only
    from chatter.stability.lobes import lobes

    diagram = lobes(case, method)
    summary = diagram.summary()
    lowest, operating = summary["lowest_limit"], summary["operating_point"]
    curve = Curve(
        "critical depth [mm]",
        "",
        _numbers(rpm(diagram.limits.spindle_speed)),
        _numbers(diagram.limits.critical_depth * 1e3),
        "spindle speed [rpm]",
    )
    return Outcome(
        {
            "critical_depth_mm": operating["critical_depth_mm"],
            "lowest_limit_mm": lowest["critical_depth_mm"],
            "stable_below_mm": lowest["stable_below_mm"],
            "lowest_limit_speed_rpm": lowest["spindle_speed_rpm"],
            "max_axial_depth_mm": summary["max_axial_depth_mm"],
        },
        {"verdict": _verdict(operating)},
        (curve,),
    )


def _critical_depth(case: Case, method: str | None, only: tuple[str, ...]) -> Outcome:
    del only
    from chatter.stability.check import check

    found = check(case, method)
    summary = found.summary()
    return Outcome(
        {
            "critical_depth_mm": summary["critical_depth_mm"],
            "chatter_frequency_Hz": summary["limit"]["chatter_frequency_Hz"],
            "spectral_radius": summary["spectral_radius"],
            "certain_depth_mm": finite_or_none(found.lowest_depth * 1e3),
            "max_axial_depth_mm": summary["limit"]["max_axial_depth_mm"],
        },
        {"verdict": summary["verdict"]},
    )


def _simulated(case: Case) -> SimulationResult:
    from chatter.simulation.simulate import simulate

    result = simulate(case)
    if result.interrupted:
        # half a run is not a point of a study
        raise KeyboardInterrupt
    return result


def _forces(case: Case, method: str | None, only: tuple[str, ...]) -> Outcome:
    del method, only
    result = _simulated(case)
    summary = result.summary()
    mean = summary["mean_force_N"]
    settled = np.ptp(result.displacement[result.settled], axis=0)
    numbers = {
        "peak_resultant_N": summary["peak_resultant_N"],
        "mean_Fx_N": mean["Fx"],
        "mean_Fy_N": mean["Fy"],
        "mean_Fz_N": mean["Fz"],
        "mean_power_W": summary["power"]["mean_W"],
        "settled_displacement_um": float(settled.max(initial=0.0)) * 1e6,
        "chatter_frequency_Hz": summary["chatter_frequency_Hz"],
    }
    turned = result.spindle_angle / (2.0 * math.pi)
    first = int(np.searchsorted(turned, math.floor(turned[-1]) - _DRAWN_REVOLUTIONS))
    drawn = slice(
        first,
        None,
        max(1, math.ceil((len(turned) - first) / _DRAWN_REVOLUTIONS / _POINTS_PER_REVOLUTION)),
    )
    x = _numbers(turned[drawn])
    resultant = np.linalg.norm(result.force[drawn], axis=1)
    motion = np.linalg.norm(result.displacement[drawn], axis=1) * 1e6
    across = "revolutions of the spindle"
    curves = [Curve("resultant force [N]", "", x, _numbers(resultant), across)]
    if motion.any():
        label = "displacement of the tool [µm]"
        curves.append(Curve(label, "", x, _numbers(motion), across))
    return Outcome(numbers, {"verdict": summary["verdict"]}, tuple(curves))


def _surface(case: Case, method: str | None, only: tuple[str, ...]) -> Outcome:
    del method, only
    result = _simulated(case)
    summary = result.summary()
    finish = result.finish
    if not finish.walls and finish.floor is None:
        raise InputError(
            f"{case.name}: no surface is evaluated: {'; '.join(finish.notes) or 'none is left'}"
        )
    rough, place = summary["roughness"], summary["surface_location"]
    numbers = {
        "surface_location_error_um": summary["surface_location_error_um"],
        "Ra_um": rough["wall"]["Ra_um"],
        "Rz_um": rough["wall"]["Rz_um"],
        "floor_error_um": place["floor_um"],
        "floor_Ra_um": rough["floor"]["Ra_um"],
        "floor_Rz_um": rough["floor"]["Rz_um"],
        "chatter_frequency_Hz": summary["chatter_frequency_Hz"],
    }
    return Outcome(numbers, {"verdict": summary["verdict"]}, tuple(_profiles(case, finish)))


def _profiles(case: Case, finish: Finish) -> Iterator[Curve]:
    """Profiles of the surface along the feed, over a few revolutions."""
    of_surface = {
        f"wall {wall.profiles.side} near the tip [µm]": (
            wall.profiles.x,
            wall.profiles.deviation[0],
        )
        for wall in finish.walls
    }
    if finish.floor is not None and not finish.floor.profile.sharp:
        of_surface["floor [µm]"] = (finish.floor.profile.x, finish.floor.profile.height)
    drawn = _PROFILE_REVOLUTIONS * case.cut.feed_per_tooth * case.tool.teeth
    for label, (along, height) in of_surface.items():
        x = along - along[0]
        kept = x <= drawn
        y = _numbers(height[kept] * 1e6)
        yield Curve(label, "", _numbers(x[kept] * 1e3), y, "along the feed [mm]")


def _frf(model: Model, method: str | None, only: tuple[str, ...]) -> Outcome:
    del method
    frfs = _case_frfs(model) if isinstance(model, Case) else _machine_frfs(model, only)
    numbers: dict[str, float | None] = {}
    curves = []
    highest = (-1.0, "", 0.0, "")
    for name, quantity, given, frequency, values in frfs:
        unit, factor = frf_unit(given)
        size = factor * np.abs(values)
        peak = int(np.argmax(size))
        if size[peak] > highest[0]:
            highest = (float(size[peak]), name, float(frequency[peak]), unit)
        numbers[f"peak of {name} [{unit}]"] = float(size[peak])
        numbers[f"frequency of {name} [Hz]"] = float(frequency[peak])
        label = f"{quantity} [{unit}]"
        curves.append(Curve(label, name, _numbers(frequency), _numbers(size), "frequency [Hz]"))
    own = {"highest_peak": highest[0], "peak_frequency_Hz": highest[2]}
    units = {"highest_peak": highest[3]}
    return Outcome({**own, **numbers}, {"highest": highest[1]}, tuple(curves), units=units)


def _case_frfs(case: Case) -> list[tuple[str, str, str, Any, Any]]:
    """FRFs of the tool against the workpiece that are not zero."""
    from chatter.compile.structure import structure_of
    from chatter.engine.loop_stability import refuse_unstable_structure

    case.require("structure")
    structure = structure_of(case)
    refuse_unstable_structure(structure)
    lines, values = structure.receptance()
    return [
        (f"tool {axis}", "receptance", "m/N", lines, values[:, k, k])
        for k, axis in enumerate("xyz")
        if np.any(np.abs(values[:, k, k]) > 0.0)
    ]


def _machine_frfs(machine: Any, only: tuple[str, ...]) -> list[tuple[str, str, str, Any, Any]]:
    """FRFs that a machine file asks for, of the linearised machine."""
    from chatter.simulation.virtual_tests.from_file import default_frfs, frfs

    unknown = [name for name in only if name not in machine.frf]
    if unknown:
        known = ", ".join(machine.frf) or "none"
        raise InputError(
            f"{machine.name}: --only {unknown[0]}: there is no [frf.{unknown[0]}]; there are "
            f"{known}"
        )
    sections = machine.frf or default_frfs(machine)
    linear = {
        name: section.model_copy(update={"by": "linearised"})
        for name, section in sections.items()
        if not only or name in only
    }
    found = []
    for curve in frfs(machine, linear).curves:
        frf = curve.harmonic
        found.append((curve.name, frf.quantity, curve.unit, frf.frequency, frf.values))
    return found


_CRITICAL = Quantity("critical depth at {speed}", "mm", beyond="max_axial_depth_mm")
_CERTAIN = Quantity(
    "depth stable for certain at {speed}, whatever linear methods leave out",
    "mm",
    beyond="max_axial_depth_mm",
    at_zero="not known",
    bounds="critical_depth_mm",
)
_CERTAIN_ANYWHERE = Quantity(
    "depth stable for certain at any of the speeds",
    "mm",
    beyond="max_axial_depth_mm",
    at_zero="not known",
    bounds="lowest_limit_mm",
)
_LOWEST = Quantity("lowest critical depth over speed", "mm", beyond="max_axial_depth_mm")
_CHATTER_FREQUENCY = Quantity("chatter frequency", "Hz")

_MEASURES = (
    Measure(
        "lobes",
        {
            "critical_depth_mm": _CRITICAL,
            "lowest_limit_mm": _LOWEST,
            "stable_below_mm": _CERTAIN_ANYWHERE,
        },
        _lobes,
    ),
    Measure(
        "critical depth",
        {
            "critical_depth_mm": _CRITICAL,
            "chatter_frequency_Hz": Quantity("chatter frequency at the limit", "Hz"),
            "certain_depth_mm": _CERTAIN,
            "spectral_radius": Quantity("spectral radius of the cut", "", most=1e3),
        },
        _critical_depth,
    ),
    Measure(
        "forces",
        {
            "peak_resultant_N": Quantity("peak of the resultant force", "N"),
            "settled_displacement_um": Quantity("motion of the tool after the start", "um"),
            "mean_power_W": Quantity("mean power", "W"),
            "mean_Fx_N": Quantity("mean force along x", "N"),
            "mean_Fy_N": Quantity("mean force along y", "N"),
            "mean_Fz_N": Quantity("mean force along z", "N"),
            "chatter_frequency_Hz": _CHATTER_FREQUENCY,
        },
        _forces,
    ),
    Measure(
        "surface",
        {
            "surface_location_error_um": Quantity("surface location error", "um"),
            "Ra_um": Quantity("roughness Ra", "um", read_as="roughness"),
            "Rz_um": Quantity("roughness Rz", "um", read_as="roughness"),
            "floor_error_um": Quantity("depth error of the floor", "um"),
            "floor_Ra_um": Quantity("roughness Ra of the floor", "um", read_as="roughness"),
            "floor_Rz_um": Quantity("roughness Rz of the floor", "um", read_as="roughness"),
            "chatter_frequency_Hz": _CHATTER_FREQUENCY,
        },
        _surface,
    ),
    Measure(
        "frf",
        {
            "highest_peak": Quantity("highest peak of the FRF", ""),
            "peak_frequency_Hz": Quantity("frequency of the highest peak", "Hz"),
        },
        _frf,
        logarithmic=True,
    ),
)
#: name -> kind of result
MEASURES: dict[str, Measure] = {one.name: one for one in _MEASURES}


def measure_of(name: str | None, model: Model) -> Measure:
    """Kind of result by its name; lobes of a case and FRFs of a machine by default.

    InputError if there is none of that name, or a machine alone cannot have it.
    """
    of_case = isinstance(model, Case)
    chosen = (name or ("lobes" if of_case else "frf")).replace("-", " ")
    if chosen not in MEASURES:
        known = ", ".join(MEASURES)
        raise InputError(f'--result "{name}" is not known; there are {known}')
    if not of_case and chosen != "frf":
        raise InputError(
            f"{model.name}: --result {chosen}: a machine alone makes no cut; give a case with "
            "[structure] machine, or --result frf"
        )
    return MEASURES[chosen]
