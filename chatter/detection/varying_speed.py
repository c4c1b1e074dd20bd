"""Deviations that follow from a spindle speed that varies, taken off.

The motion of a stable cut depends on the spindle speed, steeply near a resonance. Where the speed
differs from turn to turn so does the motion, and that is no chatter.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: relative change of the speed from period to period below which it counts as constant
_CONSTANT = 1e-6
#: change of the motion over its rms, per relative change of the speed, that may be laid to it:
#: about the order of a harmonic times the quality factor of a lightly damped mode
_STEEPEST = 100.0
#: periods after which a change of the speed is still felt
_LAGS = 3


def without_speed_variation(
    values: NDArray[np.float64], durations: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Take off what is linear in the speed of this period and of the ones before.

    Parameters
    ----------
    values : (periods, points, k) array of float
    durations : (periods,) array of float
        s, of each period.

    Returns
    -------
    (periods, points, k) array of float
        The same values if the speed is constant.
    """
    relative = 1.0 / durations
    relative = relative / relative.mean() - 1.0
    spread = float(np.std(relative))
    if spread < _CONSTANT or len(values) < 6 * _LAGS:
        return values
    padded = np.concatenate([np.full(_LAGS - 1, relative[0]), relative])
    count = len(values)
    base = np.stack([padded[_LAGS - 1 - lag :][:count] for lag in range(_LAGS)], axis=1)
    # what is fitted are differences: a transient that decays is no trend of the speed
    steps = np.diff(base, axis=0)
    left, singular, right = np.linalg.svd(steps, full_matrices=False)
    kept = singular > 0.05 * singular[0]
    inverse = (right[kept].T / singular[kept]) @ left[:, kept].T
    matrix = values.reshape(count, -1)
    later = matrix[count // 2 :]
    rms = float(np.sqrt(np.mean((later - later.mean(axis=0)) ** 2)))
    rms = max(rms, float(np.std(later)))
    slaved = (base - base.mean(axis=0)) @ (inverse @ np.diff(matrix, axis=0))
    size = float(np.sqrt(np.mean(slaved**2)))
    allowed = min(1.0, _STEEPEST * spread * rms / max(size, 1e-300))
    return (matrix - allowed * slaved).reshape(values.shape)
