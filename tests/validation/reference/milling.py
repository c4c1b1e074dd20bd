"""Floquet multipliers of milling by multi-interval Chebyshev collocation.

Written from the conventions alone: x feed, y normal, phi clockwise from +y, h = dx sin + dy cos,
Fx = -Ft cos - Fr sin, Fy = Ft sin - Fr cos, Fz = Fa; a point at height z lags by z tan(helix)/R.
Intervals end at every entry and exit of tip and top of every tooth, so that the solution is
smooth inside each and converges spectrally.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(16)


@dataclass(frozen=True)
class MillingCase:
    """A linear milling problem, SI; modes are (frequency Hz, damping, mass, direction)."""

    teeth: int
    diameter: float
    helix: float
    entry: float
    exit: float
    coefficients: tuple[float, float, float]
    modes: tuple[tuple[float, float, float, tuple[float, float, float]], ...]
    speed: float
    depth: float
    process_damping: float = 0.0
    friction: float = 0.0


def tooth_matrix(phi, kt, kr, ka):
    """dF = -H d for one tooth, per length of edge."""
    s, c = math.sin(phi), math.cos(phi)
    force = np.array([-kt * c - kr * s, kt * s - kr * c, ka])
    return -np.outer(force, [s, c, 0.0])


def edge_matrix(case, tip, kt, kr, ka):
    """Sum over teeth of the integral of H along the engaged edge, tip of tooth 0 at `tip`."""
    lag_per_depth = math.tan(case.helix) / (0.5 * case.diameter)
    total = np.zeros((3, 3))
    for tooth in range(case.teeth):
        top_lag = lag_per_depth * case.depth
        angle = tip + 2.0 * math.pi * tooth / case.teeth
        turns = range(-2 - int(top_lag // (2 * math.pi)), 3)
        for turn in turns:
            phi = angle % (2.0 * math.pi) + 2.0 * math.pi * turn
            if lag_per_depth == 0.0:
                if case.entry < phi < case.exit:
                    total += case.depth * tooth_matrix(phi, kt, kr, ka)
                continue
            # heights z with entry < phi - lag z < exit
            low = max(0.0, (phi - case.exit) / lag_per_depth)
            high = min(case.depth, (phi - case.entry) / lag_per_depth)
            if high > low:
                for node, weight in zip(GAUSS_NODES, GAUSS_WEIGHTS, strict=True):
                    z = low + 0.5 * (1.0 + node) * (high - low)
                    part = tooth_matrix(phi - lag_per_depth * z, kt, kr, ka)
                    total += 0.5 * (high - low) * weight * part
    return total


def chebyshev(count):
    """Nodes on [0, 1] ascending and the differentiation matrix (Trefethen 2000, cheb)."""
    k = np.arange(count)
    x = -np.cos(math.pi * k / (count - 1))
    c = np.where((k == 0) | (k == count - 1), 2.0, 1.0) * (-1.0) ** k
    difference = x[:, None] - x[None, :]
    d = np.outer(c, 1.0 / c) / (difference + np.eye(count))
    d -= np.diag(d.sum(axis=1))
    return 0.5 * (x + 1.0), 2.0 * d


def borders(case, longest):
    """Tip angles in one pitch at which an edge enters or leaves, cut into pieces."""
    pitch = 2.0 * math.pi / case.teeth
    lag = case.depth * math.tan(case.helix) / (0.5 * case.diameter)
    marks = [0.0, pitch]
    for angle in (case.entry, case.exit, case.entry + lag, case.exit + lag):
        marks.append(angle % pitch)
    marks = sorted(marks)
    pieces = [0.0]
    for mark in marks[1:]:
        if mark - pieces[-1] > 1e-12:
            count = max(1, math.ceil((mark - pieces[-1]) / longest))
            pieces += list(np.linspace(pieces[-1], mark, count + 1)[1:])
    return np.array(pieces)


def multipliers(case, nodes=14, waves_a_piece=0.6):
    """All multipliers over one tooth period, largest magnitude first."""
    count = len(case.modes)
    directions = np.array([mode[3] for mode in case.modes])
    omega = 2.0 * math.pi * np.array([mode[0] for mode in case.modes])
    zeta = np.array([mode[1] for mode in case.modes])
    mass = np.array([mode[2] for mode in case.modes])
    # scaled state (omega x, v)
    free = np.zeros((2 * count, 2 * count))
    for i in range(count):
        free[2 * i, 2 * i + 1] = omega[i]
        free[2 * i + 1, 2 * i] = -omega[i]
        free[2 * i + 1, 2 * i + 1] = -2.0 * zeta[i] * omega[i]
    out = np.zeros((3, 2 * count))
    out_rate = np.zeros((3, 2 * count))
    into = np.zeros((2 * count, 3))
    out[:, 0::2] = (directions / omega[:, None]).T
    out_rate[:, 1::2] = directions.T
    into[1::2] = directions / mass[:, None]
    cutting_speed = 0.5 * case.diameter * case.speed

    longest = waves_a_piece * 2.0 * math.pi * case.speed / omega.max()
    marks = borders(case, longest)
    node, d = chebyshev(nodes)
    size, pieces = 2 * count, len(marks) - 1
    # unknown history: displacement (3) at every node of every piece of the last period
    history = 3 * nodes * pieces
    width = size + history
    state = np.zeros((size, width))
    state[:, :size] = np.eye(size)
    recorded = np.zeros((history, width))
    for piece in range(pieces):
        start, end = marks[piece], marks[piece + 1]
        h = (end - start) / case.speed
        left = np.kron(d / h, np.eye(size))
        right = np.zeros((size * nodes, width))
        for k in range(nodes):
            # one-sided limits: a hair inside the piece
            share = min(max(node[k], 1e-12), 1.0 - 1e-12)
            tip = start + share * (end - start)
            stiffness = edge_matrix(case, tip, *case.coefficients)
            rows = slice(k * size, (k + 1) * size)
            a = free - into @ stiffness @ out
            if case.process_damping:
                c = case.process_damping
                dashpot = edge_matrix(case, tip, case.friction * c, c, 0.0) / cutting_speed
                a = a - into @ dashpot @ out_rate
            left[rows, rows] -= a
            first = size + 3 * (piece * nodes + k)
            right[rows, first : first + 3] = into @ stiffness
        left[:size] = 0.0
        left[:size, :size] = np.eye(size)
        right[:size] = state
        solution = np.linalg.solve(left, right)
        for k in range(nodes):
            first = 3 * (piece * nodes + k)
            recorded[first : first + 3] = out @ solution[k * size : (k + 1) * size]
        state = solution[-size:]
    monodromy = np.vstack([state, recorded])
    values = np.linalg.eigvals(monodromy)
    return values[np.argsort(-np.abs(values))]


def spectral_radius(case, nodes=14, waves_a_piece=0.6):
    """Largest magnitude of the multipliers."""
    return float(abs(multipliers(case, nodes, waves_a_piece)[0]))
