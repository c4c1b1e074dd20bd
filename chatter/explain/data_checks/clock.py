"""Clock of time records: rising, even, in seconds, without holes."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from chatter.description.formatting import to_digits
from chatter.explain.data_checks.finding import (
    NOTE,
    RUN,
    SAMPLES,
    Check,
    SignalFinding,
    of_all_or_some,
)
from chatter.explain.measurement import Measurement, Run

#: scatter of the steps, as a share of the step, that is said
_JITTER = 0.05
#: a step of more than this many is a hole
HOLE = 1.6
#: step between samples that no record has, s
_SHORTEST_STEP = 1e-7


def clock_check(longest_step: float) -> Check:
    """Check of clocks that no record of whose kind has longer steps, s."""
    return partial(_clock_findings, longest_step)


def _clock_findings(longest_step: float, measurement: Measurement) -> list[SignalFinding]:
    """Clocks that stand, run back, jump, jitter or count in another unit."""
    found = []
    wrong_units = []
    for run in measurement.runs:
        time = run.signals.get("time")
        if time is None or time.size < 8:
            count = 0 if time is None else time.size
            description = "time is missing" if time is None else f"{count} samples are too few"
            found.append(SignalFinding(RUN, run.name, "time", f"{run.name}: {description}"))
            continue
        unit = _unit(run, time, longest_step)
        wrong_units += unit
        if not unit:
            found += _rising(run, time) or _even(run, time)
    about = (
        "the clocks of {count} of {runs} runs count in another unit than their heading says: "
        + (wrong_units[0].description if wrong_units else "")
    )
    return found + of_all_or_some(wrong_units, measurement, about)


def _unit(run: Run, time: NDArray[np.float64], longest_step: float) -> list[SignalFinding]:
    step = float(np.nanmedian(np.diff(time)))
    if step > longest_step:
        description = (
            f"{run.name}: the samples are {step:.4g} s apart; time is in milliseconds, "
            f"not seconds, if it was {1e3 / step:.4g} samples a second"
        )
    elif 0.0 < step < _SHORTEST_STEP:
        description = f"{run.name}: the samples are {step:.3g} s apart; time is in another unit"
    else:
        return []
    return [SignalFinding(RUN, run.name, "time", description)]


def _rising(run: Run, time: NDArray[np.float64]) -> list[SignalFinding]:
    """Findings of a clock that does not rise."""
    if not np.all(np.isfinite(time)):
        count = int(np.sum(~np.isfinite(time)))
        if is_even(time):
            description = (
                f"{run.name}: {count} times are missing; the clock is even, they are put in"
            )
            return [SignalFinding(NOTE, run.name, "time", description)]
        return [SignalFinding(RUN, run.name, "time", f"{run.name}: {count} times are no numbers")]
    steps = np.diff(time)
    bad = np.flatnonzero(steps <= 0.0)
    if not bad.size:
        return []
    if is_even(time):
        description = (
            f"{run.name}: time is written too coarsely ({bad.size} samples share a time with the "
            "one before); an even clock is put in"
        )
        return [SignalFinding(NOTE, run.name, "time", description)]
    first = int(bad[0])
    description = (
        f"{run.name}: time does not rise at {bad.size} places, the first after sample {first + 1}: "
        f"{time[first]:.6g} s is followed by {time[first + 1]:.6g} s"
    )
    return [SignalFinding(RUN, run.name, "time", description)]


def _even(run: Run, time: NDArray[np.float64]) -> list[SignalFinding]:
    """Findings of a clock that rises, but not evenly."""
    steps = np.diff(time)
    step = float(np.median(steps))
    holes = np.flatnonzero(steps > HOLE * step)
    if holes.size > 0.02 * steps.size:
        description = (
            f"{run.name}: the clock is uneven: {holes.size} of {steps.size} steps are too long"
        )
        return [SignalFinding(NOTE, run.name, "time", description)]
    found = []
    if holes.size:
        lost = round(float(np.sum(steps[holes])) / step) - holes.size
        first = int(holes[0])
        description = (
            f"{run.name}: the clock jumps at {holes.size} places, the first at {time[first]:.6g} s "
            f"by {steps[first]:.4g} s; about {lost} samples are missing there"
        )
        found.append(SignalFinding(SAMPLES, run.name, "time", description))
    scatter = float(np.std(steps[steps <= HOLE * step])) / step
    if scatter > _JITTER:
        description = f"{run.name}: the clock jitters by {to_digits(100.0 * scatter)} % of its step"
        found.append(SignalFinding(NOTE, run.name, "time", description))
    return found


def is_even(time: NDArray[np.float64]) -> bool:
    """Whether an even clock is within a step and a half of every time that there is."""
    known = np.isfinite(time)
    if known.mean() < 0.5 or np.any(np.diff(time[known]) < 0.0):
        return False
    step, even = _even_clock(time)
    return bool(step > 0.0 and np.all(np.abs(time - even)[known] < 1.5 * step))


def evened(time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Even clock in the place of one that is even but for its resolution or missing times."""
    known = np.isfinite(time)
    if np.all(known) and np.all(np.diff(time) > 0.0):
        return time
    return _even_clock(time)[1]


def _even_clock(time: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    """Step, s, and times (n,) of the even clock nearest to the times that are known."""
    index = np.flatnonzero(np.isfinite(time))
    step, begin = np.polyfit(index, time[index], 1)
    return float(step), begin + step * np.arange(time.size)
