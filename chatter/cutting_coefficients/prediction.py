"""Forces of a cut that was not fitted: mean and waveform, by the law and by the cuts beside it.

Under a linear law, with linear dynamics of tool, workpiece and dynamometer and no tooth that
misses, every Fourier coefficient over the revolution is a line over the feed per tooth: forces of
edges and runout are the same at each feed, those of the feed grow with it, and both are filtered
alike. That holds for a tool that vibrates and cuts its own waves as well, which no rigid tool does.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from chatter.cutting_coefficients.feed_series import at_feed, differ_by_feed_alone
from chatter.cutting_coefficients.fit import FittedLaw
from chatter.cutting_coefficients.mean_forces import MeanForce, channels_of
from chatter.cutting_coefficients.revolution_average import RevolutionAverage
from chatter.cutting_coefficients.waveform_fit import WaveformFit
from chatter.cutting_coefficients.waveform_model import Complex
from chatter.description.arrays import Array
from chatter.description.case import Case

#: points over a revolution of a waveform that is compared or drawn
_POINTS = 360
#: turns of the spindle that are tried over a revolution
_TURNS = 720


@dataclass(frozen=True, eq=False)
class PredictedCut:
    """A cut that was not fitted, and its forces by those that were."""

    average: RevolutionAverage
    predicted: Complex  # (channels, k), N

    def errors(self) -> dict[str, Any]:
        """Means and peak-to-peak by channel: measured and predicted, N, and what differs."""
        found = compared(self.average, self.predicted)
        for name, share in zip(self.average.channels, self._left(), strict=True):
            found[name]["left"] = share
        return found

    def aligned(self) -> Complex:
        """Prediction (channels, k) with the spindle turned to fit, and as many harmonics, N."""
        count = min(self.predicted.shape[1], self.average.amplitude.shape[1])
        measured, expected = self.average.amplitude[:, 1:count], self.predicted[:, 1:count]
        angle = 2.0 * math.pi * np.arange(_TURNS) / _TURNS
        turned = np.exp(1j * np.outer(angle, np.arange(count)))
        match = turned[:, 1:] @ np.sum(np.conj(measured) * expected, axis=0)
        return self.predicted[:, :count] * turned[np.argmax(match.real)]

    def _left(self) -> list[float]:
        """Share of the varying force that is not predicted, at the best turn of the spindle."""
        shown = self.aligned()[:, 1:]
        measured = self.average.amplitude[:, 1 : shown.shape[1] + 1]
        size = np.linalg.norm(measured, axis=1)
        return [float(one) for one in np.linalg.norm(measured - shown, axis=1) / size]


def predicted_means(
    case: Case, law: FittedLaw, means: Sequence[MeanForce], cases: dict[str, Case]
) -> dict[str, float]:
    """Mean force of each channel, N: by a law, and what it leaves at the feeds beside it."""
    found = {}
    is_series = differ_by_feed_alone([case, *cases.values()])
    for channel in channels_of(means):
        own = [k for k, one in enumerate(means) if one.channel == channel]
        found[channel] = float(law.mean_forces_of([means[own[0]]], case)[0])
        if is_series:
            left = [means[k].value - law.predicted[k] for k in own]
            feeds = [cases[means[k].run].cut.feed_per_tooth for k in own]
            found[channel] += float(at_feed(case.cut.feed_per_tooth, feeds, left))
    return found


def predicted_waveform(case: Case, fit: WaveformFit) -> Complex:
    """Fourier coefficients (channels, k) at a start angle of zero, N.

    By lines over the feed where the cuts differ by it alone; else by the law of the rigid tool.
    """
    parts = fit.model.split(fit.parameters, len(fit.averages))
    if not differ_by_feed_alone([case, *(one.case for one in fit.averages)]):
        average = _of_case(fit.averages[0], case)
        return fit.model.seen(average, parts, fit.model.forces(average, parts), 0.0) @ (
            fit.coefficients
        )
    count = min(one.amplitude.shape[1] for one in fit.averages)
    turned = [
        one.amplitude[:, :count] * np.exp(-1j * start * np.arange(count))
        for one, start in zip(fit.averages, parts["start"], strict=True)
    ]
    feeds = [one.case.cut.feed_per_tooth for one in fit.averages]
    return at_feed(case.cut.feed_per_tooth, feeds, turned)


def _of_case(average: RevolutionAverage, case: Case) -> RevolutionAverage:
    return RevolutionAverage(
        average.run, case, average.channels, average.directions, case.cut.spindle_speed,
        average.amplitude, average.repeated,
    )  # fmt: skip


def waveform(amplitude: Complex) -> Array:
    """Forces (channels, points) over the revolution from Fourier coefficients, N."""
    harmonic = np.arange(amplitude.shape[1])
    turn = np.exp(2j * math.pi * np.outer(harmonic, np.arange(_POINTS) / _POINTS))
    return ((amplitude * np.where(harmonic == 0, 1.0, 2.0)) @ turn).real


def compared(average: RevolutionAverage, predicted: Complex) -> dict[str, dict[str, float]]:
    """Means and peak-to-peak by channel: measured and predicted, N."""
    measured, expected = waveform(average.amplitude), waveform(predicted)
    return {
        name: {
            "mean_N": float(measured[row].mean()),
            "mean_predicted_N": float(expected[row].mean()),
            "peak_to_peak_N": float(np.ptp(measured[row])),
            "peak_to_peak_predicted_N": float(np.ptp(expected[row])),
        }
        for row, name in enumerate(average.channels)
    }
