"""Turning with linear process damping: exact limits and growth by the characteristic equation.

m x'' + (c + Ci b/V) x' + k x = -Kf b (x(t) - x(t - T)), V the cutting speed and T the time of a
revolution. Everything is constant, so that exp(s t) solves it where

    m s^2 + (c + Ci b/V) s + k + Kf b (1 - exp(-s T)) = 0
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import lambertw

from .collocation import PeriodicDelayEquation, constant
from .frequency_domain import FrequencyLimit


@dataclass(frozen=True)
class TurningCase:
    """One mode in turning, SI; `process_damping` is Ci in N/m at the given diameter."""

    mass: float
    damping: float
    stiffness: float
    coefficient: float
    rpm: float
    process_damping: float = 0.0
    diameter: float = math.inf

    @property
    def delay(self):
        """Time of a revolution, s."""
        return 60.0 / self.rpm

    @property
    def process_damping_per_depth(self):
        """Ci/V, N s/m per m of depth."""
        return self.process_damping / (math.pi * self.diameter / self.delay)

    @property
    def lowest_limit(self):
        """Lowest limit over all speeds without process damping, m: 2 k zeta (1 + zeta)/Kf."""
        zeta = self.damping / (2.0 * math.sqrt(self.stiffness * self.mass))
        return 2.0 * self.stiffness * zeta * (1.0 + zeta) / self.coefficient


def limits(case, highest_factor=6.0, points=40000):
    """Return every FrequencyLimit, the lowest first.

    Real and imaginary part at s = i omega: Kf b (1 - cos) = m omega^2 - k and
    omega (c + b Ci/V) + Kf b sin = 0; b from the first makes the second an equation for omega.
    """
    natural = math.sqrt(case.stiffness / case.mass)

    def depth(omega):
        excess = case.mass * omega**2 - case.stiffness
        return excess / (case.coefficient * (1.0 - np.cos(omega * case.delay)))

    def balance(omega):
        excess = case.mass * omega**2 - case.stiffness
        phase = omega * case.delay
        cutting = omega * case.process_damping_per_depth + case.coefficient * np.sin(phase)
        own = omega * case.damping * case.coefficient * (1.0 - np.cos(phase))
        return (own + excess * cutting) / (case.stiffness * case.coefficient)

    grid = np.linspace(natural, highest_factor * natural, points)
    found = []
    for i in np.flatnonzero(np.diff(np.signbit(balance(grid)))):
        omega = brentq(balance, grid[i], grid[i + 1], xtol=1e-12 * natural, rtol=1e-15)
        # 1 - cos = 0 fulfils the equation at any depth
        if 1.0 - math.cos(omega * case.delay) > 1e-9:
            found.append(FrequencyLimit(float(depth(omega)), omega / (2.0 * math.pi)))
    return sorted(limit for limit in found if limit.depth > 0.0)


def delay_equation(case, depth):
    """Return the problem in time as a PeriodicDelayEquation with the state (omega x, x')."""
    natural = math.sqrt(case.stiffness / case.mass)
    cutting = case.coefficient * depth
    damping = case.damping + case.process_damping_per_depth * depth
    rate = -(case.stiffness + cutting) / (case.mass * natural)
    return PeriodicDelayEquation(
        constant([[0.0, natural], [rate, -damping / case.mass]]),
        constant([[0.0], [cutting / (case.mass * natural)]]),
        np.array([[1.0, 0.0]]),
        period=case.delay,
        delay=case.delay,
    )


def growth(case, depth):
    """Return |mu| over a revolution from the rightmost root, found by Newton from a mesh."""
    natural = math.sqrt(case.stiffness / case.mass)
    linear = case.damping + case.process_damping_per_depth * depth
    cutting = case.coefficient * depth

    def residual(s):
        return (
            case.mass * s**2 + linear * s + case.stiffness + cutting * (1.0 - np.exp(-s * case.delay))
        )

    def slope(s):
        return 2.0 * case.mass * s + linear + cutting * case.delay * np.exp(-s * case.delay)

    reach = 3.0 / case.delay
    across = max(200, math.ceil(8.0 * natural * case.delay))
    real, imaginary = np.meshgrid(
        np.linspace(-reach, reach, 25), np.linspace(0.0, 4.0 * natural, across)
    )
    s = (real + 1j * imaginary).ravel()
    with np.errstate(all="ignore"):
        for _ in range(60):
            s = s - residual(s) / slope(s)
        roots = s[np.abs(residual(s)) < 1e-9 * case.stiffness]
    return math.exp(roots.real.max() * case.delay)


def hayes_growth(a, b):
    """Return |mu| over a unit delay of x' = a x + b x(t - 1), exactly: s = a + W_0(b exp(-a))."""
    return math.exp(a + lambertw(b * math.exp(-a)).real)
