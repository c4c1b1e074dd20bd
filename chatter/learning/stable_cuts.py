"""What the vibration of a stable cut tells of its stability: the multiplier of its motion.

The modes of a tool that cuts are always excited a little, by the grain of the work and by chips.
From one period of the cut to the next, what they do beside the forced vibration shrinks by the
dominant multiplier (operational modal analysis of a periodic system: Allen, Sracic, Chauhan and
Hansen 2011, Mech. Syst. Signal Process. 25:1177), which a stable cut shows long before it chatters.
Samples at the same phases of successive periods are a stationary process; its multipliers follow
from the covariances between periods (covariance-driven subspace identification, Peeters and De
Roeck 1999, Mech. Syst. Signal Process. 13:855).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: phases of a period that are looked at, block rows of the covariances, multipliers looked for
_PHASES, _ROWS, _ORDER = 10, 4, 4
#: share of the strongest multiplier's part in the motion, from which on one counts
_LEAST_PART = 0.1
#: periods from which covariances are worth something
_LEAST_PERIODS = 60


class Multiplier(NamedTuple):
    """Dominant multiplier over a period of the cut, as a record shows it."""

    magnitude: float
    angle: float  # rad, 0 to pi
    deviation: float  # standard deviation of the magnitude


def multiplier_of(signal: Array, sampling: float, period: float, teeth: int) -> Multiplier | None:
    """Identify the dominant multiplier of a cut from its vibration (n,).

    `sampling` is in Hz, `period` that of the cut, s, `teeth` those whose runout repeats with the
    revolution. None where the record is too short.
    """
    rows = _motion_beside_forced(signal, sampling, period, teeth)
    if len(rows) < _LEAST_PERIODS:
        return None
    values, parts = _multipliers(rows)
    strong = parts >= _LEAST_PART * parts.max()
    dominant = values[strong][np.argmax(np.abs(values[strong]))]
    magnitude = min(float(abs(dominant)), 1.0)
    # of an autoregressive process: (1 - mu^2)/n
    deviation = math.sqrt(max(1.0 - magnitude**2, 1.0 / len(rows)) / len(rows))
    return Multiplier(magnitude, float(abs(np.angle(dominant))), deviation)


def _motion_beside_forced(signal: Array, sampling: float, period: float, teeth: int) -> Array:
    """Motion (k, phases) of k periods, without what repeats with the revolution."""
    count = int((signal.size - 1) / (sampling * period))
    count -= count % teeth
    at = (np.arange(count)[:, None] + np.arange(_PHASES) / _PHASES) * period
    rows = np.interp(at, np.arange(signal.size) / sampling, signal)
    for tooth in range(teeth):
        rows[tooth::teeth] -= rows[tooth::teeth].mean(axis=0)
    return rows


def _multipliers(rows: Array) -> tuple[NDArray[np.complex128], Array]:
    """Multipliers (o,) of periods (k, phases), and how much each makes up (o,)."""
    lags = [_covariance(rows, lag) for lag in range(1, 2 * _ROWS + 1)]
    hankel = np.block([[lags[i + j] for j in range(_ROWS)] for i in range(_ROWS)])
    left, sizes, right = np.linalg.svd(hankel)
    width, root = rows.shape[1], np.sqrt(sizes[:_ORDER])
    observed = left[:, :_ORDER] * root
    step = np.linalg.lstsq(observed[:-width], observed[width:], rcond=None)[0]
    values, vectors = np.linalg.eig(step)
    # covariances are sums over multipliers: what each adds to that of the next period
    outward = np.linalg.norm(observed[:width] @ vectors, axis=0)
    inward = np.linalg.solve(vectors, root[:, None] * right[:_ORDER, :width])
    return values, outward * np.linalg.norm(inward, axis=1)


def _covariance(rows: Array, lag: int) -> Array:
    """Covariance (phases, phases) of periods with those `lag` later."""
    return rows[lag:].T @ rows[:-lag] / (len(rows) - lag)
