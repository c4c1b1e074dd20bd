"""A measurement as a least-squares problem in the nuisance parameters and the effects added."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.explain.criteria import IMPOSSIBLE
from chatter.explain.effects.effect import Effect
from chatter.explain.fitting import Fit, LeastSquares, Residuals
from chatter.explain.kinds.kind import Kind, Noise, Signals
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter
from chatter.explain.prediction import Predictions


@dataclass(frozen=True, eq=False)
class Problem:
    """Runs, nuisance parameters, and effects that have been added."""

    measurement: Measurement
    predictions: Predictions
    noise: Noise  # run -> channel -> standard deviation, SI
    effects: tuple[Effect, ...] = ()
    #: run -> scaled residuals that coarse predictions of it lack
    correction: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    @property
    def kind(self) -> Kind:
        """Kind of the measurement."""
        return self.predictions.kind

    def with_effect(self, effect: Effect) -> Problem:
        """Same problem with one effect more."""
        return replace(self, effects=(*self.effects, effect))

    def without_effect(self, effect: Effect) -> Problem:
        """Same problem with one effect less."""
        return replace(self, effects=tuple(one for one in self.effects if one is not effect))

    def measured_by(self, effect: Effect) -> Measurement:
        """Return what was measured of the kinds in which an effect shows."""
        return self.measurement.of_kinds(effect.kinds)

    def with_noise_beside(self, values: Mapping[str, float]) -> Problem:
        """Same problem with the noise estimated from the residual of a case."""
        if not self.kind.estimates_noise:
            return self
        case = self.case(values)
        noise = {
            run.name: self.kind.noise_beside(
                run, self.predictions.of(case, run), self.noise[run.name]
            )
            for run in self.measurement.runs
        }
        return replace(self, noise=noise)

    def parameters(self) -> list[Parameter]:
        """Nuisance parameters, then those of the effects as "effect.name"."""
        found = {one.name: one for one in self.kind.nuisance_parameters(self.measurement)}
        for effect in self.effects:
            for one in effect.parameters(self.measured_by(effect)):
                name = f"{effect.name}.{one.name}"
                found.setdefault(name, replace(one, name=name))
        return list(found.values())

    def declared_pulls(self, found: Fit) -> dict[str, float]:
        """Standard deviations by which a fit moves declared values.

        What an effect adds is not declared: its usual size only helps the search.
        """
        added = {effect.name for effect in self.effects}
        return {k: v for k, v in found.pulls.items() if k.partition(".")[0] not in added}

    def case(self, values: Mapping[str, float]) -> Case:
        """Declared case with values put in."""
        own: dict[str, dict[str, float]] = {effect.name: {} for effect in self.effects}
        given: dict[str, Any] = {}
        for name, value in values.items():
            owner, _, key = name.partition(".")
            if owner in own:
                own[owner][key] = value
            else:
                given[name] = float(value)
        case = self.measurement.with_values(given)
        for effect in self.effects:
            # each upon those before it: modes that one adds are not lost to another
            case = case.patch(effect.patch(case, own[effect.name]))
        return case

    def predicted(self, values: Mapping[str, float], runs: Sequence[Run]) -> Mapping[str, Signals]:
        """Predicted signals by run; empty where one cannot be predicted."""
        try:
            case = self.case(values)
            return {run.name: self.predictions.of(case, run) for run in runs}
        except (RunError, InputError):
            return {}

    def residuals(self, values: Mapping[str, float], runs: Sequence[Run]) -> NDArray[np.float64]:
        """Scaled residuals of runs, one after the other."""
        try:
            case = self.case(values)
        except InputError:
            return np.full(self.count(runs), IMPOSSIBLE)
        parts = []
        for run in runs:
            try:
                predicted = self.predictions.of(case, run)
                residuals = self.kind.residuals(run, predicted, self.noise[run.name])
                parts.append(residuals + self.correction.get(run.name, 0.0))
            except (RunError, InputError):
                parts.append(np.full(self.count([run]), IMPOSSIBLE))
        return np.concatenate(parts)

    def coarse(self, runs: Sequence[Run]) -> list[Run]:
        """Runs as they are predicted where differences between predictions are asked for."""
        return [self.predictions.coarse(self.measurement.case, run) for run in runs]

    def screened(self, now: Fit, runs: Sequence[Run]) -> tuple[Problem, tuple[Run, ...]]:
        """Problem and runs that are predicted coarsely, exact at a fit to these runs.

        What coarse predictions lack there they nearly lack near it too.
        """
        coarse = tuple(self.coarse(runs))
        if all(one is run for one, run in zip(coarse, runs, strict=True)):
            return self, coarse
        lacking = now.residuals - self.residuals(now.by_name, coarse)
        ends = np.cumsum([self.count([run]) for run in coarse])
        parts = np.split(lacking, ends[:-1])
        names = [run.name for run in coarse]
        return replace(self, correction=dict(zip(names, parts, strict=True))), coarse

    def cost(self, values: Mapping[str, float], runs: Sequence[Run]) -> float:
        """Sum of squares of the residuals of runs."""
        residuals = self.residuals(values, runs)
        return float(residuals @ residuals)

    def count(self, runs: Sequence[Run]) -> int:
        """Residuals of runs."""
        return sum(run.signals[channel].size for run in runs for channel in self.kind.channels(run))

    def fit(
        self,
        runs: Sequence[Run],
        start: Mapping[str, float],
        jacobian: NDArray[np.float64] | None = None,
    ) -> Fit:
        """Fit everything to runs, near enough to compare effects.

        From values by name, declared ones where they are not named, with a Jacobian (n, p) near the
        start where it is known.
        """
        return self._least_squares(runs).near_fit(self._begin(start), jacobian)

    def final_fit(self, runs: Sequence[Run], start: Mapping[str, float]) -> Fit:
        """Fit everything to runs as `fit` does, to within a sixth of a standard deviation."""
        return self._least_squares(runs).fit(self._begin(start))

    def rough_fit(
        self,
        runs: Sequence[Run],
        start: Mapping[str, float],
        jacobian: NDArray[np.float64] | None = None,
    ) -> Fit:
        """Fit everything to runs near enough to rank candidates by."""
        return self._least_squares(runs).rough_fit(self._begin(start), jacobian)

    def part_of(self, found: Fit, runs: Sequence[Run], chosen: Sequence[Run]) -> Fit:
        """Return a fit to runs with the residuals of some of them alone."""
        names = {run.name for run in chosen}
        rows: NDArray[np.bool_] = np.concatenate(
            [np.full(self.count([run]), run.name in names) for run in runs]
        )
        return replace(found, residuals=found.residuals[rows], jacobian=found.jacobian[rows])

    def judged(self, found: Fit, runs: Sequence[Run]) -> Fit:
        """Return a fit to coarse predictions with the residuals of the predictions themselves."""
        return replace(found, residuals=self.residuals(found.by_name, runs))

    def _least_squares(self, runs: Sequence[Run]) -> LeastSquares:
        """Residuals of runs over the parameters; differences by what is predicted coarsely."""
        parameters = self.parameters()
        names = [one.name for one in parameters]

        def residuals_of(chosen: Sequence[Run]) -> Residuals:
            def residuals(values: NDArray[np.float64]) -> NDArray[np.float64]:
                return self.residuals(dict(zip(names, values, strict=True)), chosen)

            return residuals

        return LeastSquares(parameters, residuals_of(runs), residuals_of(self.coarse(runs)))

    def _begin(self, start: Mapping[str, float]) -> NDArray[np.float64]:
        """Values at which a fit begins, declared ones where they are not named."""
        return np.array([start.get(one.name, one.start) for one in self.parameters()])
