"""Mean force of a tooth passing, measured and of a rigid cut.

The patterns of a tooth passing a rigid cut are linear in the four force coefficients. With these
free, the residual does not depend on coefficients, edge forces or wear that the case has wrong; and
as it is the mean over all teeth, hardly on runout or pitch.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.data_checks.spindle import settled
from chatter.explain.measurement import Measurement, Run
from chatter.simulation.simulate import simulate

Patterns = NDArray[np.float64]  # (2, bins): x and y

_BINS = 24
_COEFFICIENTS = ("Ktc", "Krc", "Kte", "Kre")
_UNIT = {"Ktc": 1e9, "Krc": 1e9, "Kte": 1e4, "Kre": 1e4}
_NOTHING = {"Ktc": 1e3, "Krc": 0.0, "Kte": 0.0, "Kre": 0.0}
#: sections that a rigid cut of a fresh tool does without
_WITHOUT = ("structure", "process_damping", "contact", "wear", "dynamometer")
#: residual, as a share, of a run that goes with the others
_GOES_WITH = 0.3


def tooth_pattern(measurement: Measurement, run: Run) -> Patterns:
    """Mean force over the tooth angle in whole revolutions, (2, bins), N."""
    own = run.of(measurement.case)
    speed = own.cut.spindle_speed
    chosen = settled(run, speed)
    time = run.signals["time"]
    begin = float(run.signals["spindle_angle"][0]) if "spindle_angle" in run.signals else 0.0
    angle = begin + (time[chosen] - time[0]) * speed
    force = np.array([run.signals[name][chosen] for name in ("Fx", "Fy")])
    return _folded(angle, force, own.tool.teeth)


def force_power(measurement: Measurement, run: Run) -> float:
    """Mean square of both forces where a run is settled, N^2."""
    chosen = settled(run, run.of(measurement.case).cut.spindle_speed)
    force = np.array([run.signals[name][chosen] for name in ("Fx", "Fy")])
    return max(float(np.mean(force**2)), 1e-300)


def basis_patterns(case: Case) -> NDArray[np.float64]:
    """Patterns of a unit of each force coefficient in a rigid cut, (4, 2, bins), N."""
    materials = [{"law": "linear", **_NOTHING, key: _UNIT[key]} for key in _COEFFICIENTS]
    return np.array([rigid_pattern(case.patch({"material": one})) for one in materials])


def rigid_pattern(case: Case) -> Patterns:
    """Pattern of a tooth in a rigid cut, (2, bins), N."""
    bare: dict[str, Any] = dict.fromkeys(_WITHOUT)
    result = simulate(case.patch({**bare, "simulation": {"revolutions": 2}}))
    last = result.spindle_angle >= 2.0 * math.pi - 1e-9
    return _folded(result.spindle_angle[last], result.force[last, :2].T, case.tool.teeth)


def _folded(angle: NDArray[np.float64], force: NDArray[np.float64], teeth: int) -> Patterns:
    index = np.floor(np.mod(angle * teeth / (2.0 * math.pi), 1.0) * _BINS).astype(np.int64)
    index = np.minimum(index, _BINS - 1)
    counts = np.bincount(index, minlength=_BINS)
    sums = np.array([np.bincount(index, weights=row, minlength=_BINS) for row in force])
    means = sums / np.maximum(counts, 1)
    if np.any(counts == 0):
        known = np.flatnonzero(counts)
        means = np.array(
            [np.interp(np.arange(_BINS), known, row[known], period=_BINS) for row in means]
        )
    return means


def fitted(
    measured: Sequence[Patterns], basis: Sequence[NDArray]
) -> tuple[NDArray[np.float64], float]:
    """Coefficients, none negative, that fit all runs, and the residual as a share of the patterns.

    Every run counts the same, whatever its forces.
    """
    rows, right = [], []
    for pattern, patterns in zip(measured, basis, strict=True):
        level = max(float(np.sqrt(np.mean(pattern**2))), 1e-300)
        rows.append(patterns.reshape(len(_COEFFICIENTS), -1).T / level)
        right.append(pattern.ravel() / level)
    matrix, wanted = np.concatenate(rows), np.concatenate(right)
    coefficients, residual = scipy.optimize.nnls(matrix, wanted)
    return coefficients, float(residual / np.sqrt(wanted.size))


def of_most_runs(measured: Sequence[Patterns], basis: Sequence[NDArray]) -> NDArray[np.float64]:
    """Coefficients of the runs without those, a third at the most, that do not go with them."""
    kept = list(range(len(measured)))
    while True:
        coefficients, _ = fitted([measured[k] for k in kept], [basis[k] for k in kept])
        shares = {k: residual_share(measured[k], basis[k], coefficients) for k in kept}
        worst = max(shares, key=shares.__getitem__)
        if shares[worst] < _GOES_WITH or 3 * (len(kept) - 1) < 2 * len(measured):
            return coefficients
        kept.remove(worst)


def residual_share(pattern: Patterns, basis: NDArray, coefficients: NDArray[np.float64]) -> float:
    """Residual of a pattern by coefficients, as a share of it."""
    expected = np.tensordot(coefficients, basis, axes=1)
    level = max(float(np.sqrt(np.mean(pattern**2))), 1e-300)
    return float(np.sqrt(np.mean((pattern - expected) ** 2))) / level


def factor_of(pattern: Patterns, basis: NDArray, coefficients: NDArray[np.float64]) -> float:
    """Factor of a pattern over what coefficients predict."""
    expected = np.tensordot(coefficients, basis, axes=1)
    return float(np.sum(pattern * expected) / max(float(np.sum(expected**2)), 1e-300))
