"""FRFs that are labelled a drive point but cannot be one.

At a drive point force and motion share point and direction, power can only flow in, and the
imaginary part of the receptance is never positive. Where it is at a resonance, force and response
were somewhere else. If they were mirror points of a symmetric structure (the two ends of a
beam), every mode has the right magnitude and every second one the wrong sign.
"""

from __future__ import annotations

import numpy as np

from dynamics.frf import Frf
from dynamics.identification import IdentifiedMode, ModalFit
from dynamics.modal import Mode

NOT_PASSIVE = (
    "power flows out at some resonances, so this is no drive point; the magnitudes of its modes "
    "are used, which is right where force and response were at mirror points of a symmetric part. "
    "Measure force and response at the same point to be sure"
)
#: lines this high, relative to the peak, count as resonance
_RESONANCE_SHARE = 0.1
#: share of the summed imaginary part that may have the wrong sign
_MOST_WRONG = 0.1


def is_passive(frf: Frf) -> bool:
    """Tell whether an FRF can be that of a drive point, sign of the sensor aside.

    Parameters
    ----------
    frf : Frf

    Returns
    -------
    bool
        False where the imaginary part of the mobility-like loss changes sign between resonances.
    """
    positive = frf.band(np.finfo(float).tiny, np.inf)
    # the measured quantity keeps the weight of high and low modes alike
    turn = {"receptance": 1.0, "mobility": 1j, "accelerance": -1.0}[frf.quantity]
    loss = -(positive.values / turn).imag
    high = np.abs(positive.values) >= _RESONANCE_SHARE * np.abs(positive.values).max()
    total = np.abs(loss[high]).sum()
    inflow = loss[high][loss[high] > 0.0].sum() / total if total else 1.0
    return bool(min(inflow, 1.0 - inflow) <= _MOST_WRONG)


def mirror_point_modes(fit: ModalFit) -> tuple[Mode, ...]:
    """Real modes with the magnitudes of the residues of a tool-point FRF.

    Parameters
    ----------
    fit : ModalFit
        Without real modes of its own.

    Returns
    -------
    tuple of Mode
        Empty where no FRF is labelled a drive point.
    """
    for k, frf in enumerate(fit.frfs):
        if frf.is_drive_point:
            return tuple(_mode(mode, k, frf) for mode in fit.identified if _has_part(mode, k))
    return ()


def _has_part(mode: IdentifiedMode, k: int) -> bool:
    return bool(np.isfinite(mode.residues[k]) and abs(mode.residues[k].real) > 0.0)


def _mode(mode: IdentifiedMode, k: int, frf: Frf) -> Mode:
    direction = tuple(float(axis == (frf.response.direction or "x")) for axis in "xyz")
    return Mode(mode.frequency, mode.damping, 1.0 / abs(float(mode.residues[k].real)), direction)
