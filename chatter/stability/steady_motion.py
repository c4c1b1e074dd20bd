"""Steady motion of a cut that does not chatter: the response to the cutting force of a revolution.

Harmonic balance: the Fourier series of the force on a rigid tool times the receptance, the
regenerated force of the cut added (the loop of the multi-frequency solution, Budak and Altintas
1998, driven at the harmonics of the period), and with a flank that ploughs its force along the
motion, by Newton steps.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, ComplexArray, IntegerArray
from chatter.engine.presets import DRIVER
from chatter.stability.model import MillingModel
from cutting.edge_segments.coupling import arc_at, delay_at, part_below, share_of_height
from cutting.edge_segments.segments import EdgeSegments
from cutting.process_damping.linear_flank import LEAST_RADIUS
from cutting.process_damping.ploughing import Ploughing
from dynamics.modal.modes import inside_band

_REVOLUTION = 2.0 * math.pi
#: delays and the period that differ by less are the same, rad
_SAME_DELAY = 1e-9
#: angle along an edge between two of its points, rad; and the most points of all edges
_BETWEEN = 0.06
_MOST_POINTS = 1500
#: samples of a period: of its fastest vibration, at the least, and at the most
_SAMPLES_PER_WAVELENGTH, _FEWEST_SAMPLES, _MOST_SAMPLES = 16.0, 512, 8192
#: harmonics reach this far beyond the highest mode, and are no more than these unknowns
_REACH = 2.0
_MOST_UNKNOWNS = 700
#: delays are taken together within this phase of the highest harmonic, rad
_PHASE = 0.2
#: Newton steps along a flank that ploughs, and the change of the path at which they end, relative
_NEWTON_STEPS, _CONVERGED = 12, 1e-3


class EdgePoints(NamedTuple):
    """Points of all edges down to a depth, each for a length of edge."""

    angle: Array  # on the tool, rad (P,)
    entry: Array  # rad (P,)
    exit: Array  # rad (P,)
    delay: Array  # angle since the pass that left the surface, rad (P,)
    immersion: Array  # axial immersion angle, rad (P,)
    radius: Array  # m (P,)
    length: Array  # m (P,)
    feed: Array  # chip = feed sin(phi) - offset, m (P,)
    offset: Array  # m (P,)
    slope: Array  # at the reference chip: tangential, radial, axial, N/m^2 (P, 3)


class RigidCut(NamedTuple):
    """Cut of a rigid tool at N samples of a period."""

    force: Array  # on the tool, N (N, r)
    coupling: Array  # of every delay, N/m (g, N, r, r)
    delay: Array  # rad (g,)


class SteadyMotion(NamedTuple):
    """Steady motion u(theta) = sum of harmonics exp(i order theta) over the spindle angle."""

    order: Array  # orders, per radian of the spindle (k,)
    harmonics: ComplexArray  # m (k, r)
    period: float  # rad
    spindle: Array  # samples of a period, rad (N,)
    points: EdgePoints
    steepest: float  # slope of the motion into the work, of the edges in the cut
    pressed: float  # dA/dq of a flank that ploughs, its mean over the cut, m^2

    def path(self, angle: Array) -> Array:
        """Change of the motion over the angle turned, m/rad (n, r), at spindle angles (n,)."""
        wave = np.exp(1j * np.outer(angle, self.order)) * (1j * self.order)
        return (wave @ self.harmonics).real


def steady_motion(model: MillingModel, speed: float, depth: float) -> SteadyMotion | None:
    """Steady motion of a cut at a constant spindle speed, rad/s, and a depth, m; None in air."""
    cut = model.cut(depth)
    points = edge_points(cut.segments, depth)
    if not points.angle.size:
        return None
    period = cut.period_angle
    modes = inside_band(model.structure.modes)
    highest = max(mode.natural_frequency for mode in modes) / speed
    orders = max(8, math.ceil(_REACH * highest * period / _REVOLUTION))
    orders = min(orders, (_MOST_UNKNOWNS // model.basis.shape[1] - 1) // 2)
    samples = int(
        np.clip(_SAMPLES_PER_WAVELENGTH * orders / _REACH, _FEWEST_SAMPLES, _MOST_SAMPLES)
    )
    orders = min(orders, samples // 2 - 1)
    order = np.arange(-orders, orders + 1) * _REVOLUTION / period
    spindle = period * (np.arange(samples) + 0.5) / samples
    receptance = _receptance(model, order * speed)
    edge = np.array(getattr(model.laws[0], "edge", (0.0, 0.0, 0.0)))
    rigid = _rigid_cut(points, cut.segments, spindle, edge, model.basis_on_tool, _PHASE / order[-1])
    loop = np.eye(order.size * model.basis.shape[1], dtype=np.complex128)
    if np.any(np.abs(points.delay - period) > _SAME_DELAY):
        # with a uniform pitch every tooth meets the wave of the last in phase
        loop += _regeneration(receptance, rigid, order)
    wave = np.exp(-1j * np.outer(order, spindle)) / samples
    driven = np.einsum("kij,kj->ki", receptance, wave @ rigid.force)
    motion = SteadyMotion(order, driven, period, spindle, points, 0.0, 0.0)
    if not isinstance(model.flank, Ploughing):
        return motion._replace(harmonics=_solved(loop, driven))
    return _with_ploughing(motion, model.flank, model, receptance, wave, loop)


def _solved(loop: ComplexArray, driven: ComplexArray) -> ComplexArray:
    return np.linalg.solve(loop, driven.ravel()).reshape(driven.shape)


def _with_ploughing(
    motion: SteadyMotion,
    flank: Ploughing,
    model: MillingModel,
    receptance: ComplexArray,
    wave: ComplexArray,
    loop: ComplexArray,
) -> SteadyMotion:
    """Motion under the force of the flank along it, by Newton steps from a bare flank."""
    pressing = flank.over_slope
    table = (pressing.steepest, pressing.area, pressing.coefficient)
    force_of = flank.indentation_force * np.array([flank.friction, 1.0])
    least = LEAST_RADIUS * model.cutter.radius
    driven, harmonics = motion.harmonics, _solved(loop, motion.harmonics)
    step, change = 1.0, np.inf
    for _ in range(_NEWTON_STEPS):
        path = motion._replace(harmonics=harmonics).path(motion.spindle)
        force, damping, steepest, pressed = _flank_along(
            motion.points, motion.spindle, path, model.basis_on_tool, force_of, table, least
        )
        beside = force - np.einsum("nij,nj->ni", damping, path)
        pushed = driven + np.einsum("kij,kj->ki", receptance, wave @ beside)
        matrix = loop - _convolved(receptance, damping, 1j * motion.order)
        wanted = _solved(matrix, pushed)
        last, change = change, np.abs(wanted - harmonics).max() / np.abs(wanted).max()
        if change > 0.7 * last:
            # the kinks of the flank can make full steps go round in circles
            step *= 0.6
        harmonics = harmonics + step * (wanted - harmonics)
        if change < _CONVERGED:
            break
    return motion._replace(harmonics=harmonics, steepest=steepest, pressed=pressed)


def edge_points(segments: EdgeSegments, depth: float) -> EdgePoints:
    """Points of all edges down to a depth, m."""
    columns: list[tuple] = []
    count = segments.bottom.size
    for segment in range(count):
        top = part_below(segments, segment, depth)
        if top <= 0.0:
            continue
        lag = abs(segments.angle[segment, 1] - segments.angle[segment, 0]) * top
        parts = min(1 + int(lag / _BETWEEN), max(1, _MOST_POINTS // count))
        for part in range(parts):
            along = top * (part + 0.5) / parts
            height = share_of_height(segments, segment, along)
            entry, leave, angle = arc_at(segments, segment, along)
            delay = delay_at(segments, segment, along)
            kappa = _between(segments.immersion[segment], along)
            sine = math.sin(kappa)
            offset = sine * _between(segments.radial_offset[segment], height)
            along_axis = segments.axial_offset[segment] + segments.axial_feed * delay
            offset += math.cos(kappa) * along_axis
            length = segments.length[segment] * top / parts
            columns.append(
                (
                    angle, entry, leave, delay, kappa, _between(segments.radius[segment], height),
                    length, sine * segments.feed * delay, offset, segments.cutting[segment],
                )
            )  # fmt: skip
    table = [np.array(column) for column in zip(*columns, strict=True)]
    return EdgePoints(*(table or [*[np.zeros(0)] * 9, np.zeros((0, 3))]))


def _between(ends: Array, share: float) -> float:
    return float(ends[0] + share * (ends[1] - ends[0]))


def directions(points: EdgePoints, p: int, phi: Array, basis: Array) -> tuple[Array, Array]:
    """Force (3 laws, N, r) per tangential, radial, axial one, and chip per displacement (N, r)."""
    s, c = np.sin(phi), np.cos(phi)
    sk, ck = math.sin(points.immersion[p]), math.cos(points.immersion[p])
    zero = np.zeros_like(s)
    push = np.array(
        [
            np.stack([-c, s, zero], axis=1),
            np.stack([-sk * s, -sk * c, zero + ck], axis=1),
            np.stack([ck * s, ck * c, zero + sk], axis=1),
        ]
    )
    chip = np.stack([sk * s, sk * c, zero - ck], axis=1)
    return push @ basis, chip @ basis


def in_cut(points: EdgePoints, p: int, spindle: Array) -> tuple:
    """Places among the samples at which a point cuts, its angles there, and the rigid chip."""
    phi = points.entry[p] + np.mod(spindle + points.angle[p] - points.entry[p], _REVOLUTION)
    chip = points.feed[p] * np.sin(phi) - points.offset[p]
    inside = np.flatnonzero((phi < points.exit[p]) & (chip > 0.0))
    return inside, phi[inside], chip[inside]


def _rigid_cut(
    points: EdgePoints,
    segments: EdgeSegments,
    spindle: Array,
    edge: Array,
    basis: Array,
    resolution: float,
) -> RigidCut:
    """Force and couplings, delays taken together to a resolution (rad)."""
    rank, samples = basis.shape[1], spindle.size
    _, first, group = np.unique(
        np.round(points.delay / resolution), return_index=True, return_inverse=True
    )
    delays = points.delay[first]
    force = np.zeros((samples, rank))
    coupling = np.zeros((delays.size, samples, rank, rank))
    for p in range(points.angle.size):
        inside, phi, chip = in_cut(points, p, spindle)
        if not inside.size:
            continue
        exponents = segments.exponent + segments.above_exponent
        ratio = np.maximum(chip / segments.reference, 1e-9)
        slopes = points.slope[p][:, None] * ratio ** exponents[:, None]
        push, chip_of = directions(points, p, phi, basis)
        slope = np.einsum("ln,lni->ni", slopes, push)
        whole = np.einsum("ln,lni->ni", slopes * chip / (1.0 + exponents[:, None]), push)
        force[inside] += points.length[p] * (whole + np.einsum("l,lni->ni", edge, push))
        coupling[group[p], inside] += points.length[p] * slope[:, :, None] * -chip_of[:, None, :]
    return RigidCut(force, coupling, delays)


def _receptance(model: MillingModel, omega: Array) -> ComplexArray:
    """Receptance (k, r, r) of the modes at angular frequencies, negative ones too."""
    natural, damping, shape, gain = model.modal_arrays
    dynamic = natural**2 - omega[:, None] ** 2 + 2j * damping * natural * omega[:, None]
    return np.einsum("km,mi,mj->kij", 1.0 / dynamic, shape, gain)


def _convolved(receptance: ComplexArray, coupling: Array, factor: ComplexArray) -> ComplexArray:
    """Motion at harmonic k by that at harmonic m times its factor, as a matrix.

    The coupling is a force by the motion at the samples of a period, (N, r, r).
    """
    samples = coupling.shape[0]
    spectrum = np.fft.fft(coupling, axis=0) / samples
    blocks = spectrum[_differences(factor.size) % samples] * factor[:, None, None]
    return _motion_by_motion(receptance, blocks, samples)


def _regeneration(receptance: ComplexArray, rigid: RigidCut, order: Array) -> ComplexArray:
    """Loop of the regenerated force -K (u - u delayed)."""
    samples, count = rigid.coupling.shape[1], order.size
    spectra = np.fft.fft(rigid.coupling, axis=1) / samples
    factors = 1.0 - np.exp(-1j * np.outer(order, rigid.delay))
    reached = spectra[:, np.arange(1 - count, count) % samples]
    by_motion = np.tensordot(factors, reached, axes=1)
    blocks = by_motion[np.arange(count)[None, :], _differences(count) + count - 1]
    return _motion_by_motion(receptance, blocks, samples)


def _differences(count: int) -> IntegerArray:
    """Harmonic of the force less that of the motion, (k, m)."""
    return np.subtract.outer(np.arange(count), np.arange(count))


def _motion_by_motion(receptance: ComplexArray, blocks: ComplexArray, samples: int) -> ComplexArray:
    """Matrix of the motion at harmonic k by that at harmonic m.

    From receptances (k, r, r) and forces at k by the motion at m (k, m, r, r), of which a period
    has so many samples.
    """
    count, _, rank, _ = blocks.shape
    # samples lie in the middle of their parts of the period
    phase = np.exp(-1j * np.pi / samples * _differences(count))
    force = (blocks * phase[:, :, None, None]).transpose(0, 2, 1, 3)
    motion = receptance @ force.reshape(count, rank, count * rank)
    return motion.reshape(count * rank, count * rank)


@njit(**DRIVER)
def _flank_along(points, spindle, path, basis, force_of, table, least_radius):
    """Force of the flank (N, r), its derivative by the path, steepest slope and mean dA/dq."""
    steepest, area, coefficient = table
    samples, rank = path.shape
    force, damping = np.zeros((samples, rank)), np.zeros((samples, rank, rank))
    push, normal = np.empty(rank), np.empty(rank)
    last, largest = area.shape[0] - 1, 0.0
    engaged, summed = 0.0, 0.0
    for p in range(points.angle.shape[0]):
        sk, ck = math.sin(points.immersion[p]), math.cos(points.immersion[p])
        radius = max(points.radius[p], least_radius)
        for n in range(samples):
            past = (spindle[n] + points.angle[p] - points.entry[p]) / _REVOLUTION
            phi = points.entry[p] + (past - math.floor(past)) * _REVOLUTION
            s, c = math.sin(phi), math.cos(phi)
            if phi >= points.exit[p] or points.feed[p] * s <= points.offset[p]:
                continue
            slope = 0.0
            for i in range(rank):
                normal[i] = sk * (s * basis[0, i] + c * basis[1, i]) - ck * basis[2, i]
                push[i] = -force_of[1] * normal[i]
                push[i] += force_of[0] * (s * basis[1, i] - c * basis[0, i])
                slope += normal[i] * path[n, i] / radius
            largest = max(largest, abs(slope))
            place = min(max(0.5 * (slope / steepest + 1.0) * last, 0.0), last - 1e-9)
            low = int(place)
            share = place - low
            rate = coefficient[low] + share * (coefficient[low + 1] - coefficient[low])
            engaged, summed = engaged + points.length[p], summed + points.length[p] * rate
            pressed = area[low] + share * (area[low + 1] - area[low])
            # beyond the table the last rate goes on
            pressed += rate * (slope - min(max(slope, -steepest), steepest))
            for i in range(rank):
                force[n, i] += points.length[p] * pressed * push[i]
                for j in range(rank):
                    part = points.length[p] * rate / radius * push[i] * normal[j]
                    damping[n, i, j] += part
    return force, damping, largest, summed / max(engaged, 1e-300)
