"""The edges of a tool as the time-domain kernels see them."""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED
from cutting.tool.cutter import GAUSS_POINT, EdgeSlices


class EdgeTable(NamedTuple):
    """N teeth by L slices; angles in bins of the spindle turn where nothing else is said."""

    bins: int
    whole: NDArray[np.int64]  # angle of the middle of the slice on the tool, (N, L)
    part: NDArray[np.float64]  # its fraction, (N, L)
    half_lag: NDArray[np.float64]  # by which the upper end trails the middle, (N, L)
    sine: NDArray[np.float64]  # of the angles of middle and two Gauss points, (N, L, 3)
    cosine: NDArray[np.float64]  # (N, L, 3)
    normal_offset: NDArray[np.float64]  # of the edge, outwards, m, (N, L)
    radius: NDArray[np.float64]  # m, (L,)
    sine_immersion: NDArray[np.float64]  # (L,)
    cosine_immersion: NDArray[np.float64]  # (L,)
    edge_length: NDArray[np.float64]  # m, (L,)
    share: NDArray[np.float64]  # of the axial depth, (L,)
    share_per_length: NDArray[np.float64]  # of edge, 1/m, (L,)
    half_tilt: NDArray[np.float64]  # of the normal from the middle to the upper end, rad, (L,)
    half_rise: NDArray[np.float64]  # of the radius from the middle to the upper end, m, (L,)
    gauss: NDArray[np.float64]  # sine and cosine of the immersion, radius (m) at the Gauss points
    # above and below the middle, (L, 2, 3)


def edge_table(slices: EdgeSlices, bins: int) -> EdgeTable:
    """Lay out edge slices for kernels that count angles in `bins` a turn."""
    bin_number = np.mod(slices.angle * bins / (2.0 * math.pi), bins)
    # the last bit of an angle must not make a tooth start a turn early
    near = np.round(bin_number)
    bin_number = np.where(np.abs(bin_number - near) < 1e-9 * bins, near, bin_number) % bins
    whole = np.floor(bin_number).astype(np.int64)
    middle = bin_number * 2.0 * math.pi / bins
    reach = 0.5 * slices.lag * GAUSS_POINT
    points = np.stack([middle, middle - reach, middle + reach], axis=-1)
    upright = np.abs(slices.immersion - 0.5 * math.pi) < 1e-12
    # an upright edge has none at all, not the rounding of pi/2
    sine = np.where(upright, 1.0, np.sin(slices.immersion))
    cosine = np.where(upright, 0.0, np.cos(slices.immersion))
    half_tilt, half_rise = (
        0.5 * slices.tilt,
        0.5 * (slices.upper_radius - slices.lower_radius) / GAUSS_POINT,
    )
    gauss = [
        np.stack(
            [*tilted_normal(sine, cosine, side * half_tilt), slices.radius + side * half_rise],
            axis=-1,
        )
        for side in (GAUSS_POINT, -GAUSS_POINT)
    ]
    return EdgeTable(
        bins=bins,
        whole=whole,
        part=bin_number - whole,
        half_lag=0.5 * slices.lag * bins / (2.0 * math.pi),
        sine=np.sin(points),
        cosine=np.cos(points),
        normal_offset=slices.normal_offset,
        radius=slices.radius,
        sine_immersion=sine,
        cosine_immersion=cosine,
        edge_length=slices.edge_length,
        share=slices.thickness / slices.thickness.sum(),
        share_per_length=slices.thickness / slices.thickness.sum() / slices.edge_length,
        half_tilt=half_tilt,
        half_rise=half_rise,
        gauss=np.stack(gauss, axis=1),
    )


@register_jitable(**INLINED)
def tilted_normal(sine, cosine, tilt):
    """Sine and cosine of an axial immersion that is tilted by a small angle, rad."""
    bend = 1.0 - 0.5 * tilt * tilt
    return sine * bend + cosine * tilt, cosine * bend - sine * tilt


@register_jitable(**INLINED)
def spindle_bin(edges, tooth, slice_index, whole, part):
    """Bin of the middle of an edge slice at a spindle angle: whole bin and fraction."""
    whole = whole + edges.whole[tooth, slice_index]
    part = part + edges.part[tooth, slice_index]
    if part >= 1.0:
        part -= 1.0
        whole += 1
    if whole >= edges.bins:
        whole -= edges.bins
    return whole, part


@register_jitable(**INLINED)
def signed_bin(edges, whole, part):
    """Bin as a number that runs on below zero, so that an arc from zero is not broken."""
    if whole >= edges.bins - edges.bins // 4:
        return whole - edges.bins + part
    return whole + part


@register_jitable(**INLINED)
def direction(edges, tooth, slice_index, point, rotation):
    """Sine and cosine of the angle of a point of the slice (0 middle, 1 and 2 Gauss points)."""
    s, c = edges.sine[tooth, slice_index, point], edges.cosine[tooth, slice_index, point]
    return rotation.sine * c + rotation.cosine * s, rotation.cosine * c - rotation.sine * s


@register_jitable(**INLINED)
def force_on_tool(sk, ck, sine, cosine, tangential, radial, axial):
    """Force (x, y, z) on the tool from the force on an edge.

    Parameters
    ----------
    sk, ck : float
        Sine and cosine of the axial immersion k.
    sine, cosine : float
        Of the rotation angle p.
    tangential, radial, axial : float
        N.

    Notes
    -----
    The tangential force acts against the motion of the edge, the radial one along its inward
    normal (-sin k sin p, -sin k cos p, cos k), the axial one along (cos k sin p, cos k cos p,
    sin k), with k the axial immersion and p the rotation angle (Altintas and Engin 2001, eq. 12,
    with the axial force counted positive upwards along the axis).
    """
    in_plane = axial * ck - radial * sk
    return (
        in_plane * sine - tangential * cosine,
        in_plane * cosine + tangential * sine,
        radial * ck + axial * sk,
    )
