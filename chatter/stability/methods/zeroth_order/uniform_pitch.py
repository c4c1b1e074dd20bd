"""Zeroth-order solution in the frequency domain (Altintas and Budak 1995).

The periodic directional matrix is replaced by its mean H0. At the critical depth w

    det(I + w (1 - exp(-i omega T)) G(i omega) H0) = 0,

so that every eigenvalue lambda of G H0 gives w (1 - exp(-i theta)) = -1/lambda with theta the
phase between this pass and the last. The receptance may come straight from a measurement.
Exact where the mean is all there is (many teeth, slotting, a helix at w = k pi D/(N tan beta));
low radial immersion adds flip lobes that it does not know.
"""

from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array, ComplexArray
from chatter.stability.methods.zeroth_order.kernels import order_like_neighbours, zero_order_limits


class ZeroOrderLimit(NamedTuple):
    """Limit over spindle speed by the zeroth-order solution."""

    spindle_speed: Array  # rad/s (n,)
    critical_depth: Array  # m (n,), inf where no lobe reaches
    chatter_frequency: Array  # Hz (n,), nan there
    lowest_depth: float  # m, over all speeds
    lowest_frequency: float  # Hz

    def __repr__(self) -> str:
        """How many limits there are: the arrays would fill the screen."""
        found = int(np.isfinite(self.critical_depth).sum())
        return f"<ZeroOrderLimit of {self.spindle_speed.size} speeds (rad/s), {found} limits (m)>"


def zero_order_limit(
    frequency: Array,
    receptance: ComplexArray,
    averaged_directional: Array,
    teeth: int,
    speeds: Array,
) -> ZeroOrderLimit:
    """Critical depth at every spindle speed.

    Frequencies (m,), Hz, ascend, > 0; the receptance (m, r, r), m/N, is the relative one of tool
    and worksegment in the directions of motion; the mean directional matrix (r, r), N/m^2, is over
    a revolution, all teeth, which are uniformly spaced; spindle speeds (n,) are in rad/s.
    """
    eigenvalues = _continuous(_eigenvalues(receptance @ averaged_directional))
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.where(eigenvalues == 0.0, np.nan, -1.0 / eigenvalues)
    omega = 2.0 * np.pi * frequency
    delays = 2.0 * np.pi / (teeth * speeds)
    depth, chatter = zero_order_limits(omega, np.ascontiguousarray(inverse), delays)
    with np.errstate(divide="ignore", invalid="ignore"):
        anywhere = np.where(inverse.real > 0.0, np.abs(inverse) ** 2 / (2.0 * inverse.real), np.inf)
    line, branch = np.unravel_index(np.nanargmin(anywhere), anywhere.shape)
    lowest = float(anywhere[line, branch])
    return ZeroOrderLimit(speeds, depth, chatter, lowest, float(frequency[line]))


def _eigenvalues(matrices: ComplexArray) -> ComplexArray:
    """Eigenvalues (m, r) of every line; those of two by two in closed form, ten times as fast."""
    if matrices.shape[1] != 2:
        return np.linalg.eigvals(matrices)
    (a, b), (c, d) = (matrices[:, i, :].T for i in range(2))
    middle, half = 0.5 * (a + d), 0.5 * (a - d)
    root = np.sqrt(half * half + b * c)
    # the larger one first; the smaller one from the product, which loses no digits
    larger = middle + np.where((middle.conj() * root).real < 0.0, -root, root)
    with np.errstate(divide="ignore", invalid="ignore"):
        smaller = np.where(larger == 0.0, 0.0, (a * d - b * c) / larger)
    return np.stack([larger, smaller], axis=1)


def _continuous(eigenvalues: ComplexArray) -> ComplexArray:
    """Order the eigenvalues of every line like those of the line before."""
    ordered = eigenvalues.copy()
    order_like_neighbours(ordered)
    return ordered
