"""Ploughing: the flank pressed into the wave that the edge has just cut.

The force is the specific indentation force times the volume of work material that the flank
displaces (Shaw and DeSalvo 1970; Wu 1989, J. Eng. Ind. 111, eqs. 9 to 14). The volume follows from
the wave behind the edge, the clearance angle, the flank wear and the edge radius. What a still
tool displaces with its rounded edge belongs to the edge coefficients and is taken off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED
from cutting.process_damping.leaves import FlankLeaves
from cutting.process_damping.linear_flank import LEAST_RADIUS, LinearFlank, bare_flank
from cutting.process_damping.pressed_flank import PressingOverSlope, pressing_over_slope
from cutting.process_damping.viscous import ViscousProcessDamping

#: material parts at this angle before the lowest point of a rounded edge (Basuray et al. 1977)
_SEPARATION_ANGLE = math.radians(37.6)
#: nodes of the flank along the contact at rest, and behind it
_NODES_OF_CONTACT = 40
_NODES_BEHIND = 20
#: samples of the wave over the contact at rest, at the least, where the steps are that short; and
#: over the wave that is followed, at the most
_SAMPLES_OF_CONTACT = 8
_MOST_SAMPLES = 4096
#: the wave is followed until the clearance is this high, m
_HIGHEST_WAVE = 2e-4


@dataclass(frozen=True)
class Ploughing:
    """Indentation of the flank.

    Parameters
    ----------
    indentation_force : float
        Specific indentation force, N/m^3.
    clearance_angle : float
        rad.
    flank_wear : float
        Length of the land worn parallel to the cutting speed, m.
    edge_radius : float
        m.
    friction : float
        mu, tangential over radial force.
    """

    indentation_force: float
    clearance_angle: float
    flank_wear: float = 0.0
    edge_radius: float = 0.0
    friction: float = 0.0

    @property
    def contact_length(self) -> float:
        """Length of contact of a still tool, m: rounded edge, worn land and flank behind it.

        It ends where the flank comes out of the line of the new surface (`profile` is zero).
        """
        arc = self.edge_radius * math.sin(_SEPARATION_ANGLE)
        if self.clearance_angle >= _SEPARATION_ANGLE:
            return 2.0 * arc + self.flank_wear
        still_below = math.cos(self.clearance_angle) - math.cos(_SEPARATION_ANGLE)
        behind = math.sin(self.clearance_angle) + still_below / math.tan(self.clearance_angle)
        return arc + self.flank_wear + self.edge_radius * behind

    def profile(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Depth of the flank below the line of the new surface, m, behind the parting point.

        At distances (n,) along the cutting speed, m, >= 0: positive where a still tool displaces
        material, negative where there is clearance.
        """
        radius = self.edge_radius
        lowest = radius * math.sin(_SEPARATION_ANGLE)
        depth = radius * (1.0 - math.cos(_SEPARATION_ANGLE))
        before = np.minimum(distance - lowest, 0.0)
        after = np.maximum(distance - lowest - self.flank_wear, 0.0)
        arc_end = radius * math.sin(self.clearance_angle)
        on_arc = np.minimum(after, arc_end)
        rise = radius - np.sqrt(radius**2 - before**2) + radius - np.sqrt(radius**2 - on_arc**2)
        return depth - rise - np.maximum(after - arc_end, 0.0) * math.tan(self.clearance_angle)

    @property
    def small_vibration(self) -> ViscousProcessDamping:
        """Dashpot that the flank is for small vibration about a still tool.

        At a distance s the wave lies r(t) - r(t - s/V) = s r'/V lower, and the displaced volume a
        width is the sum of that. A rounded edge is pressed at rest and gives C = K L^2/2 over the
        length of contact L. A flat land touches without pressure: it acts on the way in alone, so
        that half of the energy is taken, C = K l^2/4 (Ahmadi and Ismail 2012, Int. J. Mach. Tools
        Manuf. 54, 46).
        """
        pressing = 0.5 if self.edge_radius > 0.0 else 0.25
        coefficient = pressing * self.indentation_force * self.contact_length**2
        return ViscousProcessDamping(coefficient, self.friction)

    def linear(self, radius: float) -> LinearFlank:
        """Dashpot about a still tool, for compiled linear analysis, of a tool of this radius, m."""
        small = self.small_vibration.coefficient / self.indentation_force
        return bare_flank()._replace(
            tangential=self.indentation_force * self.friction,
            radial=self.indentation_force,
            pressed=np.full(2, small),
            least_radius=LEAST_RADIUS * radius,
        )

    @cached_property
    def over_slope(self) -> PressingOverSlope:
        """Area that the flank presses over the slope of the motion into the work."""
        return pressing_over_slope(self.profile, self.contact_length, self.clearance_angle)

    def table(self, radius: NDArray[np.float64], teeth: int, step_angle: float) -> PloughingFlank:
        """Table for the kernels, with the samples of the wave for every tooth and slice.

        From the radius of the edge slices (L,), m, and the rotation in a time step, rad.
        """
        contact = self.contact_length
        length = contact + _HIGHEST_WAVE / math.tan(self.clearance_angle)
        nodes = np.concatenate(
            [
                np.linspace(0.0, contact, _NODES_OF_CONTACT + 1),
                contact + (length - contact) * np.linspace(0.0, 1.0, _NODES_BEHIND + 1)[1:] ** 2,
            ]
        )
        arc = np.maximum(radius, LEAST_RADIUS * radius.max()) * step_angle
        longest = arc.max()
        fine = math.floor(contact / _SAMPLES_OF_CONTACT / longest)
        stride = max(1, fine, math.ceil(length / (_MOST_SAMPLES - 2) / longest))
        samples = math.ceil(length / (stride * longest)) + 2
        shape = (teeth, radius.size)
        return PloughingFlank(
            indentation_force=self.indentation_force,
            friction=self.friction,
            distance=nodes,
            depth=self.profile(nodes),
            inverse_radius=step_angle / arc,
            spacing=stride * arc,
            stride=stride,
            surface=np.zeros((*shape, samples)),
            newest=np.zeros(shape, dtype=np.int64),
            filled=np.zeros(shape, dtype=np.int64),
            age=np.zeros(shape, dtype=np.int64),
        )


class PloughingFlank(NamedTuple):
    """Flank of the edge, and the wave that each slice of it has just cut."""

    indentation_force: float  # N/m^3
    friction: float
    distance: NDArray[np.float64]  # of the nodes of the flank behind the parting point, m, (J,)
    depth: NDArray[np.float64]  # of the flank below the new surface there, m, (J,)
    inverse_radius: NDArray[np.float64]  # of the edge slices, 1/m (L,)
    spacing: NDArray[np.float64]  # of the samples along the cut, m, (L,)
    stride: int  # steps between samples
    surface: NDArray[np.float64]  # surface left at the last samples, outwards, m, (N, L, K)
    newest: NDArray[np.int64]  # column of the last sample, (N, L)
    filled: NDArray[np.int64]  # samples since the edge came into the cut, (N, L)
    age: NDArray[np.int64]  # steps since the last sample, (N, L)


@register_jitable(**INLINED)
def _area_above(left, right, width):
    """Area above zero of a straight line from `left` to `right` over a width."""
    if left >= 0.0 and right >= 0.0:
        return 0.5 * (left + right) * width
    if left <= 0.0 and right <= 0.0:
        return 0.0
    high = left if left > right else right
    low = right if left > right else left
    return 0.5 * high * high / (high - low) * width


@register_jitable(**INLINED)
def ploughing_force(flank, tooth, segment, position, turning, rate, speed):  # noqa: ARG001
    """Tangential and radial force per length of edge, N/m.

    The position of the edge along its outward normal is in the frame of the samples, m. The normal
    turns with the edge: `turning`, m/rad, takes the displacement of the tool back to the normal at
    a place that the edge has left, so that a tool that is displaced but still ploughs nothing.
    Rate and speed are not used: the wave itself says how fast the edge moves.
    """
    count = flank.filled[tooth, segment]
    samples = flank.surface.shape[2]
    spacing = flank.spacing[segment]
    # the newest sample was taken `age` steps before the last one, the others a stride earlier each
    first = spacing * (flank.age[tooth, segment] + 1) / flank.stride
    newest = flank.newest[tooth, segment]
    drift = turning * flank.inverse_radius[segment]
    area = 0.0
    if count == 0:
        return 0.0, 0.0
    left = at_rest = flank.depth[0]
    for node in range(1, flank.distance.shape[0]):
        distance = flank.distance[node]
        if distance <= first:
            near_wave, far_wave = position, flank.surface[tooth, segment, newest]
            share = distance / first
        else:
            behind = (distance - first) / spacing
            nearer = int(behind)
            if nearer + 1 >= count:
                break
            column = newest - nearer
            if column < 0:
                column += samples
            near_wave = flank.surface[tooth, segment, column]
            column = column - 1 if column > 0 else samples - 1
            far_wave = flank.surface[tooth, segment, column]
            share = behind - nearer
        depth = flank.depth[node]
        right = position - drift * distance - (near_wave + share * (far_wave - near_wave)) + depth
        width = distance - flank.distance[node - 1]
        # what a still tool displaces belongs to the edge coefficients
        area += _area_above(left, right, width) - _area_above(at_rest, depth, width)
        left, at_rest = right, depth
    radial = flank.indentation_force * area
    return flank.friction * radial, radial


@register_jitable(**INLINED)
def store_surface_history(flank, tooth, segment, surface):
    """Take the surface left by the edge in this step, m, into the samples."""
    age = flank.age[tooth, segment] + 1
    if flank.filled[tooth, segment] == 0 or age >= flank.stride:
        samples = flank.surface.shape[2]
        column = flank.newest[tooth, segment] + 1
        if column >= samples:
            column = 0
        flank.newest[tooth, segment] = column
        flank.surface[tooth, segment, column] = surface
        flank.filled[tooth, segment] = min(samples, flank.filled[tooth, segment] + 1)
        age = 0
    flank.age[tooth, segment] = age


@register_jitable(**INLINED)
def clear_surface_history(flank, tooth, segment):
    """The edge has left the cut: there is nothing behind it any more."""
    flank.filled[tooth, segment] = 0
    flank.age[tooth, segment] = 0


PLOUGHING = FlankLeaves(
    PloughingFlank, ploughing_force, store_surface_history, clear_surface_history, has_memory=True
)
