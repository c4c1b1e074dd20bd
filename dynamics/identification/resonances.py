"""Resonances as one reads them off an FRF, where a few real modes miss more than noise.

Joints that are not viscous and small resonances of everything else leave no model of real modes
right to the noise. What is asked of the modes then is what is read off the curve: where the
resonances are, and how large.
"""

from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.identification.real_modes import RealModel, ToolPointRecords
from dynamics.identification.residues import Records

#: fall on both sides by which a maximum is a resonance of its own: to half the power, dB
HALF_POWER = 3.0

#: share of the largest value of a resonance that the lines hold by which it is fitted
_CREST = 0.85

#: noise of the lines off the resonances over that of the largest of them
_OFF_RESONANCE = 5.0


def shoulder(tool: ToolPointRecords, real: RealModel) -> int | None:
    """The least of the modes without a maximum of their own in the fitted receptance, or None.

    A maximum counts where the level falls to half the power on both of its sides; it belongs to
    the mode with the largest receptance among those whose half-power bands hold it.
    """
    records = tool.records
    level = _level(real.synthesis(tool), tool)
    maxima, _ = scipy.signal.find_peaks(20.0 * np.log10(level), prominence=HALF_POWER)
    hertz = real.natural_frequency / (2.0 * np.pi)
    receptance = peak_receptances(real)
    read = ~within_lines(tool, real)
    for maximum in records.frequency[maxima]:
        near = np.flatnonzero(np.abs(hertz - maximum) <= 2.0 * real.damping * hertz)
        if near.size:
            read[near[np.argmax(receptance[near])]] = True
    unread = np.flatnonzero(~read)
    return int(unread[np.argmin(receptance[unread])]) if unread.size else None


def by_their_crests(tool: ToolPointRecords, real: RealModel) -> Records:
    """Records whose noise makes the crests of all resonances count alike, the rest little."""
    records = tool.records
    level = _level(records.values, tool)
    hertz = real.natural_frequency / (2.0 * np.pi)
    share = np.full(level.size, _OFF_RESONANCE)
    crests = [
        _crest(records.frequency, level, *mode) for mode in zip(hertz, real.damping, strict=True)
    ]
    largest = max((float(np.max(level[crest])) for crest in crests if crest.size), default=1.0)
    for crest in crests:
        if crest.size:
            share[crest] = float(np.max(level[crest])) / largest
    return replace(records, noise=records.noise * share[:, None])


def within_lines(tool: ToolPointRecords, real: RealModel) -> NDArray[np.bool_]:
    """Whether each mode lies between the first and the last line."""
    hertz, lines = real.natural_frequency / (2.0 * np.pi), tool.records.frequency
    return (hertz >= lines[0]) & (hertz <= lines[-1])


def peak_receptances(real: RealModel) -> NDArray[np.float64]:
    """Receptance of each mode along itself at its resonance, m/N: 1 / (2 zeta k)."""
    inverse_mass = np.sum(real.vectors**2, axis=1)
    return inverse_mass / (2.0 * real.damping * real.natural_frequency**2)


def _level(values: NDArray[np.complex128], tool: ToolPointRecords) -> NDArray[np.float64]:
    """Size of the receptances at the tool point taken together, m/N, (n,)."""
    there = [k for k, pair in enumerate(tool.pairs) if pair is not None]
    scale = np.abs(tool.records.laplace) ** tool.records.derivative
    return np.maximum(np.linalg.norm(values[:, there], axis=1) / scale, 1e-300)


def _crest(
    frequency: NDArray[np.float64], level: NDArray[np.float64], hertz: float, damping: float
) -> NDArray[np.int64]:
    """Lines in a row about the maximum in the half-power band of a mode; none of one outside."""
    near = np.flatnonzero(np.abs(frequency - hertz) <= 1.5 * damping * hertz)
    if near.size == 0:
        return near
    top = near[int(np.argmax(level[near]))]
    low = np.flatnonzero(level[:top] < _CREST * level[top])
    high = np.flatnonzero(level[top:] < _CREST * level[top])
    first = int(low[-1]) + 1 if low.size else 0
    last = top + int(high[0]) if high.size else level.size
    return np.arange(first, last)
