"""Stability limits in the frequency domain, by brute force.

With u the displacement of the tool, G its receptance and A(t) the force for unit regeneration and
unit depth, F = depth A(t) (u(t) - u(t - T)). A motion of the harmonics omega + k 2 pi/T has

    U_k = depth (1 - exp(-i omega T)) G(omega + k 2 pi/T) sum_l A_(k-l) U_l

(Budak and Altintas 1998, truncated at |k| <= order). Order 0 keeps only the mean of A and is the
zeroth-order solution (Altintas and Budak 1995). A limit is a real frequency at which an eigenvalue
of the right-hand side without the depth is real and positive: 1/depth.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, linear_sum_assignment

from .milling import Mode, border_angles, stiffness_of_cut


class FrequencyLimit(NamedTuple):
    """A depth in m and the frequency in Hz of the vibration at it."""

    depth: float
    frequency: float


def modal_receptance(modes):
    """Return the receptance of modes as a function of omega (k,) with values (k, 3, 3)."""
    modes = [Mode(*mode) for mode in modes]

    def receptance(omega):
        omega = np.asarray(omega, dtype=float)[:, None, None]
        return sum(
            np.outer(mode.shape, mode.shape)
            / (mode.angular**2 - omega**2 + 2j * mode.damping * mode.angular * omega)
            for mode in modes
        )

    return receptance


def residue_receptance(poles):
    """Return the receptance of (axis, Hz, damping, sigma, nu) with residues sigma + i nu.

    FRF = sum (alpha + beta s)/(s^2 + 2 zeta wn s + wn^2), alpha = 2 (zeta wn sigma - wd nu),
    beta = 2 sigma: poles in conjugate pairs that need not belong to real modes.
    """

    def receptance(omega):
        s = 1j * np.asarray(omega, dtype=float)
        total = np.zeros((len(s), 3, 3), dtype=complex)
        for axis, frequency, damping, sigma, nu in poles:
            natural = 2.0 * math.pi * frequency
            damped = natural * math.sqrt(1.0 - damping**2)
            alpha = 2.0 * (damping * natural * sigma - damped * nu)
            denominator = s**2 + 2.0 * damping * natural * s + natural**2
            total[:, axis, axis] += (alpha + 2.0 * sigma * s) / denominator
        return total

    return receptance


def directional_harmonics(case, highest=0):
    """Fourier coefficients A_k of the force for unit regeneration and depth, k from -highest."""
    orders = np.arange(-highest, highest + 1)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    edges = np.concatenate([[0.0], border_angles(case), [case.pitch]])
    # short enough for the highest harmonic
    steps = [np.linspace(a, b, 2 + highest) for a, b in zip(edges[:-1], edges[1:], strict=True)]
    edges = np.unique(np.concatenate(steps))
    half = 0.5 * np.diff(edges)[:, None]
    angles = (edges[:-1, None] + half * (1.0 + nodes)).ravel()
    shares = (half * weights).ravel() / case.pitch
    matrices = stiffness_of_cut(case, angles) / case.depth
    waves = np.exp(-1j * case.teeth * orders[:, None] * angles)
    return np.tensordot(waves * shares, matrices, axes=(1, 0))


def _harmonic_matrices(receptance, harmonics, omega, tooth_passing):
    """G(omega + k tooth passing) A_(k-l) in blocks of x and y, (k, 2 n, 2 n)."""
    order = (len(harmonics) - 1) // 4
    shifts = np.arange(-order, order + 1)
    blocks = []
    for shift in shifts:
        response = receptance(omega + shift * tooth_passing)[:, :2, :]
        row = [response @ harmonics[2 * order + shift - other][:, :2] for other in shifts]
        blocks.append(np.concatenate(row, axis=2))
    return np.concatenate(blocks, axis=1)


def _branches(values):
    """Reorder eigenvalues (k, n) so that each column is continuous."""
    values = values.copy()
    for i in range(1, len(values)):
        expected = 2.0 * values[i - 1] - values[i - 2] if i > 1 else values[0]
        _, order = linear_sum_assignment(np.abs(expected[:, None] - values[i][None, :]))
        values[i] = values[i][order]
    return values


def limits_at(receptance, harmonics, tooth_period, frequencies):
    """Return every FrequencyLimit at a speed, the lowest first.

    `harmonics` are A_-2h ... A_2h for the truncation |k| <= h, so that A_0 alone gives the
    zeroth-order solution; `frequencies` is a grid in Hz fine enough to follow the eigenvalues.
    """
    tooth_passing = 2.0 * math.pi / tooth_period

    def eigenvalues(omega):
        matrices = _harmonic_matrices(receptance, harmonics, omega, tooth_passing)
        regeneration = 1.0 - np.exp(-1j * omega * tooth_period)
        return np.linalg.eigvals(matrices) * regeneration[:, None]

    omega = 2.0 * math.pi * np.asarray(frequencies)
    grid = _branches(eigenvalues(omega))
    limits = []
    for i, branch in np.argwhere(np.diff(np.signbit(grid.imag), axis=0)):
        ends, values = omega[i : i + 2], grid[i : i + 2, branch]
        if values.real.max() <= 0.0:
            continue

        def nearest(at, ends=ends, values=values):
            found = eigenvalues(np.array([at]))[0]
            share = (at - ends[0]) / (ends[1] - ends[0])
            expected = values[0] + share * (values[1] - values[0])
            return found[np.argmin(np.abs(found - expected))]

        if nearest(ends[0]).imag * nearest(ends[1]).imag > 0.0:
            continue
        root = brentq(lambda at: nearest(at).imag, *ends, xtol=1e-10)
        value = nearest(root)
        if value.real > 0.0 and abs(value.imag) < 1e-6 * value.real:
            limits.append(FrequencyLimit(1.0 / value.real, root / (2.0 * math.pi)))
    return sorted(limits)


def frequency_grid(modes, tooth_period, highest_factor=3.0):
    """Frequencies in Hz that resolve the resonances and the waves in a tooth period."""
    frequencies = np.array([mode[0] for mode in modes])
    bandwidth = min(mode[0] * mode[1] for mode in modes)
    step = min(bandwidth / 8.0, 1.0 / (40.0 * tooth_period))
    return np.arange(0.2 * frequencies.min(), highest_factor * frequencies.max(), step)


def zero_order_limit(case, receptance=None, frequencies=None):
    """Return the lowest FrequencyLimit of the zeroth-order solution at the speed of `case`."""
    if receptance is None:
        receptance = modal_receptance(case.modes)
    if frequencies is None:
        frequencies = frequency_grid(case.modes, case.tooth_period)
    limits = limits_at(receptance, directional_harmonics(case), case.tooth_period, frequencies)
    return limits[0] if limits else FrequencyLimit(math.inf, math.nan)


def lowest_zero_order_limit(case, receptance, frequencies):
    """Return the lowest FrequencyLimit of the zeroth-order solution over all speeds.

    With L = 1/eigenvalue = depth (1 - exp(-i omega T)) the best phase omega T gives
    depth = |L|^2/(2 Re L).
    """
    omega = 2.0 * math.pi * np.asarray(frequencies)
    matrices = _harmonic_matrices(receptance, directional_harmonics(case), omega, 0.0)
    inverse = 1.0 / np.linalg.eigvals(matrices)
    with np.errstate(divide="ignore"):
        depth = np.where(inverse.real > 0.0, np.abs(inverse) ** 2 / (2.0 * inverse.real), np.inf)
    lowest = depth.min(axis=1)
    best = np.argmin(lowest)
    return FrequencyLimit(float(lowest[best]), float(frequencies[best]))


def multi_frequency_limit(case, order, frequencies):
    """Return the lowest FrequencyLimit with harmonics |k| <= order at the speed of `case`."""
    harmonics = directional_harmonics(case, 2 * order)
    limits = limits_at(modal_receptance(case.modes), harmonics, case.tooth_period, frequencies)
    return limits[0] if limits else FrequencyLimit(math.inf, math.nan)
