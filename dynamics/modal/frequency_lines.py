"""Frequencies at which the receptance of modes is sampled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def frequency_lines(
    natural_frequency: NDArray[np.float64], damping: NDArray[np.float64], highest: float
) -> NDArray[np.float64]:
    """Frequencies on which a modal receptance is sampled: dense around each mode.

    Parameters
    ----------
    natural_frequency : (n,) array of float
        Hz.
    damping : (n,) array of float
        Ratio.
    highest : float
        Last line, Hz.

    Returns
    -------
    (m,) array of float
        Hz, ascending.
    """
    lines = [np.geomspace(0.05 * natural_frequency.min(), highest, 8000)]
    for f, zeta in zip(natural_frequency, damping, strict=True):
        width = max(zeta, 1e-4) * f
        # evenly in the phase of the resonance: tangent spacing
        angle = np.linspace(-1.0, 1.0, 6001) * np.arctan(60.0)
        lines.append(f + width * np.tan(angle))
    merged = np.unique(np.concatenate(lines))
    return merged[(merged > 0.0) & (merged <= highest)]
