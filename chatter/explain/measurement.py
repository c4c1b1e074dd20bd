"""What was measured: runs with their signals, and the case that was declared about them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.records.description import RecordDescription

#: runs of which some can be held out, and parts that fewer runs are cut into
_ENOUGH_RUNS, _PARTS = 3, 6


@dataclass(frozen=True, eq=False)
class Run:
    """One recorded run."""

    name: str  # of its file
    overrides: Mapping[str, Any]  # paths of the case -> values that hold in this run
    #: (n,) each, SI, by the name in the heading: "time", "Fx", "x", "velocity", ...
    signals: Mapping[str, NDArray[np.float64]]
    cut_time: float = 0.0  # that the tool had cut before the run, s
    condition: str = ""  # of FRFs
    direction: str = ""  # of FRFs
    axis: str = ""  # of the machine, that moves; where it is named
    #: (n,), 1 for samples that count, 0 for those that the checks excluded
    usable: NDArray[np.float64] | None = None
    #: of samples by channel, 1 at the most
    weights: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    record: Any = None  # what the kind derives from the signals, in a type of its own
    #: channels beside the usual ones that are predicted -> what they hold
    components: Mapping[str, Any] = field(default_factory=dict)
    #: channels that are described in measurement.toml and have a direction
    described: tuple[str, ...] = ()
    whole: Run | None = None  # run of which this one is a part
    part: slice | None = None  # samples of the whole run that the part holds
    kind: str = ""  # where the measurement is a set-up of several

    def weight(self, channel: str) -> NDArray[np.float64]:
        """Weights (n,) of the samples of a channel, 0 where they are excluded."""
        count = self.signals[channel].size
        weight = self.weights.get(channel, np.ones(count))
        return weight if self.usable is None else weight * self.usable

    def level(self, channel: str) -> float:
        """Rms of a channel over the whole run, of which a part may be at rest."""
        return float(np.sqrt(np.mean((self.whole or self).signals[channel] ** 2)))

    @property
    def step(self) -> float:
        """Time from sample to sample, s, of as many digits as a clock has."""
        return float(f"{np.median(np.diff(self.signals['time'])):.9g}")

    def in_part(self, number: int, parts: int) -> Run:
        """Return one of some equal parts in time, 0 <= number < parts."""
        size = self.signals["time"].size
        chosen = slice(number * size // parts, (number + 1) * size // parts)

        def cut(columns: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
            return {name: values[chosen] for name, values in columns.items()}

        return replace(
            self,
            name=f"{self.name}, part {number + 1} of {parts}",
            signals=cut(self.signals),
            usable=None if self.usable is None else self.usable[chosen],
            weights=cut(self.weights),
            whole=self,
            part=chosen,
        )

    def with_overrides(self, overrides: Mapping[str, Any]) -> Run:
        """Same run, as a whole and in its part, with more overrides."""
        whole = None if self.whole is None else self.whole.with_overrides(overrides)
        return replace(self, overrides={**self.overrides, **overrides}, whole=whole)

    def with_record(self, record: Any) -> Run:
        """Same run, as a whole and in its part, with another record."""
        whole = None if self.whole is None else self.whole.with_record(record)
        return replace(self, record=record, whole=whole)

    def of_kind(self, kind: str) -> Run:
        """Same run, as a whole and in its part, as one of a kind of a set-up."""
        whole = None if self.whole is None else self.whole.of_kind(kind)
        return replace(self, kind=kind, whole=whole)

    def of(self, case: Case) -> Case:
        """Return a case with the overrides of the run."""
        return case.patch(dict(self.overrides)) if self.overrides else case


@dataclass(frozen=True, eq=False)
class Measurement:
    """What was measured, and the case that was declared about it."""

    kind: str  # "milling", "axis", "stability", "frf", "drive", "set-up"
    title: str
    folder: Path
    case: Case
    runs: tuple[Run, ...]
    #: relative, of declared values by path
    tolerances: Mapping[str, float] = field(default_factory=dict)
    idle_power: float | None = None  # that the spindle takes in the air, W
    record: RecordDescription | None = None  # how the runs were recorded, where it is told
    #: path of the case -> least and largest value, SI, that the next measurement may have
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    #: of a set-up: what was measured of each kind, with the case of the whole; runs are theirs
    parts: tuple[Measurement, ...] = ()

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of the runs: one, but of a set-up."""
        if not self.parts:
            return (self.kind,)
        return tuple(dict.fromkeys(run.kind for run in self.runs))

    def of_kinds(self, kinds: Sequence[str]) -> Measurement:
        """Return the measurement with its runs of some kinds alone."""
        if not self.parts or all(name in kinds for name in self.kinds):
            return self
        runs = tuple(run for run in self.runs if run.kind in kinds)
        parts = tuple(part for part in self.parts if part.kind in kinds)
        if len(parts) != 1:
            return replace(self, runs=runs, parts=parts)
        (one,) = parts
        return replace(one, case=self.case, runs=runs, tolerances=self.tolerances)

    def with_parts(self, parts: Sequence[Measurement]) -> Measurement:
        """Return a set-up with other parts, and their runs."""
        runs = [run.of_kind(part.kind) for part in parts for run in part.runs]
        return replace(self, parts=tuple(parts), runs=tuple(runs))

    def in_parts(self, most: int = _PARTS) -> Measurement:
        """Return the measurement with its runs cut in time where there are too few to judge by.

        Runs are cut into `most` parts, all together.
        """
        if len(self.runs) >= _ENOUGH_RUNS:
            return self
        parts = -(-most // len(self.runs))
        return self.with_runs([run.in_part(k, parts) for run in self.runs for k in range(parts)])

    def with_runs(self, runs: list[Run]) -> Measurement:
        """Same measurement with other runs."""
        return replace(self, runs=tuple(runs))

    def with_case(self, case: Case) -> Measurement:
        """Same measurement with another case declared."""
        parts = tuple(part.with_case(case) for part in self.parts)
        return replace(self, case=case, parts=parts)

    def with_values(self, values: Mapping[str, Any]) -> Case:
        """Return the declared case with values put in by path."""
        return self.case.patch(dict(values)) if values else self.case
