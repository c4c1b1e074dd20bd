"""A recording: channels over time, what they are of."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError

#: quantity of a channel -> power of the frequency that makes it comparable with a velocity or a
#: sound, in which a chatter line of the structure and the harmonics of the teeth are alike in size
SLOPES = {
    "sound": 0.0,
    "acceleration": 0.0,
    "velocity": 0.0,
    "displacement": 1.0,
    "force": 1.0,
    "torque": 1.0,
    "current": 1.0,
    "power": 1.0,
    "unknown": 0.0,
}
#: samples that are of any use, samples a second that show vibration at all, and s in which it does
_FEWEST, _SLOWEST, _SHORTEST = 256, 20.0, 0.001


@dataclass(frozen=True, eq=False)
class Recording:
    """Channels over time, at a uniform step.

    Parameters
    ----------
    name : str
        As in messages: the file.
    time_step : float
        s.
    channels : tuple of str
        Names.
    quantities : tuple of str
        Of each channel, a key of `SLOPES`.
    values : (n, k) array of float
    start : float
        s, time of the first sample.
    tacho : (n,) array of float or None
        Pulses of a tacho.
    spindle_frequency : float or None
        Hz, as measured beside the channels.
    once_per_revolution : bool
        Whether the tacho is known to give one pulse a revolution.

    Raises
    ------
    InputError
        If there are too few samples, or some are not finite.
    """

    name: str
    time_step: float
    channels: tuple[str, ...]
    quantities: tuple[str, ...]
    values: NDArray[np.float64]
    start: float = 0.0
    tacho: NDArray[np.float64] | None = None
    spindle_frequency: float | None = None
    once_per_revolution: bool = False

    def __post_init__(self) -> None:
        count = len(self.values)
        if count < _FEWEST:
            raise InputError(f"{self.name}: {count} samples; at least {_FEWEST} are needed")
        for number, channel in enumerate(self.channels):
            wrong = np.flatnonzero(~np.isfinite(self.values[:, number]))
            if wrong.size:
                raise InputError(f"{self.name}: {channel}: sample {wrong[0] + 1} is not finite")
        if not (math.isfinite(self.time_step) and self.time_step > 0.0):
            raise InputError(f"{self.name}: the time does not increase")
        self._require_clock_of_a_recording()

    def _require_clock_of_a_recording(self) -> None:
        """Refuse a clock that counts in another unit, or a rate that was mistyped."""
        rate, unit = 1.0 / self.time_step, "is its time in another unit?"
        if not rate >= _SLOWEST:
            raise InputError(
                f"{self.name}: {rate:.3g} samples a second, where {_SLOWEST:g} are needed; {unit}"
            )
        if not self.duration >= _SHORTEST:
            raise InputError(
                f"{self.name}: {self.duration:.3g} s at {rate:.3g} samples a second, where "
                f"{_SHORTEST:g} s are needed; {unit}"
            )

    @property
    def duration(self) -> float:
        """Length in s."""
        return len(self.values) * self.time_step

    @property
    def slopes(self) -> tuple[float, ...]:
        """Power of the frequency by which each channel is weighted."""
        return tuple(SLOPES[one] for one in self.quantities)
