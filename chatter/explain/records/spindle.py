"""Speed of the spindle in a record: by the tacho, or by what repeats with the revolution."""

import math
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: pulses of a tacho from which it gives a speed
_LEAST_PULSES = 3
#: orders of the revolution whose power shows the speed, and share of the band that they may fill
_MOST_ORDERS, _BAND = 60, 0.9
#: points of the spectrum for each that the record resolves
_REFINED = 16
#: power of an order over the median of the spectrum from which it tells the speed
_ABOVE_NOISE = 30.0
#: orders that are looked at in full
_TELLING = 12
#: tolerance of a speed, at the least, and to which it is found, as shares
_LEAST_TOLERANCE, _RESOLVED = 1e-3, 1e-6


class TachoReading(NamedTuple):
    """What a tacho tells: speed, rad/s, and a time at which its pulse rises, s."""

    speed: float
    pulse: float


def tacho_reading(time: Array, signal: Array) -> TachoReading | None:
    """Speed and pulse of a signal that rises once a revolution; None where it does not."""
    low, high = float(signal.min()), float(signal.max())
    above = signal > 0.5 * (low + high)
    rises = np.flatnonzero(~above[:-1] & above[1:])
    if rises.size < _LEAST_PULSES:
        return None
    share = (0.5 * (low + high) - signal[rises]) / (signal[rises + 1] - signal[rises])
    at = time[rises] + share * (time[rises + 1] - time[rises])
    period = float(np.median(np.diff(at)))
    count = np.round((at - at[0]) / period)
    slope, begin = np.polyfit(count, at, 1)
    # pulses that are no pulses of a spindle are not even
    if np.max(np.abs(at - begin - slope * count)) > 0.1 * slope:
        return None
    return TachoReading(2.0 * math.pi / float(slope), float(begin))


def speed_by_repetition(time: Array, signals: Array, declared: float, tolerance: float) -> float:
    """Speed, rad/s, near the declared one at whose orders signals (c, n) have the most power."""
    count = time.size
    step = float(time[-1] - time[0]) / (count - 1)
    size = 1 << math.ceil(math.log2(_REFINED * count))
    window = np.hanning(count)
    level = np.maximum(np.std(signals, axis=1), 1e-300)
    centred = (signals - signals.mean(axis=1, keepdims=True)) / level[:, None]
    windowed = centred * window
    power = np.sum(np.abs(np.fft.rfft(windowed, size, axis=1)) ** 2, axis=0)
    tolerance = max(tolerance, _LEAST_TOLERANCE)
    orders = _telling(power, 2.0 * math.pi / (size * step), declared, tolerance, math.pi / step)

    def power_at_orders(speed: float) -> float:
        waves = np.exp(-1j * speed * np.outer(time - time[0], orders))
        return float(np.sum(np.abs(windowed @ waves) ** 2))

    # the sharpest peak is that of the highest order
    grid_step = math.pi / (step * count) / orders.max()
    points = int(2.0 * tolerance * declared / grid_step) + 3
    speeds = declared * np.linspace(1.0 - tolerance, 1.0 + tolerance, points)
    best = int(np.argmax([power_at_orders(speed) for speed in speeds]))
    found = scipy.optimize.minimize_scalar(
        lambda speed: -power_at_orders(speed),
        bounds=(speeds[max(best - 1, 0)], speeds[min(best + 1, points - 1)]),
        method="bounded",
        options={"xatol": _RESOLVED * declared},
    )
    return float(found.x)


def _telling(
    power: Array, resolution: float, speed: float, tolerance: float, band: float
) -> NDArray[np.int64]:
    """Orders of the revolution that tell most of the speed: in power by the square of the order.

    Of a spectrum over angular frequencies in steps of a resolution, rad/s.
    """
    orders = np.arange(1, max(1, min(_MOST_ORDERS, int(_BAND * band / speed))) + 1)
    levels = np.empty(orders.size)
    for index, order in enumerate(orders):
        low = int(order * speed * (1.0 - tolerance) / resolution)
        high = int(order * speed * (1.0 + tolerance) / resolution) + 2
        levels[index] = float(power[low:high].max(initial=0.0))
    told = np.where(levels > _ABOVE_NOISE * float(np.median(power)), levels * orders**2, 0.0)
    chosen = np.argsort(-told)[:_TELLING]
    return np.sort(orders[chosen[told[chosen] > 0.0]]) if told.any() else orders
