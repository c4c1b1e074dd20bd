"""Record of a drive: motion and the effort that went with it.

A record is along a slide (m, m/s, N) or about a shaft (rad, rad/s, N m); every function of this
package takes either, and its results are in the units of the record.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.frf.container import MeasurementError

_FEWEST = 16
#: largest deviation of a sampling interval from their mean
_UNEVEN = 0.05
#: largest distance between position and integrated velocity, of the range of position
_APART = 0.2


@dataclass(frozen=True)
class DriveRecord:
    """Evenly sampled motion and effort of one axis.

    MeasurementError if the signals are too short, of different lengths, not finite, unevenly
    sampled, or position and velocity do not belong together (units, sign).
    """

    time: NDArray[np.float64]  # (n,), s, ascending, evenly spaced within 5 %
    position: NDArray[np.float64]  # (n,), m or rad
    velocity: NDArray[np.float64]  # (n,), m/s or rad/s
    #: (n,), driving force, N, or torque, N m: positive drives towards positive positions
    effort: NDArray[np.float64]
    #: (n,), m/s^2 or rad/s^2, where it was measured; otherwise it is derived from the velocity
    acceleration: NDArray[np.float64] | None = None
    name: str = "drive record"  # of the record, for messages
    #: (n,), samples whose effort is not what moved the axis: no law is judged by them
    excluded: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        for signal in ("time", "position", "velocity", "effort", "acceleration"):
            if signal == "acceleration" and self.acceleration is None:
                continue
            values = np.array(getattr(self, signal), dtype=np.float64)
            values.flags.writeable = False
            object.__setattr__(self, signal, values)
            self._check_signal(signal, values)
        self._check_sampling()
        self._check_motion()

    def _check_signal(self, signal: str, values: NDArray[np.float64]) -> None:
        if values.ndim != 1 or len(values) != len(self.time):
            raise MeasurementError(
                f"{self.name}: {signal} has shape {values.shape}, time has {self.time.shape}; "
                "one value for each sample is needed"
            )
        if len(values) < _FEWEST:
            raise MeasurementError(
                f"{self.name}: {len(values)} samples; at least {_FEWEST} are needed"
            )
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise MeasurementError(
                f"{self.name}: {signal} is {values[bad[0]]} at sample {bad[0] + 1}"
            )

    def _check_sampling(self) -> None:
        intervals = np.diff(self.time)
        mean = self.sample_time
        if not mean > 0.0:
            raise MeasurementError(f"{self.name}: time does not ascend")
        worst = int(np.argmax(np.abs(intervals - mean)))
        if abs(intervals[worst] - mean) > _UNEVEN * mean:
            raise MeasurementError(
                f"{self.name}: samples {worst + 1} and {worst + 2} are {intervals[worst]:g} s "
                f"apart, on average they are {mean:g} s; even sampling is needed"
            )

    def _check_motion(self) -> None:
        reach = float(np.ptp(self.position))
        if not reach > 0.0:
            raise MeasurementError(f"{self.name}: the axis does not move")
        steps = 0.5 * (self.velocity[1:] + self.velocity[:-1]) * np.diff(self.time)
        gap = self.position[1:] - self.position[0] - np.cumsum(steps)
        if np.ptp(gap) > _APART * reach:
            raise MeasurementError(
                f"{self.name}: position and integrated velocity drift apart by {np.ptp(gap):g} "
                f"over a range of {reach:g}; check their units and signs"
            )

    @property
    def sample_time(self) -> float:
        """Mean sampling interval, s."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    def part(self, start: float, end: float) -> DriveRecord:
        """Samples from start to end, s, both included, as a record of its own.

        Raises MeasurementError if too few samples lie there.
        """
        kept = (self.time >= start) & (self.time <= end)
        if np.count_nonzero(kept) < _FEWEST:
            raise MeasurementError(
                f"{self.name}: {np.count_nonzero(kept)} samples between {start:g} and {end:g} s; "
                f"at least {_FEWEST} are needed"
            )
        acceleration = None if self.acceleration is None else self.acceleration[kept]
        return DriveRecord(
            self.time[kept],
            self.position[kept],
            self.velocity[kept],
            self.effort[kept],
            acceleration,
            f"{self.name} from {start:g} to {end:g} s",
            None if self.excluded is None else self.excluded[kept],
        )

    def near_excluded(self, reach: float) -> NDArray[np.bool_]:
        """Samples (n,) within a time, s, of one that is left out."""
        if self.excluded is None:
            return np.zeros(len(self.time), dtype=np.bool_)
        return self.near(self.excluded, reach)

    def near(self, marked: NDArray[np.bool_], reach: float) -> NDArray[np.bool_]:
        """Samples (n,) within a time, s, of one that is marked (n,)."""
        samples = int(np.ceil(reach / self.sample_time))
        count = np.convolve(marked, np.ones(2 * samples + 1), mode="full")
        return count[samples : samples + len(marked)] > 0.5


def record_from_current(
    time: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike,
    current: ArrayLike,
    *,
    torque_constant: float,
    transmission: float = 1.0,
    name: str = "drive record",
) -> DriveRecord:
    """Return a record whose effort comes from the motor current.

    Signals (n,): time, s, motion in the unit of the result, and the torque-producing component of
    the current, A. Effort, N or N m, = torque constant, N m/A, above 0, x current x transmission:
    the turn of the motor for a unit of position, 2 pi / pitch in rad/m for the force at a slide
    behind a screw, 1 for the torque about the motor shaft itself; negative where the motor turns
    backward. MeasurementError if the signals do not make a record, ValueError if a constant is out
    of its range.

    As the modelling of the test machine with drive control and friction does, section 2.3. Losses
    of the transmission stay in the friction found.
    """
    if not 0.0 < torque_constant < math.inf:
        raise ValueError(f"{name}: torque_constant must be above 0 N m/A, not {torque_constant}")
    if not (math.isfinite(transmission) and transmission != 0.0):
        raise ValueError(f"{name}: transmission must be finite and not 0, not {transmission}")
    effort = torque_constant * transmission * np.asarray(current, dtype=np.float64)
    return DriveRecord(
        np.asarray(time), np.asarray(position), np.asarray(velocity), effort, name=name
    )
