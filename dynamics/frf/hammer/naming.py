"""Putting a name and a reason to what sets a record apart from the others."""

import numpy as np
import scipy

from dynamics.frf.hammer.comparison import RecordAssessment
from dynamics.frf.hammer.consensus import AlignedSet
from dynamics.frf.hammer.record import Fault, Finding, HammerRecord
from dynamics.frf.hammer.written_number import written

#: factors by which a wrong unit or sensitivity scales a channel
_UNIT_SLIPS = {
    9.80665: "g taken for m/s^2 (or the reverse)",
    4.4482216: "lbf taken for N (or the reverse)",
    25.4: "inches taken for millimetres (or the reverse)",
    39.37008: "inches taken for metres (or the reverse)",
    1000.0: "a factor of a thousand in the unit",
    10.0: "a gain step of ten",
    100.0: "a gain step of a hundred",
}
#: unexplained share of the energy above which the response does not follow the force at all
_UNRELATED = 0.4
#: unexplained share of the energy below which gain and delay are the whole story
_EXPLAINED = 0.15
#: samples over which slow and fast parts of a residual are told apart
_SLOW = 256


def named(
    record: HammerRecord, aligned: AlignedSet, assessment: RecordAssessment, others: int
) -> Finding:
    """Name the fault of a record that deviates from the others, with the evidence.

    The severity is above 1; the finding is decisive where at least two of the others agree against
    the record.
    """
    fault, reason = _fault_and_reason(record, aligned, assessment)
    if others < 2:
        return Finding(
            record.name,
            "not_comparable",
            f"{reason}; with one other record to judge by it cannot be told which is at fault",
            is_decisive=False,
        )
    if others == 2:
        reason += " (judged by two records only)"
    return Finding(record.name, fault, reason)


def _fault_and_reason(
    record: HammerRecord, aligned: AlignedSet, assessment: RecordAssessment
) -> tuple[Fault, str]:
    comparison, limits = assessment.comparison, assessment.limits
    if comparison.misfit > _UNRELATED:
        return "no_coherence", (
            f"the response does not follow the force as in the other records: "
            f"{comparison.misfit**2:.0%} of its energy is left unexplained by gain and delay"
        )
    gain_is_off = abs(comparison.gain - 1.0) > limits.gain
    delay_is_off = abs(comparison.delay) > limits.delay
    if comparison.misfit < max(_EXPLAINED, limits.misfit) and (gain_is_off or delay_is_off):
        return _gain_or_delay(record, assessment)
    if assessment.excess.ratio > 1.0:
        return _local(record, aligned, assessment)
    return "unlike_the_others", (
        f"the response differs from what the other records predict by {comparison.misfit:.1%} of "
        f"its root energy (gain {comparison.gain:.3f}, delay {comparison.delay:+.2f} samples)"
    )


def _gain_or_delay(record: HammerRecord, assessment: RecordAssessment) -> tuple[Fault, str]:
    comparison, limits = assessment.comparison, assessment.limits
    gain, delay = comparison.gain, comparison.delay
    if abs(delay) > limits.delay:
        seconds = abs(delay) / record.sampling_rate
        also = f"; its gain is {gain:.3f}" if abs(gain - 1.0) > limits.gain else ""
        return "trigger_skew", (
            f"the response comes {seconds * 1e6:.0f} us ({abs(delay):.2f} samples) "
            f"{'late' if delay > 0 else 'early'} against the other records{also}"
        )
    if gain < 0.0:
        size = (
            f", and {written(abs(gain))} times as large" if abs(abs(gain) - 1) > limits.gain else ""
        )
        return "wrong_polarity", (
            f"response per force has the opposite sign to the other records{size}"
        )
    return "wrong_gain", (
        f"response per force is {written(gain)} times that of the other records{_unit_slip(gain)}"
    )


def _unit_slip(gain: float) -> str:
    for factor, meaning in _UNIT_SLIPS.items():
        if min(abs(gain / factor - 1.0), abs(gain * factor - 1.0)) < 0.01:
            return f": {meaning}?"
    return ""


def _local(
    record: HammerRecord, aligned: AlignedSet, assessment: RecordAssessment
) -> tuple[Fault, str]:
    """Name what is left over in one segment of the record."""
    comparison, excess = assessment.comparison, assessment.excess
    residual, response = comparison.residual, comparison.response
    near = slice(max(excess.start - _SLOW, 0), excess.stop + _SLOW)
    square = residual[near] ** 2
    energy = float(square.sum())
    sample = near.start + int(np.argmax(square))
    after = (sample - aligned.lead) / aligned.sampling_rate * 1e3
    what = f"{written(excess.size)} {record.response_unit} {after:.1f} ms after the hit"
    share = f"{excess.size / np.max(np.abs(response)):.1%} of the peak"
    if float(np.max(scipy.ndimage.uniform_filter1d(square, 6))) * 6.0 > 0.7 * energy:
        return "dropout", f"the response jumps by {what} ({share}) against the other records"
    extreme = np.abs(response[near]) > 0.85 * np.max(np.abs(response))
    if after < 20.0 and float(square[extreme].sum()) > 0.6 * energy:
        return "clipped", f"the response falls short at its peaks, by up to {what} ({share})"
    slow = scipy.ndimage.uniform_filter1d(residual, _SLOW)[near]
    if float(np.sum(slow**2)) > 0.6 * energy:
        return "drift", f"the response baseline moves, by {what} ({share})"
    if after < 1.0:
        return "unlike_the_others", (
            f"the response differs from what the other records predict by {what} ({share})"
        )
    return "late_bump", f"a disturbance that no force explains: {what} ({share})"
