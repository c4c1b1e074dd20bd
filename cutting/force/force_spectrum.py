"""Fourier series over the turn of the spindle of the force on a tool that does not vibrate.

Every slice of an edge is integrated over its arc, and the lag within it in closed form, so that the
coefficients have no aliasing however sharply a tooth enters or leaves. Which earlier pass left the
surface is decided by the thinnest chip, as everywhere in this package.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.engagement.immersion import slice_engagement
from cutting.engagement.uncut_band import UncutBand
from cutting.force.law import ForceLaw
from cutting.process_damping.viscous import ViscousProcessDamping
from cutting.tool.cutter import Cutter, EdgeSlices, edge_slices, slice_counts
from cutting.tool.tooth_passes import earlier_passes

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_TURN = 2.0 * math.pi
#: Gauss points over the arc: at least so many, and so many a cycle of the highest harmonic
_LEAST_POINTS, _POINTS_A_CYCLE = 48, 4
#: lag within a slice, rad, where the chip is the same at all heights, and elsewhere
_LAG_OF_ALIKE, _LAG_OF_OTHERS = math.inf, 0.05
_SMALLEST_CHIP = 1e-9


class ForceSpectrum(NamedTuple):
    """Coefficients c_k of sum_k c_k exp(i k theta), theta the angle of the spindle."""

    harmonic: NDArray[np.int64]  # k >= 0, in turns of the spindle, (n,)
    force: Complex  # x, y, z on the tool, N, (n, 3)
    torque: Complex  # N m, (n,)


class CouplingSpectrum(NamedTuple):
    """Coefficients of what a small motion u of the tool adds to the force.

    dF(theta) = sum_g K_g(theta) (u(theta) - u(theta - delay_g)) + D(theta) du/dtheta.
    """

    harmonic: NDArray[np.int64]  # k >= 0, (n,)
    delay: Array  # rad, (g,)
    regeneration: Complex  # K_g, N/m, (g, n, r, r)
    damping: Complex  # D, N/m (per rad of the spindle), (n, r, r)


class RigidCut:
    """Chip of every edge of a rigid tool over its arc.

    Parameters
    ----------
    cutter : Cutter
    laws : sequence of ForceLaw
        One for each tooth.
    band : UncutBand
    feed_per_tooth, axial_depth : float
        m.
    highest : int
        Highest harmonic of the turn that is wanted.
    """

    def __init__(
        self,
        cutter: Cutter,
        laws: Sequence[ForceLaw],
        band: UncutBand,
        feed_per_tooth: float,
        axial_depth: float,
        highest: int,
    ) -> None:
        self.cutter, self.laws = cutter, tuple(laws)
        slices = _slices(cutter, axial_depth)
        entry, leave = slice_engagement(band, slices.radius)
        cuts = np.flatnonzero(entry < leave)
        self.slices = slices_at(slices, cuts)
        entry, leave = entry[cuts], leave[cuts]
        points = max(
            _LEAST_POINTS, math.ceil(_POINTS_A_CYCLE * highest * _longest(entry, leave) / _TURN)
        )
        node, weight = _gauss(points)
        half = 0.5 * (leave - entry)
        self.angle = (0.5 * (leave + entry))[:, None] + half[:, None] * node
        self.weight = half[:, None] * weight
        order, ahead = earlier_passes(self.slices.angle)
        offset = self.slices.normal_offset
        inset = offset[order, np.arange(offset.shape[1])[None, :, None]] - offset[:, :, None]
        rise = feed_per_tooth * cutter.teeth * ahead / _TURN
        across = np.sin(self.slices.immersion)[:, None] * np.sin(self.angle)
        chips = rise[:, :, None, :] * across[None, :, :, None] - inset[:, :, None, :]
        thinnest = chips.argmin(axis=3)
        self.chip = np.take_along_axis(chips, thinnest[..., None], axis=3)[..., 0]
        self.delay = np.take_along_axis(
            np.broadcast_to(ahead[:, :, None, :], chips.shape), thinnest[..., None], axis=3
        )[..., 0]

    def force(self, harmonic: NDArray[np.int64]) -> ForceSpectrum:
        """Fourier series of the force and the torque at harmonics k >= 0 (n,)."""
        along = np.stack([law.force(self.chip[j]) for j, law in enumerate(self.laws)], axis=1)
        tangential, radial, axial = along * self.slices.edge_length[:, None]
        push = self._push(tangential, radial, axial)
        torque = tangential * self.slices.radius[:, None]
        series = self._series(np.concatenate([push, torque[..., None]], axis=-1), harmonic)
        return ForceSpectrum(harmonic, series[:, :3], series[:, 3])

    def coupling(
        self, harmonic: NDArray[np.int64], basis: Array, flank: ViscousProcessDamping | None
    ) -> CouplingSpectrum:
        """Fourier series of what small motions add.

        At harmonics (n,), for motion in the directions of a basis (3, r).
        """
        cuts = self.chip > 0.0
        chip = np.maximum(self.chip, _SMALLEST_CHIP * max(float(self.chip.max()), 1e-300))
        slope = np.stack([law.slope(chip[j]) for j, law in enumerate(self.laws)], axis=1)
        matrix = self._matrix(slope * cuts, basis)
        place = np.round(self.delay, 9)
        delays = np.unique(place[cuts])
        regeneration = [
            self._series(matrix * (place == delay)[..., None, None], harmonic) for delay in delays
        ]
        damping = np.zeros((harmonic.size, basis.shape[1], basis.shape[1]), dtype=np.complex128)
        if flank is not None:
            # C (b/V) r_dot with V = Omega R: over the angle of the spindle the speed drops out
            c = flank.coefficient / self.cutter.radius * cuts
            damping = self._series(
                self._matrix(np.stack([flank.friction * c, c, 0.0 * c]), basis), harmonic
            )
        return CouplingSpectrum(harmonic, delays, np.array(regeneration), damping)

    def _matrix(self, slope: Array, basis: Array) -> Array:
        """Force by the motion along the basis, N/m, (N, L, Q, r, r), from (3, N, L, Q)."""
        tangential, radial, axial = slope * self.slices.edge_length[:, None]
        push = self._push(tangential, radial, axial) @ basis
        sk, ck = (part(self.slices.immersion)[:, None] for part in (np.sin, np.cos))
        s, c = np.sin(self.angle), np.cos(self.angle)
        normal = np.stack([sk * s, sk * c, -ck * np.ones_like(s)], axis=-1) @ basis
        return push[..., :, None] * normal[..., None, :]

    def _push(self, tangential: Array, radial: Array, axial: Array) -> Array:
        """Force (..., 3) on the tool; see `cutting.tool.edge_table.force_on_tool`."""
        sk, ck = (part(self.slices.immersion)[:, None] for part in (np.sin, np.cos))
        s, c = np.sin(self.angle), np.cos(self.angle)
        plane = axial * ck - radial * sk
        return np.stack(
            [plane * s - tangential * c, plane * c + tangential * s, radial * ck + axial * sk],
            axis=-1,
        )

    def _series(self, values: Array, harmonic: NDArray[np.int64]) -> Complex:
        """Coefficients (n, ...) of the sum over all edges of values (N, L, Q, ...)."""
        teeth, pieces, points = values.shape[:3]
        flat = (
            values.reshape(teeth, pieces, points, math.prod(values.shape[3:]))
            * self.weight[:, :, None]
        )
        wave = np.exp(-1j * self.angle[:, None, :] * harmonic[:, None])
        integral = wave @ flat
        place = self.slices.angle[..., None] * harmonic
        blur = np.sinc(self.slices.lag[..., None] * harmonic / _TURN)
        turned = np.exp(1j * place) * blur
        total = np.einsum("jlk,jlkc->kc", turned, integral) / _TURN
        return total.reshape(harmonic.size, *values.shape[3:])


@lru_cache(maxsize=64)
def _gauss(points: int) -> tuple[Array, Array]:
    """Nodes and weights on (-1, 1)."""
    return np.polynomial.legendre.leggauss(points)


def _longest(entry: Array, leave: Array) -> float:
    return float((leave - entry).max()) if entry.size else 0.0


def _slices(cutter: Cutter, depth: float) -> EdgeSlices:
    alike = len(set(cutter.helix)) == 1 and cutter.serration is None
    upright = alike and cutter.edge_angle >= 0.5 * math.pi - 1e-9
    corner, straight = slice_counts(cutter, depth, _LAG_OF_OTHERS)
    if upright and straight:
        straight = slice_counts(cutter, depth, _LAG_OF_ALIKE)[1]
    return edge_slices(cutter, depth, (corner, straight))


_OF_SLICE = (
    "height",
    "thickness",
    "radius",
    "immersion",
    "edge_length",
    "tilt",
    "lower_radius",
    "upper_radius",
)
_OF_TOOTH = ("angle", "lag", "normal_offset", "offset_rise")


def slices_at(slices: EdgeSlices, indices: NDArray[np.int64]) -> EdgeSlices:
    """Some of the slices of an edge, by their indices (k,)."""
    one = {name: getattr(slices, name)[indices] for name in _OF_SLICE}
    several = {name: getattr(slices, name)[:, indices] for name in _OF_TOOTH}
    return EdgeSlices(**one, **several)
