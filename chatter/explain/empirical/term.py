"""A table over a physical variable, written into the case, whose shape is fitted."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Values, free
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import Parameter

Array = NDArray[np.float64]

#: entries of a table a period, and typical size of a change of the force
_ENTRIES, _SIZE = 48, 0.05
#: accuracy to which a period is known at first, as a share of it
_PERIOD_SHARE = 3e-3
#: least factor of a force
_LEAST_FACTOR = 0.0


class EmpiricalTerm(Effect):
    """A term over a variable: so many shapes, each with an amplitude.

    Attributes
    ----------
    over : str
        Variable, as in a case file.
    shapes : int
        Amplitudes that are fitted.
    """

    label = "empirical term"
    help = "a term learnt from the residual; it explains nothing"
    over: str
    shapes: int

    def applies(self, measurement: Measurement) -> bool:
        """Where the case has no term over the variable."""
        return measurement.case.empirical_over(self.over) is None

    def patch(self, case: Case, values: Values) -> Patch:
        """Terms of the case, and this one beside them."""
        kept = [
            {"over": one.over, "at": list(one.at), "periodic": one.periodic,
             **({"factor": list(one.factor)} if one.factor else {"force": list(one.force)})}
            for one in case.empirical
            if one.over != self.over
        ]  # fmt: skip
        return {"empirical": [*kept, {"over": self.over, **self.table(values)}]}

    @abstractmethod
    def table(self, values: Values) -> dict[str, object]:
        """Entries of the term in a case file."""


class Harmonic(EmpiricalTerm):
    """Factor of the force in harmonics of the angle of the spindle."""

    name = "empirical_angle"
    kinds = ("milling",)
    over = "spindle angle"

    def __init__(self, orders: int) -> None:
        self.orders = orders
        self.shapes = 2 * orders

    def period(self, values: Values) -> float:  # noqa: ARG002  (that of a travel is fitted)
        """Period of the variable, SI."""
        return 2.0 * math.pi

    def parameters(self, measurement: Measurement) -> Sequence[Parameter]:  # noqa: ARG002
        """Amplitude of cosine and sine of each order; their mean is that of the coefficients."""
        names = [f"{part}_{k}" for k in range(1, self.orders + 1) for part in ("cosine", "sine")]
        return [free(name, 0.0, _SIZE, "") for name in names]

    def table(self, values: Values) -> dict[str, object]:
        """Factor over one period."""
        share = np.linspace(0.0, 1.0, _ENTRIES * self.orders + 1)
        factor = np.ones(share.size)
        for k in range(1, self.orders + 1):
            angle = 2.0 * math.pi * k * share
            factor += values[f"cosine_{k}"] * np.cos(angle) + values[f"sine_{k}"] * np.sin(angle)
        factor[-1] = factor[0]
        return {
            "at": (share * self.period(values)).tolist(),
            "factor": np.maximum(factor, _LEAST_FACTOR).tolist(),
            "periodic": True,
        }


class PeriodicTravel(Harmonic):
    """Factor of the force that repeats along the feed."""

    name = "empirical_travel"
    over = "feed distance"

    def __init__(self, orders: int, period: float) -> None:
        super().__init__(orders)
        self.first_period = period
        self.shapes += 1

    def period(self, values: Values) -> float:
        """Period along the feed, m."""
        return float(values["period"])

    def parameters(self, measurement: Measurement) -> Sequence[Parameter]:
        """Amplitudes, and the period."""
        period = self.first_period
        size = _PERIOD_SHARE * period
        bounds = {"lower": 0.9 * period, "upper": 1.1 * period}
        return [*super().parameters(measurement), free("period", period, size, "m", **bounds)]

    def nothing(self, measurement: Measurement) -> Values:
        """No amplitudes, whatever the period."""
        return {one.name: 0.0 for one in super().parameters(measurement)}


class OverSpeed(EmpiricalTerm):
    """Factor of the force as a polynomial of the logarithm of the cutting speed."""

    name = "empirical_speed"
    kinds = ("milling",)
    over = "cutting speed"

    def __init__(self, powers: int, speeds: Array) -> None:
        self.shapes = powers
        self.at = np.unique(speeds)
        self.middle = float(np.exp(np.mean(np.log(self.at))))

    def parameters(self, measurement: Measurement) -> Sequence[Parameter]:  # noqa: ARG002
        """Coefficient of each power; at the middle speed nothing changes."""
        return [free(f"power_{k}", 0.0, _SIZE, "") for k in range(1, self.shapes + 1)]

    def table(self, values: Values) -> dict[str, object]:
        """Factor from the lowest to the highest speed measured."""
        at = np.geomspace(self.at[0], self.at[-1], 25)
        ratio = np.log(at / self.middle)
        factor = 1.0 + sum(values[f"power_{k}"] * ratio**k for k in range(1, self.shapes + 1))
        return {"at": at.tolist(), "factor": np.maximum(factor, _LEAST_FACTOR).tolist()}


class AxisTable(EmpiricalTerm):
    """Force on an axis, linear between knots of its variable."""

    kinds = ("axis",)

    def __init__(self, knots: Array, force: float) -> None:
        self.knots = knots
        self.shapes = knots.size
        self.typical = force

    def parameters(self, measurement: Measurement) -> Sequence[Parameter]:  # noqa: ARG002
        """Force at each knot, N."""
        size = _SIZE * self.typical
        return [free(f"force_{k}", 0.0, size, "N") for k in range(1, self.knots.size + 1)]

    def table(self, values: Values) -> dict[str, object]:
        """Force at each knot."""
        force = [float(values[f"force_{k}"]) for k in range(1, self.knots.size + 1)]
        return {"at": self.knots.tolist(), "force": force}


class OverPosition(AxisTable):
    """Force on an axis over its position."""

    name = "empirical_position"
    over = "position"


class OverVelocity(AxisTable):
    """Force on an axis over its velocity."""

    name = "empirical_velocity"
    over = "velocity"
