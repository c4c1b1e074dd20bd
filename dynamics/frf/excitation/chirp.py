"""Sine chirps: a sine of constant amplitude that sweeps through a band."""

import numpy as np
import scipy

from dynamics.frf.excitation.signal import (
    ExcitationError,
    PeriodicSignal,
    lines_between,
    require_band,
    require_positive,
    whole_steps,
)

#: share of the period over which a chirp rises, and falls, by default
TAPER = 0.02


def linear_chirp(
    lowest: float,
    highest: float,
    period: float,
    amplitude: float,
    step: float,
    taper: float = TAPER,
) -> PeriodicSignal:
    """Return a chirp whose frequency, Hz, grows evenly with time; amplitude in N or N m.

    Its power is nearly flat over the band. It begins and ends at zero, so that it can stand alone
    with rest before and behind it, or be repeated. The period, s, is a whole number of steps, s.
    The taper is the share of the period, 0 to 0.5, over which the amplitude rises from zero along
    half a cosine, and over which it falls again; the ends of the band get less power by it.
    ExcitationError if the band does not lie below half the sampling frequency, or a value makes no
    sense.
    """
    require_band("chirp", lowest, highest, step)
    require_positive("chirp", "amplitude", amplitude)
    if not 0.0 <= taper <= 0.5:
        raise ExcitationError(f"chirp: taper is {taper}; a share of the period from 0 to 0.5")
    samples = whole_steps("chirp", "period", period, step)
    share = np.arange(samples) / samples
    turns = period * (lowest * share + 0.5 * (highest - lowest) * share**2)
    # a window over one sample more is zero at the first sample of the next period
    envelope = scipy.signal.windows.tukey(samples + 1, 2.0 * taper)[:-1]
    return PeriodicSignal(
        amplitude * envelope * np.sin(2.0 * np.pi * turns),
        step,
        lines_between("chirp", lowest, highest, samples, step),
    )
