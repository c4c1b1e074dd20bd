"""A set of hammer records examined, averaged, and what was left out of it."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from dynamics.frf.container import Frf, MeasurementError
from dynamics.frf.hammer.examine import examine_records
from dynamics.frf.hammer.hit import locate_hit, with_later_blows
from dynamics.frf.hammer.record import Finding, HammerRecord
from dynamics.frf.hammer.spectra import Estimator, averaged_spectra, frf_of, h1, usable_band
from dynamics.frf.hammer.windows import choose_windows


@dataclass(frozen=True)
class HammerTest:
    """FRF of a set of hammer records."""

    frf: Frf  # average over the records used, from 0 Hz to half the sampling rate
    # of each record used, alone, with the same windows and lines; for a fit across all
    record_frfs: tuple[Frf, ...]
    usable_band: tuple[float, float]  # Hz; where force and coherence suffice
    used: tuple[str, ...]  # names of the records averaged
    # faults for which records were left out; a record may have several
    excluded: tuple[Finding, ...]
    # faults of records averaged all the same, because they were asked to be kept
    kept: tuple[Finding, ...]
    remarks: tuple[Finding, ...]  # what the examination could not decide

    @property
    def frf_in_band(self) -> Frf:
        """The average over the usable band only."""
        return self.frf.band(*self.usable_band)

    @property
    def frfs(self) -> tuple[Frf, ...]:
        """What a modal fit takes: the average of all records used, over the usable band."""
        return (self.frf_in_band,)


def hammer_test(
    records: Sequence[HammerRecord],
    keep: Collection[str] = (),
    estimator: Estimator = h1,
    unreadable: Sequence[tuple[str, str]] = (),
) -> HammerTest:
    """Examine hammer records, leave out the faulty ones and average the rest.

    Records are of one sampling rate and quantity; those named in `keep` are averaged whatever the
    examination finds. Estimators are `dynamics.frf.hammer.spectra.h1` and `h2`. Unreadable are
    files of the set that could not be read, by name and reason. MeasurementError if no good record
    is left, a name in `keep` is unknown, or a record that is unreadable or without any hit is to be
    kept.
    """
    findings = [Finding(name, "unreadable", reason) for name, reason in unreadable]
    findings += examine_records(records)
    _require_keepable(records, keep, findings)
    decisive = [finding for finding in findings if finding.is_decisive]
    faulty = {finding.record for finding in decisive} - set(keep)
    used = [record for record in records if record.name not in faulty]
    if not used:
        reasons = "; ".join(f"{finding.record}: {finding.reason}" for finding in decisive)
        raise MeasurementError(f"no good record among {len(records)}: {reasons}")
    bounced = {finding.record for finding in decisive if finding.fault == "double_hit"}
    hits = [
        with_later_blows(record, hit) if record.name in bounced else hit
        for record, hit in ((record, locate_hit(record)) for record in used)
    ]
    windows = choose_windows(used, hits)
    spectra = averaged_spectra(used, windows, hits)
    singles = [
        frf_of(averaged_spectra([record], windows, [hit]), h1, record.source or record.name)
        for record, hit in zip(used, hits, strict=True)
    ]
    names = tuple(record.name for record in used)
    return HammerTest(
        frf=frf_of(spectra, estimator, ", ".join(names)),
        record_frfs=tuple(singles),
        usable_band=usable_band(spectra),
        used=names,
        excluded=tuple(finding for finding in decisive if finding.record in faulty),
        kept=tuple(finding for finding in decisive if finding.record not in faulty),
        remarks=tuple(finding for finding in findings if not finding.is_decisive),
    )


def _require_keepable(
    records: Sequence[HammerRecord], keep: Collection[str], findings: Sequence[Finding]
) -> None:
    for finding in findings:
        if finding.fault in ("unreadable", "no_hit", "cut_hit") and finding.record in keep:
            raise MeasurementError(f"{finding.record} cannot be kept: {finding.reason}")
    names = [record.name for record in records]
    for name in keep:
        if name not in names:
            raise MeasurementError(f"no record {name!r} to keep; there are {', '.join(names)}")
