"""What a call gives for a case, as names and numbers.

This is the only place of the stored numbers that knows names of attributes and keys in results: who
renames one changes it here, and the stored names stay.
"""

from __future__ import annotations

import math
import runpy
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

import chatter
from tests.stored_numbers.cases import StoredCase

RPM = 30.0 / math.pi

#: share by which numbers of deterministic linear algebra and fixed steps may differ: what another
#: processor or another order of sums does to them is about 1e-12, kinds of search stop at 1e-9
EXACT = 1e-6
#: fits and searches end where progress is small: within their own stopping criterion
SEARCHED = 1e-4


class Reading(NamedTuple):
    """A number, a text, or a short list of them.

    Parameters
    ----------
    value : float, int, str, bool or list
        nan and inf stand for themselves.
    unit : str
    rtol : float
        Of the largest magnitude in a list.
    atol : float
        For numbers that are what is left of larger ones.
    """

    value: Any
    unit: str = ""
    rtol: float = EXACT
    atol: float = 0.0


Readings = dict[str, Reading]


def _spread(values: Sequence[Any], most: int = 8) -> list[Any]:
    """At most so many entries, evenly spread, the first and last among them."""
    if len(values) <= most:
        return list(values)
    return [values[i] for i in np.linspace(0, len(values) - 1, most).round().astype(int)]


def _numbers(values: Any, most: int = 8) -> list[float]:
    return [float(value) for value in _spread(np.ravel(np.asarray(values, dtype=float)), most)]


def _case(stored: StoredCase) -> chatter.Case:
    case = chatter.load(stored.file)
    if stored.machine_patch:
        case = case.with_machine(case.machine_file().patch(stored.machine_patch))
    return case.patch(stored.patch) if stored.patch else case


def _machine(stored: StoredCase) -> Any:
    machine = chatter.load_machine(stored.file)
    return machine.patch(stored.patch) if stored.patch else machine


# -- stability ------------------------------------------------------------------------------------


def check(stored: StoredCase) -> Readings:
    """Verdict on the operating point and limit at its speed."""
    result = chatter.check(_case(stored), **stored.arguments)
    limit, rtol = result.limit, stored.rtol or EXACT
    return {
        "method": Reading(result.method),
        "stable": Reading(bool(result.stable)),
        "bifurcation": Reading(result.bifurcation),
        "spectral radius": Reading(float(result.spectral_radius), "", rtol),
        "chatter frequency": Reading(float(result.chatter_frequency), "Hz", rtol),
        "critical depth": Reading(1e3 * float(result.critical_depth), "mm", rtol),
        "bifurcation at the limit": Reading(limit.bifurcation[0]),
        "frequency at the limit": Reading(float(limit.chatter_frequency[0]), "Hz", rtol),
        "crossings": Reading(_numbers(1e3 * limit.crossings[0]), "mm", rtol),
        "zeroth-order depth": Reading(1e3 * float(result.zero_order_depth), "mm"),
    }


def lobes(stored: StoredCase) -> Readings:
    """Limits over speed, the grid where it is asked for, and pockets."""
    result = chatter.lobes(_case(stored), **stored.arguments)
    limits = result.limits
    found = {
        "method": Reading(result.method),
        "speeds": Reading(_numbers(RPM * limits.spindle_speed), "rpm"),
        "critical depths": Reading(_numbers(1e3 * limits.critical_depth), "mm"),
        "chatter frequencies": Reading(_numbers(limits.chatter_frequency), "Hz"),
        "bifurcations": Reading(_spread(limits.bifurcation)),
        "changes of stability": Reading([len(one) for one in _spread(limits.crossings)]),
        "searched to": Reading(1e3 * float(result.max_depth[0]), "mm"),
        "zeroth-order depths": Reading(_numbers(1e3 * result.zero_order.critical_depth), "mm"),
        "depth at the operating speed": Reading(
            1e3 * float(result.operating.critical_depth[0]), "mm"
        ),
        "pockets": Reading([RPM * float(one.spindle_speed) for one in result.pockets[:4]], "rpm"),
    }
    if result.grid is not None:
        radius = result.grid.spectral_radius
        rows = _spread(range(len(radius)), 3)
        columns = _spread(range(radius.shape[1]), 3)
        found["spectral radius on the grid"] = Reading(_numbers(radius[rows][:, columns], 9))
    return found


def lobes_over(stored: StoredCase) -> Readings:
    """Limit depth over a value of the case."""
    result = chatter.lobes_over(_case(stored), **stored.arguments)
    return {
        "values": Reading(_numbers(result.axis.values)),
        "critical depths": Reading(_numbers(1e3 * result.limits.critical_depth), "mm"),
        "chatter frequencies": Reading(_numbers(result.limits.chatter_frequency), "Hz"),
    }


# -- time domain ----------------------------------------------------------------------------------


def simulate(stored: StoredCase) -> Readings:
    """Verdict, forces, vibration, power, surface and energy of a cut in time."""
    result = chatter.simulate(_case(stored))
    summary = result.summary()
    rtol = stored.rtol or EXACT
    # the numbers were stored when the record of a machine began one row after the start
    first = 1 if "machine" in summary else 0
    force, moved = result.force, 1e6 * result.displacement
    sampled_force, sampled_motion = force[first:], moved[first:]
    # samples at odd places in time show a shift of the phase that no peak or mean shows
    places = (np.array([0.117, 0.391, 0.683, 0.947]) * (len(sampled_force) - 1)).round()
    places = places.astype(int)
    size, swing = float(np.abs(force).max()), float(np.abs(moved).max())
    settled = moved[result.settled]
    found = {
        "verdict": Reading(summary["verdict"]),
        "bifurcation": Reading(summary.get("bifurcation", "not judged")),
        "chatter frequency": Reading(
            _or_nan(summary["chatter_frequency_Hz"]), "Hz", max(rtol, SEARCHED)
        ),
        "steps a revolution": Reading(float(summary["resolution"]["steps_per_revolution"])),
        "revolutions": Reading(float(summary["revolutions"])),
        "peak force": Reading(_numbers(np.abs(force).max(axis=0)), "N", rtol),
        "mean force": Reading(_numbers(force[result.settled].mean(axis=0)), "N", rtol, rtol * size),
        "force at four times": Reading(_numbers(sampled_force[places], 12), "N", rtol, rtol * size),
        "displacement at four times": Reading(_numbers(sampled_motion[places], 12), "um", rtol),
        "peak displacement": Reading(_numbers(np.abs(moved).max(axis=0)), "um", rtol),
        "standard deviation of the displacement": Reading(
            _numbers(settled.std(axis=0)), "um", rtol, rtol * swing
        ),
        "mean power": Reading(float(summary["power"]["mean_W"]), "W", rtol),
    }
    surface = {
        "location error": summary["surface_location_error_um"],
        "wall Ra": summary["roughness"]["wall"]["Ra_um"],
        "floor Ra": summary["roughness"]["floor"]["Ra_um"],
    }
    for name, value in surface.items():
        if value is not None:
            found[name] = Reading(float(value), "um", rtol, rtol * swing)
    for name, value in result.energy.items():
        found[f"energy {name}"] = Reading(float(value), "J", rtol)
    if "workpiece" in summary:
        found["removed volume"] = Reading(summary["workpiece"]["removed_volume_mm3"], "mm^3", rtol)
    if "machine" in summary:
        of_machine = summary["machine"]
        found["mean spindle speed"] = Reading(of_machine["spindle_speed_rpm"]["mean"], "rpm", rtol)
        for drive, efforts in of_machine["drives"].items():
            peak = float(efforts["peak_effort"])
            found[f"peak effort {drive}"] = Reading(peak, "N or N m", rtol)
            found[f"mean effort {drive}"] = Reading(
                float(efforts["mean_effort"]), "N or N m", rtol, rtol * peak
            )
    return found


def bifurcation(stored: StoredCase) -> Readings:
    """Once-per-period points of cuts over a value."""
    arguments = stored.arguments
    result = chatter.bifurcation(_case(stored), arguments["path"], arguments["values"])
    points = result.summary()["points"]
    rtol = stored.rtol or EXACT
    return {
        "verdicts": Reading([one["verdict"] for one in points]),
        "bifurcations": Reading([one["bifurcation"] for one in points]),
        "spread": Reading([one["spread_um"] for one in points], "um", rtol),
    }


# -- machines -------------------------------------------------------------------------------------


def frf(stored: StoredCase) -> Readings:
    """Frequency responses of a machine, linearised and by test."""
    result = chatter.frf(_machine(stored), stored.arguments["names"])
    found = {}
    for curve in result.curves:
        summary = curve.summary()
        unit = summary["unit"]
        found[f"{curve.name}: largest"] = Reading(summary["largest"]["magnitude"], unit)
        found[f"{curve.name}: at"] = Reading(summary["largest"]["frequency_Hz"], "Hz")
        for name, response in (("linearised", curve.harmonic), ("tested", curve.tested)):
            if response is not None:
                values = np.array(_spread(response.values, 6))
                size = float(np.abs(values).max())
                found[f"{curve.name}: {name}"] = Reading(
                    _numbers(np.column_stack([values.real, values.imag]), 12),
                    unit,
                    EXACT,
                    EXACT * size,
                )
        for name, peaks in (
            ("peaks", summary["peaks"]),
            ("peaks of the test", summary["tested_peaks"] or []),
        ):
            frequencies = [float(peak["frequency_Hz"]) for peak in peaks]
            found[f"{curve.name}: {name}"] = Reading(_numbers(frequencies), "Hz")
    return found


def move(stored: StoredCase) -> Readings:
    """Tracking and contour error of a trajectory."""
    result = chatter.move(_machine(stored), stored.arguments["name"])
    summary = result.summary()
    rtol = stored.rtol or EXACT
    found = {"duration": Reading(float(summary["duration_s"]), "s")}
    for axis, errors in summary["axes"].items():
        for name, value in errors.items():
            if name == "effort_unit":
                continue
            unit = "N or N m" if name == "effort" else "um"
            found[f"{axis} {name.removesuffix('_um').replace('_', ' ')}"] = Reading(
                float(value), unit, rtol
            )
    if summary["contour_error_um"] is not None:
        found["contour error"] = Reading(float(summary["contour_error_um"]), "um", rtol)
    places = (np.array([0.117, 0.391, 0.683, 0.947]) * (len(result.time) - 1)).round().astype(int)
    effort = result.effort[places]
    found["effort at four times"] = Reading(
        _numbers(effort, 12), "N or N m", rtol, rtol * float(np.abs(result.effort).max())
    )
    for name, force in result.friction.items():
        found[f"friction {name} at four times"] = Reading(
            _numbers(force[places]), "N or N m", rtol, rtol * float(np.abs(force).max())
        )
    return found


# -- studies --------------------------------------------------------------------------------------


def optimum(stored: StoredCase) -> Readings:
    """Best cut within the limits of a case."""
    summary = chatter.optimum(_case(stored), **stored.arguments).summary()
    best = summary["best"]
    rtol = SEARCHED
    found = {
        "feasible": Reading(bool(summary["feasible"])),
        "points": Reading(int(summary["searched"]["points"])),
        "excluded share": Reading([float(one) for one in summary["excluded_share"].values()]),
    }
    if best is not None:
        found |= {
            "limited by": Reading(list(best["active"])),
            "spindle speed": Reading(best["spindle_speed_rpm"], "rpm", rtol),
            "axial depth": Reading(best["axial_depth_mm"], "mm", rtol),
            "radial depth": Reading(best["radial_depth_mm"], "mm", rtol),
            "removal rate": Reading(best["removal_rate_cm3_per_min"], "cm^3/min", rtol),
            "power": Reading(best["power_W"], "W", rtol),
            "deflection": Reading(best["deflection_um"], "um", rtol),
            "surface error": Reading(best["surface_error_um"], "um", rtol, 1e-3),
            "verdict in time": Reading((best["time_domain"] or {}).get("verdict", "none")),
        }
        if best["probability"] is not None:
            found["probability"] = Reading(best["probability"])
    return found


def pitch(stored: StoredCase) -> Readings:
    """Pitch angles for a range of speeds."""
    summary = chatter.pitch(_case(stored)).summary()
    return {
        "best": Reading(summary["best"]["name"]),
        "pitch": Reading([float(one) for one in summary["best"]["pitch_deg"]], "deg", SEARCHED),
        "lowest limit before": Reading(summary["lowest_limit_mm"]["before"], "mm"),
        "lowest limit after": Reading(summary["lowest_limit_mm"]["after"], "mm", SEARCHED),
        "chatter frequency": Reading(summary["rule"]["chatter_frequency_Hz"], "Hz"),
    }


def uncertainty(stored: StoredCase) -> Readings:
    """Limits with what is known of material and modes."""
    result = chatter.uncertainty(_case(stored), **stored.arguments)
    summary = result.summary()
    limit = summary["limit_at_operating_speed_mm"]
    return {
        "probability of stability": Reading(summary["operating_point"]["probability_of_stability"]),
        "mean limit": Reading(limit["mean"], "mm"),
        "standard deviation of the limit": Reading(limit["standard_deviation"], "mm"),
        "limits of the first samples": Reading(_numbers(1e3 * result.operating[:6]), "mm"),
        "shares of the variance": Reading(
            [float(one["share_of_variance"]) for one in summary["parameters"]]
        ),
    }


def whatif(stored: StoredCase) -> Readings:
    """What would change if values were others."""
    arguments = dict(stored.arguments)
    result = chatter.whatif(_case(stored), arguments.pop("vary"), **arguments)
    return {
        "points": Reading([" ".join(point.labels) for point in result.points]),
        result.quantity: Reading([_or_nan(value) for value in result.values()]),
    }


def modes(stored: StoredCase) -> Readings:
    """Modal parameters from measured FRFs."""
    result = chatter.modes(stored.file, **stored.arguments)
    found = result.fit.identified
    # the fit stops at its own criterion, and its last digits hang on the library of linear algebra
    return {
        "frequencies": Reading([float(one.frequency) for one in found], "Hz", SEARCHED),
        "damping": Reading([float(one.damping) for one in found], "", 1e-3),
        "masses": Reading([_or_nan(one.mass) for one in found], "kg", 1e-3),
        "fit error": Reading(max(float(one.rms) for one in result.fit.errors), "", 1e-3),
        "band": Reading([float(result.fit.band.lowest), float(result.fit.band.highest)], "Hz"),
    }


# -- measurements ---------------------------------------------------------------------------------


def compare(stored: StoredCase) -> Readings:
    """Error of the declared case against a measurement."""
    told = chatter.compare(stored.file).summary()
    runs = _spread(told["runs"], 6)
    return {
        "kind": Reading(told["kind"]),
        "error over signal": Reading(_or_nan(told["nrmse"])),
        "runs": Reading([f"{one['run']}: {one['channel']}" for one in runs]),
        "error of runs": Reading([float(one["error"]) for one in runs], "SI"),
        "error over noise": Reading([float(one["over_noise"]) for one in runs], "", 1e-4),
    }


def explain(stored: StoredCase) -> Readings:
    """Verdict on a measurement, the effects named and the errors before and after."""
    told = chatter.explain(stored.file).summary()
    effects, error = told["effects"], told["error"]
    found = {
        "verdict": Reading(told["verdict"]),
        "effects": Reading([one["name"] for one in effects]),
        "partial": Reading([one["name"] for one in told["partial"]]),
    }
    for effect in effects:
        for name, one in effect["parameters"].items():
            # least squares end within a ten-thousandth of the parameter's own interval
            low, high = one["ci95"] or (one["value"], one["value"])
            width = float(high - low)
            found[f"{effect['name']}: {name}"] = Reading(
                float(one["value"]), one["unit"], 1e-3, 1e-2 * width
            )
    for name in ("declared", "before", "after", "holdout_before", "holdout_after", "noise_floor"):
        value = _or_nan(error.get(name))
        found[f"error {name.replace('_', ' ')}"] = Reading(value, "", stored.rtol or 1e-3)
    return found


def script(stored: StoredCase) -> Readings:
    """Natural frequencies of the machine that an example's script builds."""
    made = runpy.run_path(str(stored.file))
    structure = made["machine"](tuple(stored.arguments["numbers"]))
    return {"natural frequencies": Reading(_numbers(structure.natural_frequencies(8)), "Hz")}


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else float(value)


#: name in cases.toml -> what computes it
CALLS: Mapping[str, Callable[[StoredCase], Readings]] = {
    one.__name__: one
    for one in (
        check,
        lobes,
        lobes_over,
        simulate,
        bifurcation,
        frf,
        move,
        optimum,
        pitch,
        uncertainty,
        whatif,
        modes,
        compare,
        explain,
        script,
    )
}


def readings(stored: StoredCase) -> Readings:
    """Compute what a case gives."""
    return CALLS[stored.call](stored)
