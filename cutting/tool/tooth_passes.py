"""Passes of the other teeth before each tooth."""

import math

import numpy as np
from numpy.typing import NDArray

_REVOLUTION = 2.0 * math.pi


def earlier_passes(angle: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Teeth that passed within the revolution before each tooth, and how far ahead they are.

    Parameters
    ----------
    angle : (N, L) array of float
        Of the edges on the tool, rad.

    Returns
    -------
    (N, L, N) array of int, (N, L, N) array of float
        The teeth, latest pass first, and the angle to them, rad, > 0; the last is the tooth
        itself, a revolution ago.
    """
    ahead = np.mod(angle[None, :, :] - angle[:, None, :], _REVOLUTION)
    ahead = np.where(ahead < 1e-9, _REVOLUTION, ahead)
    ahead = np.moveaxis(ahead, 1, 2)
    order = np.argsort(ahead, axis=2)
    return order, np.take_along_axis(ahead, order, axis=2)
