"""FRFs that are labelled a drive point but cannot be one.

At a drive point force and motion share point and direction, power can only flow in, and the
imaginary part of the receptance is never positive. Where it is at a resonance, force and response
were somewhere else. If they were at opposite ends of a symmetric structure, such as a beam, every
mode has the right magnitude and every second one the wrong sign.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.frf.container import Frf
from dynamics.identification.result import IdentifiedMode, ModalFit
from dynamics.modal.modes import Mode

NOT_PASSIVE = (
    "power flows out at some resonances, so this is no drive point; the magnitudes of its modes "
    "are used, which is right where force and response were at opposite ends of a symmetric part. "
    "Measure force and response at the same point to be sure"
)
#: lines this high, relative to the peak, count as resonance
_RESONANCE_SHARE = 0.1
#: share of the summed imaginary part that may have the wrong sign
_MOST_WRONG = 0.1


def is_passive(frf: Frf) -> bool:
    """Tell whether an FRF can be that of a drive point, sign of the sensor aside.

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


def with_magnitudes(fit: ModalFit) -> ModalFit:
    """Give the modes of a drive point that is none the mass that the magnitude of its FRF means.

    Returns
    -------
    ModalFit
        The same where it has real modes at the tool point, or where no FRF is labelled a drive
        point; else with masses, directions and a warning in every mode.
    """
    labelled = [k for k, frf in enumerate(fit.frfs) if frf.is_drive_point]
    if fit.modes or not labelled:
        return fit
    k = labelled[0]
    axis = fit.frfs[k].response.direction or "x"
    direction = tuple(float(axis == name) for name in "xyz")
    identified = tuple(_with_magnitude(mode, k, direction) for mode in fit.identified)
    modes = tuple(
        Mode(mode.frequency, mode.damping, mode.mass, direction)
        for mode in identified
        if mode.mass is not None
    )
    notes = (*fit.notes, f"{fit.frfs[k].source}: {NOT_PASSIVE}")
    return replace(fit, identified=identified, modes=modes, no_mass_reason="", notes=notes)


def _with_magnitude(
    mode: IdentifiedMode, k: int, direction: tuple[float, float, float]
) -> IdentifiedMode:
    residue = abs(float(mode.residues[k].real))
    if not (np.isfinite(residue) and residue > 0.0):
        return mode
    return replace(mode, mass=1.0 / residue, direction=direction)
