"""Ploughing: the flank pressed into the wave that the edge has just cut.

The force is the specific indentation force times the volume of work material that the flank
displaces (Shaw and DeSalvo 1970; Wu 1989, J. Eng. Ind. 111, eqs. 9 to 14). The volume follows from
the wave behind the edge, the clearance angle, the flank wear and the edge radius. What a still
tool displaces with its rounded edge belongs to the edge coefficients and is taken off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.edge_force import INLINED

#: material parts at this angle before the lowest point of a rounded edge (Basuray et al. 1977)
_SEPARATION_ANGLE = math.radians(37.6)
#: samples of the wave along the contact at rest, and most samples looked back
_SAMPLES_A_CONTACT = 12
_MOST_SAMPLES = 96
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
        """Length of contact of a still tool, m: rounded edge and worn land."""
        arc = self.edge_radius * math.sin(_SEPARATION_ANGLE)
        recovery = self.edge_radius * (1.0 - math.cos(_SEPARATION_ANGLE))
        behind = min(arc, recovery / math.tan(self.clearance_angle))
        return arc + self.flank_wear + behind

    def profile(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Depth of the flank below the line of the new surface, m, behind the parting point.

        Parameters
        ----------
        distance : (n,) array of float
            Along the cutting speed, m, >= 0.

        Returns
        -------
        (n,) array of float
            Positive where a still tool displaces material, negative where there is clearance.
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


class PloughingFlank(NamedTuple):
    """Flank of each edge slice, and the wave that it has just cut."""

    indentation_force: float  # N/m^3
    friction: float
    profile: NDArray[np.float64]  # depth below the new surface at each sample, m, (N, L, K+1)
    spacing: NDArray[np.float64]  # of the samples along the cut, m, (N, L)
    stride: int  # steps between samples
    wave: NDArray[np.float64]  # surface left at the last samples, outwards, m, (N, L, K)
    newest: NDArray[np.int64]  # column of the last sample, (N, L)
    filled: NDArray[np.int64]  # samples since the edge came into the cut, (N, L)
    age: NDArray[np.int64]  # steps since the last sample, (N, L)


def ploughing_flank(
    law: Ploughing, radius: NDArray[np.float64], teeth: int, step_angle: float
) -> PloughingFlank:
    """Lay out the samples of the wave for every tooth and slice.

    Parameters
    ----------
    law : Ploughing
    radius : (L,) array of float
        Of the edge slices, m.
    teeth : int
    step_angle : float
        Rotation in a time step, rad.
    """
    contact = law.contact_length
    length = contact + _HIGHEST_WAVE / math.tan(law.clearance_angle)
    arc = np.maximum(radius, 1e-3 * radius.max()) * step_angle
    wanted = max(contact / _SAMPLES_A_CONTACT, length / _MOST_SAMPLES)
    stride = max(1, int(wanted / arc.max()))
    samples = min(_MOST_SAMPLES, max(2, math.ceil(length / (stride * arc.max()))))
    spacing = stride * arc
    distance = spacing[:, None] * np.arange(samples + 1)
    profile = law.profile(distance.ravel()).reshape(distance.shape)
    shape = (teeth, radius.size)
    return PloughingFlank(
        indentation_force=law.indentation_force,
        friction=law.friction,
        profile=np.ascontiguousarray(np.broadcast_to(profile, (*shape, samples + 1))),
        spacing=np.ascontiguousarray(np.broadcast_to(spacing, shape)),
        stride=stride,
        wave=np.zeros((*shape, samples)),
        newest=np.zeros(shape, dtype=np.int64),
        filled=np.zeros(shape, dtype=np.int64),
        age=np.zeros(shape, dtype=np.int64),
    )


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
def ploughing_force(flank, tooth, piece, place, rate, speed):  # noqa: ARG001
    """Tangential and radial force per length of edge, N/m.

    Parameters
    ----------
    flank : PloughingFlank
    tooth, piece : int
    place : float
        Of the edge along its outward normal, m, in the frame of the samples.
    rate, speed : float
        Not used: the wave itself says how fast the edge moves.
    """
    count = flank.filled[tooth, piece]
    samples = flank.wave.shape[2]
    spacing = flank.spacing[tooth, piece]
    # the newest sample was taken `age` steps before the last one, the others a stride earlier each
    first = spacing * (flank.age[tooth, piece] + 1) / flank.stride
    area = 0.0
    left = at_rest = flank.profile[tooth, piece, 0]
    reached = 0.0
    for k in range(count):
        column = flank.newest[tooth, piece] - k
        if column < 0:
            column += samples
        distance = first + k * spacing
        node = int(distance / spacing)
        if node >= samples:
            break
        part = distance / spacing - node
        depth = (1.0 - part) * flank.profile[tooth, piece, node] + part * (
            flank.profile[tooth, piece, node + 1]
        )
        right = place - flank.wave[tooth, piece, column] + depth
        width = distance - reached
        # what a still tool displaces belongs to the edge coefficients
        area += _area_above(left, right, width) - _area_above(at_rest, depth, width)
        left, at_rest, reached = right, depth, distance
    radial = flank.indentation_force * area
    return flank.friction * radial, radial


@register_jitable(**INLINED)
def note_wave(flank, tooth, piece, surface):
    """Take the surface left by the edge in this step, m, into the samples."""
    age = flank.age[tooth, piece] + 1
    if flank.filled[tooth, piece] == 0 or age >= flank.stride:
        samples = flank.wave.shape[2]
        column = flank.newest[tooth, piece] + 1
        if column >= samples:
            column = 0
        flank.newest[tooth, piece] = column
        flank.wave[tooth, piece, column] = surface
        flank.filled[tooth, piece] = min(samples, flank.filled[tooth, piece] + 1)
        age = 0
    flank.age[tooth, piece] = age


@register_jitable(**INLINED)
def forget_wave(flank, tooth, piece):
    """The edge has left the cut: there is nothing behind it any more."""
    flank.filled[tooth, piece] = 0
    flank.age[tooth, piece] = 0
