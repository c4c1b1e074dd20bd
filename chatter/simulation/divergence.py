"""Whether two runs that begin almost alike stay apart: a verdict that needs no period.

Under a varying spindle speed no turn is like the next one, so that turns cannot be compared. A
stable cut forgets how it began: a small push at the start dies out. What does not is chatter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.simulation.growth import delayed, motion_of
from chatter.simulation.setup import set_up
from dynamics.modal import Mode

#: the push moves the tool by this share of the feed
_PUSH = 1e-5
#: turns that are looked at, at the most
_MOST_TURNS = 300.0
#: a difference that shrinks by less than this share a turn stays
_SUSTAINED = 0.004
#: differences below this share of the largest are rounding
_ROUNDING = 1e-6
_LEAST_TURNS = 8


@dataclass(frozen=True)
class Divergence:
    """How the difference of two runs develops.

    Parameters
    ----------
    rate : float
        Logarithm a turn; -inf where it is gone at once.
    frequency : float
        Strongest line of the difference, Hz.
    """

    rate: float
    frequency: float

    @property
    def stable(self) -> bool:
        """True where the push is forgotten."""
        return self.rate < -_SUSTAINED


def divergence(case: Case, modes: tuple[Mode, ...]) -> Divergence:
    """Run a case twice, the second time pushed a little, and follow the difference.

    Parameters
    ----------
    case : Case
        Run with the delayed chip.
    modes : tuple of Mode
        Of its structure.
    """
    setups = [set_up(delayed(case), modes) for _ in range(2)]
    limit = min(setups[0].resolution.turns, _MOST_TURNS)
    setups = [replace(setup, resolution=replace(setup.resolution, turns=limit)) for setup in setups]
    pushes = (0.0, _PUSH * case.cut.feed_per_tooth)
    (first, done), (second, also_done) = (
        motion_of(setup, setup.resolution.steps, push=push)
        for setup, push in zip(setups, pushes, strict=True)
    )
    count = max(min(done, also_done), 0)
    difference = second[:count] - first[:count]
    bins = setups[0].resolution.steps_a_turn
    turns = count // bins
    if turns < _LEAST_TURNS:
        # one of them has left the range of the model
        return Divergence(math.inf, math.nan)
    size = np.sqrt(np.mean(difference[: turns * bins].reshape(turns, -1) ** 2, axis=1))
    alive = np.flatnonzero(size < _ROUNDING * size.max())
    end = int(alive[0]) if alive.size else turns
    begin = end // 3
    if end - begin < 3:
        return Divergence(-math.inf, math.nan)
    rate = float(np.polyfit(np.arange(begin, end), np.log(size[begin:end]), 1)[0])
    window = difference[begin * bins : end * bins]
    return Divergence(rate, _strongest(window, setups[0].step))


def _strongest(signal: NDArray[np.float64], step: float) -> float:
    """Frequency of the strongest line of (n, 3) samples, Hz, between the lines of the FFT."""
    window = np.hanning(len(signal))[:, None]
    amplitude = np.linalg.norm(np.fft.rfft(signal * window, axis=0), axis=1)
    peak = int(np.clip(np.argmax(amplitude[1:]) + 1, 1, len(amplitude) - 2))
    low, middle, high = np.log(np.maximum(amplitude[peak - 1 : peak + 2], 1e-300))
    shift = 0.5 * (low - high) / (low - 2.0 * middle + high)
    return float((peak + shift) / (len(signal) * step))
