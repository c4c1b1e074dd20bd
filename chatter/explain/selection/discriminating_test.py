"""Discriminating tests: measurements in which explanations that fit alike differ."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.explain.criteria import DISCRIMINATES
from chatter.explain.kinds.kind import Kind, Noise
from chatter.explain.measurement import Measurement


def discriminating_test(
    measurement: Measurement, kind: Kind, noise: Noise, one: Case, other: Case
) -> dict[str, Any] | None:
    """Trial in which two cases that fit a measurement alike differ most; None if in none.

    Noise is by run and channel, a standard deviation each. Of the trial are told "description":
    what to measure; "channel"; "over_noise": by how many standard deviations of the noise the
    predictions differ there (rms).
    """
    best: dict[str, Any] | None = None
    for trial in kind.trials(measurement, noise):
        try:
            first, second = (kind.predict(trial.run.of(case), trial.run) for case in (one, other))
        except (InputError, RunError):
            # what cannot be cut cannot be measured
            continue
        for channel, level in trial.noise.items():
            apart = float(np.sqrt(np.mean((first[channel] - second[channel]) ** 2))) / level
            if apart > max(DISCRIMINATES, best["over_noise"] if best else 0.0):
                best = {"description": trial.description, "channel": channel, "over_noise": apart}
    return best


def in_words(name: str, test: Mapping[str, Any] | None) -> str:
    """Sentence on the test that discriminates between an effect and the one that was named."""
    if test is None:
        return f"no test among those considered discriminates against {name}"
    return (
        f"{test['description']} discriminates against {name}: {test['channel']} differs by "
        f"{test['over_noise']:.3g} times its noise"
    )
