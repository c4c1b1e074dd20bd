"""Pulses of torque released at an angle of the spindle.

Excites a drive while the machine cuts, each time the tool tip points in the same direction.
Source: the impulse torque command of "Time Domain Coupled Simulation of Machine Tool Dynamics and
Cutting Forces considering the Influences of Nonlinear Friction Characteristics and Process
Damping", Figures 5 to 7.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.frf.excitation.signal import ExcitationError, PulseTrain, pulses_at, require_positive

_TURN = 2.0 * np.pi
#: of an angle from a passage that rounding alone keeps short of it, rad
_ROUNDING = 1e-9


def angle_at_constant_speed(
    speed: float, samples: int, step: float, start: float = 0.0
) -> NDArray[np.float64]:
    """Return the angle of a spindle at a speed, rad/s, at each step, s, from a start; rad."""
    require_positive("spindle angle", "step", step)
    if not math.isfinite(speed) or speed == 0.0:
        raise ExcitationError(f"spindle angle: speed is {speed}; a finite speed, not 0, rad/s")
    return start + speed * step * np.arange(samples)


def passages(angle: ArrayLike, at: float) -> NDArray[np.int64]:
    """Return the samples at which a spindle has come to an angle: the first at or behind it.

    Angles (n,), rad, run on, or start again at every turn as an encoder has it, by less than half a
    turn a sample; `at`, rad, is of any turn. Turning back and forth over it counts once a turn.
    ExcitationError if the angles are no finite column or never come past the angle.
    """
    angle = np.asarray(angle, dtype=np.float64)
    if angle.ndim != 1 or angle.size < 2 or not np.isfinite(angle).all():
        raise ExcitationError("spindle angle: at least two finite samples in one column are needed")
    running = np.unwrap(angle)
    forward = running if running[-1] >= running[0] else -running
    target = at if running[-1] >= running[0] else -at
    turns = np.floor((forward - target + _ROUNDING) / _TURN)
    # where the spindle swings back, it must come to a new turn to count again
    furthest = np.maximum.accumulate(turns)
    found = np.flatnonzero(np.diff(furthest) > 0.0) + 1
    if abs((forward[0] - target + 0.5 * _TURN) % _TURN - 0.5 * _TURN) <= _ROUNDING:
        found = np.concatenate([[0], found])
    if found.size == 0:
        raise ExcitationError(
            f"spindle angle: it runs from {running[0]:g} to {running[-1]:g} rad and never comes to "
            f"{at:g} rad"
        )
    return found.astype(np.int64)


def angle_triggered_pulses(
    angle: ArrayLike, at: float, pulse: NDArray[np.float64], step: float, revolutions: int = 1
) -> PulseTrain:
    """Return a pulse of torque each time a spindle comes to an angle.

    Over the n samples of the angles, rad, as for `passages`; the pulse (m,), N m, is from
    `dynamics.frf.excitation.hammer`; the step is in s. A passage too late for a whole pulse gets
    none. From a pulse to the next go several revolutions, so that the vibration dies away between
    them. ExcitationError if no pulse finds its place or pulses overlap.
    """
    if revolutions < 1:
        raise ExcitationError(f"angle-triggered pulses: every {revolutions} revolutions; 1 or more")
    samples = np.size(angle)
    starts = passages(angle, at)[::revolutions]
    starts = starts[starts + len(pulse) <= samples]
    if starts.size == 0:
        raise ExcitationError(
            f"angle-triggered pulses: the spindle comes to {at:g} rad too late for a pulse of "
            f"{len(pulse)} samples to end within {samples}"
        )
    return pulses_at(starts, [pulse] * starts.size, samples, step)
