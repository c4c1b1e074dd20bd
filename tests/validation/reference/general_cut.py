"""Any milling cut as a periodic delay equation of many delays, and its multipliers over a turn.

Independent of the product: at every instant it looks along every edge for which earlier pass has
left the surface, finds the ends of each stretch by bisection, and integrates over it by Gauss
quadrature. Conventions as in `milling`; besides, with k the axial immersion angle (90 degrees on
an upright edge) and n = (sin k sin phi, sin k cos phi, -cos k) the normal of the edge,

    h   = n . (u(t) - u(t - delay)) + sin k (feed a turn) (delay angle)/(2 pi) sin phi - inset
    Fx  = (Fa cos k - Fr sin k) sin phi - Ft cos phi
    Fy  = (Fa cos k - Fr sin k) cos phi + Ft sin phi
    Fz  = Fr cos k + Fa sin k

per length of edge, h the least over all earlier passes within a turn, inset what the earlier edge
stands further out than this one along the normal. A point at height z trails by z tan(helix)/R.

Runout, setting errors and serrations move an edge bodily from its nominal line, and the chip is to
the first order in them, as it is in feed and vibration: a tooth that is moved by d stands n . d
further out. One set further down along the axis (axial error a, d = (0, 0, -a)) thus by a cos k,
and nothing on an upright edge; one further out by r sin k. A serrated edge lies deeper by
(depth/2)(1 - cos(2 pi (z/wavelength + tooth/teeth))) at the height z; its length, its inclination
and the directions of its forces are taken to be those of the nominal edge.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigvals
from scipy.optimize import brentq
from scipy.sparse.linalg import eigs

from .collocation import SAME, GaussPolynomial
from .milling import Mode

_TURN = 2.0 * math.pi
#: of larger matrices only the largest eigenvalues are looked for
_DENSE = 900


@dataclass(frozen=True)
class GeneralCut:
    """A linearised milling cut, SI; lists have one entry a tooth.

    `profile` gives (height, radius, immersion angle, arc length rate) along the edge through
    `corner_radius` and `edge_angle`; `offsets` are the radial deviations of the teeth, runout
    included, `axial` those along the axis, positive further down; `serration` is (depth from
    crest to valley, wavelength); `variation` is (amplitude, cycles a period, turns a period,
    triangle).
    """

    diameter: float
    pitch: tuple[float, ...]
    helix: tuple[float, ...]
    mode: str
    radial_depth: float
    coefficients: tuple[float, float, float]
    modes: tuple[Mode, ...]
    speed: float
    depth: float
    feed: float = 1e-4
    corner_radius: float = 0.0
    edge_angle: float = 0.5 * math.pi
    offsets: tuple[float, ...] = ()
    exponent: float = 1.0
    radial_exponent: float | None = None
    reference_chip: float = 1e-4
    process_damping: float = 0.0
    friction: float = 0.0
    variation: tuple[float, int, int, bool] | None = None
    axial: tuple[float, ...] = ()
    serration: tuple[float, float] | None = None

    @property
    def teeth(self):
        """Number of teeth."""
        return len(self.pitch)


class _Edge:
    """Geometry along the edge; s runs over the arc length from tip to the depth of cut."""

    def __init__(self, cut):
        self.cut = cut
        radius, corner, angle = 0.5 * cut.diameter, cut.corner_radius, cut.edge_angle
        self.radius = radius
        corner_top = corner * (1.0 - math.cos(angle))
        self.turn = angle
        if corner and cut.depth < corner_top:
            self.turn = math.acos(1.0 - cut.depth / corner)
        self.on_corner = corner * self.turn
        self.straight = max(0.0, cut.depth - corner_top) / math.sin(angle)
        self.length = self.on_corner + self.straight
        self.corner_top = corner * (1.0 - math.cos(self.turn))
        self.corner_radius_out = radius - corner + corner * math.sin(self.turn)
        top = self.at(np.array([self.length]))
        self.top_radius = float(top[1][0])

    def at(self, s):
        """Height, radius and immersion angle at arc lengths s."""
        cut = self.cut
        corner = max(cut.corner_radius, 1e-300)
        kappa = np.where(s < self.on_corner, s / corner, cut.edge_angle)
        beyond = np.maximum(s - self.on_corner, 0.0)
        height = np.where(
            s < self.on_corner,
            corner * (1.0 - np.cos(kappa)),
            self.corner_top + beyond * math.sin(cut.edge_angle),
        )
        radius = np.where(
            s < self.on_corner,
            self.radius - corner + corner * np.sin(kappa),
            self.corner_radius_out + beyond * math.cos(cut.edge_angle),
        )
        if not cut.corner_radius:
            kappa = np.full_like(s, cut.edge_angle)
        return height, radius, kappa

    def arc(self, radius):
        """Entry and exit angle; an empty arc where the edge does not reach the stock."""
        cut = self.cut
        if cut.mode == "slot":
            return np.zeros_like(radius), np.full_like(radius, math.pi)
        cosine = (self.radius - cut.radial_depth) / np.maximum(radius, 1e-300)
        arc = np.arccos(np.clip(cosine, -1.0, 1.0))
        if cut.mode == "up":
            return np.zeros_like(radius), arc
        return math.pi - arc, np.full_like(radius, math.pi)


class _Cut:
    """What stands in the cut at an instant."""

    def __init__(self, cut, samples=160):
        self.cut, self.edge = cut, _Edge(cut)
        self.start = np.concatenate([[0.0], np.cumsum(cut.pitch)[:-1]])
        self.offsets = np.array(cut.offsets if cut.offsets else (0.0,) * cut.teeth)
        self.axial = np.array(cut.axial if cut.axial else (0.0,) * cut.teeth)
        self.slope = np.tan(np.array(cut.helix)) / (0.5 * cut.diameter)
        self.grid = np.linspace(0.0, self.edge.length, samples + 1)
        if cut.corner_radius:
            self.grid = self.edge.length * np.linspace(0.0, 1.0, samples + 1)
        upright = not any(cut.helix) and not cut.corner_radius
        if upright and cut.edge_angle == 0.5 * math.pi and not cut.serration:
            self.grid = np.array([0.0, self.edge.length])
        count = 24 if cut.exponent < 1.0 else 12
        self.nodes, self.weights = np.polynomial.legendre.leggauss(count)

    def outwards(self, height, kappa):
        """How far every edge stands out from the nominal one along the normal (N, k), m."""
        radial = np.repeat(self.offsets[:, None], np.size(height), axis=1)
        if self.cut.serration:
            depth, wavelength = self.cut.serration
            share = np.arange(self.cut.teeth)[:, None] / self.cut.teeth
            radial -= 0.5 * depth * (1.0 - np.cos(_TURN * (height / wavelength + share)))
        return radial * np.sin(kappa) + self.axial[:, None] * np.cos(kappa)

    def chips(self, tooth, s, spindle):
        """Static chips against every pass (N, k), angles to them (N, k), rotation angle, kappa."""
        height, radius, kappa = self.edge.at(s)
        angle = self.start[:, None] - self.slope[:, None] * height
        ahead = np.mod(angle - angle[tooth], _TURN)
        ahead[tooth] = _TURN
        phi = np.mod(spindle + angle[tooth], _TURN)
        feed_a_turn = self.cut.feed * self.cut.teeth
        sine = np.sin(kappa)
        chip = sine * feed_a_turn * ahead / _TURN * np.sin(phi)
        out = self.outwards(height, kappa)
        chip = chip - (out - out[tooth])
        entry, leave = self.edge.arc(radius)
        inside = (entry < phi) & (phi < leave)
        return np.where(inside, chip, -np.inf), ahead, phi, kappa

    def active(self, tooth, s, spindle):
        """Pass that left the surface at many places or angles; -1 in the air, -2 off the stock."""
        chip = self.chips(tooth, np.atleast_1d(s), spindle)[0]
        least = np.argmin(chip, axis=0)
        thinnest = chip[least, np.arange(chip.shape[1])]
        return np.where(thinnest > 0.0, least, np.where(np.isneginf(thinnest), -2, -1))

    def stretches(self, tooth, spindle):
        """(pass, from, to) of the stretches in the cut along an edge."""
        found = self.active(tooth, self.grid, spindle)
        changes = np.flatnonzero(found[1:] != found[:-1])
        low, high = self.grid[changes], self.grid[changes + 1]
        for _ in range(46 if changes.size else 0):
            middle = 0.5 * (low + high)
            same = self.active(tooth, middle, spindle) == found[changes]
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        cuts = [0.0, *(0.5 * (low + high))]
        # the profile has a kink where the corner ends
        cuts = sorted([*cuts, self.edge.on_corner, self.edge.length])
        for low, high in itertools.pairwise(cuts):
            if high - low > 1e-12 * self.edge.length:
                which = self.active(tooth, 0.5 * (low + high), spindle)[0]
                if which >= 0:
                    yield which, low, high

    def _along(self, low, high):
        """Places and weights of the quadrature over a stretch."""
        # even in s where all is even in s, and dense at the ends with a size effect
        x, weight = 0.5 * (self.nodes + 1.0), 0.5 * self.weights
        if self.grid.size == 2:
            x, weight = np.array([0.5]), np.array([1.0])
        elif self.cut.exponent < 1.0:
            weight = weight * 30.0 * (x * (1.0 - x)) ** 2
            x = x**3 * (10.0 - 15.0 * x + 6.0 * x * x)
        return low + (high - low) * x, (high - low) * weight

    def couplings(self, spindle):
        """Angles since the passes (k,), matrices (k, 3, 3), and dashpot (3, 3) times the speed."""
        cut, delays, matrices = self.cut, [np.empty(0)], [np.empty((0, 3, 3))]
        dashpot = np.zeros((3, 3))
        for tooth in range(cut.teeth):
            for which, low, high in self.stretches(tooth, spindle):
                s, size = self._along(low, high)
                chip, ahead, phi, kappa = self.chips(tooth, s, spindle)
                ratio = np.maximum(chip[which], 1e-24) / cut.reference_chip
                radial = cut.exponent if cut.radial_exponent is None else cut.radial_exponent
                push = 0.0
                exponents = (cut.exponent, radial, cut.exponent)
                for part, p in zip(np.diag(cut.coefficients), exponents, strict=True):
                    normal, unsized = _directions(phi, kappa, part)
                    push = push + p * ratio ** (p - 1.0) * unsized
                delays.append(np.broadcast_to(ahead[which], s.shape))
                matrices.append(np.einsum("k,ik,jk->kij", size, push, normal))
                c = cut.process_damping
                _, push = _directions(phi, kappa, (cut.friction * c, c, 0.0))
                dashpot += np.einsum("k,ik,jk->ij", size, push, normal)
        return np.concatenate(delays), np.concatenate(matrices), dashpot

    def _ends(self):
        """Arc lengths of tip, top, and where the edge meets the stock or leaves a full slot."""
        near = 1e-9 * self.edge.length
        ends = [near, self.edge.length - near]
        reach = abs(self.edge.radius - self.cut.radial_depth)

        def short(s):
            return float(self.edge.at(np.array([s]))[1][0]) - reach

        if self.cut.mode != "slot" and short(ends[0]) < 0.0 < short(ends[1]):
            ends.append(brentq(short, *ends, xtol=1e-16) + near)
        return ends

    def border_angles(self, samples=1440):
        """Spindle angles in a turn at which tip, top or the pattern of passes changes."""
        angles = []
        grid = np.linspace(0.0, _TURN, samples + 1) + 1e-4
        for tooth in range(self.cut.teeth):
            for s in self._ends():
                found = self.active(tooth, s, grid)
                changes = np.flatnonzero(found[1:] != found[:-1])
                low, high = grid[changes], grid[changes + 1]
                for _ in range(44):
                    middle = 0.5 * (low + high)
                    same = self.active(tooth, s, middle) == found[changes]
                    low, high = np.where(same, middle, low), np.where(same, high, middle)
                angles += list(0.5 * (low + high) % _TURN)
        for angle in self._changes_of_pattern(samples // 2):
            if not angles or np.min(np.abs(np.array(angles) - angle)) > 1e-6:
                angles.append(angle)
        return np.array(sorted(angles))

    def _pattern(self, tooth, spindle):
        """Passes that follow each other along an edge, and that at the end of the corner."""
        found = self.active(tooth, self.grid, spindle)
        kept = np.append(True, found[1:] != found[:-1])
        corner = self.active(tooth, self.edge.on_corner, spindle)
        return (*found[kept], *corner)

    def _changes_of_pattern(self, samples):
        """Spindle angles in a turn at which a stretch within an edge comes, goes or passes on."""
        grid = np.linspace(0.0, _TURN, samples + 1) + 1e-4
        for tooth in range(self.cut.teeth):
            found = [self._pattern(tooth, angle) for angle in grid]
            for i in range(samples):
                low, before = grid[i], found[i]
                while before != found[i + 1]:
                    low, high = self._first_change(tooth, low, grid[i + 1], before)
                    yield 0.5 * (low + high) % _TURN
                    low, before = high, self._pattern(tooth, high)

    def _first_change(self, tooth, low, high, before):
        """Angles close to each other between which the pattern of an edge changes first."""
        for _ in range(36):
            middle = 0.5 * (low + high)
            if self._pattern(tooth, middle) == before:
                low = middle
            else:
                high = middle
        return low, high


def _directions(phi, kappa, coefficients):
    """Normal of the edge and force on the tool per chip and length, (3, k) each."""
    s, c, sk, ck = np.sin(phi), np.cos(phi), np.sin(kappa), np.cos(kappa)
    kt, kr, ka = coefficients
    plane = ka * ck - kr * sk
    return (
        np.array([sk * s, sk * c, -ck]),
        np.array([plane * s - kt * c, plane * c + kt * s, kr * ck + ka * sk]),
    )


class _Spindle:
    """Angle of the spindle in time, with a varying speed, and the other way around."""

    def __init__(self, cut):
        self.speed, self.variation = cut.speed, cut.variation
        self.turns = cut.variation[2] if cut.variation else 1
        self.period = self.turns * _TURN / cut.speed
        if cut.variation:
            self.rate = cut.variation[1] / self.period

    def speed_at(self, time):
        if not self.variation:
            return self.speed
        cycle = (self.rate * time) % 1.0
        wave = math.sin(_TURN * cycle)
        if self.variation[3]:
            wave = 1.0 - abs((4.0 * cycle + 1.0) % 4.0 - 2.0)
        return self.speed * (1.0 + self.variation[0] * wave)

    def angle(self, time):
        if not self.variation:
            return self.speed * time
        cycle = (self.rate * time) % 1.0
        if self.variation[3]:
            if cycle < 0.25:
                swing = 2.0 * cycle**2
            elif cycle < 0.75:
                swing = 0.25 - 2.0 * (cycle - 0.5) ** 2
            else:
                swing = 2.0 * (1.0 - cycle) ** 2
        else:
            swing = (1.0 - math.cos(_TURN * cycle)) / _TURN
        return self.speed * (time + self.variation[0] / self.rate * swing)

    def time(self, angle):
        if not self.variation:
            return angle / self.speed
        reach = self.variation[0] / self.rate
        middle = angle / self.speed
        return brentq(
            lambda t: self.angle(t) - angle, middle - reach, middle + reach, xtol=1e-15, rtol=1e-14
        )


def _merged(marks, period):
    """Marks modulo the period, ascending from 0 to the period, without the repeated ones."""
    edges = [0.0]
    for mark in sorted(np.mod(marks, period)):
        if mark - edges[-1] > SAME * period:
            edges.append(float(mark))
    if period - edges[-1] <= SAME * period:
        edges.pop()
    return [*edges, period]


def multipliers(cut, nodes=10, waves=0.5, longest_angle=0.6, samples=160):
    """Return the largest Floquet multipliers over a period: a turn, or that of the variation.

    A stretch of the edge shorter than its length over `samples` may be overlooked.
    """
    state = _StateSpace(cut)
    inside, spindle = _Cut(cut, samples), _Spindle(cut)
    angles = inside.border_angles()
    marks = [
        spindle.time(angle + _TURN * turn) for turn in range(spindle.turns) for angle in angles
    ]
    if cut.variation and cut.variation[3]:
        marks += [(0.25 + 0.5 * k) / spindle.rate for k in range(2 * cut.variation[1])]
    highest = max(mode[0] for mode in cut.modes)
    delays = np.concatenate([inside.couplings(angle)[0] for angle in np.linspace(0, _TURN, 200)])
    slowest = 1.0 + (cut.variation[0] if cut.variation else 0.0)
    longest = min(
        waves / highest, longest_angle / cut.speed, 0.95 * np.min(delays) / (cut.speed * slowest)
    )
    edges = [0.0]
    for left, right in itertools.pairwise(_merged(marks, spindle.period)):
        count = math.ceil((right - left) / longest - SAME)
        inner = np.linspace(left, right, count + 1)
        if cut.exponent < 1.0:
            # where the chip vanishes the slope of a size effect grows without bound, that of an
            # upright edge in time too
            levels = 5 if any(cut.helix) else 9
            share = (right - left) / count * 0.15 ** np.arange(levels, 0, -1)
            inner = np.sort(np.concatenate([inner, left + share, right - share]))
        edges += list(inner[1:])
    operator = _monodromy(state, inside, spindle, np.array(edges), GaussPolynomial(nodes))
    values = _largest_eigenvalues(operator)
    return values[np.argsort(-np.abs(values), kind="stable")]


def _largest_eigenvalues(operator):
    """All eigenvalues of a small matrix, six of the largest of a large one."""
    if len(operator) <= _DENSE:
        return eigvals(operator)
    start = np.cos(np.arange(len(operator)))
    return eigs(operator, k=6, v0=start, tol=1e-12, return_eigenvectors=False)


class _StateSpace:
    """x' = (free + force (K observed + D rate)) x - force K_d observed x(t - delay).

    What is observed is the motion in the r directions `basis` (3, r) that the modes span.
    """

    def __init__(self, cut):
        modes = [Mode(*mode) for mode in cut.modes]
        omega = np.array([mode.angular for mode in modes])
        damping = np.array([mode.damping for mode in modes])
        shapes = np.array([mode.shape for mode in modes])
        zero = np.zeros((len(modes), len(modes)))
        self.free = np.block(
            [[zero, np.diag(omega)], [-np.diag(omega), -2.0 * np.diag(damping * omega)]]
        )
        directions, size, _ = np.linalg.svd(shapes.T)
        self.basis = directions[:, : np.sum(size > 1e-12 * size[0])]
        seen = self.basis.T @ shapes.T
        none = np.zeros_like(seen)
        self.observed = np.hstack([seen / omega, none])
        self.rate = np.hstack([none, seen])
        self.force = np.vstack([none.T, seen.T])

    def seen(self, matrix):
        """Matrices (..., 3, 3) between force and motion as (..., r, r)."""
        return self.basis.T @ matrix @ self.basis


def _monodromy(state, inside, spindle, edges, polynomial):
    """Matrix of the operator that takes state and motion over a period to the same later."""
    size, count = state.free.shape[0], len(polynomial.points) - 1
    intervals, period = len(edges) - 1, spindle.period
    # no delay is longer than a turn at the lowest speed
    slowest = inside.cut.speed * (1.0 - (inside.cut.variation[0] if inside.cut.variation else 0.0))
    periods = math.ceil(_TURN / slowest / period - 1e-9)
    rank = state.basis.shape[1]
    block = (count + 1) * rank
    width = size + periods * intervals * block
    current, rows_of_state = [], np.eye(size, width)

    def earlier(time):
        turn = math.floor(time / period + 1e-13)
        local = time - turn * period
        interval = min(
            max(np.searchsorted(edges, local + 1e-13 * period, "right") - 1, 0), intervals - 1
        )
        left, right = edges[interval], edges[interval + 1]
        weights = polynomial.values_at(min(max((local - left) / (right - left), 0.0), 1.0))
        if turn == 0:
            return np.tensordot(weights, current[interval].reshape(count + 1, rank, width), axes=1)
        first = size + ((-turn - 1) * intervals + interval) * block
        rows = np.zeros((rank, width))
        rows[:, first : first + block] = np.kron(weights, np.eye(rank))
        return rows

    for left, right in itertools.pairwise(edges):
        length = right - left
        matrix = np.kron(polynomial.derivative[:, 1:] / length, np.eye(size))
        right_side = np.kron(-polynomial.derivative[:, :1] / length, rows_of_state)
        for node in range(count):
            time = left + length * polynomial.points[node + 1]
            angle = spindle.angle(time)
            delays, matrices, dashpot = inside.couplings(angle)
            delays, alike = np.unique(np.round(delays, 13), return_inverse=True)
            couplings = np.zeros((len(delays), rank, rank))
            np.add.at(couplings, alike, state.seen(matrices))
            present = state.free + state.force @ couplings.sum(axis=0) @ state.observed
            speed = spindle.speed_at(time) * inside.edge.top_radius
            present = present + state.force @ (state.seen(dashpot) / speed) @ state.rate
            rows = slice(node * size, (node + 1) * size)
            matrix[rows, rows] -= present
            for delay, coupling in zip(delays, couplings, strict=True):
                right_side[rows] -= state.force @ coupling @ earlier(spindle.time(angle - delay))
        nodes = np.linalg.solve(matrix, right_side)
        solution = np.concatenate([rows_of_state[None], nodes.reshape(count, size, width)])
        current.append(np.einsum("qd,pdw->pqw", state.observed, solution).reshape(block, width))
        rows_of_state = np.tensordot(polynomial.end, solution, axes=1)
    kept = np.zeros(((periods - 1) * intervals * block, width))
    kept[:, size : size + len(kept)] = np.eye(len(kept))
    operator = np.vstack([rows_of_state, *current, kept])
    used = np.any(operator != 0.0, axis=0)
    return operator[np.ix_(used, used)]


def spectral_radius(cut, **options):
    """Return the largest magnitude of the multipliers over a period."""
    return float(abs(multipliers(cut, **options)[0]))
