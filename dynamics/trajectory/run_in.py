"""Run-in and run-out of a trajectory that begins or ends at speed, such as a circle at its feed."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from dynamics.trajectory.jerk_limited import JerkLimitedMove, speed_change_length
from dynamics.trajectory.motion import Motion, Trajectory, require_positive


@dataclass(frozen=True)
class WithRunIn:
    """A trajectory with straight, jerk-limited lines to its start and from its end.

    They go along the velocity there, from rest and to rest, and last the same time where the
    trajectory ends as fast as it begins.

    Raises
    ------
    TrajectoryError
        If acceleration or jerk is not above 0, or the trajectory begins or ends at rest.
    """

    trajectory: Trajectory
    acceleration: float  # limit along the lines, m/s^2
    jerk: float  # m/s^3

    def __post_init__(self):
        for key in ("acceleration", "jerk"):
            require_positive("run-in", key, getattr(self, key))
        for motion in self._ends:
            require_positive("run-in", "speed", float(np.linalg.norm(motion.velocity)))

    @cached_property
    def _ends(self) -> tuple[Motion, Motion]:
        inner = self.trajectory
        return inner.at(0.0), inner.at(inner.duration)

    @cached_property
    def _lines(self) -> tuple[JerkLimitedMove, JerkLimitedMove]:
        """Lines from rest to rest whose middles, at their velocity, are start and end."""
        lines = []
        for motion in self._ends:
            speed = float(np.linalg.norm(motion.velocity))
            length = speed_change_length(0.0, speed, self.acceleration, self.jerk)
            way = length / speed * motion.velocity
            first, last = motion.position - way, motion.position + way
            lines.append(JerkLimitedMove(first, last, speed, self.acceleration, self.jerk))
        return lines[0], lines[1]

    @property
    def part(self) -> tuple[float, float]:
        """Times at which the trajectory itself begins and ends, s."""
        lead = 0.5 * self._lines[0].duration
        return lead, lead + self.trajectory.duration

    @property
    def duration(self) -> float:
        """From start to end, s."""
        return self.part[1] + 0.5 * self._lines[1].duration

    def at(self, time: ArrayLike) -> Motion:
        """Return position, velocity and acceleration of all axes at times, s."""
        time = np.asarray(time, dtype=np.float64)
        begin, end = self.part
        into, out = self._lines
        before = into.at(np.minimum(time, begin))
        within = self.trajectory.at(np.clip(time - begin, 0.0, end - begin))
        after = out.at(0.5 * out.duration + np.maximum(time - end, 0.0))
        early, late = (time < begin)[..., None], (time > end)[..., None]
        return Motion(
            *(
                np.where(early, one, np.where(late, other, between))
                for one, between, other in zip(before, within, after, strict=True)
            )
        )
