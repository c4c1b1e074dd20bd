"""Set-ups: tap tests, cuts, moves and verdicts of one machine, tool and part, judged together."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.explain.kinds.frf import FrequencyResponse
from chatter.explain.kinds.kind import Array, Cuts, Deviation, Kind, Noise, Signals, Trial
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.finding import Finding
from chatter.explain.residuals.residual import Residual, over_noise
from chatter.studies.kept_arrays import KeptArrays

#: kinds that hold cuts to draw among lobes, the best first
_OF_CUTS = ("stability", "milling")


class SetUp(Kind):
    """Parts of several kinds, each run predicted and judged as its own kind does.

    Parameters
    ----------
    kinds : dict of str to Kind
        Kinds that a part may be of, by name.
    """

    name = "set-up"
    sections = ()
    columns = ()

    def __init__(self, kinds: Mapping[str, Kind]) -> None:
        self.kinds = kinds

    def _of(self, run: Run) -> Kind:
        return self.kinds[run.kind]

    def _by_kind(
        self, measurement: Measurement, change: Callable[[Kind, Measurement], Measurement]
    ) -> Measurement:
        """Measurement whose runs are changed by their kinds; itself where none is."""
        changed: dict[str, Run] = {}
        for name in measurement.kinds:
            own = measurement.of_kinds((name,))
            found = change(self.kinds[name], own)
            changed |= {one.name: new for one, new in zip(own.runs, found.runs, strict=True)}
        runs = [changed[run.name] for run in measurement.runs]
        if all(new is old for new, old in zip(runs, measurement.runs, strict=True)):
            return measurement
        return measurement.with_runs(runs)

    def require(self, measurement: Measurement) -> None:
        """Raise InputError where the case or a run lacks what its part needs."""
        for part in measurement.parts:
            self.kinds[part.kind].require(part)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Return the measurement with every part as its kind is searched."""
        return measurement.with_parts(
            [self.kinds[part.kind].prepared(part) for part in measurement.parts]
        )

    def channels(self, run: Run) -> tuple[str, ...]:
        """Signals of a run that its kind predicts."""
        return self._of(run).channels(run)

    def revolution(self, run: Run) -> float | None:
        """Time after which a record of its kind repeats itself, s."""
        return self._of(run).revolution(run)

    def reported_channels(self, run: Run) -> tuple[str, ...]:
        """Channels whose errors its kind reports."""
        return self._of(run).reported_channels(run)

    def predict(self, case: Case, run: Run) -> Signals:
        """Signals of a run as its kind predicts them."""
        return self._of(run).predict(case, run)

    def reduced(self, case: Case, run: Run) -> Case:
        """Return the case as the kind of the run needs it."""
        return self._of(run).reduced(case, run)

    def stands_alone(self, run: Run) -> bool:
        """As the kind of the run does."""
        return self._of(run).stands_alone(run)

    def keeping(self, kept: KeptArrays) -> Kind:
        """Return the set-up with each of its kinds as it keeps what costs most."""
        return SetUp({name: kind.keeping(kept) for name, kind in self.kinds.items()})

    def nuisance_parameters(self, measurement: Measurement) -> list[Parameter]:
        """Declared values that any of the kinds refits, each once."""
        found: dict[str, Parameter] = {}
        for name in measurement.kinds:
            for one in self.kinds[name].nuisance_parameters(measurement.of_kinds((name,))):
                found.setdefault(one.name, one)
        return list(found.values())

    def searched_at_start(self, measurement: Measurement) -> list[Parameter]:
        """Declared values that any of the kinds looks at around first, each once."""
        found: dict[str, Parameter] = {}
        for name in measurement.kinds:
            for one in self.kinds[name].searched_at_start(measurement.of_kinds((name,))):
                found.setdefault(one.name, one)
        return list(found.values())

    def coarse(self, case: Case, run: Run) -> Mapping[str, Any]:
        """Overrides by which a run costs its kind less to predict."""
        return self._of(run).coarse(case, run)

    def cheaper_runs(self, case: Case, runs: Sequence[Run]) -> Sequence[Run]:
        """FRFs of a machine, beside what is simulated in time."""
        cheap = [run for run in runs if run.kind == FrequencyResponse.name]
        return cheap if case.on_machine and len(cheap) < len(runs) else ()

    def refined(self, measurement: Measurement, case: Case) -> Measurement:
        """Return the measurement as its kinds refine it by a case that was found."""
        return self._by_kind(measurement, lambda kind, part: kind.refined(part, case))

    def with_records_by(self, measurement: Measurement, case: Case) -> Measurement:
        """Return the measurement with the records of its kinds as a case tells them."""
        return self._by_kind(measurement, lambda kind, part: kind.with_records_by(part, case))

    def predicted_as(self, run: Run) -> str:
        """What a prediction depends on, as the kind of the run has it."""
        return self._of(run).predicted_as(run)

    def residuals(self, run: Run, predicted: Signals, noise: Mapping[str, float]) -> Array:
        """Residuals of a run as its kind scales them."""
        return self._of(run).residuals(run, predicted, noise)

    def known_noise(self, run: Run) -> Mapping[str, float]:
        """Noise of a run that its kind knows before any fit."""
        return self._of(run).known_noise(run)

    def first_noise(self, run: Run) -> Mapping[str, float]:
        """Noise of a run for the first fit."""
        return self._of(run).first_noise(run)

    def noise_beside(
        self, run: Run, predicted: Signals, noise: Mapping[str, float]
    ) -> Mapping[str, float]:
        """Noise of a run from its residual, where its kind estimates it so."""
        return self._of(run).noise_beside(run, predicted, noise)

    def deviation(
        self, run: Run, channel: str, measured: Array, predicted: Array, level: float | None
    ) -> Deviation:
        """Noise of a channel of a run, sample by sample."""
        return self._of(run).deviation(run, channel, measured, predicted, level)

    def noise_floor(self, residuals: Sequence[ChannelResidual]) -> float:
        """Error of a model that is right: the mean over the channels of all kinds."""
        floors, counts = [], []
        for name, parts in _grouped(residuals).items():
            channels = {one.channel for one in parts}
            reported = set(chain(*(self.reported_channels(one.run) for one in parts)))
            floors.append(self.kinds[name].noise_floor(parts))
            counts.append(max(len(channels & reported), 1))
        return float(np.average(floors, weights=counts))

    def findings(self, residual: Residual) -> tuple[Finding, ...]:
        """What the diagnostics of every kind find in its part of a residual."""
        return tuple(chain(*(one.kind.findings(one) for one in self._parts_of(residual))))

    def leading(self, residual: Residual) -> Residual:
        """Return the part of a residual that is farthest from its noise."""
        return max(self._parts_of(residual), key=lambda one: over_noise(one.parts))

    def _parts_of(self, residual: Residual) -> Iterable[Residual]:
        return [
            replace(
                residual,
                measurement=residual.measurement.of_kinds((name,)),
                kind=self.kinds[name],
                parts=tuple(parts),
            )
            for name, parts in _grouped(residual.parts).items()
        ]

    def trials(self, measurement: Measurement, noise: Noise) -> list[Trial]:
        """Measurements of every kind that there is."""
        found = []
        for name in measurement.kinds:
            for trial in self.kinds[name].trials(measurement.of_kinds((name,)), noise):
                found.append(trial._replace(run=replace(trial.run, kind=name)))
        return found

    def information(
        self, trial: Trial, channel: str, weights: Array, predicted: Sequence[Array]
    ) -> float:
        """Information, bit, that a channel of a trial is expected to give of weighted cases."""
        return self._of(trial.run).information(trial, channel, weights, predicted)

    def cuts(self, measurement: Measurement) -> Cuts:
        """Cuts of the part that was cut; that of the declared case where none was."""
        name = next((one for one in _OF_CUTS if one in measurement.kinds), None)
        if name is None:
            return super().cuts(measurement)
        return self.kinds[name].cuts(measurement.of_kinds((name,)))


def _grouped(residuals: Sequence[ChannelResidual]) -> dict[str, list[ChannelResidual]]:
    """Residuals by the kind of their run."""
    found: dict[str, list[ChannelResidual]] = {}
    for one in residuals:
        found.setdefault(one.run.kind, []).append(one)
    return found
