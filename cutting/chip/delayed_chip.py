"""Chip thickness from the true positions of the edge against what every earlier tooth left.

The motion of the tool is kept over the last turn, at every bin of the spindle angle. An edge at a
position meets what each tooth left there within the turn before it, at the moment when that tooth
passed; the outermost of them bounds the chip, so that a tooth that stayed in the air leaves the
work of the earlier ones. What lies more than a turn back is forgotten. The memory does not grow
with the length of the run, nor with the number of slices. Edges that are partly in the cut are
taken in part, and each slice is integrated by two Gauss points, so that forces of a still tool
converge with the fourth power of the slice height and vary smoothly in time.
"""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.chip.delayed_edge import at_jump, chip_at, part_of_slice, straight_mean, whole_slice
from cutting.chip.tool_point import InclinedRotation, Rotation, TurningRotation
from cutting.compiled import INLINED, by_table
from cutting.process_damping.flank import BARE, LEAVES, end_contact, flank_force, store_surface
from cutting.tool.edge_table import EdgeTable, direction, force_on_tool, signed_bin, spindle_bin

#: an edge that is this many bins outside the arc has left the cut
_MARGIN = 2.0
#: a straight edge is looked at this many bins late, so that it is on one side of a jump
_NUDGE = 1e-6


class DelayedCut(NamedTuple):
    """Cut of a tool through the waves that its teeth have left in the last turn."""

    edges: EdgeTable
    law: NamedTuple
    flank: NamedTuple
    entry: NDArray[np.float64]  # of the middle of each slice, bins, (L,)
    exit: NDArray[np.float64]  # bins, (L,)
    entry_rise: NDArray[np.float64]  # from the middle to the upper end, bins, (L,)
    exit_rise: NDArray[np.float64]  # bins, (L,)
    arc: NDArray[np.float64]  # first entry and last exit of all slices, bins, (2,)
    reach: NDArray[np.float64]  # of an edge behind and before its first slice, bins, (N, 2)
    helices: int  # 1 where all flutes have one helix, else the number of slices
    earlier: NDArray[np.int64]  # tooth of the k-th pass back, (N, L, N)
    delay: NDArray[np.float64]  # turn of the spindle since that pass, bins, (N, helices, N)
    radial_offset: NDArray[np.float64]  # of the edge behind that of the pass, at the Gauss points
    # above and below the middle, m, (N, L, N, 2)
    history: NDArray[np.float64]  # x, y, z of the tool against the work at each bin of the last
    # turn, path and vibration, m, and its change to the next bin by its slope, m, (2, bins, 3)
    since: NDArray[np.float64]  # scratch: motion since each pass, m, (N, 3)


@register_jitable(**INLINED)
def _along_x(rotation, edges):  # noqa: ARG001
    """Heading of a feed along x, bins."""
    return 0.0


@register_jitable(**INLINED)
def _as_it_turns(rotation, edges):  # noqa: ARG001
    """Heading of the feed, bins."""
    return rotation.heading


@register_jitable(**INLINED)
def _bin_along_x(rotation, edges, whole, part):  # noqa: ARG001
    """Bin of an edge as a number near the arc of the cut."""
    return signed_bin(edges, whole, part)


@register_jitable(**INLINED)
def _bin_as_it_turns(rotation, edges, whole, part):
    """Bin of an edge as a number near the arc of the cut, which turns with the feed."""
    towards = int(rotation.heading)
    turned = whole + towards
    if turned >= edges.bins:
        turned -= edges.bins
    return signed_bin(edges, turned, part) - towards


#: angle by which the arcs of the cut turn with the feed, clockwise ones becoming smaller, bins
_heading = by_table({Rotation: _along_x, TurningRotation: _as_it_turns, InclinedRotation: _along_x})
_position = by_table(
    {Rotation: _bin_along_x, TurningRotation: _bin_as_it_turns, InclinedRotation: _bin_along_x}
)


@register_jitable(**INLINED)
def _place_on_plane(rotation, point):
    """Place of the tool on a path across its axis."""
    u = point.displacement
    return rotation.x + u[0], rotation.y + u[1], u[2]


@register_jitable(**INLINED)
def _place_in_space(rotation, point):
    """Place of the tool on a path that is inclined to its axis."""
    u = point.displacement
    return rotation.x + u[0], rotation.y + u[1], rotation.z + u[2]


@register_jitable(**INLINED)
def _no_axial_path(rotation, share, position, rate):  # noqa: ARG001
    """Place and rate along the axis of a tool whose path lies across it."""
    return position, rate


@register_jitable(**INLINED)
def _with_axial_path(rotation, share, position, rate):
    """Place and rate along the axis, m, with the path's own, at a share of the step."""
    path = rotation.z - rotation.z_before
    return position + rotation.z_before + share * path, rate + path


#: place of the tool against the work, m: path and vibration
_place_now = by_table(
    {Rotation: _place_on_plane, TurningRotation: _place_on_plane, InclinedRotation: _place_in_space}
)
_along_tool_axis = by_table(
    {Rotation: _no_axial_path, TurningRotation: _no_axial_path, InclinedRotation: _with_axial_path}
)


@register_jitable(**INLINED)
def _motion_since(cut, tooth, piece, rotation, now):
    """Fill the scratch with the motion of the tool since each earlier pass, m."""
    bins = cut.edges.bins
    for k in range(cut.since.shape[0]):
        position = rotation.whole + rotation.part - cut.delay[tooth, piece, k]
        if position < 0.0:
            position += bins
        whole = int(position)
        t = position - whole
        if whole >= bins:
            whole -= bins
        after = whole + 1
        if after >= bins:
            after = 0
        for axis in range(3):
            left, right = cut.history[0, whole, axis], cut.history[0, after, axis]
            if t > 0.0:
                # cubic Hermite, from the values and slopes at the bins on both sides
                rise, fall = cut.history[1, whole, axis], cut.history[1, after, axis]
                step = right - left
                bend = (1.0 - t) * (rise - step) + t * (step - fall)
                left += t * step + t * (1.0 - t) * bend
            cut.since[k, axis] = now[axis] - left


@register_jitable(**INLINED)
def _outward(cut, tooth, piece, sine, cosine, point):
    """Place of the edge along its outward normal, m, from its nominal path."""
    sk, ck = cut.edges.sine_immersion[piece], cut.edges.cosine_immersion[piece]
    u = point.displacement
    return cut.edges.normal_offset[tooth, piece] + sk * (u[0] * sine + u[1] * cosine) - ck * u[2]


@register_jitable(**INLINED)
def _on_flank(flank, cut, tooth, piece, rotation, point, total):
    """Add the force on the flank of the length of edge that is in the cut."""
    length = total[4]
    if length <= 0.0:
        return total
    sine, cosine = direction(cut.edges, tooth, piece, 0, rotation)
    sk, ck = cut.edges.sine_immersion[piece], cut.edges.cosine_immersion[piece]
    v = point.velocity
    rate = sk * (v[0] * sine + v[1] * cosine) - ck * v[2]
    own = _outward(cut, tooth, piece, sine, cosine, point)
    speed = rotation.speed * cut.edges.radius[cut.edges.radius.shape[0] - 1]
    turning = sk * (point.displacement[0] * cosine - point.displacement[1] * sine)
    ft, fr = flank_force(flank, tooth, piece, own, turning, rate, speed)
    fx, fy, fz = force_on_tool(sk, ck, sine, cosine, ft, fr, 0.0)
    return (
        total[0] + length * fx,
        total[1] + length * fy,
        total[2] + length * fz,
        total[3] + length * ft * cut.edges.radius[piece],
        total[4],
    )


@register_jitable(**INLINED)
def _off_flank(flank, cut, tooth, piece, rotation, point, total):  # noqa: ARG001
    """Add nothing: the flank touches nothing."""
    return total


#: adds the force on the flank, where there is one
_add_flank_force = by_table({one.table: _off_flank if one is BARE else _on_flank for one in LEAVES})


@register_jitable(**INLINED)
def _all_in_air(cut, tooth, rotation):
    """Tell whether no part of an edge is in the arc of the cut."""
    whole, part = spindle_bin(cut.edges, tooth, 0, rotation.whole, rotation.part)
    position = _position(rotation, cut.edges, whole, part) + _heading(rotation, cut.edges)
    low, high = position + cut.reach[tooth, 0], position + cut.reach[tooth, 1]
    for turns in range(-1, 2):
        shift = turns * cut.edges.bins
        if high + shift >= cut.arc[0] and low + shift <= cut.arc[1]:
            return False
    return True


@register_jitable(**INLINED)
def delayed_forces(group, rotation, point):
    """Add the cutting force on the tool at the motion of the tool point."""
    cut, edges = group, group.edges
    now = _place_now(rotation, point)
    teeth, pieces = edges.whole.shape
    advance = rotation.advance
    heading = _heading(rotation, edges)
    sx = sy = sz = mx = my = mz = torque = contact = 0.0
    for tooth in range(teeth):
        if _all_in_air(cut, tooth, rotation):
            continue
        looked_back = False
        for piece in range(pieces):
            whole, part = spindle_bin(edges, tooth, piece, rotation.whole, rotation.part)
            position = _position(rotation, edges, whole, part)
            entry, leave = cut.entry[piece] - heading, cut.exit[piece] - heading
            at_entry = abs(edges.half_lag[tooth, piece] + cut.entry_rise[piece])
            at_exit = abs(edges.half_lag[tooth, piece] + cut.exit_rise[piece])
            steep_in, steep_out = at_entry < 0.5 * advance, at_exit < 0.5 * advance
            # half the turn of the spindle in which a slice enters or leaves; a jump is seen late
            entering = advance if steep_in else at_entry
            leaving = advance if steep_out else at_exit
            if position + entering < entry or position - leaving > leave:
                continue
            if cut.helices > 1 or not looked_back:
                _motion_since(cut, tooth, piece if cut.helices > 1 else 0, rotation, now)
                looked_back = True
            settled = False
            force = (0.0, 0.0, 0.0, 0.0, 0.0)
            inside, ahead = position - entering >= entry, position + leaving <= leave
            if inside and ahead:
                force, settled = whole_slice(cut, tooth, piece, rotation)
            if not settled:
                # at a jump the limit from the right: one tooth leaves as another one enters
                seen = position + _NUDGE if steep_in or steep_out else position
                force = part_of_slice(cut, tooth, piece, seen, heading)
            force = _add_flank_force(cut.flank, cut, tooth, piece, rotation, point, force)
            mean = force
            # well inside the arc there is no jump, even where a part of the slice is in the air
            if not (inside and ahead) and (steep_in or steep_out):
                if (steep_in or inside) and (steep_out or ahead):
                    mean = straight_mean(cut, tooth, piece, position, rotation, heading)
                    mean = _add_flank_force(cut.flank, cut, tooth, piece, rotation, point, mean)
                    _note_blur(point, mean, force)
                if steep_in and position - advance < entry <= position + _NUDGE:
                    _note_jump(point, 0, at_jump(cut, tooth, piece, entry), force)
                if steep_out and position - advance < leave <= position + _NUDGE:
                    _note_jump(point, 1, at_jump(cut, tooth, piece, leave), force)
            sx += force[0]
            sy += force[1]
            sz += force[2]
            torque += force[3]
            contact += force[4] * edges.share_per_length[piece]
            mx += mean[0]
            my += mean[1]
            mz += mean[2]
    point.sample[0] += sx
    point.sample[1] += sy
    point.sample[2] += sz
    point.force[0] += mx
    point.force[1] += my
    point.force[2] += mz
    point.torque[0] += torque
    point.contact[0] += contact


@register_jitable(**INLINED)
def _note_blur(point, mean, force):
    """Keep the mean force and torque over the turn of a step, less those at its end."""
    point.jumped[0] = 1
    for k in range(4):
        point.blur[k] += mean[k] - force[k]


@register_jitable(**INLINED)
def _note_jump(point, side, at, force):
    """Keep what the force is before (0) and after (1) the jumps of a step, less that at its end.

    An edge that enters (side 0) is not there before, one that leaves (side 1) not after.
    """
    point.jumped[0] = 1
    for axis in range(3):
        point.jump[1 - side, axis] += at[axis] - force[axis]
        point.jump[side, axis] -= force[axis]


@register_jitable(**INLINED)
def _vibration(point, axis, share, step):
    """Displacement at a share of the step, m, and its change over the step at that rate, m."""
    u0, u1 = point.displacement_before[axis], point.displacement[axis]
    rise, fall = point.velocity_before[axis] * step, point.velocity[axis] * step
    gain = u1 - u0
    bend = (1.0 - share) * (rise - gain) + share * (gain - fall)
    position = u0 + share * gain + share * (1.0 - share) * bend
    rate = gain + (1.0 - 2.0 * share) * bend + share * (1.0 - share) * (2.0 * gain - rise - fall)
    return position, rate


@register_jitable(**INLINED)
def _store_motion(cut, rotation, point):
    """Keep the position of the tool at the bins that the spindle has passed in the step."""
    bins = cut.edges.bins
    crossed = int(rotation.part_before + rotation.advance)
    for k in range(1, crossed + 1):
        share = (k - rotation.part_before) / rotation.advance
        passed = rotation.whole_before + k
        if passed >= bins:
            passed -= bins
        for axis in range(3):
            position, rate = _vibration(point, axis, share, rotation.step)
            if axis == 0:
                position += rotation.x_before + share * (rotation.x - rotation.x_before)
                rate += rotation.x - rotation.x_before
            if axis == 1:
                position += rotation.y_before + share * (rotation.y - rotation.y_before)
                rate += rotation.y - rotation.y_before
            if axis == 2:
                position, rate = _along_tool_axis(rotation, share, position, rate)
            cut.history[0, passed, axis] = position
            cut.history[1, passed, axis] = rate / rotation.advance


@register_jitable(**INLINED)
def _store_surface(cut, tooth, piece, position, rotation, point):
    """Let the flank store what surface lies behind the edge now."""
    along = position + _heading(rotation, cut.edges)
    if along < cut.entry[piece] or along > cut.exit[piece]:
        end_contact(cut.flank, tooth, piece)
        return
    sine, cosine = direction(cut.edges, tooth, piece, 0, rotation)
    own = _outward(cut, tooth, piece, sine, cosine, point)
    sk, ck = cut.edges.sine_immersion[piece], cut.edges.cosine_immersion[piece]
    chip = chip_at(cut, tooth, piece, (sk, ck, 0.0, sine, cosine), 0.0)
    # where the edge is in the air the old surface stays, further out than the edge
    store_surface(cut.flank, tooth, piece, own - min(chip, 0.0))


@register_jitable(**INLINED)
def _surfaces_behind(flank, cut, rotation, point):  # noqa: ARG001
    """Let the flank of every edge store what surface lies behind it now."""
    edges = cut.edges
    now = _place_now(rotation, point)
    teeth, pieces = edges.whole.shape
    for tooth in range(teeth):
        looked_back = False
        for piece in range(pieces):
            whole, part = spindle_bin(edges, tooth, piece, rotation.whole, rotation.part)
            position = _position(rotation, edges, whole, part)
            along = position + _heading(rotation, edges)
            if along < cut.entry[piece] - _MARGIN or along > cut.exit[piece] + _MARGIN:
                continue
            if cut.helices > 1 or not looked_back:
                _motion_since(cut, tooth, piece if cut.helices > 1 else 0, rotation, now)
                looked_back = True
            _store_surface(cut, tooth, piece, position, rotation, point)


@register_jitable(**INLINED)
def _no_surfaces(flank, cut, rotation, point):
    """Store nothing: the flank has no memory."""


#: lets the flank take in the surface behind every edge, where it has a memory
_store_surfaces = by_table(
    {one.table: _surfaces_behind if one.has_memory else _no_surfaces for one in LEAVES}
)


@register_jitable(**INLINED)
def delayed_commit(group, rotation, point):
    """Remember the motion of the step: what the edges have left behind."""
    _store_surfaces(group.flank, group, rotation, point)
    _store_motion(group, rotation, point)
