"""Points judged stable or chatter: numbers out of any sense, units, verdicts turned round."""

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError, RunError
from chatter.description.unit_system import units_of
from chatter.description.units import from_rpm, rpm
from chatter.explain.data_checks.finding import FATAL, NOTE, RUN, SAMPLES, SignalFinding
from chatter.explain.measurement import Measurement, Run
from chatter.explain.stability_margin import stability_margins

Vector = NDArray[np.float64]

#: what no spindle turns at, rad/s, and no depth, m
_SPEEDS, _DEPTHS = (0.1, 1e5), (1e-7, 1.0)
#: chance that a stable point is the deeper one of a pair at like speeds, beyond which the
#: verdicts are turned round
_TURNED = 0.75
#: share of verdicts that the declared case has right at the most, where they are turned round
_MOST_RIGHT = 0.45
_UNITS = {
    "rad/s taken as rpm": rpm(1.0),
    "rpm taken as rad/s": from_rpm(1.0),
    "revolutions a second taken as rpm": 60.0,
    "in another unit, off by 1000": 1000.0,
    "in another unit, off by 1/1000": 0.001,
}
#: of the range of speeds beyond which a declared speed has nothing to do with it
_OUTSIDE = 3.0


def wrong_verdicts(measurement: Measurement) -> list[SignalFinding]:
    """Points without sense, speeds in a wrong unit, verdicts turned round."""
    run = measurement.runs[0]
    found = _senseless(measurement, run)
    bad = found[0].samples if found else np.zeros(run.signals["stable"].size, dtype=bool)
    judged = np.isfinite(run.signals["stable"]) & ~bad
    speeds = run.signals["spindle_speed"][judged]
    stable = run.signals["stable"][judged] > 0.5
    if stable.size < 6:
        return found
    if stable.all() or not stable.any():
        word = "stable" if stable.all() else "chatter"
        description = (
            f"{run.name}: all {stable.size} verdicts are {word}: no limit lies among the points"
        )
        return [*found, SignalFinding(NOTE, run.name, "stable", description)]
    return [*found, *_units(measurement, run, speeds), *_turned(measurement, run, judged)]


def _senseless(measurement: Measurement, run: Run) -> list[SignalFinding]:
    speeds, depths = run.signals["spindle_speed"], run.signals["axial_depth"]
    good = (speeds >= _SPEEDS[0]) & (speeds <= _SPEEDS[1])
    good &= (depths >= _DEPTHS[0]) & (depths <= _DEPTHS[1])
    if good.all():
        return []
    first = int(np.argmin(good))
    description = (
        f"{run.name}: {np.sum(~good)} of {good.size} points are out of any sense, the first at "
        f"point {first + 1}: {rpm(speeds[first]):.4g} rpm, "
        f"{units_of(measurement.case).length.text(depths[first])}"
    )
    severity = SAMPLES if good.mean() > 0.7 else RUN
    return [SignalFinding(severity, run.name, "stable", description, ~good)]


def _units(measurement: Measurement, run: Run, speeds: Vector) -> list[SignalFinding]:
    declared = measurement.case.cut.spindle_speed if measurement.case.cut else None
    if not declared:
        return []
    low, high = float(speeds.min()), float(speeds.max())
    if low / _OUTSIDE <= declared <= high * _OUTSIDE:
        return []
    for description, factor in _UNITS.items():
        if low * factor / 1.3 <= declared <= high * factor * 1.3:
            text = (
                f"{run.name}: the speeds are {description}: {rpm(low):.4g} to "
                f"{rpm(high):.4g} rpm; the case declares "
                f"{rpm(declared):.4g} rpm"
            )
            return [SignalFinding(FATAL, run.name, "spindle_speed", text)]
    return []


def _turned(measurement: Measurement, run: Run, judged: NDArray[np.bool_]) -> list[SignalFinding]:
    speeds, depths = run.signals["spindle_speed"][judged], run.signals["axial_depth"][judged]
    stable = run.signals["stable"][judged] > 0.5
    deeper = stable_is_deeper(speeds, depths, stable)
    if deeper < _TURNED:
        return []
    try:
        margins = stability_margins(measurement.case, speeds, depths)
    except (InputError, RunError):
        return []  # a case that cannot be used is reported where it is
    right = float(np.mean((margins > 0.0) == stable))
    if right > _MOST_RIGHT:
        return []
    description = (
        f"{run.name}: the verdicts are turned round: of two points at like speeds the stable one "
        f"is the deeper one in {100.0 * deeper:.0f} % of the pairs, and the declared case has "
        f"{100.0 * right:.0f} % of the verdicts right, turned round "
        f"{100.0 * (1.0 - right):.0f} %"
    )
    return [SignalFinding(FATAL, run.name, "stable", description)]


def stable_is_deeper(speeds: Vector, depths: Vector, stable: NDArray[np.bool_]) -> float:
    """Share of the pairs of a stable point and one with chatter in which the stable one is deeper.

    Depths are taken over their trend with speed, as tests are made near the limit.
    """
    speed, depth = np.log(speeds), np.log(depths)
    degree = 2 if np.unique(speed).size > 5 else 0
    trend = np.polyval(np.polyfit(speed - speed.mean(), depth, degree), speed - speed.mean())
    above = depth - trend
    return float(np.mean(above[stable][:, None] > above[~stable][None, :]))
