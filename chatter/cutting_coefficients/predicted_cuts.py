"""Cuts predicted by those that were fitted: each one in turn, and those kept apart."""

from __future__ import annotations

from collections.abc import Sequence

from chatter.cutting_coefficients.fit import FittedLaw, fitted_law
from chatter.cutting_coefficients.mean_forces import MeanForce
from chatter.cutting_coefficients.prediction import (
    PredictedCut,
    predicted_means,
    predicted_waveform,
)
from chatter.cutting_coefficients.revolution_average import RevolutionAverage, revolution_average
from chatter.cutting_coefficients.waveform_choice import refitted
from chatter.cutting_coefficients.waveform_fit import WaveformFit
from chatter.description.case import Case
from chatter.explain.measurement import Measurement

#: cuts of which each can be left out in turn
_ENOUGH_CUTS = 3


def predicted_cut(
    average: RevolutionAverage,
    law: FittedLaw,
    means: Sequence[MeanForce],
    cases: dict[str, Case],
    fit: WaveformFit,
) -> PredictedCut:
    """Forces of a cut by the law and the waveforms of others; `cases` are those of the means."""
    found = predicted_waveform(average.case, fit).copy()
    of_channel = predicted_means(average.case, law, means, cases)
    found[:, 0] = [of_channel[name] for name in average.channels]
    return PredictedCut(average, found)


def each_by_the_others(
    law: FittedLaw, means: Sequence[MeanForce], cases: dict[str, Case], fit: WaveformFit
) -> tuple[PredictedCut, ...]:
    """Each cut by the same laws fitted to the others; empty of fewer than three."""
    if len(fit.averages) < _ENOUGH_CUTS:
        return ()
    found = []
    for one in fit.averages:
        rest = {name: case for name, case in cases.items() if name != one.run}
        others = [mean for mean in means if mean.run != one.run]
        again = fitted_law(law.law, others, rest)
        if again is None:
            return ()
        waves = refitted(fit, [other for other in fit.averages if other is not one])
        found.append(predicted_cut(one, again, others, rest, waves))
    return tuple(found)


def of_measurement(
    measurement: Measurement,
    law: FittedLaw,
    means: Sequence[MeanForce],
    cases: dict[str, Case],
    fit: WaveformFit,
) -> tuple[PredictedCut, ...]:
    """Cuts of a measurement that was kept apart."""
    averages = [revolution_average(measurement, run) for run in measurement.runs]
    return tuple(predicted_cut(one, law, means, cases, fit) for one in averages)
