"""Edge forces that set in where the chip begins at zero.

The edge force acts as soon as there is a chip. Where a tooth begins or ends its cut at a chip of
zero, vibration shifts that moment, by the change of the chip over its slope along the arc, and the
edge force acts for so much longer or shorter. That is a stiffness as the chip's own is one; the
linear methods, by custom, leave it out (Altintas and Budak 1995 drop the edge forces).
"""

from __future__ import annotations

import math

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.model import MillingModel
from chatter.stability.steady_motion import EdgePoints, directions, edge_points

#: share of the stiffness of the chip from which on it is reported: limits of end mills in the time
#: domain lay between none and four fifths of the share below those of the linear methods
REPORTED_ONSET = 0.02
#: angles of the arc of a point of the edge at which the stiffness of the chip is summed
_ANGLES = 48
#: least depth, of a limit, at which a bound of it is looked for, and depths between
_LEAST_DEPTH, _DEPTHS = 0.01, 7
#: chip at the end of an arc that is zero but for rounding, of the largest
_ZERO = 1e-6


def edge_force_onset(model: MillingModel, depth: float) -> float:
    """Stiffness of edge forces that set in at a chip of zero, over that of the chip.

    Both averaged over a revolution, as matrices between the directions of the motion (Frobenius
    norms), down to a depth, m. Where an arc of the cut ends at the very angle of zero chip, as
    without runout, a wave outwards does not lengthen it: half of the stiffness acts.
    """
    onset, chip = _stiffness(model, depth)
    return onset / chip if chip > 0.0 else 0.0


def share_is_that_of_all_depths(model: MillingModel) -> bool:
    """Whether edge forces and chip grow alike with the depth: on the edge of a cylinder."""
    return model.cutter.is_cylindrical and not model.is_inclined


def lowest_limit_with_onset(model: MillingModel, limit: float) -> float:
    """Depth, m, that edge forces which set in at a chip of zero leave of a linear limit at least.

    With the share s of the stiffness of the edge forces over that of the chip at the limit itself:
    where both together are as stiff as 1 - s^2 of the chip there. With a share that is the same at
    all depths that is the limit times 1 - s; on a ball the share falls with the depth, and the chip
    grows by less than the depth. 0 where the share is 1 or more.
    """
    depths = limit * np.geomspace(_LEAST_DEPTH, 1.0, _DEPTHS)
    at_limit = _stiffness(model, limit)
    share = at_limit[0] / at_limit[1] if at_limit[1] > 0.0 else 0.0
    if share >= 1.0:
        return 0.0
    whole = np.array([*(sum(_stiffness(model, depth)) for depth in depths[:-1]), sum(at_limit)])
    wanted = (1.0 - share**2) * at_limit[1]
    reached = np.log(np.maximum.accumulate(np.maximum(whole, 1e-300)))
    if math.log(wanted) < reached[0]:
        return 0.0
    return float(np.exp(np.interp(math.log(wanted), reached, np.log(depths))))


def _stiffness(model: MillingModel, depth: float) -> tuple[float, float]:
    """Stiffness of the edge forces that set in, and of the chip, down to a depth, m; N/m rad."""
    edge = np.array(getattr(model.laws[0], "edge", (0.0, 0.0, 0.0)))
    points = edge_points(model.cut(depth).segments, depth)
    if not np.any(edge) or not points.angle.size:
        return 0.0, 0.0
    onset, chip = 0.0, 0.0
    for p in range(points.angle.size):
        onset = onset + _onset_of(points, p, edge, model.basis_on_tool)
        chip = chip + _chip_of(points, p, model.basis_on_tool)
    return float(np.linalg.norm(onset)), float(np.linalg.norm(chip))


def _onset_of(points: EdgePoints, p: int, edge: Array, basis: Array) -> Array | float:
    """Sum (r, r) over the angles of zero chip of a point of the edge, N/m rad."""
    found: Array | float = 0.0
    for phi, share in _angles_of_zero_chip(points, p):
        push, normal = directions(points, p, np.array([phi]), basis)
        slope = abs(points.feed[p] * math.cos(phi))
        if slope > 0.0:
            force = np.einsum("l,li->i", edge, push[:, 0])
            found = found + share * points.length[p] / slope * np.outer(force, normal[0])
    return found


def _angles_of_zero_chip(points: EdgePoints, p: int) -> list[tuple[float, float]]:
    """Angles at which feed sin(phi) = offset, rad, and what of a shift counts on average."""
    if points.feed[p] <= 0.0 or abs(points.offset[p]) >= points.feed[p]:
        return []
    zero = math.asin(points.offset[p] / points.feed[p])
    found = []
    for phi in (zero, math.pi - zero):
        inside = min(phi - points.entry[p], points.exit[p] - phi)
        if inside >= -_ZERO:
            found.append((phi, 1.0 if inside > _ZERO else 0.5))
    return found


def _chip_of(points: EdgePoints, p: int, basis: Array) -> Array | float:
    """Integral (r, r) of the stiffness of the chip over the arc of a point of the edge, N/m rad."""
    arc = points.exit[p] - points.entry[p]
    if arc <= 0.0:
        return 0.0
    phi = points.entry[p] + arc * (np.arange(_ANGLES) + 0.5) / _ANGLES
    phi = phi[points.feed[p] * np.sin(phi) > points.offset[p]]
    if not phi.size:
        return 0.0
    push, normal = directions(points, p, phi, basis)
    slope = np.einsum("l,lni->ni", points.slope[p], push)
    return points.length[p] * arc / _ANGLES * np.einsum("ni,nj->ij", slope, normal)
