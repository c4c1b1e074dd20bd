"""Blows of a hammer: half sines, one or several."""

import math

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.excitation.signal import (
    ExcitationError,
    PulseTrain,
    pulses_at,
    require_positive,
    whole_steps,
)


def half_sine_blow(width: float, peak: float, step: float) -> NDArray[np.float64]:
    """Return a blow of half a sine, from its zero to its zero or one sample beyond.

    Its spectrum falls to its first zero at 1.5 / width, Hz.

    Parameters
    ----------
    width : float
        Time of contact, s; at least two steps.
    peak : float
        N; with the sign of the blow. Reached between two samples where width is no even number
        of steps.
    step : float
        s.

    Returns
    -------
    (n,) array of float
        N.

    Raises
    ------
    ExcitationError
        If the width is shorter than two steps or a value is not finite.
    """
    require_positive("half-sine blow", "step", step)
    require_positive("half-sine blow", "width", width)
    if width < 2.0 * step:
        raise ExcitationError(
            f"half-sine blow: width {width:g} s is shorter than two steps of {step:g} s"
        )
    if not math.isfinite(peak) or peak == 0.0:
        raise ExcitationError(f"half-sine blow: peak is {peak}; a finite force, not 0, is needed")
    phase = np.pi * step / width * np.arange(math.ceil(width / step - 1e-9) + 1)
    return peak * np.maximum(np.sin(phase), 0.0)


def several_blows(
    width: float,
    peak: float,
    step: float,
    count: int,
    spacing: float,
    scatter: float = 0.0,
    seed: int = 0,
    rest: float = 0.0,
) -> PulseTrain:
    """Return blows of half a sine at even spacing, each a little different as by hand.

    Parameters
    ----------
    width, peak, step : float
        As for `half_sine_blow`; s, N, s.
    count : int
    spacing : float
        From the start of one blow to that of the next, and from that of the last to the end, s.
        The response must have died away within it.
    scatter : float
        Standard deviation of peak and of width over their values, 1; drawn apart from each other,
        cut at three times itself.
    seed : int
        Of the scatter.
    rest : float
        Before the first blow, s.

    Raises
    ------
    ExcitationError
        If a time is not a whole number of steps or a blow does not end before the next.
    """
    if count < 1:
        raise ExcitationError(f"several blows: count is {count}; 1 at least")
    if not 0.0 <= scatter < 1.0 / 3.0:
        raise ExcitationError(f"several blows: scatter is {scatter}; 0 or more, below 1/3")
    apart = whole_steps("several blows", "spacing", spacing, step)
    lead = whole_steps("several blows", "rest", rest, step) if rest else 0
    draws = np.random.default_rng(seed).standard_normal((count, 2))
    factors = 1.0 + scatter * np.clip(draws, -3.0, 3.0)
    blows = [half_sine_blow(width * wide, peak * strong, step) for wide, strong in factors]
    return pulses_at(lead + apart * np.arange(count), blows, lead + apart * count, step)
