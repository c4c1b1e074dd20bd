"""`chatter simulate CASE`: the cut in the time domain."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.cli.errors import EXIT_RUN_FAILED
from chatter.cli.progress import progress_bar
from chatter.cli.results import present
from chatter.description.formatting import to_digits
from chatter.description.unit_system import METRIC, UnitSystem
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.io.result_tables import KINDS, require_kind
from chatter.report.console import print_answer, print_line, print_table

if TYPE_CHECKING:
    from chatter.description.case import Case
    from chatter.simulation.result import SimulationResult

#: peak at the start over that of the settled cut from which on it is worth a line
_NOTABLE = 1.02
#: W from which on power is printed in kW
_LARGE_POWER = 1e4
#: cutting edge angle from which on an edge makes a wall, deg
_UPRIGHT = 89.0


def simulate(
    case: options.CaseFile,
    assignments: options.Assignments = None,
    chip: Annotated[
        str | None, typer.Option("--chip", help="delay (default), dexel or voxel.")
    ] = None,
    signals: Annotated[
        str, typer.Option("--signals", help=f"File of the signals: {', '.join(KINDS)}.")
    ] = "csv",
    out: options.OutputFolder = None,
    json: options.Json = False,
) -> None:
    """Simulate the cut of a case: forces, vibration, surface, chatter or not."""
    require_kind(signals, "signals")
    description = options.patched_case(case, assignments)
    if chip is not None:
        description = description.patch({"simulation.chip": chip})
    from chatter.engine.loop import run
    from chatter.simulation.displaced_too_far import DisplacedTooFarError
    from chatter.simulation.simulate import simulate as run_simulation
    from chatter.stability.beside_simulation import linear_verdict
    from chatter.stability.verdict_of_displaced import with_linear_verdict

    folder = options.output_folder(out, case.stem)
    failure = None
    with progress_bar("time steps of the cut", run) as work:
        try:
            result = run_simulation(description, progress=work)
        except DisplacedTooFarError as error:
            failure = error
            work.begin("critical depth, for a verdict")
            result = with_linear_verdict(error, work)
        work.begin("linear verdict on the same cut")
        linear = None if failure is not None else linear_verdict(result)
        if linear is not None:
            result = replace(result, linear=linear)
    options.print_coefficients(description)
    present(
        result,
        folder,
        json=json,
        words=_print_summary,
        notes=result.summary()["notes"],
        save=partial(result.save, signals=signals),
    )
    if failure is not None:
        raise failure
    if result.interrupted:
        raise typer.Exit(EXIT_RUN_FAILED)


def _print_summary(result: SimulationResult) -> None:
    summary, units = result.summary(), result.units
    force, torque = units.force, units.torque
    cutting_speed, feed_rate = units.instead_of("m/min"), units.instead_of("mm/min")
    peak, mean = summary["peak_force_N"], summary["mean_force_N"]
    rows = [[name, _shown(peak[name], force), _shown(mean[name], force)] for name in peak]
    part = "in chatter" if summary["verdict"] == "chatter" else "settled cut"
    headers = ["", f"peak [{force.name}]", f"mean [{force.name}]"]
    print_table(f"force on the tool, {part}", headers, rows)
    power = summary["power"]
    print_line(
        f"power {_power(power['mean_W'], units)} mean, {_power(power['peak_W'], units)} peak; "
        f"torque {to_digits(power['mean_torque_Nm'] * torque.factor, 3)} {torque.name} mean"
    )
    print_line(
        f"{_speed(result.case)}, cutting speed "
        f"{cutting_speed.text(summary['cutting_speed_m_per_min'])}"
        f"{_speed_in_cut(result.case, units)}, feed rate "
        f"{to_digits(summary['feed_rate_mm_per_min'] * feed_rate.factor, 4)} {feed_rate.name}; "
        f"displacement {_displacement(summary['peak_displacement_um'], units)} peak"
    )
    _print_transient(summary, units)
    for line in _surface(summary, _edge_angle(result), units):
        print_line(line)
    frequency = summary["chatter_frequency_Hz"]
    at = "" if frequency is None else f" at {frequency:.1f} Hz"
    print_answer(f"{summary['verdict']}{at}: {summary['reason']}")
    if result.linear is not None:
        print_line(result.linear.sentence())


def _shown(force: float, unit: UsualUnit) -> str:
    """Force to four digits, and to a thousandth of a newton: below is rounding alone."""
    return to_digits((round(force, 3) + 0.0) * unit.factor, 4)


def _displacement(length: float, units: UnitSystem, digits: int = 3) -> str:
    """Length, um, in the unit that is read."""
    unit = units.instead_of("um")
    return f"{to_digits(length * unit.factor, digits)} {unit.name}"


def _power(power: float, units: UnitSystem) -> str:
    if units is not METRIC:
        return units.power.text(power)
    return f"{power:.4g} W" if abs(power) < _LARGE_POWER else f"{power / 1e3:.4g} kW"


def _speed(case: Case) -> str:
    return f"{to_digits(rpm(case.cut.spindle_speed), 4)} rpm"


def _speed_in_cut(case: Case, units: UnitSystem) -> str:
    """Largest diameter in the cut and the speed there, where it is another than the diameter."""
    from chatter.compile.inclined_axis import diameter_in_cut

    wide = None if case.stock is not None else diameter_in_cut(case)
    if wide is None:
        return ""
    there = units.cutting_speed.text(0.5 * wide * case.cut.spindle_speed)
    return f" on the diameter, {there} on the {units.length.text(wide)} that cut"


def _edge_angle(result: SimulationResult) -> float:
    """Angle of the edge against the plane of the feed at the depth of the cut, deg.

    On a ball or a corner that is deeper than the cut it is that of the arc there.
    """
    cutter, depth = result.setup.cutter, result.case.cut.axial_depth
    corner = cutter.corner_radius
    if depth < corner * (1.0 - math.cos(cutter.edge_angle)):
        return math.degrees(math.acos(1.0 - depth / corner))
    return math.degrees(cutter.edge_angle)


def _surface(summary: dict, edge_angle: float, units: UnitSystem) -> list[str]:
    """Lines on what the cut leaves behind: wall and floor, each where it makes one."""
    location, rough = summary["surface_location"], summary["roughness"]
    wall, floor = summary["surface_location_error_um"], location["floor_um"]
    # an inclined edge leaves a shoulder, which is the work of the next pass
    name = "wall" if edge_angle > _UPRIGHT else f"shoulder at {edge_angle:.3g} deg"
    lines = []
    if wall is not None:
        shown = f"{_displacement(wall, units)} (too {_removed(wall)} removed)"
        lines.append(f"{name}: surface location error {shown}{_roughness(rough['wall'], units)}")
    if floor is not None:
        depth = f"{_displacement(abs(floor), units)} too {'high' if floor < 0.0 else 'deep'}"
        lines.append(f"floor: {depth}{_roughness(rough['floor'], units)}")
    scallops = summary.get("scallop_height_um")
    if scallops is not None:
        lines.append(f"between passes: scallops of {_displacement(scallops, units)}")
    return lines if edge_angle > _UPRIGHT else lines[::-1]


def _removed(error: float) -> str:
    """What a surface location error, positive into the work, says of the work removed."""
    return "little" if error < 0.0 else "much"


def _roughness(heights: dict, units: UnitSystem) -> str:
    if heights["Ra_um"] is None:
        return ""
    unit, factor = units.instead_of("um", "roughness")
    mean, depth = (to_digits(heights[key] * factor, 3) for key in ("Ra_um", "Rz_um"))
    return f", Ra {mean} {unit}, Rz {depth} {unit}"


def _print_transient(summary: dict, units: UnitSystem) -> None:
    """Print what the start exceeds the settled cut by, where it does."""
    start = summary.get("transient")
    if start is None:
        return
    above = [
        f"{to_digits(start[key] * unit.factor, 4)} {unit.name}"
        for key, unit in (
            ("peak_resultant_N", units.force),
            ("peak_displacement_um", units.instead_of("um")),
        )
        if start[key] > _NOTABLE * summary[key]
    ]
    if above:
        print_line(f"at the start, until {start['until_s']:.3g} s: up to {' and '.join(above)}")
