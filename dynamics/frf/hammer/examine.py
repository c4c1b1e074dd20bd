"""Examination of the records of a set, each on its own and against the others."""

from collections.abc import Sequence

import numpy as np

from dynamics.frf.container import MeasurementError
from dynamics.frf.hammer.channel_checks import channel_findings
from dynamics.frf.hammer.force_checks import force_findings
from dynamics.frf.hammer.hit import Hit, locate_hit
from dynamics.frf.hammer.record import Finding, HammerRecord
from dynamics.frf.hammer.record_comparison import findings_against_each_other
from dynamics.frf.hammer.response_checks import decay_end, response_findings


def examine_records(records: Sequence[HammerRecord]) -> list[Finding]:
    """Examine every record for faults, first on its own, then against the others.

    Each record alone: no hit, a second blow, clipping, dropouts, stuck samples and drift of either
    channel, a response that does not answer. Then the records without such faults predict each
    other's response: a wrong gain or polarity, a trigger skew, a late bump without force, a
    response that does not follow the force. Limits come from the noise of each record and from the
    scatter of those that agree. Findings are in the order of the records. MeasurementError if
    sampling rates or quantities differ, or two records have one name.
    """
    require_one_kind(records)
    findings: list[Finding] = []
    sound: list[tuple[HammerRecord, Hit]] = []
    for record in records:
        try:
            hit = locate_hit(record)
        except MeasurementError as error:
            reason = str(error).removeprefix(f"{record.name}: ")
            findings.append(Finding(record.name, "no_hit", reason))
            continue
        own = force_findings(record, hit)
        known = {finding.fault for finding in own}
        own += [f for f in channel_findings(record, hit) if f.fault not in known]
        if not own:  # with a faulty force there is no telling where the response should begin
            own = response_findings(record, hit)
        findings += own
        if not own:
            sound.append((record, hit))
    late = _late_hits(sound)
    findings += late
    names = {finding.record for finding in late}
    sound = [(record, hit) for record, hit in sound if record.name not in names]
    findings += findings_against_each_other(sound)
    order = {record.name: index for index, record in enumerate(records)}
    return sorted(findings, key=lambda finding: order[finding.record])


def require_one_kind(records: Sequence[HammerRecord]) -> None:
    """Raise MeasurementError unless records share rate and quantity and have names of their own."""
    if not records:
        raise MeasurementError("no hammer record to examine")
    first = records[0]
    names = set()
    for record in records:
        if abs(record.sampling_rate - first.sampling_rate) > 1e-4 * first.sampling_rate:
            raise MeasurementError(
                f"{record.name} is sampled at {record.sampling_rate:g} Hz and {first.name} at "
                f"{first.sampling_rate:g} Hz; the records of a set must be sampled alike"
            )
        if record.quantity != first.quantity:
            raise MeasurementError(
                f"{record.name} gives {record.quantity} and {first.name} {first.quantity}; "
                "the records of a set must measure the same"
            )
        if record.name in names:
            raise MeasurementError(f"two records are named {record.name}")
        names.add(record.name)


def _late_hits(sound: list[tuple[HammerRecord, Hit]]) -> list[Finding]:
    """Records whose ringing is cut off where that of the others is not: triggered too early."""
    if not sound:
        return []
    left = [record.force.size - hit.onset for record, hit in sound]
    usual = float(np.median(left))
    per_sample = 1e3 / sound[0][0].sampling_rate  # milliseconds
    return [
        Finding(
            record.name,
            "late_hit",
            f"the blow comes {hit.onset * per_sample:.0f} ms into the record, which cuts the "
            f"ringing off after {samples * per_sample:.0f} ms; the others leave "
            f"{usual * per_sample:.0f} ms",
        )
        for (record, hit), samples in zip(sound, left, strict=True)
        if samples < 0.5 * usual and decay_end(record, hit) >= record.force.size
    ]
