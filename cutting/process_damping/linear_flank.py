"""Flank as the linear analysis sees it: a dashpot, which may follow the steady motion of the cut.

The viscous form is a dashpot C/V. A flank that ploughs is one by the slope at which the steady
motion moves the edge into the work at that moment (see `pressed_flank`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED

_REVOLUTION = 2.0 * math.pi
#: of the outermost radius: the tip of a ball has no cutting speed
LEAST_RADIUS = 1e-3


class LinearFlank(NamedTuple):
    """Dashpot of the flank, for compiled code; neither table in the viscous form.

    The force a length of edge is this factor over the cutting speed, times `pressed` at the slope
    of the steady motion where there is such a table, times the velocity into the work.
    """

    tangential: float  # N/m, or N/m^3 where there is a table
    radial: float
    pressed: NDArray[np.float64]  # describing dA/dq over the slope, m^2 (S,)
    steepest: float  # the slopes go from minus this to this
    path: NDArray[np.float64]  # steady motion over the angle turned, m/rad (M, 3)
    period: float  # of the path, rad
    least_radius: float  # m
    stiffening: float  # stiffness that the vibrating flank has over its dashpot, 1/rad

    def at_slope(self, slope: NDArray[np.float64]) -> NDArray[np.float64]:
        """Describing dA/dq, m^2, at slopes of any shape."""
        given = np.linspace(-self.steepest, self.steepest, self.pressed.size)
        return np.interp(slope, given, self.pressed)


class VibratingLand(NamedTuple):
    """What the length of a pressed land against the wave that chatter leaves changes."""

    dashpot: float  # factor on K l^2/2
    stiffness: float  # over the dashpot, times the cutting speed over the radius, 1/rad


def vibrating_land(length: float, frequency: float, speed: float, radius: float) -> VibratingLand:
    """Dashpot and stiffness of a pressed land that vibrates at one frequency.

    The wave lies r(t) - r(t - s/V) lower at the distance s; summed over a land of x = w l/V,

        C/V w = K V/w (1 - cos x),    stiffness = K l (1 - sin x / x),

    the dashpot K l^2/2 and no stiffness where the land is short.

    Parameters
    ----------
    length : float
        m.
    frequency : float
        rad/s.
    speed : float
        Of the spindle, rad/s.
    radius : float
        m.
    """
    x = frequency * length / (speed * radius)
    if x < 1e-3:
        return VibratingLand(1.0, x * x / 3.0 * radius / length)
    dashpot = 2.0 * (1.0 - math.cos(x)) / x**2
    return VibratingLand(dashpot, 2.0 * (1.0 - math.sin(x) / x) / dashpot * radius / length)


def bare_flank() -> LinearFlank:
    """A flank that touches nothing."""
    return LinearFlank(0.0, 0.0, np.zeros(0), 1.0, np.zeros((0, 3)), _REVOLUTION, 0.0, 0.0)


@register_jitable(**INLINED)
def inverse_radius(flank, radius):
    """One over the radius that the cutting speed is taken at, 1/m; 0 where nothing touches.

    A flank that ploughs is taken at the radius of each point of the edge: then it is 1.
    """
    if flank.radial <= 0.0:
        return 0.0
    return 1.0 if flank.pressed.shape[0] > 0 else 1.0 / radius


@register_jitable(**INLINED)
def pressed_at(flank, slope):
    """Describing dA/dq at a slope, m^2."""
    last = flank.pressed.shape[0] - 1
    place = 0.5 * (slope / flank.steepest + 1.0) * last
    if place <= 0.0:
        return flank.pressed[0]
    if place >= last:
        return flank.pressed[last]
    low = int(place)
    share = place - low
    return flank.pressed[low] + share * (flank.pressed[low + 1] - flank.pressed[low])


@register_jitable(**INLINED)
def _along_path(flank, spindle, axis):
    count = flank.path.shape[0]
    place = spindle / flank.period
    place = (place - math.floor(place)) * count
    low = min(int(place), count - 1)
    following = low + 1 if low + 1 < count else 0
    share = place - low
    return flank.path[low, axis] + share * (flank.path[following, axis] - flank.path[low, axis])


@register_jitable(**INLINED)
def pressed_over_radius(flank, radius, spindle, sine, cosine, sine_of_edge, cosine_of_edge):
    """Describing dA/dq over the radius, m, of a point of the edge at a spindle angle, rad.

    Sine and cosine are of its immersion angle and of its axial immersion angle.
    """
    radius = max(radius, flank.least_radius)
    slope = 0.0
    if flank.path.shape[0] > 0:
        plane = sine * _along_path(flank, spindle, 0) + cosine * _along_path(flank, spindle, 1)
        slope = sine_of_edge * plane - cosine_of_edge * _along_path(flank, spindle, 2)
        slope /= radius
    return pressed_at(flank, slope) / radius
