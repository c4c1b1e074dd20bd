"""Spindle and teeth: angle and forces against the declared speed, teeth counted in the forces."""

import math

import numpy as np
from numpy.typing import NDArray

from chatter.description.formatting import signed
from chatter.description.units import rpm
from chatter.explain.data_checks.finding import NOTE, RUN, SignalFinding, of_all_or_some
from chatter.explain.measurement import Measurement, Run

Vector = NDArray[np.float64]

#: deviation of a spindle speed that is said, and that makes a run useless, as shares
_SAID, _WRONG = 0.003, 0.01
#: of a record, after its transient
_SETTLED = 0.35
#: speeds looked at around the declared one
_SEARCHED = 0.22
#: shares of a signal's variance that repeats with a right speed, and with a wrong one beside it
_REPEATS = 0.8
#: runs, and share of them, that agree on another speed, from which on it is that of all
_AGREEING, _AGREEING_SHARE = 3, 0.2
#: power of the tooth-passing frequency of a right speed over that of a wrong one
_STRONGER = 1.5
#: of a tooth period a revolution, within which speeds are looked at
_BELOW_A_TOOTH = 0.85
_BESIDE = 0.8
_BINS = 72
#: revolutions at the end of a record that are looked at, at the most: they tell a speed to 1e-4
_MOST_REVOLUTIONS = 100
_MOST_TEETH = 16
#: share of the runs in which another number of teeth must be counted
_TEETH_SHARE = 0.3


def forces(run: Run) -> list[Vector]:
    """In-plane forces of a run, as far as recorded."""
    return [run.signals[name] for name in ("Fx", "Fy") if name in run.signals]


def settled(run: Run, speed: float) -> slice:
    """Whole revolutions at the end of a record, two at least where it has them."""
    time = run.signals["time"]
    period = 2.0 * math.pi / speed
    duration = float(time[-1] - time[0])
    revolutions = max(
        math.floor((1.0 - _SETTLED) * duration / period), min(2, math.floor(duration / period))
    )
    begin = int(np.searchsorted(time, time[-1] - revolutions * period))
    return slice(begin, None)


def wrong_speeds(measurement: Measurement) -> list[SignalFinding]:
    """Spindle speeds that the spindle angle or the tooth harmonics contradict."""
    found, ratios = [], []
    notes = []
    for run in measurement.runs:
        declared = run.of(measurement.case).cut.spindle_speed
        by_angle = speed_by_angle(run)
        by_forces = speed_by_forces(run, declared, measurement.case.tool.teeth)
        words = []
        if by_angle is not None and abs(by_angle / declared - 1.0) > _WRONG:
            hint = _as_unit(by_angle, declared)
            words.append(f"its spindle angle turns at {_rpm(by_angle)}{hint}")
            ratio = by_angle / declared
        if by_forces is not None and abs(by_forces / declared - 1.0) > _WRONG:
            words.append(f"its forces repeat with a spindle at {_rpm(by_forces)}")
            ratio = by_forces / declared if len(words) == 1 else by_angle / declared
        if words:
            description = f"{run.name}: {' and '.join(words)}; the case declares {_rpm(declared)}"
            found.append(
                SignalFinding(RUN, run.name, "spindle_angle" if by_angle else "", description)
            )
            ratios.append(ratio)
        elif by_angle is not None and abs(by_angle / declared - 1.0) > _SAID:
            description = (
                f"{run.name}: the spindle angle turns at {_rpm(by_angle)}, "
                f"{100.0 * (by_angle / declared - 1.0):+.2f} % off the declared {_rpm(declared)}"
            )
            notes.append(SignalFinding(NOTE, run.name, "spindle_angle", description))
    about = "the declared spindle speed is wrong in {count} of {runs} runs"
    if ratios:
        about += (
            f": the spindle turned at {np.median(ratios):.4g} times what the case declares "
            f"({signed(100.0 * (np.median(ratios) - 1.0))} %)"
        )
    # runs that agree on how far it is off speak for those that are too short to show it
    agree = len(ratios) >= _AGREEING and np.ptp(ratios) < _WRONG
    share = _AGREEING_SHARE if agree else 0.5
    return of_all_or_some(found, measurement, about, share) + notes


def _rpm(speed: float) -> str:
    return f"{rpm(speed):.5g} rpm"


def _as_unit(by_angle: float, declared: float) -> str:
    ratio = by_angle / declared
    if abs(ratio * math.pi / 180.0 - 1.0) < 0.05:
        return " (it is in degrees, not radians)"
    if ratio < 0.0:
        return " (backwards)"
    for factor, words in ((1e3, "time is in milliseconds"), (1e-3, "time is in milliseconds")):
        if abs(ratio / factor - 1.0) < 0.05:
            return f" ({words} on one side)"
    return ""


def speed_by_angle(run: Run) -> float | None:
    """Slope of the spindle angle over time, rad/s; None where there is no angle."""
    angle = run.signals.get("spindle_angle")
    if angle is None:
        return None
    known = np.isfinite(angle)
    if known.sum() < 8 or np.ptp(angle[known]) == 0.0:
        return None
    time, angle = run.signals["time"][known], angle[known]
    if np.ptp(angle) <= 2.0 * math.pi + 1e-6:
        angle = np.unwrap(angle)
    return float(np.polyfit(time - time[0], angle, 1)[0])


def speed_by_forces(run: Run, declared: float, teeth: int) -> float | None:
    """Spindle speed with whose revolution the forces repeat; None where they do not show it.

    The share of the variance that means over the revolution's angle explain, over speeds around
    the declared one; another speed is reported only where it explains nearly all and the declared
    one clearly less. Speeds at which another whole number of tooth periods makes a revolution are
    not examined.
    """
    chosen = _latest(run, declared)
    time = run.signals["time"][chosen]
    signals = [values[chosen] for values in forces(run)]
    revolutions = (time[-1] - time[0]) * declared / (2.0 * math.pi)
    if not signals or revolutions < 2.0 or time.size < 4 * _BINS:
        return None
    step = 0.1 / (revolutions * 8.0)
    count = int(min(_SEARCHED, _BELOW_A_TOOTH / (teeth + 1)) / step)
    ratios = 1.0 + step * np.arange(-count, count + 1)
    shares = np.array([_repeating(time, signals, ratio * declared) for ratio in ratios])
    best = float(shares.max())
    if best < _REPEATS or shares[count] > best - (1.0 - _BESIDE) * best:
        return declared if shares[count] > 0.5 * _REPEATS else None
    # a whole number of tooth periods explains as much as a revolution: the nearest speed counts
    good = np.flatnonzero(shares > best - 0.05)
    nearest = good[np.argmin(np.abs(good - count))]
    around = np.arange(max(nearest - 3, 0), min(nearest + 4, ratios.size))
    found = float(ratios[around[np.argmax(shares[around])]] * declared)
    # chatter may be a multiple of another revolution, but the teeth do not pass with it
    passing = [tooth_passing(time, signals, speed * teeth) for speed in (declared, found)]
    return found if passing[1] > _STRONGER * passing[0] else None


def _latest(run: Run, speed: float) -> slice:
    """Last revolutions of the settled part of a record."""
    time = run.signals["time"]
    begin = np.searchsorted(time, time[-1] - _MOST_REVOLUTIONS * 2.0 * math.pi / speed)
    return slice(max(int(begin), settled(run, speed).start), None)


def tooth_passing(time: Vector, signals: list[Vector], frequency: float) -> float:
    """Power of signals at an angular frequency, rad/s."""
    wave = np.exp(-1j * frequency * (time - time[0]))
    return float(sum(np.abs(wave @ (values - values.mean())) ** 2 for values in signals))


def _repeating(time: Vector, signals: list[Vector], speed: float) -> float:
    """Share of the variance that repeats with the revolution, chance taken off."""
    index = (np.mod((time - time[0]) * speed / (2.0 * math.pi), 1.0) * _BINS).astype(np.int64)
    index = np.minimum(index, _BINS - 1)
    counts = np.maximum(np.bincount(index, minlength=_BINS), 1)
    total = between = 0.0
    for values in signals:
        means = np.bincount(index, weights=values, minlength=_BINS) / counts
        middle = values.mean()
        total += float(np.sum((values - middle) ** 2))
        between += float(np.sum((means[index] - middle) ** 2))
    chance = _BINS / time.size
    return (between / max(total, 1e-300) - chance) / (1.0 - chance)


def wrong_teeth(measurement: Measurement) -> list[SignalFinding]:
    """Numbers of teeth that the forces contradict."""
    teeth = measurement.case.tool.teeth
    found, counted = [], []
    for run in measurement.runs:
        count = counted_teeth(run, run.of(measurement.case).cut.spindle_speed, teeth)
        if count is not None and count != teeth:
            description = (
                f"{run.name}: the forces repeat {count} times a revolution; the case declares "
                f"{teeth} teeth"
            )
            found.append(SignalFinding(RUN, run.name, "", description))
            counted.append(count)
    about = "the number of teeth is wrong in {count} of {runs} runs"
    if counted:
        most = max(set(counted), key=counted.count)
        about += f": the forces repeat {most} times a revolution; the case declares {teeth} teeth"
    # single ones are left to the patterns of the cut, which runout does not trouble
    every = of_all_or_some(found, measurement, about, share=_TEETH_SHARE)
    return every if every is not found else []


def counted_teeth(run: Run, speed: float, declared: int) -> int | None:
    """Teeth that pass a revolution by the orders of the forces; None where they do not show it.

    Runout and unequal pitch put energy into all orders of the revolution, so that the orders of
    another number of teeth must hold nearly all of it, and those of the declared number not.
    """
    orders = order_energies(run, speed)
    if orders is None or orders.sum() <= 0.0:
        return None
    share = {
        count: float(orders[count - 1 :: count].sum() / orders.sum())
        for count in range(1, _MOST_TEETH + 1)
    }
    likely = [count for count, value in share.items() if value > 0.9]
    count = max(likely, default=1)
    if count == declared or count == 1:
        return None
    multiple = count % declared == 0
    if multiple or share.get(declared, 0.0) < 0.5:
        # orders of a multiple are among those of the declared number; the first of them counts
        lowest = float(orders[declared - 1]) / float(orders.sum())
        return count if not multiple or lowest < 0.02 else None
    return None


def order_energies(run: Run, speed: float) -> Vector | None:
    """Energies (n,) of the in-plane forces at the orders 1 to n of the revolution."""
    chosen = settled(run, speed)
    time = run.signals["time"][chosen]
    signals = [values[chosen] for values in forces(run)]
    if not signals or time.size < 3 * _MOST_TEETH:
        return None
    revolutions = (time[-1] - time[0]) * speed / (2.0 * math.pi)
    if revolutions < 0.95:
        return None
    samples_a_revolution = time.size / revolutions
    orders = np.arange(1, int(min(4 * _MOST_TEETH, 0.45 * samples_a_revolution)) + 1)
    waves = np.exp(-1j * np.outer(orders, (time - time[0]) * speed))
    energies = np.zeros(orders.size)
    for values in signals:
        energies += np.abs(waves @ (values - values.mean())) ** 2 / time.size**2
    return energies
