"""Chip thickness from a workpiece that the moving edges really carve.

Every slice of the tool cuts a layer of the workpiece. The path of the tool, its feed and its
vibration are all in the places of the edges, so that entry, exit, corners and steps of the stock,
missed cuts and earlier passes come out of themselves.
"""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED, by_table
from cutting.dexel.carving import dexel_carve, dexel_chip_thickness
from cutting.dexel.stock import DexelStock
from cutting.force.laws import edge_force
from cutting.process_damping.flank import LEAVES, end_contact, flank_force, store_surface
from cutting.tool.edge_table import EdgeTable, direction, force_on_tool
from cutting.voxel.carving import voxel_carve, voxel_chip_thickness
from cutting.voxel.stock import VoxelStock


class DiscreteCut(NamedTuple):
    """Cut of a tool through a workpiece of layers."""

    edges: EdgeTable
    law: NamedTuple
    flank: NamedTuple
    stock: DexelStock | VoxelStock
    depth: float  # of all layers, m
    removed: NDArray[np.float64]  # volume removed since the start, m^3, (1,)


#: chip thickness that an edge meets at the end of a step, m
chip_thickness = by_table({DexelStock: dexel_chip_thickness, VoxelStock: voxel_chip_thickness})
#: removes what an edge sweeps in a step; the area, m^2
carve = by_table({DexelStock: dexel_carve, VoxelStock: voxel_carve})


@register_jitable(**INLINED)
def _edge_place(edges, tooth, piece, sine, cosine, motion, x, y):
    """Tool axis and edge (cx, cy, ex, ey) in the plane of a layer, m, at a spindle angle."""
    s, c = edges.sine[tooth, piece, 0], edges.cosine[tooth, piece, 0]
    across, along = sine * c + cosine * s, cosine * c - sine * s
    sk, ck = edges.sine_immersion[piece], edges.cosine_immersion[piece]
    # a tool that is lifted cuts the layer with a lower, narrower part of its edge
    radius = edges.radius[piece] + (edges.normal_offset[tooth, piece] - ck * motion[2]) / sk
    cx, cy = x + motion[0], y + motion[1]
    return cx, cy, cx + radius * across, cy + radius * along


@register_jitable(**INLINED)
def _step_of_edge(edges, tooth, piece, rotation, point):
    """Tool axis and edge before and after the step, m."""
    before = _edge_place(
        edges,
        tooth,
        piece,
        rotation.sine_before,
        rotation.cosine_before,
        point.displacement_before,
        rotation.x_before,
        rotation.y_before,
    )
    after = _edge_place(
        edges,
        tooth,
        piece,
        rotation.sine,
        rotation.cosine,
        point.displacement,
        rotation.x,
        rotation.y,
    )
    return before, after


@register_jitable(**INLINED)
def _thickness(cut, tooth, piece, rotation, point):
    """Chip thickness along the normal of the edge, m."""
    (cx0, cy0, ex0, ey0), (cx1, cy1, ex1, ey1) = _step_of_edge(
        cut.edges, tooth, piece, rotation, point
    )
    radial = chip_thickness(cut.stock, piece, tooth, cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1)
    return radial * cut.edges.sine_immersion[piece]


@register_jitable(**INLINED)
def discrete_forces(group, rotation, point):
    """Add the cutting force on the tool at the motion of the tool point."""
    cut, edges = group, group.edges
    teeth, pieces = edges.whole.shape
    u, v = point.displacement, point.velocity
    speed = rotation.speed * edges.radius[pieces - 1]
    for tooth in range(teeth):
        for piece in range(pieces):
            chip = _thickness(cut, tooth, piece, rotation, point)
            if chip <= 0.0:
                continue
            sine, cosine = direction(edges, tooth, piece, 0, rotation)
            sk, ck = edges.sine_immersion[piece], edges.cosine_immersion[piece]
            rate = sk * (v[0] * sine + v[1] * cosine) - ck * v[2]
            own = _outward(edges, tooth, piece, sine, cosine, point)
            ft, fr, fa = edge_force(cut.law, tooth, chip)
            turning = sk * (u[0] * cosine - u[1] * sine)
            pt, pr = flank_force(cut.flank, tooth, piece, own, turning, rate, speed)
            force = force_on_tool(sk, ck, sine, cosine, ft + pt, fr + pr, fa)
            length = edges.edge_length[piece]
            for axis in range(3):
                point.force[axis] += length * force[axis]
                point.sample[axis] += length * force[axis]
            point.torque[0] += length * (ft + pt) * edges.radius[piece]
            point.contact[0] += edges.share[piece]


@register_jitable(**INLINED)
def _outward(edges, tooth, piece, sine, cosine, point):
    """Place of the edge along its outward normal, m, from its nominal path."""
    sk, ck = edges.sine_immersion[piece], edges.cosine_immersion[piece]
    u = point.displacement
    return edges.normal_offset[tooth, piece] + sk * (u[0] * sine + u[1] * cosine) - ck * u[2]


@register_jitable(**INLINED)
def _surface_behind(flank, cut, tooth, piece, rotation, point):
    """Let the flank store what surface lies behind the edge now."""
    if _thickness(cut, tooth, piece, rotation, point) <= 0.0:
        end_contact(flank, tooth, piece)
        return
    sine, cosine = direction(cut.edges, tooth, piece, 0, rotation)
    store_surface(flank, tooth, piece, _outward(cut.edges, tooth, piece, sine, cosine, point))


@register_jitable(**INLINED)
def _no_surface(flank, cut, tooth, piece, rotation, point):
    """Store nothing: the flank has no memory."""


#: lets the flank take in the surface behind an edge, where it has a memory
_store_surface_of_layer = by_table(
    {one.table: _surface_behind if one.has_memory else _no_surface for one in LEAVES}
)


@register_jitable(**INLINED)
def discrete_commit(group, rotation, point):
    """Carve the workpiece along the motion of the step."""
    cut, edges = group, group.edges
    teeth, pieces = edges.whole.shape
    for tooth in range(teeth):
        for piece in range(pieces):
            _store_surface_of_layer(cut.flank, cut, tooth, piece, rotation, point)
            (cx0, cy0, ex0, ey0), (cx1, cy1, ex1, ey1) = _step_of_edge(
                edges, tooth, piece, rotation, point
            )
            area = carve(cut.stock, piece, tooth, cx0, cy0, ex0, ey0, cx1, cy1, ex1, ey1)
            cut.removed[0] += area * edges.share[piece] * cut.depth
