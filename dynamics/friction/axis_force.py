"""Force that moves an axis: inertia, friction in its forms, cogging, a load.

The axis is a mass on its guide; the force is that of the motor, referred to the slide.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.identification.dynamic_fit import friction_along
from dynamics.friction.lugre import LuGre

#: speed within which a direction is not one, m/s: sliding friction passes through zero there
SMOOTH = 2e-5
#: change of a velocity over a sample, over the smoothing, below which the direction is a constant
_STEADY = 1e-3
#: bristle damping where only the stiffness is known, as a damping ratio of the mass on it
_BRISTLE_DAMPING = 0.3


@dataclass(frozen=True)
class AxisForce:
    """Parameters of the force of an axis."""

    mass: float  # kg
    viscous: float = 0.0  # N s/m
    coulomb: float = 0.0  # N
    static: float | None = None  # friction at the onset of motion, N; with `stribeck_velocity`
    stribeck_velocity: float = 0.01  # m/s
    presliding_stiffness: float | None = None  # of the contact before it slides, N/m
    presliding_damping: float | None = None  # of the same, N s/m
    asymmetry: float = 0.0  # Coulomb friction forwards above the mean of both directions, N
    offset: float = 0.0  # constant force held, N
    quadratic_drag: float = 0.0  # N s^2/m^2
    cogging_amplitude: float = 0.0  # N
    cogging_period: float = 0.01  # m
    cogging_phase: float = 0.0  # rad
    backlash: float = 0.0  # way of the motor in which it does not drive the slide, m
    motor_mass: float = 0.0  # part of the mass on the motor's side of the backlash, kg
    warm_up_share: float = 0.0  # of the viscous friction at the start that decays
    warm_up_time: float = 1.0  # constant of the decay, s

    def along(
        self,
        position: NDArray[np.float64],
        velocity: NDArray[np.float64],
        acceleration: NDArray[np.float64],
        step: float,
        begun: float = 0.0,
        motor_acceleration: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Force (n,), N, along a motion: position, velocity, acceleration (n,), m, m/s, m/s^2.

        The step between samples is in s; `begun` is the time that the axis had moved before, s, for
        the warm-up. The motor's acceleration (n,), m/s^2, is given where its own motion is known:
        the motion is then that of the slide, and what drives it through the backlash follows from
        it; else it is the motor's.
        """
        time = begun + step * np.arange(position.size)
        warm = 1.0 + self.warm_up_share * np.exp(-time / self.warm_up_time)
        force = self.mass * acceleration + self.viscous * warm * velocity
        force = force + self.offset + self.quadratic_drag * velocity * np.abs(velocity)
        turn = 2.0 * math.pi / self.cogging_period
        force = force + self.cogging_amplitude * np.sin(turn * position + self.cogging_phase)
        friction = self.dry_friction(position, velocity, step)
        if motor_acceleration is not None:
            return force + friction + self.motor_mass * (motor_acceleration - acceleration)
        if self.backlash > 0.0:
            driven = drives_slide(position, self.backlash)
            return np.where(driven, force + friction, 0.0)
        return force + friction

    def dry_friction(
        self, position: NDArray[np.float64], velocity: NDArray[np.float64], step: float
    ) -> NDArray[np.float64]:
        """Coulomb friction with its onset, its presliding and its asymmetry, N."""
        direction = direction_of(velocity)
        static = self.coulomb if self.static is None else self.static
        if self.presliding_stiffness is None or self.coulomb <= 0.0:
            law = CoulombStribeck(self.coulomb, static, self.stribeck_velocity)
            sliding = law.steady_state_force(np.abs(velocity))
            return (sliding + self.asymmetry * direction) * direction
        damping = self.presliding_damping
        if damping is None:
            damping = 2.0 * _BRISTLE_DAMPING * math.sqrt(self.mass * self.presliding_stiffness)
        law = LuGre(
            bristle_stiffness=self.presliding_stiffness,
            bristle_damping=damping,
            viscous=0.0,
            coulomb=self.coulomb,
            static=max(static, self.coulomb),
            stribeck_velocity=self.stribeck_velocity,
        )
        return friction_along(law, position, step) + self.asymmetry * direction * direction


def direction_of(velocity: NDArray[np.float64]) -> NDArray[np.float64]:
    """Direction (n,), from -1 to 1, of a velocity (n,), m/s: mean over the time of each sample.

    The velocity runs on a straight line from the middle between a sample and the one before it to
    the middle after it. A reversal between two samples so shows when it was.
    """
    middle = 0.5 * (velocity[1:] + velocity[:-1])
    ends = np.concatenate((velocity[:1], middle, velocity[-1:])) / SMOOTH
    change = np.diff(ends)
    magnitude = np.abs(ends)
    # logarithm of the hyperbolic cosine, the integral of the tangent
    integral = magnitude + np.log1p(np.exp(-2.0 * magnitude))
    steady = np.abs(change) < _STEADY
    mean = np.diff(integral) / np.where(steady, 1.0, change)
    return np.where(steady, np.tanh(velocity / SMOOTH), mean)


def drives_slide(position: NDArray[np.float64], backlash: float) -> NDArray[np.bool_]:
    """Samples (n,) at which a motor with backlash is in touch with the slide.

    The slide follows as in play: it stays where it is until the motor has crossed the gap.
    """
    slide = np.empty_like(position)
    at, half = position[0], 0.5 * backlash
    touching = np.empty(position.size, dtype=bool)
    for i, x in enumerate(position):
        moved = min(max(at, x - half), x + half)
        touching[i] = abs(abs(x - moved) - half) < 1e-12
        slide[i] = at = moved
    return touching
