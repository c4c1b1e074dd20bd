"""Sampled excitation: one period of a periodic signal, and pulses in a train."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: of a period over the step, from a whole number
_WHOLE = 1e-6


class ExcitationError(ValueError):
    """An excitation that makes no sense; the message names what and the value given."""


@dataclass(frozen=True)
class PeriodicSignal:
    """One period of a force (N) or torque (N m), sampled at the steps of a simulation."""

    values: NDArray[np.float64]  # (n,), N or N m
    step: float  # s
    #: (l,), excited harmonics of the period; line k lies at k / (n step), Hz
    lines: NDArray[np.int64]

    @property
    def period(self) -> int:
        """Samples in a period."""
        return self.values.size

    @property
    def frequency(self) -> NDArray[np.float64]:
        """Frequencies of the excited lines, Hz, shape (l,)."""
        return self.lines / (self.values.size * self.step)

    @property
    def rms(self) -> float:
        """Root of the mean square."""
        return float(np.sqrt(np.mean(self.values**2)))

    @property
    def peak(self) -> float:
        """Largest magnitude of the samples."""
        return float(np.abs(self.values).max())

    def with_rms(self, rms: float) -> PeriodicSignal:
        """Return the signal scaled to an rms value, N or N m."""
        require_positive("periodic signal", "rms", rms)
        return replace(self, values=self.values * (rms / self.rms))

    def with_peak(self, peak: float) -> PeriodicSignal:
        """Return the signal scaled to a largest magnitude, N or N m."""
        require_positive("periodic signal", "peak", peak)
        return replace(self, values=self.values * (peak / self.peak))

    def repeated(self, periods: int, leading: int = 0) -> NDArray[np.float64]:
        """Return the signal over leading periods, for transients to die away, and periods to use.

        (n (leading + periods),), N or N m.
        """
        if periods < 1 or leading < 0:
            raise ExcitationError(
                f"periodic signal: {periods} periods behind {leading}; 1 behind 0 at least"
            )
        return np.tile(self.values, leading + periods)


@dataclass(frozen=True)
class PulseTrain:
    """Pulses of force (N) or torque (N m) with rest between them."""

    values: NDArray[np.float64]  # (n,), N or N m
    step: float  # s
    starts: NDArray[np.int64]  # (p,), sample at which each pulse begins, rising


def pulses_at(
    starts: ArrayLike, pulses: Sequence[NDArray[np.float64]], samples: int, step: float
) -> PulseTrain:
    """Return pulses put at given samples.

    Pulses in N or N m, step in s; the p starts are samples and rise. ExcitationError if a pulse
    runs into the next or over the end.
    """
    require_positive("pulses", "step", step)
    starts = np.asarray(starts, dtype=np.int64).reshape(-1)
    if starts.size == 0 or starts.size != len(pulses):
        raise ExcitationError(f"pulses: {starts.size} starts for {len(pulses)} pulses")
    values = np.zeros(samples)
    ends = [*starts[1:], samples]
    for start, pulse, end in zip(starts, pulses, ends, strict=True):
        if start < 0 or start + len(pulse) > end:
            raise ExcitationError(
                f"pulses: one of {len(pulse)} samples at sample {start} does not end before the "
                f"next pulse or the end of the train, at sample {end}"
            )
        values[start : start + len(pulse)] = pulse
    return PulseTrain(values, step, starts)


def require_positive(what: str, key: str, value: float) -> None:
    """Raise ExcitationError unless value is a finite number above zero."""
    if not (math.isfinite(value) and value > 0.0):
        raise ExcitationError(f"{what}: {key} is {value}; a finite number above 0 is needed")


def whole_steps(what: str, key: str, time: float, step: float) -> int:
    """Return a time in whole steps, at least one, or raise ExcitationError."""
    require_positive(what, "step", step)
    require_positive(what, key, time)
    steps = round(time / step)
    if steps < 1 or abs(time / step - steps) > _WHOLE * steps:
        raise ExcitationError(
            f"{what}: {key} {time:g} s is not a whole multiple of the step {step:g} s"
        )
    return steps


def require_band(what: str, lowest: float, highest: float, step: float) -> None:
    """Raise ExcitationError unless a band, Hz, lies above 0 and below half the sampling rate."""
    require_positive(what, "lowest frequency", lowest)
    require_positive(what, "step", step)
    if not lowest < highest < 0.5 / step:
        raise ExcitationError(
            f"{what}: band {lowest:g} to {highest:g} Hz; the highest must lie above the lowest and "
            f"below half the sampling frequency, {0.5 / step:g} Hz"
        )


def lines_between(
    what: str, lowest: float, highest: float, samples: int, step: float
) -> NDArray[np.int64]:
    """Return the harmonics of a period of some samples from a lowest to a highest frequency, Hz."""
    duration = samples * step
    first = math.ceil(lowest * duration * (1.0 - 1e-12))
    last = math.floor(highest * duration * (1.0 + 1e-12))
    if last - first < 1:
        raise ExcitationError(
            f"{what}: a period of {duration:g} s has fewer than two lines between {lowest:g} and "
            f"{highest:g} Hz; make it longer"
        )
    return np.arange(first, last + 1)
