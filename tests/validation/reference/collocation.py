"""Monodromy operator of a linear periodic delay equation by Gauss collocation.

The equation is x'(t) = A(t) x(t) + B(t) y(t - delay) with y = C x and A, B of one period. The
period is cut into intervals that end wherever A or B jumps or has a kink. On each of them the
solution is a polynomial through its value at the left end and at Gauss-Legendre nodes, where it
fulfils the equation. The nodes lie inside the interval, so that a coefficient is never evaluated
on a jump and the limits are one-sided by themselves; inside, all is smooth and the error falls
faster than any power of the number of nodes.

The operator takes the state at the start and y over the earlier period or periods to the same one
period later. Its eigenvalues are the Floquet multipliers.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigvals

#: borders closer than this share of a period, and points closer than this share of an interval,
#: are the same
SAME = 1e-12


@dataclass(frozen=True)
class PeriodicDelayEquation:
    """x'(t) = A(t) x(t) + B(t) C x(t - delay); d states, of which C picks q values.

    `present` takes times (k,) to A (k, d, d) and `delayed` to B (k, d, q); `observed` is C (q, d);
    `borders` are the times in a period at which A or B is not smooth.
    """

    present: Callable[[np.ndarray], np.ndarray]
    delayed: Callable[[np.ndarray], np.ndarray]
    observed: np.ndarray
    period: float
    delay: float
    borders: tuple[float, ...] = ()


def constant(matrix):
    """Return the coefficient function of a constant matrix."""
    matrix = np.asarray(matrix, dtype=float)
    return lambda times: np.broadcast_to(matrix, (len(times), *matrix.shape))


class GaussPolynomial:
    """Polynomials on [0, 1] through the left end and `count` Gauss nodes.

    `points` is (count + 1,), first the left end; `derivative` (count, count + 1) gives the slope at
    the nodes and `end` (count + 1,) the value at 1, both from the values at `points`.
    """

    def __init__(self, count):
        nodes, weights = np.polynomial.legendre.leggauss(count)
        self.points = np.concatenate([[0.0], 0.5 * (nodes + 1.0)])
        difference = self.points[:, None] - self.points[None, :]
        np.fill_diagonal(difference, 1.0)
        # barycentric weights (Berrut and Trefethen 2004, eq. 3.2 and 9.4)
        self._weights = 1.0 / np.prod(4.0 * difference, axis=1)
        derivative = self._weights[None, :] / self._weights[:, None] / difference
        np.fill_diagonal(derivative, 0.0)
        np.fill_diagonal(derivative, -derivative.sum(axis=1))
        self.derivative = derivative[1:]
        # the slope integrated by Gauss quadrature, which is exact for it
        self.end = 0.5 * weights @ self.derivative
        self.end[0] += 1.0

    def values_at(self, place):
        """Return the row (count + 1,) that interpolates at one `place` in [0, 1]."""
        difference = place - self.points
        nearest = np.argmin(np.abs(difference))
        if abs(difference[nearest]) < SAME:
            return np.eye(len(self.points))[nearest]
        row = self._weights / difference
        return row / row.sum()


def mesh(equation, longest):
    """Cut the period at the borders and into intervals no longer than `longest` or the delay."""
    period = equation.period
    longest = min(longest, equation.delay)
    marks = np.sort(np.append(np.mod(equation.borders, period), period))
    edges = [0.0]
    for mark in marks:
        gap = mark - edges[-1]
        if gap > SAME * period:
            edges += list(np.linspace(edges[-1], mark, math.ceil(gap / longest - SAME) + 1)[1:])
    edges[-1] = period
    return np.array(edges)


class _History:
    """y as rows over the basis (state at the start, y over the earlier periods)."""

    def __init__(self, equation, edges, polynomial):
        self.edges, self.polynomial, self.period = edges, polynomial, equation.period
        self.values, self.states = equation.observed.shape
        self.periods = math.ceil(equation.delay / equation.period - SAME)
        self.intervals = len(edges) - 1
        self.block = len(polynomial.points) * self.values
        self.width = self.states + self.periods * self.intervals * self.block
        self.current = []

    def _rows(self, turn, interval):
        """y at the points of an interval of this period (turn 0) or of an earlier one (< 0)."""
        if turn == 0:
            return self.current[interval]
        first = self.states + ((-turn - 1) * self.intervals + interval) * self.block
        rows = np.zeros((self.block, self.width))
        rows[:, first : first + self.block] = np.eye(self.block)
        return rows

    def at(self, time):
        """Rows (values, width) of y at a time before those of the interval being solved."""
        turn = math.floor(time / self.period)
        time -= turn * self.period
        interval = np.searchsorted(self.edges, time, side="right") - 1
        interval = min(interval, self.intervals - 1)
        left, right = self.edges[interval], self.edges[interval + 1]
        weights = self.polynomial.values_at((time - left) / (right - left))
        rows = self._rows(turn, interval).reshape(len(weights), self.values, self.width)
        used = np.flatnonzero(weights)
        return np.tensordot(weights[used], rows[used], axes=1)

    def next_period(self, state):
        """Rows of the operator: the state and y one period later."""
        kept = np.zeros(((self.periods - 1) * self.intervals * self.block, self.width))
        kept[:, self.states : self.states + len(kept)] = np.eye(len(kept))
        return np.vstack([state, *self.current, kept])


def _interval_response(equation, polynomial, left, length):
    """Solution at the nodes from the state at the left end (n d, d) and delayed y (n d, n q)."""
    count = len(polynomial.points) - 1
    times = left + length * polynomial.points[1:]
    present, delayed = equation.present(times), equation.delayed(times)
    size, values = delayed.shape[1:]
    matrix = np.kron(polynomial.derivative[:, 1:] / length, np.eye(size))
    right = np.zeros((count * size, size + count * values))
    right[:, :size] = np.kron(-polynomial.derivative[:, :1] / length, np.eye(size))
    for node in range(count):
        rows = slice(node * size, (node + 1) * size)
        matrix[rows, rows] -= present[node]
        right[rows, size + node * values : size + (node + 1) * values] = delayed[node]
    response = np.linalg.solve(matrix, right)
    return response[:, :size], response[:, size:]


def monodromy(equation, nodes, longest):
    """Return the matrix of the operator over one period, without what nothing depends on."""
    polynomial = GaussPolynomial(nodes)
    edges = mesh(equation, longest)
    history = _History(equation, edges, polynomial)
    size = history.states
    state = np.eye(size, history.width)
    for left, right in itertools.pairwise(edges):
        times = left + (right - left) * polynomial.points[1:]
        earlier = np.vstack([history.at(time - equation.delay) for time in times])
        from_left, from_earlier = _interval_response(equation, polynomial, left, right - left)
        solution = np.vstack([state, from_left @ state + from_earlier @ earlier])
        solution = solution.reshape(nodes + 1, size, history.width)
        recorded = np.einsum("qd,pdw->pqw", equation.observed, solution)
        history.current.append(recorded.reshape(history.block, history.width))
        state = np.tensordot(polynomial.end, solution, axes=1)
    operator = history.next_period(state)
    # y that nothing refers to adds only zeros to the eigenvalues
    used = np.any(operator != 0.0, axis=0)
    return operator[np.ix_(used, used)]


def multipliers(equation, nodes=16, longest=math.inf):
    """Return all Floquet multipliers, largest magnitude first."""
    values = eigvals(monodromy(equation, nodes, longest))
    return values[np.argsort(-np.abs(values), kind="stable")]
