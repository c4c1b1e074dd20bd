"""What an effect is: a patch of a case with named numbers, and when it may be missing."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import Parameter

Values = Mapping[str, float]
#: paths of a case -> values
Patch = dict[str, Any]
#: channel -> samples, SI
Signals = Mapping[str, NDArray[np.float64]]
#: name -> value and SI unit
Reported = Mapping[str, tuple[float, str]]


class Effect(ABC):
    """An effect that a model may lack.

    Attributes
    ----------
    name : str
        As in explanation.json.
    label : str
        As in pictures.
    help : str
        What it does, for reports and the docs.
    kinds : tuple of str
        Kinds of measurement in which it shows.
    section : str
        Section of the case that the parameters are keys of.
    declared : str
        Path into the case: the effect may be missing where nothing stands there, or 0.
    essential : tuple of str
        Amounts each of which it must have: without one it is another effect, which nobody lists.
    """

    name: ClassVar[str]
    label: ClassVar[str]
    help: ClassVar[str]
    kinds: ClassVar[tuple[str, ...]]
    section: ClassVar[str] = ""
    declared: ClassVar[str] = ""
    essential: ClassVar[tuple[str, ...]] = ()

    @property
    def variants(self) -> tuple[Effect, ...]:
        """Forms of the effect that are tried, of which the best counts."""
        return (self,)

    @property
    def richer(self) -> tuple[Effect, ...]:
        """Forms with more parameters, tried in its place once it is found and something is left."""
        return ()

    def applies(self, measurement: Measurement) -> bool:
        """Whether it may be missing in a measurement of one of its kinds."""
        return not measurement.case.get(self.declared)

    def applies_beside(self, measurement: Measurement, others: Collection[str]) -> bool:
        """Whether it may be missing beside other effects that were found, by name."""
        return True

    @abstractmethod
    def parameters(self, measurement: Measurement) -> Sequence[Parameter]:
        """Numbers that are fitted, with their priors or sizes and bounds, SI."""

    def nothing(self, measurement: Measurement) -> Values:
        """Amounts and their values at which there is no effect; what begins at zero by default."""
        return {
            one.name: 0.0
            for one in self.parameters(measurement)
            if not one.prior and one.start == 0.0
        }

    def patch(self, case: Case, values: Values) -> Patch:
        """Assignments of a case by path; the parameters as keys of the section by default."""
        return {f"{self.section}.{key}": float(value) for key, value in values.items()}

    def starts(self, measurement: Measurement) -> Sequence[Values]:
        """Start values to try, each by name; those of the parameters where none is named."""
        return ({},)

    def sizable_starts(self, measurement: Measurement) -> Sequence[Values]:
        """Start values of an effect that is not small; none by default.

        Tried where a fit has drawn declared values out of their tolerances: they may stand for the
        effect, and are put back.
        """
        return ()

    def proposed(
        self, measurement: Measurement, predicted: Mapping[str, Signals]
    ) -> Sequence[Values]:
        """Start values that the residual proposes beside those of `starts`; none by default.

        Predicted signals are by run, of the case that leaves the residual.
        """
        return ()

    def reported(self, values: Values) -> Reported | None:
        """Numbers for the report; None for the parameters themselves."""
        return None


def free(name: str, start: float, size: float, unit: str, **bounds: float) -> Parameter:
    """A parameter without a prior, of a typical size."""
    return Parameter(name, start, size, prior=False, unit=unit, **bounds)


def polar(first: float, second: float) -> tuple[float, float]:
    """Length and angle, rad from 0 to 2 pi, of two components."""
    return math.hypot(first, second), math.atan2(second, first) % (2.0 * math.pi)
