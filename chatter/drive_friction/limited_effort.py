"""Efforts that stand flat, as at the limit of a drive or an amplifier, and what is made of them.

Where a drive is at its limit nothing damps the axis: it vibrates under a constant effort, and its
acceleration answers for nothing in the effort. A lower low-pass keeps the mean motion, which obeys
the law. Where an amplifier or a limit cuts the record itself, the effort is not what moved the
axis, and its samples are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.arrays import Array
from chatter.drive_friction.friction_laws import FitSettings, FittedFriction, fit_coulomb
from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.record import DriveRecord

#: unexplained share of the effort above which its values are not to be used
UNEXPLAINED = 0.2
#: a remedy is taken where it leaves less than this share of what was unexplained
_BETTER = 0.5
#: width of a flat top: this many deviations of the noise, and this share of the top
_NOISES, _FLAT = 6.0, 0.005
#: times more samples in the flat top than in as wide a band below; a sine has 2.4 times as many
_PILED_UP = 5.0
#: least share of the samples of the records in flat tops
_LEAST = 0.02
#: share of the samples of flat tops where the law of the others asks for more, if they are cut
_CUT = 0.75
#: lowest low-pass that is tried, in periods a record
_PERIODS = 2.0


@dataclass(frozen=True, eq=False)
class FlatTops:
    """Samples at the largest effort of the records, in either direction."""

    level: float  # N or N m
    marked: tuple[NDArray[np.bool_], ...]  # (n,) of each record

    @property
    def share(self) -> float:
        """Share of the samples of all records."""
        return float(np.mean(np.concatenate(self.marked)))


@dataclass(frozen=True, eq=False)
class Remedy:
    """Records and settings with which a law explains the effort."""

    records: tuple[DriveRecord, ...]
    settings: FitSettings


def unexplained(
    fit: FittedFriction, records: Sequence[DriveRecord], settings: FitSettings
) -> float:
    """Rms of what a law leaves of the effort of judged samples, over the rms of the effort."""
    left, whole = [], []
    low_pass = settings.low_pass
    for record in records:
        effort = low_pass.apply(record.effort, record.sample_time)
        judged = np.abs(record.velocity) >= settings.minimum_speed
        judged &= ~record.near_excluded(low_pass.settling)
        left.append((fit.effort(record, low_pass) - effort)[judged])
        whole.append(effort[judged] - fit.offset)
    size = max(_rms(whole), np.finfo(float).tiny)
    return _rms(left) / size


def flat_tops(records: Sequence[DriveRecord], low_pass: LowPass) -> FlatTops | None:
    """Flat tops of the efforts; none where they peak as they like.

    MeasurementError if the low-pass does not fit a record.
    """
    noise = max(
        float(np.std(one.effort - low_pass.apply(one.effort, one.sample_time))) for one in records
    )
    marked = [np.zeros(len(one.time), dtype=np.bool_) for one in records]
    levels = []
    for sign in (1.0, -1.0):
        top = max(float(np.max(sign * one.effort)) for one in records)
        # the steps onto a flat top are above the low-pass, but no noise: a tenth at the most
        width = max(min(_NOISES * noise, 0.1 * top), _FLAT * top)
        if not top > 0.0 or not _piled_up(records, sign, top, width):
            continue
        levels.append(top)
        for k, one in enumerate(records):
            marked[k] |= sign * one.effort >= top - width
    found = FlatTops(max(levels), tuple(marked)) if levels else None
    return found if found is not None and found.share >= _LEAST else None


def _piled_up(records: Sequence[DriveRecord], sign: float, top: float, width: float) -> bool:
    effort = sign * np.concatenate([one.effort for one in records])
    within = np.count_nonzero(effort >= top - width)
    below = np.count_nonzero((effort >= top - 2.0 * width) & (effort < top - width))
    return within >= _PILED_UP * max(below, 1)


def remedy(
    records: Sequence[DriveRecord],
    fit: FittedFriction,
    settings: FitSettings,
    tops: FlatTops | None,
    others: Sequence[FitSettings],
) -> Remedy | None:
    """What makes the effort of records explained; none where it is, or nothing does.

    A law of Coulomb friction judges. The other settings are tried where too much is unexplained.
    """
    before = unexplained(fit, records, settings)
    tried = []
    if tops is not None:
        tried.append(_without(records, settings, tops))
    if before > UNEXPLAINED:
        tried += [(Remedy(tuple(records), one), _fitted(records, one)) for one in others]
    judged = [
        (unexplained(found, one.records, one.settings), k)
        for k, (one, found) in enumerate(tried)
        if found is not None
    ]
    if not judged or min(judged)[0] >= _BETTER * before:
        return None
    return tried[min(judged)[1]][0]


def _without(
    records: Sequence[DriveRecord], settings: FitSettings, tops: FlatTops
) -> tuple[Remedy, FittedFriction | None]:
    rest = tuple(
        replace(one, excluded=mark) for one, mark in zip(records, tops.marked, strict=True)
    )
    fit = _fitted(rest, settings)
    if fit is not None and not _asks_for_more(fit, records, settings, tops):
        fit = None
    return Remedy(rest, settings), fit


def _asks_for_more(
    fit: FittedFriction, records: Sequence[DriveRecord], settings: FitSettings, tops: FlatTops
) -> bool:
    """Whether a law asks for an effort above the flat tops, so that these were cut."""
    more = [
        (np.sign(one.effort) * fit.effort(one, settings.low_pass) >= np.abs(one.effort))[mark]
        for one, mark in zip(records, tops.marked, strict=True)
    ]
    return float(np.mean(np.concatenate(more))) >= _CUT


def lower_low_passes(records: Sequence[DriveRecord], settings: FitSettings) -> list[FitSettings]:
    """Settings with lower and lower cut-off frequencies, as far as records are long."""
    shortest = min(float(one.time[-1] - one.time[0]) for one in records)
    cutoffs = []
    cutoff = 0.5 * settings.low_pass.cutoff
    while cutoff * shortest >= _PERIODS:
        cutoffs.append(cutoff)
        cutoff *= 0.5
    return [replace(settings, low_pass=LowPass(one)) for one in cutoffs]


def _fitted(records: Sequence[DriveRecord], settings: FitSettings) -> FittedFriction | None:
    try:
        return fit_coulomb(records, settings)
    except MeasurementError:
        return None


def _rms(parts: Sequence[Array]) -> float:
    whole = np.concatenate(parts)
    return float(np.sqrt(np.mean(whole**2))) if whole.size else 0.0
