"""Periodic multisines: harmonics of one period, all of the same amplitude."""

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.excitation.signal import (
    ExcitationError,
    PeriodicSignal,
    lines_between,
    require_band,
    require_positive,
    whole_steps,
)


def full_lines(lowest: float, highest: float, period: float, step: float) -> NDArray[np.int64]:
    """Return all harmonics of a period, s, from a lowest to a highest frequency, Hz."""
    require_band("multisine", lowest, highest, step)
    samples = whole_steps("multisine", "period", period, step)
    return lines_between("multisine", lowest, highest, samples, step)


def odd_lines(lowest: float, highest: float, period: float, step: float) -> NDArray[np.int64]:
    """Return the odd harmonics alone.

    Even nonlinearities then answer on lines that are not excited and leave the FRF alone.
    """
    lines = full_lines(lowest, highest, period, step)
    return lines[lines % 2 == 1]


def random_phases(lines: NDArray[np.int64], seed: int) -> NDArray[np.float64]:
    """Return phases drawn evenly over a turn, rad; a seed gives a realisation."""
    return np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, lines.size)


def schroeder_phases(lines: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the phases -pi i (i - 1) / l of l lines, rad, with a low crest factor.

    Meant for lines at even distances. Source: M. R. Schroeder, 1970, "Synthesis of low-peak-factor
    signals and binary sequences with low autocorrelation", IEEE Transactions on Information
    Theory 16, for a flat spectrum.
    """
    number = np.arange(1, lines.size + 1)
    return -np.pi * number * (number - 1.0) / lines.size


def multisine(
    lines: NDArray[np.int64], phases: NDArray[np.float64], period: float, rms: float, step: float
) -> PeriodicSignal:
    """Return a multisine; `PeriodicSignal.with_peak` scales it to a peak instead of an rms.

    Harmonics (l,) from `full_lines` or `odd_lines`; phases (l,) of the cosines, rad, from
    `random_phases` or `schroeder_phases`; the period, s, is a whole number of steps; rms in N or N
    m. ExcitationError if a line does not lie between zero and half the sampling frequency.
    """
    samples = whole_steps("multisine", "period", period, step)
    require_positive("multisine", "rms", rms)
    lines = np.asarray(lines, dtype=np.int64)
    phases = np.asarray(phases, dtype=np.float64)
    if lines.size == 0 or lines.shape != phases.shape:
        raise ExcitationError(f"multisine: {lines.size} lines and {phases.size} phases")
    if lines.min() < 1 or 2 * lines.max() >= samples or np.unique(lines).size != lines.size:
        raise ExcitationError(
            f"multisine: lines {lines.min()} to {lines.max()} of a period of {samples} samples; "
            f"they must differ and lie from 1 to {(samples - 1) // 2}"
        )
    spectrum = np.zeros(samples // 2 + 1, dtype=np.complex128)
    spectrum[lines] = np.exp(1j * phases)
    signal = PeriodicSignal(np.fft.irfft(spectrum, samples), step, lines)
    return signal.with_rms(rms)
