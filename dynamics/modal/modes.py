"""Modal model at the tool point: real modes with directions, on the tool or the workpiece side."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Side = Literal["tool", "workpiece"]
Band = Literal["inside", "below", "above"]


@dataclass(frozen=True)
class Mode:
    """One real mode as the tool point feels it.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency, Hz.
    damping : float
        Viscous damping ratio, 1.
    mass : float
        Modal mass, kg, for the unit mode vector at the tool point.
    direction : (3,) tuple of float
        Unit vector of the motion of the tool point (x feed, y normal, z tool axis).
    side : str
        ``"tool"`` or ``"workpiece"``: which side of the contact moves.
    band : str
        ``"inside"``, or ``"below"`` or ``"above"`` for a mode that stands for what lies beyond the
        band of a measurement: its compliance counts, its resonance was not measured.
    """

    frequency: float
    damping: float
    mass: float
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    side: Side = "tool"
    band: Band = "inside"

    @property
    def natural_frequency(self) -> float:
        """Undamped natural frequency, rad/s."""
        return 2.0 * np.pi * self.frequency

    @property
    def stiffness(self) -> float:
        """Modal stiffness, N/m."""
        return self.mass * self.natural_frequency**2


def inside_band(modes: Sequence[Mode]) -> tuple[Mode, ...]:
    """Modes whose resonance was measured; all where none was."""
    return tuple(mode for mode in modes if mode.band == "inside") or tuple(modes)


def receptance_matrix(modes: Sequence[Mode], frequency: ArrayLike) -> NDArray[np.complex128]:
    """Relative receptance between tool and workpiece at the tool point.

    The force acts on the tool and, reversed, on the workpiece, and the displacement is that of
    the tool against the workpiece: the sign of a workpiece mode enters twice and cancels.

    Parameters
    ----------
    modes : sequence of Mode
    frequency : (n,) array of float
        Hz.

    Returns
    -------
    (n, 3, 3) array of complex
        m/N.
    """
    omega = 2.0 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    total = np.zeros((omega.size, 3, 3), dtype=np.complex128)
    for mode in modes:
        e = np.asarray(mode.direction, dtype=np.float64)
        wn = mode.natural_frequency
        response = 1.0 / (mode.mass * (wn**2 - omega**2 + 2j * mode.damping * wn * omega))
        total += response[:, None, None] * np.outer(e, e)
    return total


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
