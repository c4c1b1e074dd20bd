"""Errors of predictions by run and channel, as shares of the signals."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from chatter.description.case import Case
from chatter.explain.kinds.kind import mean_over_channels
from chatter.explain.measurement import Run
from chatter.explain.prediction import Predictions
from chatter.explain.residuals.residual import Residual
from chatter.io.result_files import finite_or_none

#: models on the way from the declared case to the repaired one
DECLARED, REFITTED, REPAIRED = "declared", "refitted", "repaired"


class ChannelError(NamedTuple):
    """Error of one channel of one run."""

    run: str
    channel: str
    error: float  # rms, SI
    relative: float  # over the rms of the signal, 1
    noise: float = math.nan  # rms, SI, where it was estimated
    over_noise: float = math.nan  # rms over the noise, sample by sample


def errors_of(case: Case, predictions: Predictions, runs: Sequence[Run]) -> list[ChannelError]:
    """Errors of a case's predictions of runs, by run and channel."""
    found = []
    for run in runs:
        predicted = predictions.of(case, run)
        for channel in predictions.kind.reported_channels(run):
            signal, weight = run.signals[channel], run.weights.get(channel)
            residual = predicted[channel] - signal
            if run.usable is not None:
                residual = residual * run.usable
            squared = None if weight is None else weight**2
            error = float(np.sqrt(np.average(residual**2, weights=squared)))
            level = max(run.level(channel), 1e-300)
            found.append(ChannelError(run.name, channel, error, error / level))
    return found


def _squares(errors: Sequence[ChannelError]) -> dict[str, list[float]]:
    """Squares of the relative errors by channel."""
    found: dict[str, list[float]] = {}
    for one in errors:
        found.setdefault(one.channel, []).append(one.relative**2)
    return found


def by_channel(errors: Sequence[ChannelError]) -> dict[str, float]:
    """Rms over the runs of the relative errors, by channel."""
    return {channel: float(np.sqrt(np.mean(v))) for channel, v in _squares(errors).items()}


def overall(errors: Sequence[ChannelError]) -> float:
    """Relative error of several runs: the mean over the channels of the rms over the runs."""
    return mean_over_channels(_squares(errors))


@dataclass(frozen=True, eq=False)
class BeforeAfter:
    """Errors over the signal, channel -> number."""

    noise: dict[str, float]  # of all runs
    #: model -> errors, on the runs for fitting, of cases fitted to these
    fitted: dict[str, dict[str, float]]
    holdout: dict[str, dict[str, float]]  # the same on the others

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels."""
        return tuple(self.noise)

    def summary(self) -> dict[str, Any]:
        """Entry of explanation.json: channel -> errors."""

        def of(errors: dict[str, dict[str, float]], channel: str) -> dict[str, float | None]:
            return {model: finite_or_none(one[channel]) for model, one in errors.items()}

        return {
            channel: {
                "noise_floor": finite_or_none(self.noise[channel]),
                "fitted_runs": of(self.fitted, channel),
                "holdout_runs": of(self.holdout, channel),
            }
            for channel in self.channels
        }


def before_after(
    cases: Mapping[str, Case],
    predictions: Predictions,
    runs: tuple[Sequence[Run], Sequence[Run]],
    residual: Residual,
) -> BeforeAfter:
    """Errors of several models by channel.

    Cases by model, the declared one first; runs for fitting, and those held out. The noise is that
    of the residual of the refitted case.
    """
    fitted, holdout = (
        {model: by_channel(errors_of(case, predictions, some)) for model, case in cases.items()}
        for some in runs
    )
    shown = [
        one for one in residual.channels if one in fitted[DECLARED] and one in holdout[DECLARED]
    ]
    noise = {}
    for channel in shown:
        shares = [
            (part.noise / max(part.run.level(part.channel), 1e-150)) ** 2
            for part in residual.of(channel)
        ]
        noise[channel] = float(np.sqrt(np.mean(shares)))
    return BeforeAfter(noise, fitted, holdout)
