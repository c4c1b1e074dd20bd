"""Checks of a measurement, group by group, and the exclusion of what they find."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chatter.explain.data_checks.clock import HOLE, evened
from chatter.explain.data_checks.finding import CHANNEL, FATAL, FOLLOWS, RUN, SAMPLES, SignalFinding
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement import Measurement, Run

#: channels without which no prediction can stand beside a signal
_ABSCISSAE = ("time", "spindle_angle", "spindle_speed")


@dataclass(frozen=True, eq=False)
class Checked:
    """A measurement, what was found in it, and what of it can be used."""

    measurement: Measurement  # without what is unusable
    findings: tuple[SignalFinding, ...]  # the worst first

    @property
    def is_fatal(self) -> bool:
        """Whether nothing can be concluded from the measurement beside its declared case."""
        return any(one.severity == FATAL for one in self.findings)

    @property
    def forbids_prediction(self) -> bool:
        """Whether not even times and samples are such that a prediction can stand beside them."""
        return any(one.severity == FATAL and one.channel in _ABSCISSAE for one in self.findings)

    def as_list(self) -> list[dict[str, Any]]:
        """Findings as they stand in explanation.json."""
        return [one.as_dict() for one in self.findings]


def checked(measurement: Measurement) -> Checked:
    """Check a measurement by the checks of its kind and exclude what is unusable.

    InputError if the case lacks a section, or a run a column that its kind needs.
    """
    if measurement.parts:
        return _checked_parts(measurement)
    kind = KINDS[measurement.kind]
    kind.require(measurement)
    found: list[SignalFinding] = []
    usable = measurement
    for number, group in enumerate(kind.checks):
        new = [finding for check in group for finding in check(usable)]
        found += new
        remaining = excluding(usable, new)
        if number == 0 and remaining.runs and not any(one.severity == FATAL for one in new):
            # what is told of records is believed of samples that are sound alone
            remaining, new = kind.as_recorded(remaining)
            found += new
        if any(one.severity == FATAL for one in new):
            break
        if not remaining.runs:
            description = f"none of the {len(measurement.runs)} runs can be used"
            found.append(SignalFinding(FATAL, "", "", description))
            break
        usable = remaining
    ranks = list(FOLLOWS)
    return Checked(usable, tuple(sorted(_once(found), key=lambda one: ranks.index(one.severity))))


def _checked_parts(measurement: Measurement) -> Checked:
    """Check every part of a set-up by itself."""
    parts = [checked(part) for part in measurement.parts]
    ranks = list(FOLLOWS)
    found = sorted(
        (finding for part in parts for finding in part.findings),
        key=lambda one: ranks.index(one.severity),
    )
    return Checked(measurement.with_parts([one.measurement for one in parts]), tuple(found))


def _once(found: Sequence[SignalFinding]) -> list[SignalFinding]:
    """Findings without those that report the same again."""
    seen: dict[tuple[str, str, str], SignalFinding] = {}
    for one in found:
        seen.setdefault((one.severity, one.run, one.description), one)
    return list(seen.values())


def excluding(measurement: Measurement, found: Sequence[SignalFinding]) -> Measurement:
    """Measurement without what is unusable.

    Samples that are unusable are bridged by a straight line and marked; holes in a clock are filled
    likewise.
    """
    dropped = {one.run for one in found if one.severity == RUN}
    runs = [run for run in measurement.runs if run.name not in dropped]
    return replace(measurement, runs=tuple(_without(run, found) for run in runs))


def _without(run: Run, found: Sequence[SignalFinding]) -> Run:
    own = [one for one in found if one.run == run.name]
    signals, usable = dict(run.signals), run.usable
    for one in own:
        if one.severity == CHANNEL:
            for name in one.channel.split(", "):
                signals.pop(name, None)
    marked = [one for one in own if one.severity == SAMPLES and one.samples is not None]
    for one in marked:
        if one.channel in ("stable", "spindle_power"):
            # the test counts by what else was noted of it
            signals[one.channel] = np.where(one.samples, np.nan, signals[one.channel])
        elif one.channel in signals:
            signals[one.channel] = bridged(signals[one.channel], one.samples)
            usable = (1.0 if usable is None else usable) * ~one.samples
    if any(one.channel == "time" for one in own) and "time" in signals:
        signals["time"] = evened(signals["time"])
        signals, usable = _on_even_clock(signals, usable)
    angle = signals.get("spindle_angle")
    if angle is not None and not np.all(np.isfinite(angle)) and np.isfinite(angle).any():
        signals["spindle_angle"] = bridged(angle, ~np.isfinite(angle))
    return replace(run, signals=signals, usable=usable)


def bridged(values: NDArray[np.float64], bad: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Values with a straight line across bad samples."""
    good = np.flatnonzero(~bad & np.isfinite(values))
    if not good.size:
        return np.zeros(values.size)
    return np.where(bad, np.interp(np.arange(values.size), good, values[good]), values)


def _on_even_clock(
    signals: dict[str, NDArray[np.float64]], usable: NDArray[np.float64] | None
) -> tuple[dict[str, NDArray[np.float64]], NDArray[np.float64] | None]:
    """Signals on an even clock, and which samples are usable: none in holes of the old one."""
    time = signals["time"]
    steps = np.diff(time)
    step = float(np.median(steps))
    holes = np.flatnonzero(steps > HOLE * step)
    count = round(float(time[-1] - time[0]) / step) + 1
    if count > 10 * time.size:
        return signals, usable  # a clock that jumps by more than the record is long
    even = time[0] + step * np.arange(count)
    kept = np.interp(even, time, np.ones(time.size) if usable is None else usable) > 0.999
    for hole in holes:
        kept &= ~((even > time[hole] + 0.5 * step) & (even < time[hole + 1] - 0.5 * step))
    found = {
        name: np.interp(even, time, values)
        for name, values in signals.items()
        if values.size == time.size
    }
    return {**found, "time": even}, kept.astype(np.float64)
