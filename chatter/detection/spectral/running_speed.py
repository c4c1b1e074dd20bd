"""Speed of the spindle by the lines of windows as they come."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.revolution_frequency import (
    ABOUT_GIVEN,
    BETTER,
    CERTAIN,
    PLAUSIBLE,
    VARIATION,
    Spacing,
    best_spacing,
    explains_more,
    line_autocorrelations,
    speed_of_frames,
)
from chatter.detection.spectral.spectra import Frames

Array = NDArray[np.float64]

#: windows that the mean speed is read off, and the latest of them that show how it varies
_WINDOWS, _LATEST = 24, 3
#: relative difference of two readings of one speed that is not that of the mean yet
_SAME = 0.01


class _Window(NamedTuple):
    level: float  # dB
    frames: Frames
    autocorrelation: Array


class RunningSpeed:
    """Speed of the spindle, corrected by the lines of the latest windows in which something is cut.

    Parameters
    ----------
    stated : float
        Hz.
    teeth : int
    """

    def __init__(self, stated: float, teeth: int) -> None:
        self._stated = stated
        self._teeth = teeth
        self._windows: deque[_Window] = deque(maxlen=_WINDOWS)
        self._other = math.nan
        #: Hz, about which the lines correct it, and as they have it now
        self.mean = self.current = stated
        #: whether lines of late show the speed
        self.is_confirmed = False

    @property
    def given(self) -> float:
        """Speed, Hz, to judge windows together by."""
        return self.mean

    @property
    def is_corrected(self) -> bool:
        """Whether the lines showed another mean than the stated one."""
        return self.mean != self._stated

    @property
    def source(self) -> str:
        """Where the speed is from, as `Revolution` has it."""
        return "given, refined by the spectrum" if self.is_confirmed else "given"

    def over(self, speeds: Sequence[float]) -> Array:
        """Speeds of windows, Hz: the present one, by which their lines are told."""
        return np.full(len(speeds), self.current)

    @property
    def is_contradicted(self) -> bool:
        """Whether the lines of the last window but no others show another speed far better."""
        return not math.isnan(self._other)

    def go_on_with(self, frequency: float) -> bool:
        """Take a speed, Hz, for the mean; true."""
        self.mean = self.current = frequency
        self._other = math.nan
        return True

    def take(self, frames: Frames, level: float, idle_level: Callable[[], float]) -> bool:
        """Take a window of a level, dB; whether its lines show another mean, which holds then."""
        self._windows.append(_Window(level, frames, line_autocorrelations(frames)[0]))
        least = idle_level()
        cut = [one for one in self._windows if one.level >= least] or [self._windows[-1]]
        everywhere = np.sum([one.autocorrelation for one in cut], axis=0)
        found = self._best(everywhere, frames.step, self._stated, ABOUT_GIVEN)
        self.is_confirmed = found.significance > PLAUSIBLE
        if not self.is_confirmed:
            self._other = math.nan
            return False
        near = self._best(everywhere, frames.step, self.mean, VARIATION)
        if self._is_far_better(found, near, cut):
            is_same = abs(found.frequency / self._other - 1.0) < _SAME
            self._other = found.frequency
            if not (is_same and found.significance > CERTAIN):
                return False
            self.go_on_with(found.frequency)
            return True
        self._other = math.nan
        latest = np.sum([one.autocorrelation for one in cut[-_LATEST:]], axis=0)
        now = speed_of_frames(latest, frames.step, near.frequency, self._teeth)
        self.current = near.frequency if math.isnan(now) else now
        return False

    def _best(self, autocorrelation: Array, step: float, about: float, within: float) -> Spacing:
        bounds = about * (1.0 - within), about * (1.0 + within)
        return best_spacing(autocorrelation, step, *bounds, self._teeth)

    def _is_far_better(self, found: Spacing, near: Spacing, cut: list[_Window]) -> bool:
        """Whether a speed explains the windows far better than one near the mean does."""
        if abs(found.frequency / self.mean - 1.0) <= VARIATION:
            return False
        if not found.score > BETTER * near.score:
            return False
        power = np.concatenate([one.frames.power for one in cut])
        frames = cut[-1].frames._replace(power=power)
        return explains_more(frames, found, near, self._teeth)
