"""Records that are sound by themselves, judged against each other."""

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.frf.hammer.comparison import (
    Comparison,
    Limits,
    RecordAssessment,
    compare,
    largest_excess,
)
from dynamics.frf.hammer.consensus import AlignedSet, agreeing_group, align, disagreement
from dynamics.frf.hammer.hit import Hit
from dynamics.frf.hammer.naming import named
from dynamics.frf.hammer.record import Finding, HammerRecord

#: least deviation of a gain from the others' that may count, and least that always does
_GAIN, _WIDEST_GAIN = 0.06, 0.25
#: least delay against the others that counts, samples
_DELAY = 0.3
#: least share of the predicted response by which two blows of a hand may differ
_TOLERANCE = 0.01
#: least root of the share of unexplained energy that counts
_MISFIT = 0.1
#: chance with which scatter alone may put a good record beyond its limits
_CHANCE = 1e-3
#: agreeing records from which their spread says something
_ENOUGH_FOR_SPREAD = 4
#: noise over peak, against the median of the set and absolutely, above which nothing is coherent
_NOISE_OVER_OTHERS = 5.0
_NOISE_OVER_PEAK = 0.025


def findings_against_each_other(sound: list[tuple[HammerRecord, Hit]]) -> list[Finding]:
    """Judge each record by what the others make of its blow.

    The records that agree predict each other's response from the force; the worst offender among
    them leaves first and the rest are judged anew, so that one fault does not blame the others.

    Of records without a fault of their own; remarks only where there are too few, or no agreement,
    to tell which is at fault.
    """
    if len(sound) < 2:
        return [_alone(record) for record, _ in sound]
    records = [record for record, _ in sound]
    aligned = align(records, [hit for _, hit in sound])
    difference = disagreement(aligned)
    members, agreement = agreeing_group(difference)
    if not members.any():
        return _undecided(records, difference)
    members = _without_offenders(aligned, members, agreement)
    findings = [_noisy(aligned, row, members) for row in range(len(records))]
    for row, assessment in enumerate(_assessed(aligned, members, agreement)):
        if findings[row] is not None or assessment.severity <= 1.0:
            continue
        others = int(members.sum()) - int(members[row])
        findings[row] = named(records[row], aligned, assessment, others)
    return [finding for finding in findings if finding is not None]


def _alone(record: HammerRecord) -> Finding:
    return Finding(
        record.name,
        "not_comparable",
        "no other good record to compare with: gain, polarity, timing and coherence cannot be "
        "judged",
        is_decisive=False,
    )


def _undecided(records: list[HammerRecord], difference: NDArray[np.float64]) -> list[Finding]:
    """Remarks where no majority agrees."""
    apart = difference + np.where(np.eye(len(records), dtype=bool), np.inf, 0.0)
    return [
        Finding(
            record.name,
            "not_comparable",
            f"differs by {apart[row].min():.0%} from the record it is most like; of "
            f"{len(records)} records too few agree to tell which are at fault",
            is_decisive=False,
        )
        for row, record in enumerate(records)
    ]


def _assessed(
    aligned: AlignedSet, members: NDArray[np.bool_], agreement: float
) -> list[RecordAssessment]:
    """Judge every record by the members, itself left out, and by how far those scatter."""
    comparisons = [compare(aligned, row, members) for row in range(members.size)]
    assessments = []
    for row, comparison in enumerate(comparisons):
        others = [comparisons[i] for i in np.flatnonzero(members) if i != row]
        limits = _limits(others, agreement)
        excess = largest_excess(comparison, limits.tolerance)
        assessments.append(RecordAssessment(comparison, excess, limits))
    return assessments


def _without_offenders(
    aligned: AlignedSet, members: NDArray[np.bool_], agreement: float
) -> NDArray[np.bool_]:
    """Members after the worst offenders have left one by one."""
    members = members.copy()
    while members.sum() > 2:
        assessments = _assessed(aligned, members, agreement)
        severities = [
            assessment.severity if member else 0.0
            for assessment, member in zip(assessments, members, strict=True)
        ]
        worst = int(np.argmax(severities))
        if severities[worst] <= 1.0:
            break
        members[worst] = False
    return members


def _limits(others: list[Comparison], agreement: float) -> Limits:
    misfit = float(np.median([comparison.misfit for comparison in others]))
    few = len(others) < _ENOUGH_FOR_SPREAD
    return Limits(
        gain=min(max(_GAIN, _unlikely([comparison.gain for comparison in others])), _WIDEST_GAIN),
        delay=max(_DELAY, _unlikely([comparison.delay for comparison in others])),
        misfit=max(_MISFIT, agreement if few else 0.0, 3.0 * misfit),
        tolerance=max(_TOLERANCE, 2.0 * misfit),
    )


def _unlikely(values: list[float]) -> float:
    """Deviation of one more value from some that their scatter makes unlikely (Student's t)."""
    count = len(values)
    if count < _ENOUGH_FOR_SPREAD:
        return 3.0 * float(np.ptp(values))
    quantile = float(scipy.stats.t.isf(0.5 * _CHANCE, count - 1))
    return quantile * float(np.std(values, ddof=1)) * float(np.sqrt(1.0 + 1.0 / count))


def _noisy(aligned: AlignedSet, row: int, members: NDArray[np.bool_]) -> Finding | None:
    """A response whose noise stands far above that of the others, measured by its own peak."""
    share = aligned.noise / np.max(np.abs(aligned.response[:, : aligned.ringing]), axis=1)
    usual = float(np.median(share[members]))
    if share[row] < max(_NOISE_OVER_OTHERS * usual, _NOISE_OVER_PEAK):
        return None
    return Finding(
        aligned.names[row],
        "no_coherence",
        f"the response is noisy: its noise is {share[row]:.1%} of its peak, in the other records "
        f"{usual:.2%}",
    )
