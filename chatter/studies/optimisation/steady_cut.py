"""The stable cut: periodic motion, power, torque, and where it leaves the wall.

A stable cut settles into a motion u that repeats as the tool does. Its harmonics follow from those
of the force on the rigid tool by the receptance of the modes,

    u_k = G(k Omega) (F_k + sum_m [sum_g K_g,k-m (1 - exp(-i m delay_g)) + i m D_k-m] u_m).

Where all teeth are alike, u repeats from tooth to tooth, every tooth meets what the one before it
has left in the same way, and the sum over g vanishes: the rigid force is all there is (Schmitz and
Mann 2006, Int. J. Mach. Tools Manuf. 46:1487). Unequal pitch, runout and process damping need the
whole. The chip is taken as linear in u: no tooth leaves the cut because it vibrates.
"""

import math
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array, ComplexArray, IntegerArray
from chatter.stability.model import MillingModel
from cutting.edge_segments.segments import period_angle
from cutting.engagement.immersion import slice_engagement
from cutting.force.force_spectrum import ForceSpectrum, RigidCut, slices_at
from cutting.tool.cutter import EdgeSlices, corner_height, edge_slices
from dynamics.modal.modes import inside_band, receptance_matrix

_REVOLUTION = 2.0 * math.pi
#: harmonics reach to this multiple of the highest mode, and over so many of the period at least
_HIGHEST = 3.0
_LEAST_HARMONICS, _MOST_HARMONICS = 8, 400
#: harmonics up to this multiple of the highest mode act on each other; those above follow the rigid
#: force
_HIGHEST_COUPLED, _MOST_COUPLED = 1.6, 120
#: points within the period, a harmonic
_POINTS_A_HARMONIC = 8
#: slices of the wall, whose middles are heights, as in simulated surfaces; every so many of them,
#: and the last, are evaluated
_HEIGHTS, _EVERY = 40, 3
#: points along the feed of a turn, where teeth leave arcs of their own height
_POINTS_ALONG = 48
#: derivatives of the motion, steps and range (rad) of the search for the furthest reach of an edge
_DERIVATIVES, _NEWTON_STEPS, _WIDEST_SHIFT = 5, 4, 0.25
#: points of motion at once
_MOST_POINTS = 4_000_000
#: direction in which an edge points at the wall, and sign of y there
_WALL = {"+y": (0.0, 1.0), "-y": (math.pi, -1.0)}


class SteadyCuts(NamedTuple):
    """What stable cuts of one depth do at n speeds."""

    power: Array  # mean over a turn, W (n,)
    torque: Array  # mean over a turn, N m (n,)
    deflection: Array  # largest displacement of tool against work within a turn, m (n,)
    surface_error: Array  # where it is largest over the height, m; positive: too much removed (n,)


class SteadyModel:
    """Steady cuts of a case at its radial depth and feed; speed and axial depth left open.

    The slowest spindle speed that will be asked for, rad/s, decides how many harmonics count.
    """

    def __init__(self, model: MillingModel, slowest: float) -> None:
        self.model = model
        self.modes = model.structure.modes
        #: harmonics of the turn from one that can be there to the next
        self.stride = round(_REVOLUTION / period_angle(model.cutter))
        highest = max(mode.frequency for mode in inside_band(self.modes))
        wanted = math.ceil(_HIGHEST * highest * _REVOLUTION / slowest / self.stride)
        count = min(max(wanted, _LEAST_HARMONICS), _MOST_HARMONICS)
        self.harmonic = self.stride * np.arange(count + 1)

    def rigid_cut(self, depth: float, highest: int) -> RigidCut:
        """Chip of the rigid tool at an axial depth, m."""
        case, model = self.model.case, self.model
        return RigidCut(
            model.cutter, model.laws, case.uncut_band, case.cut.feed_per_tooth, depth, highest
        )

    def cuts(self, speeds: Array, depth: float) -> SteadyCuts:
        """Steady cuts at spindle speeds (n,), rad/s, and an axial depth, m."""
        rigid = self.rigid_cut(depth, int(self.harmonic[-1]))
        spectrum = rigid.force(self.harmonic)
        motion = self.motion(speeds, rigid, spectrum)
        torque = float(spectrum.torque[0].real)
        return SteadyCuts(
            power=torque * speeds,
            torque=np.full(speeds.size, torque),
            deflection=np.concatenate([_peak(part) for part in self._in_parts(motion)]),
            surface_error=self._surface_error(motion, depth),
        )

    def torques(self, depths: Array) -> Array:
        """Mean torque (m,) over a turn at axial depths (m,), N m: motion has no part in it."""
        mean = np.zeros(1, dtype=np.int64)
        return np.array(
            [self.rigid_cut(float(depth), 0).force(mean).torque[0].real for depth in depths]
        )

    def motion(self, speeds: Array, rigid: RigidCut, spectrum: ForceSpectrum) -> ComplexArray:
        """Harmonics u_k (n, k, 3) of the motion of the tool against the work, m."""
        frequency = np.outer(speeds, self.harmonic) / _REVOLUTION
        receptance = receptance_matrix(self.modes, frequency.ravel())
        receptance = receptance.reshape(*frequency.shape, 3, 3)
        motion = np.einsum("nkab,kb->nka", receptance, spectrum.force)
        flank = self.model.dashpot
        if self.stride == self.model.teeth and flank is None:
            return motion
        counts = self._coupled_counts(speeds)
        feedback = self._feedback(rigid, int(counts.max()))
        for count in np.unique(counts):
            alike = np.flatnonzero(counts == count)
            motion[alike, :count] = self._coupled(
                feedback, receptance[alike, :count], motion[alike, :count]
            )
        return motion

    def _coupled_counts(self, speeds: Array) -> IntegerArray:
        """Harmonics (n,) that act on each other, in few steps of about a factor of 1.4."""
        highest = max(mode.frequency for mode in inside_band(self.modes))
        wanted = _HIGHEST_COUPLED * highest * _REVOLUTION / speeds / self.stride
        steps = np.ceil(2.0 * np.log2(np.maximum(wanted, _LEAST_HARMONICS)))
        most = min(self.harmonic.size, _MOST_COUPLED + 1)
        return np.minimum(np.ceil(2.0 ** (0.5 * steps)).astype(np.int64) + 1, most)

    def _coupled(
        self, feedback: ComplexArray, receptance: ComplexArray, rigid_motion: ComplexArray
    ) -> ComplexArray:
        """Harmonics (n, k, 3) with what the motion itself adds to the force."""
        basis, count = self.model.basis, rigid_motion.shape[1]
        middle = (len(feedback) - 1) // 2
        near = slice(middle - count + 1, middle + count)
        feedback = np.ascontiguousarray(feedback[near, :, near])
        rank, size = basis.shape[1], 2 * count - 1
        within = np.einsum("ai,nkab,bj->nkij", basis, receptance, basis)
        both = np.concatenate([within[:, :0:-1].conj(), within], axis=1)
        start = rigid_motion @ basis
        start = np.concatenate([start[:, :0:-1].conj(), start], axis=1)
        found = np.empty_like(start)
        eye = np.eye(size * rank)
        for n in range(len(start)):
            answer = np.einsum("kij,kjml->kiml", both[n], feedback)
            matrix = eye - answer.reshape(size * rank, size * rank)
            found[n] = np.linalg.solve(matrix, start[n].reshape(-1)).reshape(size, rank)
        return found[:, count - 1 :] @ basis.T

    def _feedback(self, rigid: RigidCut, count: int) -> ComplexArray:
        """Force at harmonic k by motion at harmonic m, N/m, (k, r, m, r), of both signs."""
        wanted = self.stride * np.arange(2 * count - 1)
        coupling = rigid.coupling(wanted, self.model.basis, self.model.dashpot)
        signed = np.arange(1 - count, count)
        apart = signed[:, None] - signed[None, :]
        turn = self.stride * signed
        total = 1j * turn[:, None, None] * _at(coupling.damping, apart)
        for delay, series in zip(coupling.delay, coupling.regeneration, strict=True):
            since = 1.0 - np.exp(-1j * turn * delay)
            total = total + since[:, None, None] * _at(series, apart)
        return np.moveaxis(total, 2, 1)

    def _in_parts(self, motion: ComplexArray) -> list[ComplexArray]:
        points = _POINTS_A_HARMONIC * motion.shape[1] * 3
        count = max(1, math.ceil(len(motion) * points / _MOST_POINTS))
        return np.array_split(motion, count)

    def _surface_error(self, motion: ComplexArray, depth: float) -> Array:
        """Location error (n,) of the walls at the height where it is largest, m."""
        slices = self._wall_slices(depth)
        sides = self.model.case.uncut_band.walls(self.model.cutter.radius)
        if not sides:
            return np.zeros(len(motion))
        walls = [self._wall(motion, slices, side) for side in sides]
        error = np.concatenate(walls, axis=1)
        return error[np.arange(len(error)), np.abs(error).argmax(axis=1)]

    def _wall_slices(self, depth: float) -> EdgeSlices:
        """Slices whose middles are the heights that are evaluated: the straight edge if it cuts."""
        cutter = self.model.cutter
        top = corner_height(cutter)
        if depth > top:
            slices = edge_slices(cutter, depth, (0 if top == 0.0 else 2, _HEIGHTS))
            chosen = slices.immersion >= cutter.edge_angle - 1e-9
        else:
            slices = edge_slices(cutter, depth, (_HEIGHTS, 0))
            entry, leave = slice_engagement(self.model.case.uncut_band, slices.radius)
            chosen = entry < leave
        levels = np.flatnonzero(chosen)
        return slices_at(slices, np.unique(np.append(levels[::_EVERY], levels[-1])))

    def _wall(self, motion: ComplexArray, slices: EdgeSlices, side: str) -> Array:
        """Location error (n, L) of a wall: mean of the envelope of all passes, m.

        An edge that passes with a speed along the wall's normal reaches furthest a little before or
        after it points there. All its passes do so alike, and what stands is made by that furthest
        reach, the largest y(theta) + R (cos(theta - theta_0) - 1), and not by y(theta_0).
        """
        direction, sign = _WALL[side]
        sk, ck = np.sin(slices.immersion), np.cos(slices.immersion)
        # spindle angle at which each edge points at the wall
        passing = direction - slices.angle
        tooth, level = passing.shape
        wave = np.where(self.harmonic == 0, 1.0, 2.0) * np.exp(
            1j * passing.reshape(-1, 1) * self.harmonic
        )
        turn = (1j * self.harmonic) ** np.arange(_DERIVATIVES + 1)[:, None]
        outwards = (motion[..., 1] * sign)[:, None, None, :] * sk[:, None] - (
            motion[..., 2][:, None, None, :] * ck[:, None]
        )
        taylor = [
            np.einsum("nalk,ajlk->njl", outwards, (wave * power).reshape(1, tooth, level, -1)).real
            for power in turn
        ]
        reach = _furthest(taylor, slices.radius * sk) + slices.normal_offset
        cut = self.model.case.cut
        feed = cut.feed_per_tooth * tooth
        position = feed * np.mod(passing, _REVOLUTION) / _REVOLUTION
        if self.stride == tooth:
            # cusps between arcs of one height have a mean of a twelfth of f^2/2R
            return reach[:, 0] - sk * (feed / tooth) ** 2 / (24.0 * slices.radius)
        return _mean_envelope(reach, position, feed, sk / (2.0 * slices.radius))


def _mean_envelope(reach: Array, position: Array, feed: float, curvature: Array) -> Array:
    """Mean along the feed (n, L) of the highest of parabolas, m.

    `reach` (n, N, L) is the top of the arc that each tooth leaves, m, `position` (N, L) where that
    is along the feed of a turn, m, `curvature` (L,) that of the arcs, half of 1/R, 1/m.
    """
    along = (np.arange(_POINTS_ALONG) + 0.5) / _POINTS_ALONG * feed
    highest = np.full((reach.shape[0], reach.shape[2], _POINTS_ALONG), -np.inf)
    for tooth in range(reach.shape[1]):
        apart = np.abs(along - position[tooth][:, None])
        # a tooth comes by again a turn later; the nearest of its arcs is the highest
        apart = np.minimum(apart, feed - apart)
        arc = reach[:, tooth, :, None] - curvature[:, None] * apart**2
        np.maximum(highest, arc, out=highest)
    return highest.mean(axis=2)


def _furthest(taylor: list[Array], radius: Array) -> Array:
    """Largest value near 0 of y(delta) - R (1 - cos delta), y given by its derivatives."""
    shift = np.zeros_like(taylor[0])
    for _ in range(_NEWTON_STEPS):
        slope = _polynomial(taylor[1:], shift) - radius * np.sin(shift)
        bend = np.maximum(radius * np.cos(shift) - _polynomial(taylor[2:], shift), 0.1 * radius)
        shift = np.clip(shift + slope / bend, -_WIDEST_SHIFT, _WIDEST_SHIFT)
    reached = _polynomial(taylor, shift) - radius * (1.0 - np.cos(shift))
    return np.maximum(taylor[0], reached)


def _polynomial(derivatives: list[Array], shift: Array) -> Array:
    """Taylor polynomial at a shift, by Horner's scheme."""
    total = np.zeros_like(shift)
    for order in range(len(derivatives) - 1, -1, -1):
        total = derivatives[order] + total * shift / (order + 1)
    return total


def _at(series: ComplexArray, apart: IntegerArray) -> ComplexArray:
    """Coefficients (k, m, r, r) of a real function at differences of either sign."""
    found = series[np.abs(apart)]
    return np.where((apart < 0)[..., None, None], found.conj(), found)


def _peak(series: ComplexArray) -> Array:
    """Largest length (n,) within the period of vectors given by harmonics (n, k, c)."""
    count = _POINTS_A_HARMONIC * series.shape[1]
    motion = np.fft.irfft(series, count, axis=1) * count
    return np.sqrt((motion**2).sum(axis=2).max(axis=1))
