"""Speed of the spindle by the pulses of a tacho, of windows as they come."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.revolution_frequency import pulses_of_revolution, rates_of_pulses
from chatter.detection.spectral.spectra import Frames

Array = NDArray[np.float64]

#: relative difference from a whole multiple up to which a speed is the same by other pulses
_WHOLE = 0.02


class SpeedByTacho:
    """Speed of the spindle by a tacho; `RunningSpeed` without one.

    Parameters
    ----------
    first : float
        Hz, of the pulses of the first samples.
    stated : float or None
        Hz, of the spindle, by which the pulses a revolution are told.
    once_per_revolution : bool
        Whether the tacho is known to give one.
    """

    source = "tacho"
    is_contradicted = False

    def __init__(self, first: float, stated: float | None, *, once_per_revolution: bool) -> None:
        self._pulses = 1 if once_per_revolution else pulses_of_revolution(first, stated)
        self._is_known = once_per_revolution or stated is not None
        #: Hz, as the pulses of late have it
        self.mean = self.current = first / self._pulses
        #: whether the lines showed other pulses a revolution
        self.is_corrected = False

    @property
    def given(self) -> float | None:
        """Speed, Hz, to judge windows together by; None where their lines tell the pulses."""
        return self.mean if self._is_known else None

    def take(self, frames: Frames, level: float, idle_level: Callable[[], float]) -> bool:
        """Take a window; the pulses show its speed, not its lines."""
        del frames, level, idle_level
        return False

    def take_pulses(self, window: Recording) -> None:
        """Take the pulses of a window; where it has none of a spindle the speed stays."""
        found = rates_of_pulses(window.tacho, window.time_step)
        if found is not None:
            self.mean = self.current = float(1.0 / np.mean(1.0 / found[1])) / self._pulses

    def go_on_with(self, frequency: float) -> bool:
        """Take a speed by lines, Hz, where it is that of other pulses a revolution; whether it is.

        Another one is that of earlier windows: the pulses know the present one better.
        """
        pulses = round(self._pulses * self.mean / frequency)
        is_whole = abs(self._pulses * self.mean / frequency / max(pulses, 1) - 1.0) < _WHOLE
        if self._is_known or pulses in (0, self._pulses) or not is_whole:
            return False
        self.mean = self.current = self.mean * self._pulses / pulses
        self._pulses = pulses
        self.is_corrected = True
        return True

    def over(self, speeds: Sequence[float]) -> Array:
        """Speeds of windows, Hz, as their pulses had them."""
        return np.array(speeds)
