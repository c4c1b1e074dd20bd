"""Milling as a periodic delay equation, and its multipliers over a tooth period.

Conventions: x feed, y normal, z tool axis; phi is clockwise from +y and the first tooth is at +y
when the spindle angle is zero; a point at height z lags by z tan(helix)/R. With u the displacement
of the tool relative to the workpiece and d = u(t) - u(t - tooth period)

    h  = dx sin(phi) + dy cos(phi)               r' = ux' sin(phi) + uy' cos(phi)
    Ft = Ktc b h + friction C (b/V) r'           V  = pi D n
    Fr = Krc b h +          C (b/V) r'           Fa = Kac b h
    Fx = -Ft cos(phi) - Fr sin(phi)   Fy = Ft sin(phi) - Fr cos(phi)   Fz = Fa

are the forces on the tool. The edge stands at 90 degrees of axial immersion, so that z neither
makes the chip thicker nor is it delayed, and the axial force pushes the tool along +z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from . import collocation

#: exact to rounding for the sines of half a turn
_GAUSS_NODES, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(16)
#: longest interval as an angle of the spindle, rad, however slow the structure is
_LONGEST_ANGLE = 1.0


class Mode(NamedTuple):
    """A real mode: Hz, damping ratio, modal mass in kg along the unit vector `direction`."""

    frequency: float
    damping: float
    mass: float
    direction: tuple[float, float, float]
    side: str = "tool"

    @property
    def angular(self):
        """Angular natural frequency, rad/s."""
        return 2.0 * math.pi * self.frequency

    @property
    def shape(self):
        """Mass-normalised direction of the relative motion (3,).

        A mode of the workpiece is pushed by the opposite force and moves the workpiece away, which
        together change nothing.
        """
        sign = {"tool": 1.0, "workpiece": -1.0}[self.side]
        return sign * np.array(self.direction) / math.sqrt(self.mass)


@dataclass(frozen=True)
class MillingCase:
    """A linear milling problem, SI.

    `entry` and `exit` bound the cut, `coefficients` are Ktc, Krc, Kac, `modes` are of type Mode or
    plain tuples in its order, `speed` is that of the spindle in rad/s, `depth` the axial depth.
    """

    teeth: int
    diameter: float
    helix: float
    entry: float
    exit: float
    coefficients: tuple[float, float, float]
    modes: tuple[Mode, ...]
    speed: float
    depth: float
    process_damping: float = 0.0
    friction: float = 0.0

    @property
    def pitch(self):
        """Angle between teeth, rad."""
        return 2.0 * math.pi / self.teeth

    @property
    def tooth_period(self):
        """Time between teeth, s."""
        return self.pitch / self.speed

    @property
    def lag_per_height(self):
        """Angle by which the edge lags for each metre of height."""
        return math.tan(self.helix) / (0.5 * self.diameter)


def engagement(mode, radial_depth, diameter):
    """Return entry and exit angle of an "up", "down" or "slot" cut."""
    if mode == "slot":
        return 0.0, math.pi
    arc = math.acos(1.0 - radial_depth / (0.5 * diameter))
    return (0.0, arc) if mode == "up" else (math.pi - arc, math.pi)


def _force_per_motion(phi, tangential, radial, axial):
    """Force on the tool for unit motion of the tooth, (..., 3, 3), at angles phi (...)."""
    s, c = np.sin(phi), np.cos(phi)
    force = np.stack(
        [-tangential * c - radial * s, tangential * s - radial * c, axial * np.ones_like(s)], -1
    )
    thickness = np.stack([s, c, np.zeros_like(s)], -1)
    return force[..., :, None] * thickness[..., None, :]


def edge_integral(case, spindle_angles, coefficients):
    """Integrate the force for unit motion along the engaged edges, (k, 3, 3) at (k,) angles."""
    total = np.zeros((len(spindle_angles), 3, 3))
    lag = case.lag_per_height
    if lag < 0.0:
        raise ValueError("the reference takes no left-hand helix")
    turns = math.ceil((case.exit + lag * case.depth) / (2.0 * math.pi))
    for tooth in range(case.teeth):
        tip = np.mod(spindle_angles + tooth * case.pitch, 2.0 * math.pi)
        if lag == 0.0:
            engaged = (case.entry < tip) & (tip < case.exit)
            total[engaged] += case.depth * _force_per_motion(tip[engaged], *coefficients)
            continue
        for turn in range(turns):
            # heights at which the edge is between entry and exit
            turned = tip + 2.0 * math.pi * turn
            low = np.clip((turned - case.exit) / lag, 0.0, case.depth)
            high = np.clip((turned - case.entry) / lag, 0.0, case.depth)
            half = 0.5 * (high - low)
            height = low[:, None] + half[:, None] * (1.0 + _GAUSS_NODES)
            parts = _force_per_motion(turned[:, None] - lag * height, *coefficients)
            total += half[:, None, None] * np.tensordot(parts, _GAUSS_WEIGHTS, axes=(1, 0))
    return total


def stiffness_of_cut(case, spindle_angles):
    """Force on the tool for unit d, N/m, (k, 3, 3)."""
    return edge_integral(case, spindle_angles, case.coefficients)


def damping_of_cut(case, spindle_angles):
    """Force on the tool for unit velocity by process damping, N s/m, (k, 3, 3)."""
    coefficient = case.process_damping / (0.5 * case.diameter * case.speed)
    damping = (case.friction * coefficient, coefficient, 0.0)
    return edge_integral(case, spindle_angles, damping)


def border_angles(case):
    """Angles of the first tooth in a pitch at which tip or top of a tooth enters or leaves."""
    top = case.lag_per_height * case.depth
    angles = (case.entry, case.exit, case.entry + top, case.exit + top)
    return np.unique(np.mod(angles, case.pitch))


def delay_equation(case):
    """Return the problem over one tooth period as a PeriodicDelayEquation.

    The state is (omega eta, eta') of the mass-normalised modes; delayed are x and y of the tool.
    """
    modes = [Mode(*mode) for mode in case.modes]
    count = len(modes)
    omega = np.array([mode.angular for mode in modes])
    damping = np.array([mode.damping for mode in modes])
    shapes = np.array([mode.shape for mode in modes])
    free = np.block(
        [
            [np.zeros((count, count)), np.diag(omega)],
            [-np.diag(omega), -2.0 * np.diag(damping * omega)],
        ]
    )
    displacement = np.hstack([shapes.T / omega, np.zeros((3, count))])
    velocity = np.hstack([np.zeros((3, count)), shapes.T])
    force = np.vstack([np.zeros((count, 3)), shapes])

    def present(times):
        angles = case.speed * times
        matrix = free + force @ stiffness_of_cut(case, angles) @ displacement
        if case.process_damping:
            matrix = matrix + force @ damping_of_cut(case, angles) @ velocity
        return matrix

    def delayed(times):
        return -force @ stiffness_of_cut(case, case.speed * times)[:, :, :2]

    return collocation.PeriodicDelayEquation(
        present,
        delayed,
        displacement[:2],
        period=case.tooth_period,
        delay=case.tooth_period,
        borders=tuple(border_angles(case) / case.speed),
    )


def multipliers(case, nodes=16, waves_a_piece=1.0):
    """Return all multipliers over one tooth period, largest magnitude first.

    No interval is longer than `waves_a_piece` periods of the highest mode.
    """
    highest = max(mode[0] for mode in case.modes)
    longest = min(waves_a_piece / highest, _LONGEST_ANGLE / case.speed)
    return collocation.multipliers(delay_equation(case), nodes, longest)


def spectral_radius(case, nodes=16, waves_a_piece=1.0):
    """Return the largest magnitude of the multipliers over one tooth period."""
    return float(abs(multipliers(case, nodes, waves_a_piece)[0]))
