"""Cutting tests judged stable or chatter: how likely each verdict is by the model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy.special
from numpy.typing import NDArray

from chatter.compile.structure import depends_on_speed
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.kinds.milling import structural_paths
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection.fitting import Parameter
from chatter.explain.selection.prior import tolerated
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import multipliers
from chatter.stability.model import milling_model

#: scatter of a limit depth from test to test, as a share, and tests judged wrongly for no reason
_SCATTER, _WRONG = 0.06, 0.02
#: share of the depth over which the growth is looked at
_STEP = 0.04
#: margins beyond this count as this
_FAR = 3.0
_PARTS = 6


class Stability:
    """Points over speed and depth with a verdict each; marginal ones are left out."""

    name = "stability"
    noise_is_white = False
    #: deviance residuals of a model that is right are small
    at_noise = 1.0
    #: gain in twice the logarithm of the likelihood that counts, whatever the number of points
    least_gain = (8.0, 0.0)

    def channels(self, run: Run) -> tuple[str, ...]:  # noqa: ARG002
        """The verdicts."""
        return ("stable",)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Measurement whose points are dealt out to several runs.

        Raises
        ------
        InputError
            If a column is missing or there are fewer than a dozen verdicts.
        """
        signals = measurement.runs[0].signals
        missing = [key for key in ("spindle_speed", "axial_depth", "stable") if key not in signals]
        if missing:
            raise InputError(f"{measurement.runs[0].name}: column {', '.join(missing)} is missing")
        judged = np.isfinite(signals["stable"])
        if judged.sum() < 2 * _PARTS:
            raise InputError(f"{measurement.runs[0].name}: {judged.sum()} verdicts; 12 at least")
        columns = {name: values[judged] for name, values in signals.items()}
        runs = tuple(
            replace(
                measurement.runs[0],
                name=f"points {part + 1}",
                signals={name: values[part::_PARTS] for name, values in columns.items()},
            )
            for part in range(_PARTS)
        )
        return replace(measurement, runs=runs)

    def noise_floor(self, measurement: Measurement, case: Case) -> float:
        """Error that a model has that is right: verdicts scatter about their probabilities."""
        scatter, level = [], []
        for run in measurement.runs:
            stable = self.predict(run.of(case), run)["stable"]
            scatter.append(np.mean(stable * (1.0 - stable)))
            level.append(np.mean(run.signals["stable"] ** 2))
        return float(np.sqrt(np.mean(scatter) / np.mean(level)))

    def predict(self, case: Case, run: Run) -> Mapping[str, NDArray[np.float64]]:
        """Probability of a stable verdict at every point."""
        margins = stability_margins(case, run.signals["spindle_speed"], run.signals["axial_depth"])
        likely = scipy.special.ndtr(margins / _SCATTER)
        return {"stable": _WRONG + (1.0 - 2.0 * _WRONG) * likely}

    def residuals(
        self,
        case: Case,
        run: Run,
        noise: Mapping[str, float],  # noqa: ARG002
    ) -> NDArray[np.float64]:
        """Deviance residuals: their squares are twice the lost logarithm of likelihood."""
        stable = self.predict(case, run)["stable"]
        verdict = run.signals["stable"] > 0.5
        likely = np.where(verdict, stable, 1.0 - stable)
        return np.where(verdict, 1.0, -1.0) * np.sqrt(-2.0 * np.log(likely))

    def uncertain(self, measurement: Measurement) -> list[Parameter]:
        """Cutting coefficients and modal parameters."""
        case = measurement.case
        paths = [f"material.{key}" for key in ("Ktc", "Krc") if getattr(case.material, key)]
        paths += structural_paths(case)
        if case.process_damping is not None and case.process_damping.coefficient:
            paths.append("process_damping.coefficient")
        return tolerated(measurement, paths)


def stability_margins(
    case: Case, speeds: NDArray[np.float64], depths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Share of its depth by which a cut is away from the limit; above 0: stable.

    Notes
    -----
    From the growth at the depth and a little above, as if its logarithm were linear in that of
    the depth.
    """
    growth, slope = np.empty(speeds.size), np.empty(speeds.size)
    groups = np.unique(speeds) if depends_on_speed(case) else [None]
    for speed in groups:
        chosen = slice(None) if speed is None else speeds == speed
        own = case if speed is None else case.patch({"cut.spindle_speed": float(speed)})
        cut = element_cut(milling_model(own), (1.0 + _STEP) * float(depths[chosen].max()))
        at = multipliers(cut, speeds[chosen], depths[chosen])
        above = multipliers(cut, speeds[chosen], depths[chosen] * (1.0 + _STEP))
        growth[chosen] = np.log(np.maximum(np.abs(at), 1e-12))
        slope[chosen] = (np.log(np.maximum(np.abs(above), 1e-12)) - growth[chosen]) / np.log1p(
            _STEP
        )
    # where growth does not rise with depth, its size tells no more than the side
    rising = np.maximum(slope, 0.3 * np.abs(growth) + 1e-3)
    return np.clip(-growth / rising, -_FAR, _FAR)
