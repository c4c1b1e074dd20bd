"""Cutting tests judged stable or chatter: how likely each verdict is by the model."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy.special

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.units import rpm
from chatter.explain.data_checks.verdicts import wrong_verdicts
from chatter.explain.fitting import Parameter, with_priors
from chatter.explain.kinds.kind import Array, Cuts, Deviation, Kind, Noise, Signals, Trial
from chatter.explain.kinds.milling import cutting_paths
from chatter.explain.measurement import Measurement, Run
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.misclassified_tests import misclassified, over_depth, over_speed
from chatter.explain.stability_margin import stability_margins

#: scatter of a critical depth from test to test, as a share, and tests judged wrongly for no reason
_SCATTER, _WRONG = 0.06, 0.02
#: runs that the tests are dealt out to, and verdicts that are needed
_PARTS, _LEAST_VERDICTS = 6, 12
#: least probability of an outcome in the scatter of a verdict
_LEAST_LIKELY = 1e-6
#: points of a discriminating test, a side, and noise of its verdict: outcomes are told apart where
#: their probabilities differ by most of one
_POINTS, _NOISE_OF_VERDICT = 12, 0.25


class Stability(Kind):
    """Points over speed and depth with a verdict each; marginal ones do not count."""

    name = "stability"
    table_key = "points"
    columns = (("spindle_speed",), ("axial_depth",), ("stable",))
    is_sampled = False
    estimates_noise = False
    has_autocorrelation = False
    diagnostics = (misclassified, over_speed, over_depth)
    checks = ((), (wrong_verdicts,))
    #: deviance residuals of a model that is right are small
    at_noise = 1.0
    #: twice the logarithm of the likelihood, whatever the number of points
    least_gain = (8.0, 0.0)

    def channels(self, run: Run) -> tuple[str, ...]:
        """The verdicts."""
        return ("stable",)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Return the measurement whose points are dealt out to several runs.

        Raises InputError if there are fewer than a dozen verdicts.
        """
        (run,) = measurement.runs
        judged = np.isfinite(run.signals["stable"])
        if judged.sum() < _LEAST_VERDICTS:
            raise InputError(
                f"{run.name}: {judged.sum()} verdicts; {_LEAST_VERDICTS} at least are needed"
            )
        columns = {name: values[judged] for name, values in run.signals.items()}
        return measurement.with_runs(
            [
                replace(
                    run,
                    name=f"points {part + 1}",
                    signals={name: values[part::_PARTS] for name, values in columns.items()},
                )
                for part in range(_PARTS)
            ]
        )

    def noise_floor(self, residuals: Sequence[ChannelResidual]) -> float:
        """Error that a model has that is right: verdicts scatter about their probabilities."""
        scatter = np.mean([np.mean(one.predicted * (1.0 - one.predicted)) for one in residuals])
        level = np.mean([np.mean(one.measured**2) for one in residuals])
        return float(np.sqrt(scatter / level))

    def predict(self, case: Case, run: Run) -> Signals:
        """Probability of a stable verdict at every point."""
        margins = stability_margins(case, run.signals["spindle_speed"], run.signals["axial_depth"])
        likely = scipy.special.ndtr(margins / _SCATTER)
        return {"stable": _WRONG + (1.0 - 2.0 * _WRONG) * likely}

    def residuals(self, run: Run, predicted: Signals, noise: Mapping[str, float]) -> Array:
        """Deviance residuals: their squares are twice the lost logarithm of likelihood."""
        stable = predicted["stable"]
        verdict = run.signals["stable"] > 0.5
        likely = np.where(verdict, stable, 1.0 - stable)
        return np.where(verdict, 1.0, -1.0) * np.sqrt(-2.0 * np.log(likely))

    def deviation(
        self, run: Run, channel: str, measured: Array, predicted: Array, level: float | None
    ) -> Deviation:
        """Scatter of every verdict by its own probability."""
        likely = np.clip(predicted, _LEAST_LIKELY, 1.0 - _LEAST_LIKELY)
        variance = likely * (1.0 - likely)
        return Deviation(np.sqrt(variance), float(np.sqrt(np.mean(variance))))

    def nuisance_parameters(self, measurement: Measurement) -> list[Parameter]:
        """Cutting coefficients and modal parameters."""
        return with_priors(measurement, cutting_paths(measurement.case, ("Ktc", "Krc")))

    def cuts(self, measurement: Measurement) -> Cuts:
        """The tests, with their verdicts."""
        speed, depth, stable = (
            np.concatenate([run.signals[name] for run in measurement.runs])
            for name in ("spindle_speed", "axial_depth", "stable")
        )
        return Cuts(speed, depth, stable > 0.5)

    def trials(self, measurement: Measurement, noise: Noise) -> list[Trial]:
        """Verdicts at single points over the speeds and depths that were tested."""
        speeds, depths, _ = self.cuts(measurement)
        trials = []
        for speed in np.geomspace(speeds.min(), speeds.max(), _POINTS):
            for depth in np.geomspace(depths.min(), depths.max(), _POINTS):
                words = f"a cut at {rpm(speed):.0f} rpm and {depth * 1e3:.3g} mm"
                point = {"spindle_speed": np.array([speed]), "axial_depth": np.array([depth])}
                trials.append(Trial(words, Run("trial", {}, point), {"stable": _NOISE_OF_VERDICT}))
        return trials
