"""Stabilisation diagram and the poles that stay put in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.identification.polynomial import OrderPoles

#: poles more damped than this are taken for numerical, not for modes
HIGHEST_DAMPING = 0.35

#: change from one order to the next below which a pole counts as stable
FREQUENCY_TOLERANCE = 0.01
BANDWIDTH_TOLERANCE = 0.5
DAMPING_TOLERANCE = 0.2
PARTICIPATION_TOLERANCE = 0.05

#: orders in which a pole must have been stable to become a candidate
LEAST_APPEARANCES = 3


@dataclass(frozen=True)
class StabilisationDiagram:
    """All stable-system poles of all orders, one entry a pole."""

    order: NDArray[np.int64]  # (p,), polynomial order that gave the pole
    frequency: NDArray[np.float64]  # (p,), undamped natural frequency, Hz
    damping: NDArray[np.float64]  # (p,), damping ratio, 1
    #: (p,), true where frequency, damping and participation agree with the order before
    stable: NDArray[np.bool_]


def stabilisation_diagram(
    orders: Sequence[OrderPoles], lowest: float, highest: float
) -> StabilisationDiagram:
    """Collect the poles inside a band and compare every order with the one before.

    By rising order; the band is in Hz.
    """
    order, frequency, damping, stable = [], [], [], []
    before: tuple[NDArray, NDArray, NDArray] | None = None
    for entry in orders:
        size = np.abs(entry.poles)
        ratio = -entry.poles.real / size
        hertz = size / (2.0 * np.pi)
        keep = (ratio > 0.0) & (ratio < HIGHEST_DAMPING) & (hertz >= lowest) & (hertz <= highest)
        now = (hertz[keep], ratio[keep], entry.participation[keep])
        order.append(np.full(now[0].size, entry.order))
        frequency.append(now[0])
        damping.append(now[1])
        stable.append(_stable(now, before))
        before = now
    return StabilisationDiagram(
        np.concatenate(order),
        np.concatenate(frequency),
        np.concatenate(damping),
        np.concatenate(stable),
    )


def _stable(
    now: tuple[NDArray, NDArray, NDArray], before: tuple[NDArray, NDArray, NDArray] | None
) -> NDArray[np.bool_]:
    """True for the poles of one order that the order before has as well."""
    if before is None or before[0].size == 0:
        return np.zeros(now[0].size, dtype=bool)
    shift = np.abs(now[0][:, None] - before[0])
    allowed = np.minimum(
        FREQUENCY_TOLERANCE, BANDWIDTH_TOLERANCE * np.maximum(now[1][:, None], before[1])
    )
    same = shift <= allowed * now[0][:, None]
    same &= np.abs(np.log(now[1][:, None] / before[1])) <= DAMPING_TOLERANCE
    alike = np.abs(now[2].conj() @ before[2].T) ** 2
    same &= alike >= 1.0 - PARTICIPATION_TOLERANCE
    return np.any(same, axis=1)


def stable_poles(diagram: StabilisationDiagram) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Poles that recur over the orders: the candidates for modes.

    The stable entries are gathered from the highest order down; each either joins the group
    whose running median it agrees with or opens a new one.

    Frequencies, Hz, and damping ratios (c,), by rising frequency.
    """
    groups: list[list[int]] = []
    for i in np.flatnonzero(diagram.stable)[::-1]:
        home = None
        for group in groups:
            f = float(np.median(diagram.frequency[group]))
            d = float(np.median(diagram.damping[group]))
            near = abs(diagram.frequency[i] - f) <= BANDWIDTH_TOLERANCE * d * f
            if near and abs(np.log(diagram.damping[i] / d)) <= 3.0 * DAMPING_TOLERANCE:
                home = group
                break
        if home is None:
            groups.append([int(i)])
        else:
            home.append(int(i))
    kept = [g for g in groups if np.unique(diagram.order[g]).size >= LEAST_APPEARANCES]
    frequency = np.array([np.median(diagram.frequency[g]) for g in kept])
    damping = np.array([np.median(diagram.damping[g]) for g in kept])
    by_frequency = np.argsort(frequency)
    return frequency[by_frequency], damping[by_frequency]
