"""A measurement as a least-squares problem in the uncertain values and the effects added."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.explain.kinds.kind import Effect, Kind
from chatter.explain.measurement import Measurement, Run
from chatter.explain.residuals.noise import white_level
from chatter.explain.selection.fitting import Fit, Parameter, fit

#: residual, in standard deviations, of a run that a trial case cannot make
_FAR = 1e3
#: part of a signal's rms by which predictions of other numerics may differ
NUMERICS = 0.004

Noise = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True, eq=False)
class Problem:
    """Runs, what is uncertain, and effects that have been added.

    Parameters
    ----------
    measurement : Measurement
    kind : Kind
    noise : mapping
        Run -> channel -> standard deviation, SI.
    effects : tuple of Effect
    """

    measurement: Measurement
    kind: Kind
    noise: Noise = field(default_factory=dict)
    effects: tuple[Effect, ...] = ()

    def with_effect(self, effect: Effect) -> Problem:
        """Same problem with one effect more."""
        return Problem(self.measurement, self.kind, self.noise, (*self.effects, effect))

    def parameters(self) -> list[Parameter]:
        """Uncertain values, then those of the effects as "effect.name"."""
        found = list(self.kind.uncertain(self.measurement))
        known = {one.name for one in found}
        for effect in self.effects:
            for one in effect.parameters(self.measurement):
                named = Parameter(
                    f"{effect.name}.{one.name}",
                    one.start,
                    one.size,
                    one.lower,
                    one.upper,
                    one.prior,
                    one.unit,
                )
                if named.name not in known:
                    found.append(named)
        return found

    def assignments(self, values: Mapping[str, float]) -> dict[str, Any]:
        """Paths of the case -> values, of uncertain values and effects alike."""
        own = {effect.name: {} for effect in self.effects}
        given: dict[str, Any] = {}
        for name, value in values.items():
            effect, _, key = name.partition(".")
            if effect in own:
                own[effect][key] = value
            else:
                given[name] = float(value)
        case = self.measurement.case.patch(given) if given else self.measurement.case
        for effect in self.effects:
            given |= effect.patch(case, own[effect.name])
        return given

    def case(self, values: Mapping[str, float]) -> Case:
        """Declared case with values put in."""
        given = self.assignments(values)
        return self.measurement.case.patch(given) if given else self.measurement.case

    def residuals(self, values: Mapping[str, float], runs: Sequence[Run]) -> NDArray[np.float64]:
        """Scaled residuals of runs, one after the other."""
        try:
            case = self.case(values)
        except InputError:
            return np.full(self.count(runs), _FAR)
        parts = []
        for run in runs:
            try:
                parts.append(self.kind.residuals(run.of(case), run, self.noise[run.name]))
            except (RunError, InputError):
                parts.append(np.full(self.count([run]), _FAR))
        return np.concatenate(parts)

    def count(self, runs: Sequence[Run]) -> int:
        """Residuals of runs."""
        return sum(run.signals[channel].size for run in runs for channel in self.kind.channels(run))

    def fit(
        self,
        runs: Sequence[Run],
        start: Mapping[str, float] | None = None,
        rounds: int = 8,
        jacobian: NDArray[np.float64] | None = None,
    ) -> Fit:
        """Fit everything to runs.

        Parameters
        ----------
        runs : sequence of Run
        start : mapping of str to float, optional
            Values to start from, by name; declared ones by default.
        rounds : int
        jacobian : (n, p) array of float, optional
            Near the start, where it is known.
        """
        parameters = self.parameters()
        names = [one.name for one in parameters]
        begin = np.array([(start or {}).get(one.name, one.start) for one in parameters])

        def residuals(values: NDArray[np.float64]) -> NDArray[np.float64]:
            return self.residuals(dict(zip(names, values, strict=True)), runs)

        return fit(parameters, residuals, begin, rounds, jacobian)

    def noise_beside(self, values: Mapping[str, float]) -> Noise:
        """Noise of every channel of every run, from what a case leaves of them."""
        if not getattr(self.kind, "noise_is_white", True):
            return self.noise
        case = self.case(values)
        levels: dict[str, dict[str, float]] = {}
        for run in self.measurement.runs:
            predicted = self.kind.predict(run.of(case), run)
            levels[run.name] = {
                channel: float(
                    np.hypot(
                        white_level(
                            (run.signals[channel] - predicted[channel])
                            * run.signals.get("certainty", 1.0)
                            * run.usable(run.signals[channel].size)
                        ),
                        NUMERICS * np.sqrt(np.mean(run.signals[channel] ** 2)),
                    )
                )
                for channel in self.kind.channels(run)
            }
        return levels


def scaled_difference(
    kind: Kind, case: Case, run: Run, noise: Mapping[str, float]
) -> NDArray[np.float64]:
    """Predicted less measured over the noise, of all channels of a run."""
    predicted = kind.predict(case, run)
    return np.concatenate(
        [
            (predicted[channel] - run.signals[channel])
            * (run.usable(run.signals[channel].size) / noise[channel])
            for channel in kind.channels(run)
        ]
    )
