"""Multi-frequency solution in the frequency domain, straight from FRFs, by the argument principle.

Motion that grows as exp(s t) times a function of the period holds the frequencies s + i l W, W that
of the period. With the receptance G and the Fourier coefficients H_k of the directional matrix the
cut closes the loop between them (Budak and Altintas 1998; Merdol and Altintas 2004),

    det A(s) = 0,   A_lm = delta_lm I + G(s + i l W) sum_g H_g,l-m (1 - exp(-(s + i m W) tau_g)).

A cut is stable where no root lies right of the imaginary axis; how many do is the number of turns
that det A(i w) makes as w runs over one W, since G has no poles there. A verdict needs no root. One
harmonic alone is the zeroth-order solution; the harmonics kept reach beyond the highest resonance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import sweep
from chatter.engine.presets import DRIVER, KERNEL
from chatter.stability.crossings import find_crossings
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.methods.collocation.cut_arrays import CutArrays
from cutting.edge_segments.coupling import coupling_at, part_below, radius_at, share_of_height

#: harmonics reach this far beyond the highest resonance
_REACH = 4.0
_FEWEST, _MOST = 3, 60
#: or no less than this far where so many are not enough: limits are then good to 0.2 %
_LEAST_REACH = 1.0
#: largest turn of the determinant from one frequency to the next, rad, and the finest step
_LARGEST_TURN = 0.7
_FEWEST_LINES = 24
#: the receptance changes by no more than this share of itself from one frequency to the next; what
#: it is below the other share of its peak does not count
_LARGEST_CHANGE, _BELOW_PEAK = 0.5, 0.02
#: frequencies at which the determinant of a limit is looked at, four times around its least
_LINES_HEARD = 41
_FINEST = 1e-7
#: a limit is found when its bracket is this small, relative to the depth
_DEPTH_TOLERANCE = 1e-4
#: delays vary by no more than this along a part of a piece, and differ by more to be two, rad
_SAME_DELAY, _ONE_DELAY = 4e-3, 1e-9
_MOST_PARTS = 48
#: phase of the highest order along a part up to which two Gauss points do, and three, rad
_SHORT_PART, _LONG_PART = 0.5, 1.5


class FrequencyResponse(NamedTuple):
    """Relative receptance in r directions over frequency."""

    omega: NDArray[np.float64]  # rad/s (m,)
    receptance: NDArray[np.complex128]  # m/N (m, r, r)


class Harmonics(NamedTuple):
    """Fourier coefficients of the couplings at one depth, orders -K .. K."""

    delay: NDArray[np.float64]  # rad (g,)
    stiffness: NDArray[np.complex128]  # N/m (g, 2K + 1, r, r)
    dashpot: NDArray[np.complex128]  # N s/m times the spindle speed (2K + 1, r, r)


@njit(**KERNEL)
def _parts(pieces, piece, top, highest):
    """Parts of a piece along the edge, each of one delay, that the highest order resolves."""
    varies = abs(pieces.delay[piece, 1] - pieces.delay[piece, 0])
    turned = abs(pieces.angle[piece, 1] - pieces.angle[piece, 0])
    return min(1 + int(varies / _SAME_DELAY) + int(turned * top * highest / 6.0), _MOST_PARTS)


@njit(**KERNEL)
def _points_along(pieces, piece, top, parts, highest):
    """Gauss points along a part: two or three do where it is short for the highest order."""
    turned = abs(pieces.angle[piece, 1] - pieces.angle[piece, 0])
    widened = max(
        abs(pieces.entry[piece, 1] - pieces.entry[piece, 0]),
        abs(pieces.exit[piece, 1] - pieces.exit[piece, 0]),
    )
    phase = highest * (turned + widened) * top / parts
    if pieces.exponent != 0.0 or phase > _LONG_PART:
        return 6
    return 2 if phase < _SHORT_PART else 3


@njit(**KERNEL)
def _delay_at(pieces, piece, place):
    """Angle since the pass that left the surface at a place along a piece, rad."""
    first, last = pieces.delay[piece, 0], pieces.delay[piece, 1]
    return first + share_of_height(pieces, piece, place) * (last - first)


@njit(**KERNEL)
def _distinct_delays(pieces, depth, highest):
    """Delays of all parts down to a depth, each once, ascending, rad."""
    count = 0
    for piece in range(pieces.bottom.shape[0]):
        count += _parts(pieces, piece, 1.0, highest)
    delays = np.empty(count)
    count = 0
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        parts = _parts(pieces, piece, top, highest)
        for share in range(parts):
            delays[count] = _delay_at(pieces, piece, top * (share + 0.5) / parts)
            count += 1
    delays = np.sort(delays[:count])
    used = min(1, count)
    for i in range(1, count):
        if delays[i] - delays[used - 1] > _ONE_DELAY:
            delays[used] = delays[i]
            used += 1
    return delays[:used].copy()


@njit(**KERNEL)
def _arc_at(pieces, piece, place):
    """Entry and exit at a place along a piece, and its angle on the tool, rad."""
    entry, leave = pieces.entry[piece, 0], pieces.exit[piece, 0]
    entry += place * (pieces.entry[piece, 1] - entry)
    leave += place * (pieces.exit[piece, 1] - leave)
    turned = pieces.angle[piece, 1] - pieces.angle[piece, 0]
    return entry, leave, pieces.angle[piece, 0] + share_of_height(pieces, piece, place) * turned


@njit(**KERNEL)
def _add_by_quadrature(cut, piece, place, length, speed_factor, orders, stiffness, dashpot):
    """Add the coefficients of a place along a piece that stands for a length of edge, m."""
    pieces = cut.pieces
    rank = cut.shape.shape[1]
    base = 2.0 * math.pi / cut.period_angle
    part, part_dashpot = np.empty((rank, rank)), np.empty((rank, rank))
    entry, leave, at = _arc_at(pieces, piece, place)
    spans = 2 + int((leave - entry) * orders * base / 4.0)
    for span in range(spans):
        for q in range(12):
            share = (span + cut.edge_place[12, q]) / spans
            # crowded towards the ends: a chip may vanish there, the slope of the law is infinite
            x = share * share * share * (10.0 - 15.0 * share + 6.0 * share * share)
            spindle = entry + x * (leave - entry) - at
            weight = 30.0 * (share * (1.0 - share)) ** 2 * (leave - entry)
            weight *= cut.edge_weight[12, q] / spans * length / (2.0 * math.pi)
            coupling_at(
                pieces, piece, place, spindle, weight, speed_factor, cut.basis, part, part_dashpot
            )
            turn = np.exp(-1j * base * spindle)
            wave = np.exp(1j * base * spindle * orders)
            for k in range(2 * orders + 1):
                for i in range(rank):
                    for j in range(rank):
                        stiffness[k, i, j] += wave * part[i, j]
                        if speed_factor > 0.0:
                            dashpot[k, i, j] += wave * part_dashpot[i, j]
                wave *= turn


@njit(**KERNEL)
def _add_exactly(cut, piece, place, length, speed_factor, orders, stiffness, dashpot):
    """Do the same where the force is linear in the chip.

    The coupling is then a trigonometric polynomial of the second degree in the immersion angle:
    five samples of it give its terms, and the integral of each against a wave is known.
    """
    pieces = cut.pieces
    rank = cut.shape.shape[1]
    base = 2.0 * math.pi / cut.period_angle
    part, part_dashpot = np.empty((rank, rank)), np.empty((rank, rank))
    terms = np.zeros((2, 5, rank, rank), dtype=np.complex128)
    entry, leave, at = _arc_at(pieces, piece, place)
    for sample in range(5):
        phi = 0.4 * math.pi * sample
        coupling_at(
            pieces, piece, place, phi - at, length / (2.0 * math.pi), speed_factor, cut.basis,
            part, part_dashpot,
        )  # fmt: skip
        for n in range(5):
            wave = np.exp(-1j * (n - 2) * phi) / 5.0
            terms[0, n] += wave * part
            if speed_factor > 0.0:
                terms[1, n] += wave * part_dashpot
    middle, half = 0.5 * (entry + leave), 0.5 * (leave - entry)
    for k in range(2 * orders + 1):
        order = (k - orders) * base
        for n in range(5):
            rest = n - 2 - order
            size = 2.0 * half if abs(rest) < 1e-9 else 2.0 * math.sin(rest * half) / rest
            wave = size * np.exp(1j * (rest * middle + order * at))
            for i in range(rank):
                for j in range(rank):
                    stiffness[k, i, j] += wave * terms[0, n, i, j]
                    if speed_factor > 0.0:
                        dashpot[k, i, j] += wave * terms[1, n, i, j]


@njit(**DRIVER)
def harmonics_at(cut, depth, orders):
    """Fourier coefficients of the couplings over a period of the tool, orders -K .. K.

    Parameters
    ----------
    cut : CutArrays
    depth : float
        m.
    orders : int
        K.

    Returns
    -------
    Harmonics
    """
    pieces = cut.pieces
    rank = cut.shape.shape[1]
    highest = orders * 2.0 * math.pi / cut.period_angle
    delays = _distinct_delays(pieces, depth, highest)
    stiffness = np.zeros((delays.size, 2 * orders + 1, rank, rank), dtype=np.complex128)
    dashpot = np.zeros((2 * orders + 1, rank, rank), dtype=np.complex128)
    speed_factor = 1.0 / radius_at(pieces, depth) if pieces.damping[1] > 0.0 else 0.0
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        if top <= 0.0:
            continue
        parts = _parts(pieces, piece, top, highest)
        points = _points_along(pieces, piece, top, parts, highest)
        for share in range(parts):
            delay = _delay_at(pieces, piece, top * (share + 0.5) / parts)
            own = max(0, np.searchsorted(delays, delay, side="right") - 1)
            for along in range(points):
                place = top * (share + cut.edge_place[points, along]) / parts
                length = pieces.length[piece] * top / parts * cut.edge_weight[points, along]
                if pieces.exponent == 0.0:
                    _add_exactly(
                        cut, piece, place, length, speed_factor, orders, stiffness[own], dashpot
                    )
                    continue
                _add_by_quadrature(
                    cut, piece, place, length, speed_factor, orders, stiffness[own], dashpot
                )
    return Harmonics(delays, stiffness, dashpot)


@njit(**KERNEL)
def _receptance_at(response, omega, out):
    """Set out (r, r) to the receptance at a frequency, negative ones too."""
    lines = response.omega
    w = abs(omega)
    last = lines.shape[0] - 1
    if w <= lines[0]:
        low, t = 0, 0.0
    elif w >= lines[last]:
        low, t = last - 1, 1.0
    else:
        low = np.searchsorted(lines, w, side="right") - 1
        t = (w - lines[low]) / (lines[low + 1] - lines[low])
    # above what was measured the masses alone are left
    fade = (lines[last] / w) ** 2 if w > lines[last] else 1.0
    rank = out.shape[0]
    for i in range(rank):
        for j in range(rank):
            a, b = response.receptance[low, i, j], response.receptance[low + 1, i, j]
            value = fade * (a + t * (b - a))
            out[i, j] = value if omega >= 0.0 else value.conjugate()


@njit(**KERNEL)
def _loop(response, harmonics, speed, base, omega, count, matrix):
    """Set matrix ((2 count + 2) r)^2 to A(i omega); harmonics -count - 1 .. count."""
    rank = response.receptance.shape[1]
    orders = (harmonics.dashpot.shape[0] - 1) // 2
    receptance = np.empty((rank, rank), dtype=np.complex128)
    coupling = np.empty((rank, rank), dtype=np.complex128)
    size = 2 * count + 2
    factor = np.empty(harmonics.delay.shape[0], dtype=np.complex128)
    for m in range(size):
        w = omega + (m - count - 1) * base
        for g in range(factor.shape[0]):
            factor[g] = 1.0 - np.exp(-1j * w * harmonics.delay[g] / speed)
        for l in range(size):  # noqa: E741
            k = l - m + orders
            for i in range(rank):
                for j in range(rank):
                    coupling[i, j] = harmonics.dashpot[k, i, j] * (1j * w / speed)
            for g in range(factor.shape[0]):
                for i in range(rank):
                    for j in range(rank):
                        coupling[i, j] += factor[g] * harmonics.stiffness[g, k, i, j]
            for i in range(rank):
                for j in range(rank):
                    matrix[l * rank + i, m * rank + j] = coupling[i, j]
    for l in range(size):  # noqa: E741
        _receptance_at(response, omega + (l - count - 1) * base, receptance)
        for column in range(size * rank):
            for i in range(rank):
                coupling[i, 0] = matrix[l * rank + i, column]
            for i in range(rank):
                total = complex(0.0, 0.0)
                for j in range(rank):
                    total += receptance[i, j] * coupling[j, 0]
                matrix[l * rank + i, column] = total
    for i in range(size * rank):
        matrix[i, i] += 1.0


@njit(**DRIVER)
def unstable_roots(response, harmonics, speed, base, count, marks):
    """Number of unstable multipliers.

    Parameters
    ----------
    response : FrequencyResponse
    harmonics : Harmonics
        Orders up to 2 count + 1.
    speed : float
        Spindle speed, rad/s.
    base : float
        Frequency of the period, rad/s.
    count : int
        Harmonics on either side.
    marks : (k,) array of float
        Frequencies that no step goes beyond, rad/s; see `frequency_marks`.
    """
    rank = response.receptance.shape[1]
    size = (2 * count + 2) * rank
    matrix = np.empty((size, size), dtype=np.complex128)
    _loop(response, harmonics, speed, base, 0.0, count, matrix)
    value = np.linalg.det(matrix)
    turned, at, step = 0.0, 0.0, 0.5 * base / _FEWEST_LINES
    end, mark = 0.5 * base, 0
    while at < end * (1.0 - 1e-12):
        while mark < marks.shape[0] and marks[mark] <= at:
            mark += 1
        following = min(end, at + step)
        if mark < marks.shape[0]:
            following = min(following, marks[mark])
        _loop(response, harmonics, speed, base, following, count, matrix)
        ahead = np.linalg.det(matrix)
        change = np.angle(ahead / value)
        if abs(change) > _LARGEST_TURN and following - at > _FINEST * base:
            step = 0.4 * (following - at)
            continue
        turned += change
        value, at = ahead, following
        if abs(change) < 0.3 * _LARGEST_TURN:
            step = min(2.0 * step, 0.5 * base / _FEWEST_LINES)
    return -int(np.round(turned / math.pi))


@njit(**DRIVER)
def heard_frequency(response, harmonics, speed, base, count, marks):
    """Frequency of the strongest part of the motion that is nearest to a root, and its place.

    See `unstable_roots` for the parameters.

    Returns
    -------
    (float, float)
        rad/s, and the least frequency of it as a share of `base`, 0 .. 0.5.
    """
    rank = response.receptance.shape[1]
    size = (2 * count + 2) * rank
    matrix = np.empty((size, size), dtype=np.complex128)
    best, place, low, high = np.inf, 0.0, 0.0, 0.5 * base
    grid = np.sort(np.append(marks, np.linspace(0.0, high, _LINES_HEARD)))
    for _ in range(4):
        best = np.inf
        for i in range(grid.shape[0]):
            _loop(response, harmonics, speed, base, grid[i], count, matrix)
            value = abs(np.linalg.det(matrix))
            if value < best:
                best, place = value, grid[i]
                low, high = grid[max(0, i - 1)], grid[min(grid.shape[0] - 1, i + 1)]
        grid = np.linspace(low, high, _LINES_HEARD)
    _loop(response, harmonics, speed, base, place, count, matrix)
    vector = np.ones(size, dtype=np.complex128)
    for i in range(size):
        matrix[i, i] += 1e-12
    for _ in range(3):
        vector = np.linalg.solve(matrix, vector)
        vector /= np.sqrt((np.abs(vector) ** 2).sum())
    strongest, frequency = -1.0, 0.0
    for l in range(2 * count + 2):  # noqa: E741
        strength = 0.0
        for i in range(rank):
            strength += abs(vector[l * rank + i]) ** 2
        if strength > strongest:
            strongest, frequency = strength, abs(place + (l - count - 1) * base)
    return frequency, place / base


def harmonic_counts(
    highest: float, period_angle: float, speeds: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Harmonics on either side (n,) that reach beyond the highest resonance (rad/s).

    Raises
    ------
    RunError
        If they cannot at a speed.
    """
    base = 2.0 * np.pi / period_angle * np.asarray(speeds)
    slowest = float(base.min())
    if _LEAST_REACH * highest > _MOST * slowest:
        raise RunError(
            f"at {rpm(float(np.min(speeds))):.4g} rpm the cut repeats itself "
            f"{slowest / (2.0 * np.pi):.3g} times a second and modes reach up to "
            f"{highest / (2.0 * np.pi):.4g} Hz; the {_MOST} harmonics of the multi-frequency "
            'solution do not: raise the lowest spindle speed, or take "collocation"'
        )
    return np.clip(np.ceil(_REACH * highest / base), _FEWEST, _MOST).astype(np.int64)


def _changing_lines(response: FrequencyResponse) -> NDArray[np.float64]:
    """Lines, rad/s, between which the receptance changes by no more than a share of itself."""
    flat = response.receptance.reshape(response.omega.size, -1)
    size = np.linalg.norm(flat, axis=1)
    counted = np.maximum(np.minimum(size[1:], size[:-1]), _BELOW_PEAK * size.max())
    change = np.linalg.norm(np.diff(flat, axis=0), axis=1) / (_LARGEST_CHANGE * counted)
    passed = np.floor(np.append(0.0, np.cumsum(change)))
    return response.omega[np.flatnonzero(np.diff(passed) > 0.0)]


def frequency_marks(lines: NDArray[np.float64], base: float) -> NDArray[np.float64]:
    """Frequencies w in 0 .. base/2, ascending, at which some w + l base is one of the lines.

    A resonance far narrower than the base would else be stepped over: the determinant turns there
    and back.
    """
    folded = np.sort(np.abs(lines - base * np.round(lines / base)))
    return folded[np.append(True, np.diff(folded) > _FINEST * base)] if folded.size else folded


def limit_curve(
    cut: CutArrays,
    response: FrequencyResponse,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress = no_progress,
) -> LimitCurve:
    """Limits of stability at every spindle speed.

    Parameters
    ----------
    cut : CutArrays
        Whose speed does not vary; of its modes only the highest frequency is looked at.
    response : FrequencyResponse
    speeds : (n,) array of float
        rad/s.
    depths : (m,) array of float
        Net, m.
    progress : callable, optional
        Called with (done, total) depths of the net.

    Raises
    ------
    RunError
        If the harmonics do not reach up to the highest mode; see `harmonic_counts`.
    """
    counts = harmonic_counts(cut.resolution.fastest, cut.period_angle, speeds)
    orders = 2 * int(counts.max()) + 1
    base = 2.0 * np.pi / cut.period_angle * speeds
    lines = _changing_lines(response)
    marks = [frequency_marks(lines, float(b)) for b in base]

    def verdict(speed: int, harmonics: Harmonics) -> float:
        # the coefficients of the orders that this speed needs
        return 1.0 if _roots(speed, harmonics) > 0 else -1.0

    def _roots(speed: int, harmonics: Harmonics) -> int:
        count = int(counts[speed])
        return unstable_roots(
            response, _up_to(harmonics, 2 * count + 1), speeds[speed], base[speed], count,
            marks[speed],
        )  # fmt: skip

    def at_depths(index: NDArray[np.int64]) -> list[list[float]]:
        return [
            [verdict(speed, harmonics) for speed in range(len(speeds))]
            for harmonics in (harmonics_at(cut, float(depths[i]), orders) for i in index)
        ]

    # the coefficients of one depth at a time: a tool of many delays has a good many of them
    rows = sweep(at_depths, len(depths), progress, points_a_chunk=1)
    net = np.array([row for part in rows for row in part]).T

    def growth(index: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
        def some(places: NDArray[np.int64]) -> list[float]:
            return [
                -1.0 if depth[p] == 0.0
                else verdict(int(index[p]), harmonics_at(cut, float(depth[p]), orders))
                for p in places
            ]  # fmt: skip

        return np.array([v for part in sweep(some, len(index), points_a_chunk=4) for v in part])

    crossings = find_crossings(net, depths, growth, _DEPTH_TOLERANCE)
    first = np.array([found[0] if found.size else np.inf for found in crossings])
    frequency, kind = np.full(len(speeds), np.nan), ["none"] * len(speeds)
    for i in np.flatnonzero(np.isfinite(first)):
        count = int(counts[i])
        harmonics = _up_to(harmonics_at(cut, float(first[i]), orders), 2 * count + 1)
        omega, place = heard_frequency(response, harmonics, speeds[i], base[i], count, marks[i])
        frequency[i] = omega / (2.0 * np.pi)
        kind[i] = "flip" if place > 0.5 - 1e-3 else "hopf"
    return LimitCurve(speeds, first, frequency, tuple(kind), tuple(crossings), counts)


def _up_to(harmonics: Harmonics, orders: int) -> Harmonics:
    """Coefficients of orders -K .. K alone."""
    middle = (harmonics.dashpot.shape[0] - 1) // 2
    kept = slice(middle - orders, middle + orders + 1)
    return Harmonics(
        harmonics.delay,
        np.ascontiguousarray(harmonics.stiffness[:, kept]),
        np.ascontiguousarray(harmonics.dashpot[kept]),
    )
