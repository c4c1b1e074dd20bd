"""Limits of stability over spindle speed: what every method returns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.units import rpm

#: bifurcations and chatter frequencies (Hz) at limits: (indices of speeds, depths)
AtLimits = Callable[[IntegerArray, Array], tuple[Sequence[str], Array]]


class LimitCurve(NamedTuple):
    """Limits of stability along depth at every spindle speed."""

    spindle_speed: Array  # rad/s (n,)
    critical_depth: Array  # m (n,), the first limit; inf where none was found
    chatter_frequency: Array  # Hz (n,), nan where none was found
    bifurcation: tuple[str, ...]  # "hopf", "flip" or "none" (n,)
    crossings: tuple[Array, ...]  # m, all: lost at even indices, regained at odd
    steps: IntegerArray  # steps per tooth period (n,), 0 where the method has none
    error: float = np.nan  # estimated, of the critical depths, relative; nan where it was not

    @property
    def spindle_speed_rpm(self) -> Array:
        """Spindle speeds (n,), revolutions per minute."""
        return rpm(self.spindle_speed)

    @property
    def critical_depth_mm(self) -> Array:
        """First limits (n,), mm; inf where none was found."""
        return 1e3 * self.critical_depth

    def at(self, index: int) -> LimitCurve:
        """Limits at one of the speeds alone."""
        one = slice(index, index + 1)
        return LimitCurve(
            self.spindle_speed[one], self.critical_depth[one], self.chatter_frequency[one],
            self.bifurcation[one], self.crossings[one], self.steps[one], self.error,
        )  # fmt: skip

    def __repr__(self) -> str:
        """How many limits there are: the arrays would fill the screen."""
        found = int(np.isfinite(self.critical_depth).sum())
        return f"<LimitCurve of {self.spindle_speed.size} speeds (rad/s), {found} limits (m)>"


def first_crossings(crossings: Sequence[Array]) -> Array:
    """First change of stability (n,) of each list, m; inf where there is none."""
    return np.array([found[0] if found.size else np.inf for found in crossings])


def limits_at(
    at_limits: AtLimits, speeds: Array, crossings: Sequence[Array], steps: IntegerArray
) -> LimitCurve:
    """First limit at every speed, with its chatter frequency and bifurcation.

    Speeds (n,) in rad/s; all changes of stability at each, m; `steps` (n,) is the resolution, as it
    is reported.
    """
    first = first_crossings(crossings)
    found = np.flatnonzero(np.isfinite(first))
    frequency, kind = np.full(len(speeds), np.nan), np.full(len(speeds), "none")
    if found.size:
        kind[found], frequency[found] = at_limits(found, first[found])
    return LimitCurve(speeds, first, frequency, tuple(kind.tolist()), tuple(crossings), steps)


def with_limits_between(curve: LimitCurve, other: LimitCurve) -> LimitCurve:
    """A curve with the limits at the speed of another, where it lies between its own speeds.

    A line between few speeds would pass beside the limit at that speed.
    """
    speeds, speed = curve.spindle_speed, other.spindle_speed
    index = int(np.searchsorted(speeds, speed[0]))
    if index in (0, speeds.size) or np.isclose(speeds, speed, rtol=1e-9).any():
        return curve
    others = np.delete(np.arange(speeds.size + 1), index)
    return joined_limits(
        np.insert(speeds, index, speed), [(others, curve), (np.array([index]), other)]
    )


def joined_limits(speeds: Array, parts: Sequence[tuple[IntegerArray, LimitCurve]]) -> LimitCurve:
    """Join curves of some of the speeds each, given by their indices."""
    if len(parts) == 1:
        return parts[0][1]
    order = np.argsort(np.concatenate([index for index, _ in parts]))
    curves = [curve for _, curve in parts]
    kinds = [kind for curve in curves for kind in curve.bifurcation]
    crossings = [found for curve in curves for found in curve.crossings]
    return LimitCurve(
        speeds,
        np.concatenate([curve.critical_depth for curve in curves])[order],
        np.concatenate([curve.chatter_frequency for curve in curves])[order],
        tuple(kinds[i] for i in order),
        tuple(crossings[i] for i in order),
        np.concatenate([curve.steps for curve in curves])[order],
        max(curve.error for curve in curves),
    )
