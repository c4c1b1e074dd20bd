"""A cut that was found, with what it uses of every limit."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from chatter.description.unit_system import METRIC, UnitSystem
from chatter.description.units import rpm
from chatter.stability.model import MillingModel
from chatter.studies.optimisation.limits import Limits
from chatter.studies.optimisation.operating_point import (
    OperatingPoint,
    model_with,
    rounded,
    step_of_depths,
)
from chatter.studies.optimisation.speed_depth_slice import (
    STABILITY,
    SpeedDepthSlice,
    evaluated_slice,
)

#: what is taken off the depth, a share of it and how often, where a limit is missed in time
EASING, EASINGS = 0.03, 6
#: named as what limits a cut that was made less deep so
TIME_DOMAIN = "time domain"
#: a limit is active if it would not be held at a depth larger by this share
DEEPER = 0.02
#: multiples of the depth up to which the end of stability is looked for
_DEEPER_STILL = np.linspace(1.1, 3.0, 20)
#: a range is exhausted within this share of its end
_AT_END = 1e-3
#: what rounding may have to give back, a share of the depth a time
_GIVEN_BACK, _MOST_TIMES = 1e-3, 20


@dataclass(frozen=True)
class Probability:
    """Probability that a cut is what it must be, of samples of the uncertain values."""

    stable: float  # that it is stable
    value: float  # that it is stable and keeps all limits of [optimum]
    interval: tuple[float, float]  # 95 % confidence of `value`, from the number of samples
    #: key of [optimum] -> what the stable samples do not exceed with the confidence, SI
    quantiles: dict[str, float]


@dataclass(frozen=True)
class Verification:
    """The same cut simulated in the time domain."""

    verdict: str
    power: float  # SI; nan where the run shows none
    torque: float  # SI; nan where the run shows none
    deflection: float  # SI; nan where the run shows none
    surface_error: float  # SI; nan where the run shows none
    verified: bool  # stable, and every limit held within the tolerance of the comparison


@dataclass(frozen=True, repr=False)
class Candidate:
    """A cut that keeps all limits, SI."""

    point: OperatingPoint
    power: float  # of the steady cut
    torque: float  # of the steady cut
    deflection: float  # of the steady cut
    surface_error: float  # of the steady cut
    #: at which stability ends above it, at its own speed; inf where that was not found
    critical_depth: float
    #: share of every limit that is used, the depth that the margins leave among them; nan where
    #: that is not known
    usage: dict[str, float]
    #: limits that would not be held at a depth 2 % larger, and ends of ranges
    active: tuple[str, ...]
    probability: Probability | None = None  # None where nothing is uncertain
    verification: Verification | None = None  # None where it was not simulated
    units: UnitSystem = METRIC  # of the case, that it is written in; no part of its record

    def __repr__(self) -> str:
        """The cut, in units of the shop: what it uses of each limit would fill the screen."""
        speed, *lengths = self.point[:4]
        depth, width, feed = (self.units.length.text(length) for length in lengths)
        rate = self.units.instead_of("cm³/min")
        return (
            f"<Candidate {rpm(speed):.6g} rpm, {depth} deep, {width} wide, {feed} a tooth, "
            f"{6e7 * self.removal_rate * rate.factor:.4g} {rate.name}>"
        )

    @property
    def removal_rate(self) -> float:
        """Volume removed per time, m^3/s."""
        return self.point.removal_rate

    def record(self) -> dict[str, Any]:
        """Record of the result cache."""
        values = asdict(self)
        del values["units"]
        return values

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Candidate:
        """Read what `record` returned."""
        return TypeAdapter(cls).validate_python(record)


def max_usage(candidate: Candidate) -> float:
    """Largest share of a limit that a candidate uses, of those that are known."""
    return max((value for value in candidate.usage.values() if not math.isnan(value)), default=0.0)


def candidate_at(model: MillingModel, limits: Limits, point: OperatingPoint) -> Candidate:
    """Candidate at a point, in round numbers; a little less deep where rounding needs it."""
    exact, step = point, step_of_depths(model.case)
    for _ in range(_MOST_TIMES):
        point = rounded(exact, step)
        here = model_with(model, point.radial_depth, point.feed_per_tooth)
        grid_slice = _slice_at(here, limits, point)
        if grid_slice.feasible[0, 0]:
            break
        exact = exact._replace(axial_depth=exact.axial_depth * (1.0 - _GIVEN_BACK))
    rate = float(grid_slice.removal_rate[0, 0])
    return _read(grid_slice, limits, point._replace(removal_rate=rate))


def _slice_at(here: MillingModel, limits: Limits, point: OperatingPoint) -> SpeedDepthSlice:
    """Slice of the cut itself, of one a little deeper, and of deeper ones to find its limit."""
    speeds = np.array([point.spindle_speed])
    depths = point.axial_depth * np.array([1.0, 1.0 + DEEPER, *_DEEPER_STILL])
    return evaluated_slice(here, limits, speeds, depths, limits.evaluation_speeds(speeds))


def _read(grid_slice: SpeedDepthSlice, limits: Limits, point: OperatingPoint) -> Candidate:
    depth, speed = point.axial_depth, point.spindle_speed
    kept = _end_above(
        grid_slice.stable.within(speed, limits.depth_margin, limits.speed_margin), depth
    )
    end = _end_above(grid_slice.stable.within(speed, 0.0, 0.0), depth)
    usage = {STABILITY: depth / kept if kept < grid_slice.stable.max_depth else math.nan}
    usage |= {key: float(values[0, 0]) for key, values in grid_slice.usage.items()}
    active = [key for key, held in grid_slice.satisfied.items() if not held[1, 0]]
    return Candidate(
        point=point,
        power=float(grid_slice.cuts.power[0, 0]),
        torque=float(grid_slice.cuts.torque[0, 0]),
        deflection=float(grid_slice.cuts.deflection[0, 0]),
        surface_error=float(grid_slice.cuts.surface_error[0, 0]),
        critical_depth=end if end < grid_slice.stable.max_depth else math.inf,
        usage=usage,
        active=(*active, *_ends_of_ranges(limits, point)),
    )


def _end_above(intervals: np.ndarray, depth: float) -> float:
    above = intervals[intervals[:, 1] >= depth * (1.0 - 1e-9), 1]
    return float(above.min()) if above.size else math.nan


def _ends_of_ranges(limits: Limits, point: OperatingPoint) -> list[str]:
    """Ranges whose end keeps a point from more."""
    ranges = (
        ("speeds.to", point.spindle_speed, limits.speeds),
        ("depths.to", point.axial_depth, limits.depths),
        ("radial_depths.to", point.radial_depth, limits.radial_depths),
        ("feeds.to", point.feed_per_tooth, limits.feeds),
    )
    return [
        name
        for name, value, grid in ranges
        if grid.size > 1 and value >= grid[-1] * (1.0 - _AT_END)
    ]
