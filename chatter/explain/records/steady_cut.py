"""One revolution of a settled cut, by the time-domain engine."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.explain.records.case_axes import Component
from chatter.explain.records.description import ACCELERATION, FORCE, VELOCITY
from chatter.explain.records.simulated import over_revolutions, simulated
from chatter.simulation.setup import delayed

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: revolutions of a run, and change from revolution to revolution that is settled
REVOLUTIONS = (6, 8, 12, 18, 26, 40)
_SETTLED = 1e-3
#: revolutions after which any cut is taken for settled
_LONGEST = 120
#: revolutions that the settled one is extrapolated from, at the most, less two
_MOST_TERMS = 4
#: of the changes' own size, so that changes that are nothing but rounding do not matter
_ROUNDING = 1e-13


@dataclass(frozen=True, eq=False)
class SteadyCut:
    """Harmonics of the revolution of a settled cut, over the angle from the first tooth at +y."""

    speed: float  # of the spindle, rad/s
    force: Complex  # (K + 1, 3) coefficients of exp(i k angle), on the tool, N
    displacement: Complex  # (K + 1, 3), of the tool against the workpiece, m
    power: float  # mean, W

    def harmonics(self, component: Component, orders: Array) -> Complex:
        """Harmonics (K,) of a component of force or motion at orders 1 to K, SI."""
        source = self.force if component.quantity == FORCE else self.displacement
        found = source @ np.array(component.direction)
        padded = np.zeros(orders.size, dtype=np.complex128)
        size = min(orders.size, found.size - 1)
        rate = 1j * orders[:size] * self.speed
        order = {VELOCITY: 1, ACCELERATION: 2}.get(component.quantity, 0)
        padded[:size] = found[1 : size + 1] * rate**order
        return padded


def steady_cut(case: Case, revolutions: int) -> SteadyCut:
    """Settled revolution of a case, extrapolated from the last of some revolutions from rest.

    The transients that are left die out by a few factors a revolution each; the combination of the
    last revolutions in which they cancel is that of reduced rank extrapolation (Eddy 1979; Mesina
    1977). RunError if the tool moves too far, InputError if the speed varies.
    """
    rows = _revolutions(case, revolutions)
    weights = _extrapolating(_scaled(rows))
    last = np.tensordot(weights, rows[-weights.size :], axes=1)
    harmonics = np.fft.rfft(last, axis=0) / len(last)
    harmonics[1:] *= 2.0
    force, displacement = harmonics[:, :3], harmonics[:, 3:6]
    power = float(last[:, 6].mean()) * case.cut.spindle_speed
    return SteadyCut(case.cut.spindle_speed, force, displacement, power)


def revolutions_to_settle(case: Case) -> int:
    """Revolutions from rest after which a case is settled, as far as extrapolation needs it."""
    rows = _revolutions(case, REVOLUTIONS[-1])
    scaled = _scaled(rows)
    full = scaled[-1]
    size = float(np.linalg.norm(full)) + 1e-300
    for count in REVOLUTIONS[:-1]:
        weights = _extrapolating(scaled[:count])
        found = weights @ scaled[count - weights.size : count]
        if np.linalg.norm(found - full) < _SETTLED * size:
            return count
    return REVOLUTIONS[-1]


def change_left(case: Case, revolutions: int) -> float:
    """Change of a cut from some revolutions after rest until it is settled, over its size."""
    scaled = _scaled(_revolutions(case, max(REVOLUTIONS[-1], min(2 * revolutions, _LONGEST))))
    later = scaled[min(revolutions, len(scaled) - 1)]
    size = float(np.linalg.norm(scaled[-1])) + 1e-300
    return float(np.linalg.norm(later - scaled[-1])) / size


def _revolutions(case: Case, count: int) -> Array:
    """Force, displacement and torque (count, points, 7) of revolutions from rest."""
    if case.cut.speed_variation is not None:
        raise InputError(
            f"{case.name}: cut.speed_variation: a record with an unknown spindle angle, or from "
            "the middle of a cut, is judged by the revolution that repeats; with a varying speed "
            'none does: give the angle as a column and begins = "rest"'
        )
    case = over_revolutions(case, float(count))
    result = simulated(case if case.stock is None else delayed(case))
    if not result.complete:
        raise RunError(f"{case.name}: the tool is displaced too far for a cut")
    signals = np.column_stack([result.force, result.displacement, result.torque])
    angle = result.spindle_angle
    points = round(2.0 * math.pi / float(angle[1] - angle[0]))
    whole = np.arange(count * points) * 2.0 * math.pi / points
    if angle.size != count * points + 1:
        signals = np.array([np.interp(whole, angle, row) for row in signals.T]).T
    return signals[: count * points].reshape(count, points, -1)


def _scaled(rows: Array) -> Array:
    """Revolutions (count, n) with forces and displacements of the same size."""
    sizes = np.maximum(np.sqrt(np.mean(rows[-1] ** 2, axis=0)), 1e-300)
    used = np.array([0, 1, 3, 4])
    return (rows[:, :, used] / sizes[used]).reshape(len(rows), -1)


def _terms(count: int) -> int:
    return min(_MOST_TERMS, count - 2) + 1


def _extrapolating(rows: Array) -> Array:
    """Weights (terms,) of the last revolutions in which their changes cancel best."""
    terms = _terms(len(rows))
    changes = np.diff(rows[-(terms + 1) :], axis=0)
    gram = changes @ changes.T
    gram += (_ROUNDING * float(np.trace(gram)) + 1e-300) * np.eye(terms)
    weights = np.linalg.solve(gram, np.ones(terms))
    return weights / weights.sum()
