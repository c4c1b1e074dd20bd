"""A feed axis in time: motor and slide under a cascade of position and speed control.

Motor and slide are one mass, or two with a gap between them (backlash). Friction is a smoothed
sign, or a bristle (Canudas de Wit et al. 1995, eq. 1-4) that deflects before it slides. Runge-Kutta
4 at a fixed step; the reference moves between its samples on a straight line.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
SAMPLING = 1000.0  # Hz
FINE = 90  # steps a sample


class Axis(NamedTuple):
    """Axis as it truly is; SI. A zero switches an effect off."""

    mass: float
    viscous: float
    coulomb: float = 0.0
    smooth: float = 2e-5  # speed over which the sign of the friction changes, m/s
    above: float = 0.0  # static over Coulomb friction, N
    stribeck_velocity: float = 5e-3
    bristle_stiffness: float = 0.0
    bristle_damping: float = 0.0
    asymmetry: float = 0.0
    offset: float = 0.0
    cogging_amplitude: float = 0.0
    cogging_period: float = 0.01
    cogging_phase: float = 0.0
    backlash: float = 0.0
    motor_share: float = 0.35  # of the mass, on the motor's side of the gap
    gap_stiffness: float = 4e7
    quadratic_drag: float = 0.0
    warm_up_share: float = 0.0
    warm_up_time: float = 1.0
    warm_up_each_move: float = 0.0  # 1: cold again at the start of every move
    viscous_slope: float = 0.0  # of the viscous friction along the axis, 1/m
    pulley_amplitude: float = 0.0  # torque of a pulley out of balance, as force at 1 m/s
    pulley_circumference: float = 0.1
    cable_force: float = 0.0  # N, hysteresis in position
    cable_length: float = 5e-3
    cubic_friction: float = 0.0  # N s^3/m^3
    sticky_force: float = 0.0  # a place along the axis with more friction, N
    sticky_place: float = 0.0
    sticky_width: float = 1e-3
    position_gain: float = 160.0  # 1/s
    speed_gain: float = 150.0  # 1/s, over the mass
    integral_gain: float = 20.0  # 1/s
    mass_fed_forward: float = 0.0


@njit(cache=True, error_model="numpy")
def _resistance(a, begun, t, x, v, bristle, cable):
    """Force of the guide against the motion, and the rates of bristle and cable."""
    warm = 1.0 + a.warm_up_share * np.exp(
        -(begun * (1.0 - a.warm_up_each_move) + t) / a.warm_up_time
    )
    sign = np.tanh(v / a.smooth)
    level = a.coulomb + a.above * np.exp(-((v / a.stribeck_velocity) ** 2))
    level += a.sticky_force * np.exp(-(((x - a.sticky_place) / a.sticky_width) ** 2))
    rate = 0.0
    if a.bristle_stiffness > 0.0:
        rate = v - a.bristle_stiffness * abs(v) / level * bristle
        friction = a.bristle_stiffness * bristle + a.bristle_damping * rate
    else:
        friction = level * sign
    friction += a.asymmetry * abs(sign) + a.offset
    friction += a.viscous * warm * (1.0 + a.viscous_slope * x) * v
    friction += a.quadratic_drag * v * abs(v) + a.cubic_friction * v**3
    friction += a.cogging_amplitude * np.sin(2.0 * np.pi * x / a.cogging_period + a.cogging_phase)
    friction += a.pulley_amplitude * v * v * np.sin(2.0 * np.pi * x / a.pulley_circumference)
    drag = 0.0
    if a.cable_force > 0.0:
        drag = (v - abs(v) * cable / a.cable_force) * a.cable_force / a.cable_length
        friction += cable
    return friction, rate, drag


@njit(cache=True, error_model="numpy")
def _control(a, c, cv, ca, x, v, integral):
    """Force of the motor and the rate of the integral part."""
    wanted = a.position_gain * (c - x) + cv
    error = wanted - v
    force = a.mass * (a.speed_gain * (error + a.integral_gain * integral))
    return force + a.mass_fed_forward * a.mass * ca, error


@njit(cache=True, error_model="numpy")
def _rates(a, begun, t, s, c, cv, ca, rate):
    """State: motor x, v; slide x, v; integral; bristle; cable. Returns the motor's force."""
    force, rate[4] = _control(a, c, cv, ca, s[0], s[1], s[4])
    friction, rate[5], rate[6] = _resistance(a, begun, t, s[2], s[3], s[5], s[6])
    if a.backlash > 0.0:
        gap = s[0] - s[2]
        half = 0.5 * a.backlash
        pushed = 0.0
        motor, slide = a.motor_share * a.mass, (1.0 - a.motor_share) * a.mass
        if abs(gap) > half:
            pushed = a.gap_stiffness * (gap - half * np.sign(gap))
            pushed += 0.3 * np.sqrt(a.gap_stiffness * motor) * (s[1] - s[3])
        rate[0], rate[1] = s[1], (force - pushed) / motor
        rate[2], rate[3] = s[3], (pushed - friction) / slide
    else:
        rate[0], rate[1] = s[1], (force - friction) / a.mass
        rate[2], rate[3] = rate[0], rate[1]
    return force


@njit(cache=True, error_model="numpy")
def move(a, command, speed, acceleration, begun):
    """Position of the slide, speed of the motor and its force at the samples, (n, 3)."""
    samples = command.shape[0]
    step = 1.0 / (SAMPLING * FINE)
    s, trial = np.zeros(7), np.zeros(7)
    rate = np.zeros((4, 7))
    out = np.zeros((samples, 3))
    for n in range(samples):
        last = min(n + 1, samples - 1)
        for i in range(FINE):
            for stage in range(4):
                part = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
                f = (i + part) / FINE
                c = (1.0 - f) * command[n] + f * command[last]
                cv = (1.0 - f) * speed[n] + f * speed[last]
                ca = (1.0 - f) * acceleration[n] + f * acceleration[last]
                for k in range(7):
                    trial[k] = s[k]
                    if stage > 0:
                        trial[k] += part * step * rate[stage - 1, k]
                t = (n + f) / SAMPLING
                force = _rates(a, begun, t, trial, c, cv, ca, rate[stage])
                if i == 0 and stage == 0:
                    out[n, 0] = s[2]
                    out[n, 1] = s[1]
                    out[n, 2] = force
            for k in range(7):
                s[k] += step / 6.0 * (rate[0, k] + 2.0 * rate[1, k] + 2.0 * rate[2, k] + rate[3, k])
    return out


def resistance(axis: Axis, position: float, velocity: float, time: float = 0.0) -> float:
    """Force against a steady motion without memory, N."""
    return _resistance(axis, 0.0, time, position, velocity, 0.0, 0.0)[0]
