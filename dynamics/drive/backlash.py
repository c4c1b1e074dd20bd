"""Backlash: a spring and its damper that act beyond a gap only.

F = k (u - s(u)) + c v outside the gap and 0 in it, where the elongation u counts from the middle
of the gap and s(u) is u limited to half the gap on either side (dead zone; Gelb and Vander Velde
1968, Multiple-Input Describing Functions, appendix B.1). The structure holds the spring as closed;
what the gap changes is a force k s(u) + c s'(u) v back on it. It is held over a step at its mean
along the motion of the step (discrete gradient; Gonzalez 1996, J. Nonlinear Sci. 6:449), so that
the energy stored beyond the gap is kept whatever the step, and the damper gives none back. On a
flank it is constant, and the step of the structure stays exact.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.leaves import leaf
from dynamics.structure.linear_structure import StructureError

#: halvings that end the search for a motion across a flank; a dozen tries are the rule
_ITERATIONS = 100
_ROUNDING = 1e-15


@dataclass(frozen=True)
class Backlash:
    """Spring and damper with a gap; about an axis read N m, rad for N, m.

    Raises
    ------
    StructureError
        If the stiffness or the gap is not above 0, or the damping below.
    """

    stiffness: float  # k of the closed contact, N/m
    damping: float  # c of the closed contact, N s/m
    gap: float  # from flank to flank, m

    def __post_init__(self) -> None:
        for what in ("stiffness", "gap"):
            value = getattr(self, what)
            if not (np.isfinite(value) and value > 0.0):
                raise StructureError(f"backlash: {what} is {value}; it must be above 0")
        if not (np.isfinite(self.damping) and self.damping >= 0.0):
            raise StructureError(f"backlash: damping is {self.damping}; it must be 0 or more")

    def elastic_force(self, elongation: ArrayLike) -> NDArray[np.float64]:
        """Force of the spring, N, at an elongation from the middle of the gap, m."""
        elongation = np.asarray(elongation, dtype=np.float64)
        half = 0.5 * self.gap
        return self.stiffness * (elongation - np.clip(elongation, -half, half))

    def describing_function(self, amplitude: float) -> float:
        """Equivalent stiffness, N/m, under an elongation A sin(w t) about the middle of the gap; m.

        k (1 - 2/pi (asin r + r sqrt(1 - r^2))), r half the gap over the amplitude; 0 within the
        gap. The damper, which follows the rate of the same u - s(u), is less by the same share.
        Gelb and Vander Velde 1968, appendix B.1, dead zone. ValueError if the amplitude is not
        above 0.
        """
        if not amplitude > 0.0:
            raise ValueError(f"amplitude must be above 0, not {amplitude}")
        share = min(0.5 * self.gap / amplitude, 1.0)
        limited = math.asin(share) + share * math.sqrt(1.0 - share * share)
        return self.stiffness * (1.0 - 2.0 / math.pi * limited)


class BacklashTable(NamedTuple):
    """Backlashes as the kernels see them; columns (n,), and m positions of their axes."""

    half: NDArray[np.float64]  # of the gap, m
    damping: NDArray[np.float64]  # N s/m
    position: NDArray[np.float64]  # of the axis from the start, ascending, m, (n, m)
    log_stiffness: NDArray[np.float64]  # logarithm of N/m at each, (n, m)
    port: NDArray[np.int64]  # its elongation
    travel: NDArray[np.int64]  # port that tells where the axis is; -1 where nothing changes
    stiffness: NDArray[np.float64]  # where the axis is now, N/m: state
    force: NDArray[np.float64]  # held over the last step, N: state


def backlash_table(
    laws: Sequence[Sequence[Backlash]],
    ports: Sequence[int],
    travel: Sequence[int],
    positions: Sequence[NDArray[np.float64]],
) -> BacklashTable:
    """Return backlashes on ports, in the middle of their gaps.

    Parameters
    ----------
    laws : sequence of sequence of Backlash
        Of each: at every position of its axis, with one gap and damping.
    ports, travel : sequence of int
        Stretch of each, and the port that tells where its axis is, or -1.
    positions : sequence of (m,) array of float
        Of each axis from the start, ascending, m; one, 0, where nothing changes.
    """
    most = max(len(one) for one in positions)
    position = np.full((len(laws), most), np.inf)
    stiffness = np.ones((len(laws), most))
    for i, (along, at) in enumerate(zip(laws, positions, strict=True)):
        position[i, : len(at)] = at
        stiffness[i, : len(at)] = [one.stiffness for one in along]
        stiffness[i, len(at) :] = along[-1].stiffness
    start = [int(np.argmin(np.abs(at))) for at in positions]
    return BacklashTable(
        half=np.array([0.5 * along[0].gap for along in laws]),
        damping=np.array([along[0].damping for along in laws]),
        position=position,
        log_stiffness=np.log(stiffness),
        port=np.array(ports, dtype=np.int64),
        travel=np.array(travel, dtype=np.int64),
        stiffness=np.array([along[at].stiffness for along, at in zip(laws, start, strict=True)]),
        force=np.zeros(len(laws)),
    )


@leaf
def stiffness_at(table, i, travel):
    """Stiffness of the closed contact, N/m, where its axis is, m; logarithms are interpolated."""
    last = table.position.shape[1] - 1
    if last == 0 or travel <= table.position[i, 0]:
        return math.exp(table.log_stiffness[i, 0])
    for k in range(last):
        low, high = table.position[i, k], table.position[i, k + 1]
        if travel < high:
            share = 0.0 if math.isinf(high) else (travel - low) / (high - low)
            below, above = table.log_stiffness[i, k], table.log_stiffness[i, k + 1]
            return math.exp(below + share * (above - below))
    return math.exp(table.log_stiffness[i, last])


@leaf
def opening_force(table, i, elongation, motion, h):
    """Mean force, N, that opens the closed spring over a motion (m) in a time h (s).

    From an elongation, m: k times the mean of the elongation limited to the gap, and c/h times the
    part of the motion within the gap.
    """
    half, end = table.half[i], elongation + motion
    first, last = min(max(elongation, -half), half), min(max(end, -half), half)
    if first == last:
        return table.stiffness[i] * first
    across = last - first
    beyond = (first - elongation) * first + (end - last) * last
    mean = (0.5 * across * (first + last) + beyond) / motion
    return table.stiffness[i] * mean + table.damping[i] / h * across


@leaf
def opening_step(table, i, elongation, free, compliance, h):
    """Opening force, N, held over a step of time h, s, solved together with the motion.

    The elongation at the beginning is in m; it moves by `free`, m, without this force, and by the
    compliance, m/N, more with each N of it.
    """
    k, half = table.stiffness[i], table.half[i]
    if abs(elongation) >= half:
        flank = half if elongation > 0.0 else -half
        end = elongation + free + compliance * k * flank
        if end * flank >= half * half:
            return k * flank
    else:
        slope = 0.5 * k + table.damping[i] / h
        left = 1.0 - compliance * slope
        if left > 0.0:
            motion = (free + compliance * k * elongation) / left
            if abs(elongation + motion) <= half:
                return k * elongation + slope * motion
    return opening_force(
        table, i, elongation, _across(table, i, elongation, free, compliance, h), h
    )


@leaf
def _across(table, i, elongation, free, compliance, h):
    """Motion d, m, with d = free + compliance F(d), where it crosses a flank.

    The force is bounded, so that the motion is too; false position with halved ends (Illinois;
    Dowell and Jarratt 1971, BIT 11:168).
    """
    most = table.half[i] * (table.stiffness[i] + 2.0 * table.damping[i] / h)
    a, b = free - compliance * most, free + compliance * most
    fa = a - free - compliance * opening_force(table, i, elongation, a, h)
    fb = b - free - compliance * opening_force(table, i, elongation, b, h)
    if fa >= 0.0:
        return a
    if fb <= 0.0:
        return b
    x = a
    for _ in range(_ITERATIONS):
        x = b - fb * (b - a) / (fb - fa)
        f = x - free - compliance * opening_force(table, i, elongation, x, h)
        if f == 0.0 or abs(b - a) <= _ROUNDING * (abs(x) + table.half[i]):
            break
        if (f > 0.0) == (fb > 0.0):
            fa *= 0.5
        else:
            a, fa = b, fb
        b, fb = x, f
    return x
