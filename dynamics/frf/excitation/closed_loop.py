"""FRFs of a structure inside a control loop, where noise in the response acts on the force too."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.frf.container import Frf, MeasurementError
from dynamics.frf.excitation.holds import Hold, without_hold
from dynamics.frf.excitation.periodic import PeriodicRecord, require_one_excitation
from dynamics.frf.excitation.segments import require_force, spectra_of_segments
from dynamics.frf.hammer.spectra import coherence, h1


def joint_input_output_frf(records: Sequence[PeriodicRecord], hold: Hold) -> Frf:
    """Estimate the FRF as the ratio of the answers of response and force to the reference.

    G = (S_yr / S_rr) / (S_ur / S_rr). Noise that goes round the loop knows nothing of the
    reference and averages out of both, whereas it stays in the product of response and force.

    Parameters
    ----------
    records : sequence of PeriodicRecord
        Each with its reference; realisations of the same step, period, lines and quantity.
    hold : Hold
        What lay between the samples of the force.

    Returns
    -------
    Frf
        Its coherence, of response and reference, is there where there are several periods.

    Raises
    ------
    MeasurementError
        If a record has no reference, the records are not of one kind, or a line is not excited.

    Notes
    -----
    Source: P. E. Wellstead, 1981, "Non-parametric methods of system identification", Automatica
    17; R. Pintelon and J. Schoukens, 2012, System Identification, 2nd ed., chapter 2.
    """
    require_one_excitation(records)
    first = records[0]
    columns = {"force": [], "response": [], "reference": []}
    for record in records:
        if record.reference is None:
            raise MeasurementError(
                f"{record.name}: no reference; the signal injected into the loop is needed"
            )
        for key, transforms in columns.items():
            transforms.append(record.transforms(getattr(record, key)))
    force, response, reference = (np.concatenate(parts) for parts in columns.values())
    require_force(first.frequency, np.mean(np.abs(reference) ** 2, axis=0), first.name)
    of_response = spectra_of_segments(first.frequency, reference, response, first.quantity)
    of_force = spectra_of_segments(first.frequency, reference, force, first.quantity)
    require_force(first.frequency, np.abs(of_force.cross), first.name)
    frf = Frf(
        first.frequency,
        h1(of_response) / h1(of_force),
        first.quantity,
        first.response_point,
        first.reference_point,
        coherence(of_response) if of_response.count > 1 else None,
        ", ".join(dict.fromkeys(record.name for record in records)),
    )
    return without_hold(frf, hold, first.step)
