"""Mode indicator functions of measured FRFs, and the modal assurance criterion of fitted modes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.frf.container import Frf, MeasurementError, on_common_lines


def mode_indicator_function(frfs: Sequence[Frf]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mode indicator function (MIF) of FRFs of one structure.

    Sum of |Re h| |h| over sum of |h|^2, of receptances or accelerances (Williams, Crowley and Vold
    1985, in the form of one reference): a real mode alone makes it fall towards 0 at its
    frequency, where all responses are in quadrature with the force; away from modes it is near 1.

    Parameters
    ----------
    frfs : sequence of Frf
        In any quantity.

    Returns
    -------
    frequency, indicator : (n,) arrays of float
        Hz; between 0 and 1.

    Raises
    ------
    MeasurementError
        If no FRF is given or they share no line.
    """
    if not frfs:
        raise MeasurementError("no FRF given; at least one is needed")
    accelerances = [
        frf.as_quantity("accelerance").band(np.finfo(float).tiny, np.inf) for frf in frfs
    ]
    frequency, values = on_common_lines(accelerances)
    size = np.abs(values)
    power = np.sum(size**2, axis=1)
    above = np.sum(np.abs(values.real) * size, axis=1)
    return frequency, above / np.where(power > 0.0, power, 1.0)


def modal_assurance(shapes: ArrayLike) -> NDArray[np.float64]:
    """Modal assurance criterion (MAC) between modes.

    |a^H b|^2 / (a^H a b^H b) (Allemang and Brown 1982): 1 for shapes in proportion, 0 for
    orthogonal ones.

    Parameters
    ----------
    shapes : (m, k) array of complex
        Residues of each mode over the FRFs; FRFs that a mode has no part in are NaN and left out
        of the pairs of that mode.

    Returns
    -------
    (m, m) array of float
        1 on the diagonal; 0 between modes without a common FRF.
    """
    vectors = np.atleast_2d(np.asarray(shapes, dtype=np.complex128))
    known = np.isfinite(vectors)
    vectors = np.where(known, vectors, 0.0)
    inner = np.abs(vectors.conj() @ vectors.T) ** 2
    own = np.abs(vectors) ** 2 @ known.T  # [a, b]: power of mode a on the FRFs of mode b
    norm = own * own.T
    return inner / np.where(norm > 0.0, norm, 1.0)
