"""What a confrontation is: a draw of cases, and two ways to the same numbers of each."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from chatter.description.case import Case

#: sections of a case file: keys to quantities with their units
Document = dict[str, Any]


class PremiseFailsError(Exception):
    """The product itself says that a premise of one of the ways does not hold; its sentence."""


@dataclass(frozen=True)
class Comparison:
    """A number by two ways.

    Parameters
    ----------
    quantity : str
        With its unit.
    one, other : float
    allowed : float
        Largest difference that the stated errors of both allow, in the unit of the quantity.
    """

    quantity: str
    one: float
    other: float
    allowed: float

    @property
    def agrees(self) -> bool:
        """Whether both ways give the number within what they state."""
        if math.isinf(self.one) or math.isinf(self.other):
            return self.one == self.other
        return abs(self.one - self.other) <= self.allowed

    @property
    def excess(self) -> float:
        """Difference over what is allowed."""
        if self.agrees:
            return abs(self.one - self.other) / self.allowed if self.one != self.other else 0.0
        difference = abs(self.one - self.other)
        return difference / self.allowed if self.allowed > 0.0 else math.inf


@dataclass(frozen=True)
class Confrontation:
    """Two ways to the same numbers.

    Parameters
    ----------
    name : str
    ways : str
        The two, in words.
    stated : str
        Largest difference allowed, and its reason.
    weight : float
        Share of this confrontation in all drawn cases, over the sum of all weights: cheap ones have
        more.
    draw : callable
        Random generator -> sections of a case.
    compare : callable
        Sections of a case -> numbers by both ways; `PremiseFailsError` where the product says that
        one of them does not hold.
    reads : callable, optional
        Sections -> the product's own description of them, by default as a case.
    """

    name: str
    ways: str
    stated: str
    weight: float
    draw: Callable[[np.random.Generator], Document]
    compare: Callable[[Document], Sequence[Comparison]]
    reads: Callable[[Document], object] = Case.from_dict


def relative(
    quantity: str, one: float, other: float, share: float, scale: float | None = None
) -> Comparison:
    """Comparison that allows a share of a scale, by default of the second number."""
    size = abs(other) if scale is None else abs(scale)
    return Comparison(quantity, float(one), float(other), share * size)
