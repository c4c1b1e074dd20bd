"""Drive records simulated from published parameters with numerics of their own."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from dynamics.friction.identification.record import DriveRecord


def back_and_forth(speeds, acceleration, dwell, step):
    """Moves to and fro with sine-shaped acceleration: time, position, velocity, acceleration."""
    pieces = []
    for speed in speeds:
        rise = math.pi / 2 * speed / acceleration
        t = np.arange(0.0, rise, step)
        ramp = acceleration * np.sin(math.pi * t / rise)
        hold = np.zeros(round(dwell / step))
        one = np.concatenate((ramp, hold, -ramp))
        pieces += [one, hold[: len(hold) // 4], -one, hold[: len(hold) // 4]]
    a = np.concatenate(pieces)
    v = np.concatenate(([0.0], np.cumsum(0.5 * (a[1:] + a[:-1])) * step))
    x = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1])) * step))
    return step * np.arange(len(a)), x, v, a


def sine_motion(amplitude, peak_speed, cycles, step):
    """Sine that starts at a turning point: time, position, velocity, acceleration."""
    omega = peak_speed / amplitude
    t = np.arange(0.0, cycles * 2.0 * math.pi / omega, step)
    turn = omega * t
    return (
        t,
        -amplitude * np.cos(turn),
        amplitude * omega * np.sin(turn),
        amplitude * omega**2 * np.cos(turn),
    )


def lugre_friction(law, amplitude, peak_speed, time):
    """LuGre friction of `sine_motion` by a stiff integrator, N."""
    omega = peak_speed / amplitude

    def slip(v):
        s = abs(v)
        g = law.coulomb + (law.static - law.coulomb) * math.exp(
            -((s / law.stribeck_velocity) ** law.stribeck_shape)
        )
        g += law.logarithmic * math.log1p(s / law.logarithmic_velocity)
        return g / law.bristle_stiffness

    def rate(t, z):
        v = amplitude * omega * math.sin(omega * t)
        return [v - abs(v) / slip(v) * z[0]]

    z = solve_ivp(
        rate, (0.0, time[-1]), [0.0], method="LSODA", t_eval=time, rtol=1e-8, atol=1e-13
    ).y[0]
    v = amplitude * omega * np.sin(omega * time)
    g = np.array([slip(s) for s in v])
    bend = v - np.abs(v) / g * z
    return law.bristle_stiffness * z + law.bristle_damping * bend + law.viscous * v


def noisy(time, position, velocity, effort, rng, *, effort_noise, velocity_noise, name="made up"):
    return DriveRecord(
        time,
        position,
        velocity + velocity_noise * rng.standard_normal(len(time)),
        effort + effort_noise * rng.standard_normal(len(time)),
        name=name,
    )
