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
    """Return a blow (n,), N, of half a sine, from its zero to its zero or one sample beyond.

    Its spectrum falls to its first zero at 1.5 / width, Hz. The width is the time of contact, s, at
    least two steps, s; the peak, N, has the sign of the blow and is reached between two samples
    where the width is no even number of steps. ExcitationError if the width is shorter than two
    steps or a value is not finite.
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

    Width, peak and step as for `half_sine_blow`. The spacing, s, is from the start of one blow to
    that of the next, and from that of the last to the end; the response must have died away within
    it. Rest, s, is before the first blow. The scatter is the standard deviation of peak and of
    width over their values, drawn apart from each other with the seed, cut at three times itself.
    ExcitationError if a time is not a whole number of steps or a blow does not end before the next.
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
