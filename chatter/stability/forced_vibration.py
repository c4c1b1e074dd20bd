"""Forced vibration in the steady cut, and the loss of contact that it causes.

The linear methods assume that every tooth cuts what the tooth before it has left. In the steady cut
the tool vibrates at the harmonics of its rotation. With a uniform pitch every tooth meets the wave
of the last in phase and cuts the chip of a rigid tool; else the chip changes by the vibration now
less that when the earlier tooth passed, and where this exceeds the chip the tooth loses contact.
"""

import math
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array, ComplexArray
from chatter.description.units import rpm
from chatter.stability.model import MillingModel
from chatter.stability.stability_method import StabilityMethod
from cutting.edge_segments.coupling import arc_at, delay_at, part_below, share_of_height
from cutting.edge_segments.segments import EdgeSegments

_REVOLUTION = 2.0 * math.pi
#: delays and the period that differ by less are the same, rad
_SAME_DELAY = 1e-9
#: angle along an edge between two of its points, rad; and the most points of all edges
_BETWEEN = 0.06
_MOST_POINTS = 1500
#: samples of a period: of its fastest vibration, at the least, and at the most
_SAMPLES_PER_WAVELENGTH, _FEWEST_SAMPLES, _MOST_SAMPLES = 16.0, 512, 8192
#: harmonics reach this far beyond the highest mode; up to this many unknowns the cut answers to
#: the vibration, beyond only the machine does
_REACH = 2.0
_MOST_UNKNOWNS = 700
#: delays are taken together within this phase of the highest harmonic, rad
_PHASE = 0.2
#: share of the arc lost, or of the chip changed, from which on it is reported: the multipliers of
#: random cuts in simulations are off by 25 % in the median beyond these, below them by 0.7 %
_REPORTED_LOSS, _LARGE_CHANGE = 0.08, 0.6


class EdgePoints(NamedTuple):
    """Points of all edges down to a depth, each for a length of edge."""

    angle: Array  # on the tool, rad (P,)
    entry: Array  # rad (P,)
    exit: Array  # rad (P,)
    delay: Array  # angle since the pass that left the surface, rad (P,)
    immersion: Array  # axial immersion angle, rad (P,)
    length: Array  # m (P,)
    feed: Array  # chip = feed sin(phi) - offset, m (P,)
    offset: Array  # m (P,)
    slope: Array  # at the reference chip: tangential, radial, axial, N/m^2 (P, 3)


class RigidCut(NamedTuple):
    """Cut of a rigid tool at N samples of a period."""

    force: Array  # on the tool, N (N, r)
    coupling: Array  # of every delay, N/m (g, N, r, r)
    delay: Array  # rad (g,)


class ForcedVibration(NamedTuple):
    """Steady vibration of a linear cut at one speed and depth."""

    amplitude: float  # largest distance from the mean position, m
    chip_change: float  # largest, m
    chip: float  # largest of a rigid tool, m
    loss_of_contact: float  # share of the cut of a rigid tool that has no chip left


def forced_vibration(model: MillingModel, speed: float, depth: float) -> ForcedVibration | None:
    """Steady vibration of a cut and what it does to the chip; None with a uniform pitch.

    At a constant spindle speed, rad/s, and a depth, m. Harmonic balance: the Fourier series of the
    force on a rigid tool times the receptance, the regenerated force of the cut added (the loop of
    the multi-frequency solution, Budak and Altintas 1998, driven at the harmonics of the period).
    """
    if model.case.cut.speed_variation is not None:
        return None
    cut = model.cut(depth)
    points = _edge_points(cut.segments, depth)
    period = cut.period_angle
    if not points.angle.size or np.all(np.abs(points.delay - period) < _SAME_DELAY):
        return None
    highest = max(mode.natural_frequency for mode in model.structure.modes)
    orders = max(8, math.ceil(_REACH * highest * period / (_REVOLUTION * speed)))
    samples = int(
        np.clip(_SAMPLES_PER_WAVELENGTH * orders / _REACH, _FEWEST_SAMPLES, _MOST_SAMPLES)
    )
    orders = min(orders, samples // 2 - 1)
    turn = np.arange(-orders, orders + 1) * _REVOLUTION / period
    spindle = period * (np.arange(samples) + 0.5) / samples
    receptance = _receptance(model, turn * speed)
    edge = np.array(getattr(model.laws[0], "edge", (0.0, 0.0, 0.0)))
    rigid = _rigid_cut(points, cut.segments, spindle, edge, model.basis, _PHASE / turn[-1])
    wave = np.exp(-1j * np.outer(turn, spindle)) / samples
    driven = np.einsum("kij,kj->ki", receptance, wave @ rigid.force)
    if driven.size <= _MOST_UNKNOWNS:
        driven = _with_regeneration(driven, receptance, rigid, turn)
    driven[orders] = 0.0
    return _vibration_of(points, driven, turn, spindle, model.basis)


def notes_on_steady_cut(model: MillingModel, method: StabilityMethod) -> tuple[str, ...]:
    """Say where the steady cut of a case is another than linear methods take it for."""
    speed, depth = model.case.cut.spindle_speed, model.case.cut.axial_depth
    found = forced_vibration(model, speed, depth) if method.is_linear else None
    if found is None:
        return ()
    if found.loss_of_contact < _REPORTED_LOSS and found.chip_change < _LARGE_CHANGE * found.chip:
        return ()
    return (
        f"at {rpm(speed):.0f} rpm and {depth * 1e3:.3g} mm the forced vibration of "
        f"{found.amplitude * 1e6:.3g} um changes the chip of {found.chip * 1e6:.3g} um by up to "
        f"{found.chip_change * 1e6:.3g} um: teeth lose contact over {found.loss_of_contact:.0%} of "
        "their arc, which linear methods leave out; the limit in the time domain may differ "
        "(--method time-domain)",
    )


def _edge_points(segments: EdgeSegments, depth: float) -> EdgePoints:
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
            offset += math.cos(kappa) * segments.axial_offset[segment]
            length = segments.length[segment] * top / parts
            columns.append(
                (
                    angle, entry, leave, delay, kappa, length, sine * segments.feed * delay,
                    offset, segments.cutting[segment],
                )
            )  # fmt: skip
    table = [np.array(column) for column in zip(*columns, strict=True)]
    return EdgePoints(*(table or [*[np.zeros(0)] * 8, np.zeros((0, 3))]))


def _between(ends: Array, share: float) -> float:
    return float(ends[0] + share * (ends[1] - ends[0]))


def _directions(points: EdgePoints, p: int, phi: Array, basis: Array) -> tuple[Array, Array]:
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


def _in_cut(points: EdgePoints, p: int, spindle: Array) -> tuple:
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
        inside, phi, chip = _in_cut(points, p, spindle)
        if not inside.size:
            continue
        size = np.maximum(chip / segments.reference, 1e-9) ** segments.exponent
        push, chip_of = _directions(points, p, phi, basis)
        slope = np.einsum("l,lni->ni", points.slope[p], push) * size[:, None]
        whole = slope * (chip / (1.0 + segments.exponent))[:, None]
        force[inside] += points.length[p] * (whole + np.einsum("l,lni->ni", edge, push))
        coupling[group[p], inside] += points.length[p] * slope[:, :, None] * -chip_of[:, None, :]
    return RigidCut(force, coupling, delays)


def _receptance(model: MillingModel, omega: Array) -> ComplexArray:
    """Receptance (k, r, r) at angular frequencies, negative ones too."""
    lines, values = model.receptance
    at = np.abs(omega) / _REVOLUTION
    flat = values.reshape(lines.size, -1).T
    found = np.stack(
        [np.interp(at, lines, v.real) + 1j * np.interp(at, lines, v.imag) for v in flat]
    )
    found = np.where(omega < 0.0, found.conj(), found)
    return found.T.reshape(omega.size, *values.shape[1:])


def _with_regeneration(
    driven: ComplexArray, receptance: ComplexArray, rigid: RigidCut, turn: Array
) -> ComplexArray:
    """Motion (k, r) where the cut answers to it: force = rigid force - K (u - u delayed)."""
    count, rank = driven.shape
    samples = rigid.coupling.shape[1]
    spectrum = np.fft.fft(rigid.coupling, axis=1) / samples
    difference = np.subtract.outer(np.arange(count), np.arange(count))
    # samples lie in the middle of their parts of the period
    shift = np.exp(-1j * np.pi / samples * difference)
    loop = np.zeros((count, rank, count, rank), dtype=np.complex128)
    for part, delay in zip(spectrum, rigid.delay, strict=True):
        factor = shift * (1.0 - np.exp(-1j * turn * delay))
        loop += np.einsum(
            "kij,kmjl->kiml", receptance, part[difference % samples] * factor[:, :, None, None]
        )
    matrix = loop.reshape(count * rank, count * rank) + np.eye(count * rank)
    return np.linalg.solve(matrix, driven.ravel()).reshape(count, rank)


def _vibration_of(
    points: EdgePoints, driven: ComplexArray, turn: Array, spindle: Array, basis: Array
) -> ForcedVibration:
    wave = np.exp(1j * np.outer(spindle, turn))
    motion = (wave @ driven).real
    cut, loss_of_contact, largest, change = 0.0, 0.0, 0.0, 0.0
    for p in range(points.angle.size):
        inside, phi, chip = _in_cut(points, p, spindle)
        if not inside.size:
            continue
        earlier = (wave[inside] @ (np.exp(-1j * turn * points.delay[p])[:, None] * driven)).real
        _, chip_of = _directions(points, p, phi, basis)
        vibrating = np.einsum("ni,ni->n", chip_of, motion[inside] - earlier)
        cut += points.length[p] * chip.size
        loss_of_contact += points.length[p] * np.count_nonzero(chip + vibrating <= 0.0)
        largest = max(largest, float(chip.max()))
        change = max(change, float(np.abs(vibrating).max()))
    amplitude = float(np.linalg.norm(motion - motion.mean(axis=0), axis=1).max())
    return ForcedVibration(amplitude, change, largest, float(loss_of_contact / max(cut, 1e-300)))
