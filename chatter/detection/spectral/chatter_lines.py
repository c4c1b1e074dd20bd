"""The strongest line off the harmonics of the spindle: its share of the power, its sidebands."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

Array = NDArray[np.float64]

#: lowest chatter frequency that is searched, in revolutions
LOWEST_ORDER = 1.5
#: sidebands of a chatter line to each side, and of its double
_SIDEBANDS = 3
#: logarithm above the floor at which a line counts to the family of the chatter line
_STANDS_OUT = 2.0
#: offsets at which lines by chance are sampled, how many it takes, and how many positions
_OFFSETS, _FEWEST_OFFSETS, _FEWEST_POSITIONS = 64, 8, 3
#: teeth that are tried where they are not known
MOST_TEETH = 8
#: standard deviations that the best of so many teeth, or of three sets of sidebands, has by chance
_BEST_OF_SO_MANY, _BEST_OF_THREE = 1.5, 0.7
#: share of positions that stand out by chance
_CHANCE = 0.05


class Comb(NamedTuple):
    """Harmonics of the spindle, and how far from them a bin is none."""

    revolution: float  # Hz
    tooth: float  # Hz, tooth passing frequency; that of the revolution where teeth are not known
    uncertainty: float  # relative, of the revolution
    half_width: float  # Hz, of a line

    def off(self, frequency: Array) -> NDArray[np.bool_]:
        """Whether frequencies are on no harmonic, nor too near one to be told from it."""
        order = np.round(frequency / self.revolution)
        width = self.half_width + self.uncertainty * frequency
        return np.abs(frequency - order * self.revolution) > width


class ChatterLine(NamedTuple):
    """Strongest line off the harmonics in one spectrum."""

    frequency: float  # Hz; nan where no bin is off the harmonics
    share: float  # of the power: the line, its sidebands and their double
    alone: float  # share of the line itself
    sidebands: float  # standard deviations by which sidebands stand above chance ones


NONE = ChatterLine(float("nan"), 0.0, 0.0, 0.0)


def strongest_line(power: Array, above: Array, frequency: Array, comb: Comb) -> ChatterLine:
    """Strongest line off the harmonics of a spectrum (b,) with its logarithm above the floor."""
    searched = frequency > LOWEST_ORDER * comb.revolution
    free = searched & comb.off(frequency)
    total = float(power[searched].sum())
    if not free.any() or total <= 0.0:
        return NONE
    index = int(np.argmax(np.where(free, power, 0.0)))
    at = _interpolated(power, frequency, index)
    centres = _family(at, comb)
    own = free & (np.abs(frequency - at) < comb.half_width)
    family = own.copy()
    for centre in centres:
        near = free & (np.abs(frequency - centre) < comb.half_width)
        if near.any() and above[near].max() > _STANDS_OUT:
            family |= near
    return ChatterLine(
        at,
        float(power[family].sum()) / total,
        float(power[own].sum()) / total,
        _sidebands(above, frequency, at, comb),
    )


def _interpolated(power: Array, frequency: Array, index: int) -> float:
    """Frequency of a maximum, by the parabola through the logarithms of three bins."""
    step = frequency[1] - frequency[0]
    if not 0 < index < power.size - 1 or power[index - 1 : index + 2].min() <= 0.0:
        return float(frequency[index])
    low, middle, high = np.log(power[index - 1 : index + 2])
    curvature = low - 2.0 * middle + high
    shift = 0.5 * (low - high) / curvature if curvature < 0.0 else 0.0
    return float(frequency[index] + np.clip(shift, -1.0, 1.0) * step)


def _family(line: float, comb: Comb) -> Array:
    """Sidebands of a line and of its double, one tooth passing frequency apart."""
    orders = comb.tooth * np.arange(-_SIDEBANDS, _SIDEBANDS + 1)
    return np.abs(np.concatenate([line + orders, 2.0 * line + orders]))


def _sidebands(above: Array, frequency: Array, line: float, comb: Comb) -> float:
    """Significance of the sidebands of a line, one revolution or one tooth apart."""
    near, orders, offsets = _sideband_positions(above, frequency, line, comb)

    def of(*spacings: float) -> float:
        at = np.concatenate([line + spacing * orders for spacing in spacings])
        return _significance(near, _on_spectrum(at, frequency, comb), offsets)

    if comb.tooth > comb.revolution:
        both = max(of(comb.tooth), of(comb.revolution), of(comb.tooth, comb.revolution))
        return both - _BEST_OF_THREE
    # the teeth are not known: those that fit best, less what the best of so many has by chance
    return max(of(n * comb.revolution) for n in range(1, MOST_TEETH + 1)) - _BEST_OF_SO_MANY


def sidebands_at_teeth(above: Array, frequency: Array, line: float, comb: Comb) -> float:
    """Standard deviations by which sidebands one tooth apart stand above chance ones."""
    near, orders, offsets = _sideband_positions(above, frequency, line, comb)
    return _significance(near, _on_spectrum(line + comb.tooth * orders, frequency, comb), offsets)


def _sideband_positions(
    above: Array, frequency: Array, line: float, comb: Comb
) -> tuple[_Near, Array, Array]:
    """Levels near a frequency, orders of the sidebands, and offsets of what is by chance."""
    orders = np.concatenate([np.arange(-_SIDEBANDS, 0), np.arange(1, _SIDEBANDS + 1)])
    offsets = comb.revolution * (np.arange(_OFFSETS) + 0.5) / _OFFSETS
    offsets = offsets[comb.off(line + offsets) & _between(offsets, comb)]
    return _Near(above, frequency, comb), orders, offsets


def _on_spectrum(at: Array, frequency: Array, comb: Comb) -> Array:
    """Those frequencies that the spectrum has, and that are on no harmonic."""
    at = np.abs(at)
    at = at[(at > comb.half_width) & (at < frequency[-1] - 2.0 * comb.revolution)]
    return at[comb.off(at)]


def _between(offsets: Array, comb: Comb) -> NDArray[np.bool_]:
    """Offsets, of a revolution, that leave the line that they are from."""
    return np.minimum(offsets, comb.revolution - offsets) > 1.25 * comb.half_width


class _Near:
    """Logarithm above the floor of the largest bin near a frequency."""

    def __init__(self, above: Array, frequency: Array, comb: Comb) -> None:
        self._step = float(frequency[1] - frequency[0])
        self._reach = max(round(0.5 * comb.half_width / self._step), 1)
        self._largest = maximum_filter1d(above, 2 * self._reach + 1)

    def at(self, frequencies: Array) -> Array:
        """Values of the same shape."""
        index = np.round(frequencies / self._step).astype(np.intp)
        return self._largest[
            np.clip(index, self._reach, self._largest.size - 1 - self._reach, out=index)
        ]


def _significance(near: _Near, at: Array, offsets: Array) -> float:
    """Standard deviations by which more positions stand out than chance makes.

    A position stands out that exceeds 95 % of the same position shifted by each offset.
    """
    if at.size < _FEWEST_POSITIONS or offsets.size < _FEWEST_OFFSETS:
        return 0.0
    expected = _CHANCE * at.size
    return float((_standing(near, at, offsets) - expected) / np.sqrt(expected * (1.0 - _CHANCE)))


def _standing(near: _Near, at: Array, offsets: Array) -> int:
    """Number of positions that exceed 95 % of the same position shifted by each offset."""
    others = np.quantile(near.at(at + offsets[:, None]), 1.0 - _CHANCE, axis=0)
    return int(np.sum(near.at(at) > others))


#: harmonics of the teeth that tell a cut
_HARMONICS = 30


def harmonics_significance(
    above: Array, frequency: Array, comb: Comb, without_multiples_of: int = 0
) -> float:
    """Standard deviations by which the harmonics of the teeth stand above what is beside them.

    Those may be left out that are multiples of one.
    """
    orders = np.arange(1, _HARMONICS + 1)
    if without_multiples_of > 0:
        orders = orders[orders % without_multiples_of > 0]
    at, offsets = _harmonics(frequency, comb, orders)
    return _significance(_Near(above, frequency, comb), at, offsets)


def share_of_harmonics(
    above: Array, frequency: Array, comb: Comb, count: int = _HARMONICS
) -> float:
    """Share of the first harmonics of the teeth that stand above what is beside them."""
    at, offsets = _harmonics(frequency, comb, np.arange(1, count + 1))
    if at.size < _FEWEST_POSITIONS or offsets.size < _FEWEST_OFFSETS:
        return 0.0
    return _standing(_Near(above, frequency, comb), at, offsets) / at.size


def _harmonics(frequency: Array, comb: Comb, orders: Array) -> tuple[Array, Array]:
    """Harmonics of the teeth, and offsets from them at which lines are there by chance, Hz."""
    at = comb.tooth * orders
    offsets = comb.revolution * (np.arange(_OFFSETS) + 0.5) / _OFFSETS
    return at[at < frequency[-1] - comb.revolution], offsets[_between(offsets, comb)]


def tooth_powers(power: Array, frequency: Array, comb: Comb) -> tuple[float, float, float]:
    """Power at multiples of the tooth passing frequency, at odd halves of it, and of all."""
    searched = frequency > 0.25 * comb.tooth
    half_order = np.round(2.0 * frequency / comb.tooth)
    near = searched & (np.abs(frequency - 0.5 * half_order * comb.tooth) < comb.half_width)
    odd = half_order % 2 == 1
    return (
        float(power[near & ~odd].sum()),
        float(power[near & odd].sum()),
        float(power[searched].sum()),
    )


def is_half_tooth(line: float, comb: Comb, tolerance: float) -> bool:
    """Whether a line, Hz, is an odd multiple of half the tooth passing frequency."""
    order = np.floor(line / comb.tooth) + 0.5
    return bool(abs(line - order * comb.tooth) < tolerance + comb.uncertainty * line)
