"""Errors before and after, by channel, on runs that were fitted and runs that were not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from chatter.explain.errors_of_runs import by_channel, errors_of
from chatter.explain.measurement import Run
from chatter.explain.residuals.normalised_residual import Residual
from chatter.io.result_files import finite_or_none

if TYPE_CHECKING:
    from chatter.explain.explanation import Explanation

#: steps of the way from the declared case to the repaired one
STEPS = ("declared", "refitted", "with what was added")


@dataclass(frozen=True, eq=False)
class BeforeAfter:
    """Errors over the signal, channel -> number.

    Parameters
    ----------
    noise : dict
        Of all runs.
    fitted, unseen : dict of str to dict
        Step -> errors of cases fitted to the runs for fitting alone, on these and on the others.
    """

    noise: dict[str, float]
    fitted: dict[str, dict[str, float]]
    unseen: dict[str, dict[str, float]]

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels."""
        return tuple(self.noise)

    def summary(self) -> dict[str, Any]:
        """Entry of explanation.json: channel -> errors."""
        return {
            channel: {
                "noise_floor": finite_or_none(self.noise[channel]),
                "fitted_runs": {
                    step: finite_or_none(e[channel]) for step, e in self.fitted.items()
                },
                "unseen_runs": {
                    step: finite_or_none(e[channel]) for step, e in self.unseen.items()
                },
            }
            for channel in self.channels
        }


def before_after(explanation: Explanation, residual: Residual) -> BeforeAfter:
    """Errors of the declared case, the refitted one and the one with what was added.

    Parameters
    ----------
    explanation : Explanation
    residual : Residual
        Of the refitted case, for the noise.
    """
    found, measurement = explanation.found, explanation.measurement
    cases = {
        STEPS[0]: measurement.case,
        STEPS[1]: explanation.refitted_to_fitted,
        STEPS[2]: explanation.explained_by_fitted,
    }
    if explanation.verdict != "explained":
        del cases[STEPS[2]]

    def errors(runs: Sequence[Run]) -> dict[str, dict[str, float]]:
        return {
            step: by_channel(errors_of(case, measurement, found.kind, runs))
            for step, case in cases.items()
        }

    fitted, unseen = errors(found.fitted), errors(found.unseen)
    told = set(fitted[STEPS[0]]) & set(unseen[STEPS[0]])
    noise = {key: level for key, level in noise_by_channel(residual).items() if key in told}
    return BeforeAfter(noise, fitted, unseen)


def noise_by_channel(residual: Residual) -> dict[str, float]:
    """Noise over the signal, by channel."""
    floors = {}
    for channel in residual.channels:
        shares = [
            part.noise**2 / max(float(np.mean(part.measured**2)), 1e-300)
            for part in residual.of(channel)
        ]
        floors[channel] = float(np.sqrt(np.mean(shares)))
    return floors
