"""Set points at the interpolation cycle, as the position controllers read them."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from dynamics.compiled import INLINED
from dynamics.trajectory.motion import Trajectory, TrajectoryError, require_positive

#: of a cycle over the step, from a whole number
_WHOLE = 1e-6


class SetPoints(NamedTuple):
    """Rows are cycles; held from one to the next, and at rest behind the last."""

    position: NDArray[np.float64]  # m (rad), (n, axes)
    velocity: NDArray[np.float64]  # m/s, (n, axes)
    acceleration: NDArray[np.float64]  # m/s^2, (n, axes)
    steps: int  # of the simulation per cycle


def interpolation_cycle(sample_times: Iterable[float], step: float) -> float:
    """Longest cycle, s, of which the samples of all position loops are multiples; a step without.

    Each loop then has a set point of its own at every sample; a longer one holds it over several
    samples of the fast loops, which lag behind by half of that.
    """
    return step * (math.gcd(*(round(time / step) for time in sample_times)) or 1)


def set_points(
    trajectory: Trajectory, cycle: float, step: float, standstill: float = 0.0
) -> SetPoints:
    """Return the set points of a trajectory at each interpolation cycle.

    Parameters
    ----------
    trajectory : Trajectory
        Velocity and acceleration are its derivatives, not differences of positions.
    cycle, step : float
        Interpolation cycle and step of the simulation, s.
    standstill : float
        Time before the trajectory starts, s; rounded up to whole cycles.

    Raises
    ------
    TrajectoryError
        If the cycle is no whole multiple of the step.
    """
    require_positive("set points", "interpolation cycle", cycle)
    require_positive("set points", "simulation step", step)
    steps = round(cycle / step)
    if steps < 1 or abs(cycle / step - steps) > _WHOLE * steps:
        raise TrajectoryError(
            f"set points: interpolation cycle {cycle:g} s is not a whole multiple of the "
            f"simulation step {step:g} s"
        )
    if not (math.isfinite(standstill) and standstill >= 0.0):
        raise TrajectoryError(f"set points: standstill is {standstill}; a time >= 0, s, is needed")
    # a duration that is a whole number of cycles but for rounding needs no cycle more
    waiting, moving = (
        math.ceil(time / cycle - _WHOLE) for time in (standstill, trajectory.duration)
    )
    motion = trajectory.at(cycle * np.arange(-waiting, moving + 1))
    position, velocity, acceleration = (np.ascontiguousarray(column) for column in motion)
    return SetPoints(position, velocity, acceleration, steps)


@register_jitable(**INLINED)
def set_point_at(points, axis, step_number):
    """Position, m, velocity, m/s, and acceleration, m/s^2, of an axis at a step from 0."""
    row = step_number // points.steps
    last = points.position.shape[0] - 1
    if row > last:
        return points.position[last, axis], 0.0, 0.0
    return points.position[row, axis], points.velocity[row, axis], points.acceleration[row, axis]
