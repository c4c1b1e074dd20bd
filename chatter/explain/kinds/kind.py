"""What every kind of measurement tells the search: predictions, uncertain values, effects."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection.fitting import Parameter

Signals = Mapping[str, NDArray[np.float64]]


class Kind(Protocol):
    """A kind of measurement."""

    #: as in measurement.toml
    name: str

    def channels(self, run: Run) -> tuple[str, ...]:
        """Signals of a run that are predicted."""

    def predict(self, case: Case, run: Run) -> Signals:
        """Signals of a run by a case with the overrides of the run, at its samples, SI."""

    def residuals(self, case: Case, run: Run, noise: Mapping[str, float]) -> NDArray[np.float64]:
        """What is left of a run, scaled to a standard deviation of one."""

    def uncertain(self, measurement: Measurement) -> list[Parameter]:
        """Declared values that are merely uncertain, by their paths."""


@dataclass(frozen=True)
class Effect:
    """An effect that a model may lack: a patch of the case with named numbers.

    Parameters
    ----------
    name : str
    kinds : tuple of str
        Kinds of measurement in which it shows.
    applies : callable
        Measurement -> whether it may be missing there.
    parameters : callable
        Measurement -> parameters, in SI.
    patch : callable
        (case, values by name) -> assignments of the case by path.
    starts : callable
        Measurement -> start values to try, each by name; one empty mapping for the defaults.
    says : str
        What it does, for reports.
    told : callable, optional
        Values by name -> the numbers that people want, each with its SI unit; the parameters
        themselves by default.
    """

    name: str
    kinds: tuple[str, ...]
    applies: Callable[[Measurement], bool]
    parameters: Callable[[Measurement], Sequence[Parameter]]
    patch: Callable[[Case, Mapping[str, float]], dict[str, Any]]
    starts: Callable[[Measurement], Sequence[Mapping[str, float]]] = lambda _: ({},)
    says: str = ""
    told: Callable[[Mapping[str, float]], Mapping[str, tuple[float, str]]] | None = None
