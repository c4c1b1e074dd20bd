"""FRFs of transients that die away within their records: blows, pulses and single chirps."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.frf.container import Frf, MeasurementError, Point, Quantity
from dynamics.frf.excitation.holds import Hold, without_hold
from dynamics.frf.excitation.segments import averaged_frf, spectra_of_segments
from dynamics.frf.excitation.signal import PulseTrain
from dynamics.frf.hammer.examine import require_one_kind
from dynamics.frf.hammer.record import HammerRecord
from dynamics.frf.hammer.spectra import Estimator, h1

#: share of the peak of the response that may be left at the end of a record, by default
LEFT_AT_END = 3e-3
#: share of the record, at its end, looked at for that
_END = 0.05
#: share of the peak of the force at which a transient has begun
_BEGUN = 0.01


def cut_at_pulses(
    train: PulseTrain,
    force: ArrayLike,
    response: ArrayLike,
    quantity: Quantity,
    points: tuple[Point, Point] = (Point(), Point()),
) -> list[HammerRecord]:
    """Cut a record of a train of pulses into one record a pulse, all of the shortest length.

    Force and response (n,) are sampled at the steps of the train; the force may be another than
    that of the train, as of a drive that adds to its torque command. The points are those of the
    response and of the force. MeasurementError if the columns are not as long as the train.
    """
    force, response = (np.asarray(column, dtype=np.float64) for column in (force, response))
    if force.shape != train.values.shape or response.shape != train.values.shape:
        raise MeasurementError(
            f"pulses: force has shape {force.shape} and response {response.shape}; the train has "
            f"{train.values.size} samples"
        )
    ends = np.append(train.starts[1:], train.values.size)
    length = int((ends - train.starts).min())
    return [
        HammerRecord(
            f"pulse {number}",
            1.0 / train.step,
            force[start : start + length],
            response[start : start + length],
            quantity,
            start_time=float(start * train.step),
            response_point=points[0],
            reference_point=points[1],
        )
        for number, start in enumerate(train.starts, start=1)
    ]


class NotDiedAwayError(MeasurementError):
    """A record that ends while the response still goes on."""


def frf_of_transients(
    records: Sequence[HammerRecord],
    hold: Hold,
    band: tuple[float, float],
    estimator: Estimator = h1,
    added_decay: float = 0.0,
    left_at_end: float = LEFT_AT_END,
) -> Frf:
    """Estimate the FRF of transients that begin at rest and die away within their records.

    Nothing is windowed, so that nothing is changed. Records with the noise and faults of a test by
    hand are for `dynamics.frf.hammer`. Force and response are sampled together, a force that is
    held at the beginning of the step over which it acts; records are cut to the shortest, and the
    level of the response before the force sets in is taken off. The hold is what lay between the
    samples of the force. Kept are lines of the band, Hz, those with force; estimators are
    `dynamics.frf.hammer.h1` and `h2`. The coherence over the records is there where there are
    several.

    For records too short the added decay, 1/s, is that of an exponential weight on both channels;
    told in `Frf.added_decay`, by which fitted damping is put right. `left_at_end` is the share of
    the peak of the (weighted) response that may be left at the end of the record.

    MeasurementError if the records are not of one kind, the added decay is negative, or a line of
    the band holds no force; NotDiedAwayError if a response has not died away.
    """
    require_one_kind(records)
    if not 0.0 <= added_decay < np.inf:
        raise MeasurementError(f"added decay is {added_decay} 1/s; it must be 0 or more")
    rate = records[0].sampling_rate
    length = min(record.force.size for record in records)
    weight = np.exp(-added_decay / rate * np.arange(length))
    force = np.stack([record.force[:length] for record in records]) * weight
    response = np.stack([_from_rest(record)[:length] for record in records]) * weight
    for record, column in zip(records, response, strict=True):
        _require_died_away(record.name, column, left_at_end)
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    kept = (frequency >= band[0]) & (frequency <= band[1])
    if np.count_nonzero(kept) < 2:
        raise MeasurementError(
            f"{records[0].name}: fewer than two lines from {band[0]:g} to {band[1]:g} Hz; lines "
            f"are {rate / length:g} Hz apart up to {0.5 * rate:g} Hz"
        )
    spectra = spectra_of_segments(
        frequency[kept],
        np.fft.rfft(force)[:, kept],
        np.fft.rfft(response)[:, kept],
        records[0].quantity,
        added_decay,
        (records[0].response_point, records[0].reference_point),
    )
    names = ", ".join(record.name for record in records)
    return without_hold(averaged_frf(spectra, estimator, names), hold, 1.0 / rate)


def _from_rest(record: HammerRecord) -> NDArray[np.float64]:
    """Response less its level before the force sets in."""
    magnitude = np.abs(record.force)
    if magnitude.max() == 0.0:
        raise MeasurementError(f"{record.name}: the force is zero throughout")
    onset = int(np.argmax(magnitude > _BEGUN * magnitude.max()))
    return record.response - record.response[: max(onset, 1)].mean()


def _require_died_away(name: str, response: NDArray[np.float64], left_at_end: float) -> None:
    peak = np.abs(response).max()
    end = np.abs(response[-max(1, int(_END * response.size)) :]).max()
    if end > left_at_end * peak:
        raise NotDiedAwayError(
            f"{name}: {end / peak:.2g} of the peak of the response is left at the end of the "
            f"record, more than {left_at_end:g}; record for longer, or add a decay"
        )
