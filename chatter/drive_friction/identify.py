"""`friction`: laws of friction compared on the moves of a drive, and the one to keep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.given_path import paths_given
from chatter.description.given_values import number_given
from chatter.drive_friction.drive_records import DriveRecords, DriveSettings, drive_records
from chatter.drive_friction.friction_laws import LAWS, FitSettings, FittedFriction
from chatter.drive_friction.limited_effort import flat_tops, lower_low_passes, remedy
from chatter.drive_friction.result import DriveFriction, TriedFriction
from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.record import DriveRecord
from dynamics.friction.lugre import LuGre

#: least share of the largest speed at which sliding is judged
_SLOW = 0.02
#: default low-pass: at most this, and this share of the sampling rate, Hz
_HIGHEST_CUTOFF, _CUTOFF_SHARE = 60.0, 0.06
#: records are cut into about so many parts where each is to be held out once
_PARTS = 4
#: a simpler law is kept where its error on what is held out is at most this much larger
_AS_GOOD = 1.02
#: bending of the bristles over the noise of the position, from which it is seen
_SEEN = 3.0
#: parameters without which a law says no more than the one before
_OWN: Mapping[str, tuple[str, ...]] = {
    "viscous": (),
    "coulomb": ("coulomb",),
    "stribeck": ("static", "stribeck_velocity"),
    "lugre": ("bristle_stiffness",),
}


def friction(
    files: str | Path | Sequence[str | Path] | DriveRecords,
    *,
    drive: DriveSettings | None = None,
    inertia: float | None = None,
    low_pass: float | None = None,
    law: str | None = None,
    name: str = "axis",
) -> DriveFriction:
    """Friction and inertia of a drive from records of its moves.

    Effort = inertia x acceleration + friction(motion) + offset, all signals through one low-pass
    (`dynamics.friction.identification`). Laws are tried in the order of what they can say; the
    simplest is kept whose error on parts held out is that of the best, and whose own parameters the
    records decide.

    Parameters
    ----------
    files : path, paths or DriveRecords
        Files with time, velocity or position, and force, torque or current; or a measurement
        folder of kind "axis".
    drive : DriveSettings, optional
        What the files cannot tell: columns, lead, motor constant.
    inertia : float, optional
        Known: the weighed mass, kg, or the moment of inertia about the motor, kg m^2.
    low_pass : float, optional
        Cut-off frequency, Hz; by default 60 Hz, and 6 % of the sampling rate at the most.
    law : str, optional
        Of `LAWS`, to be kept whatever the records say.
    name : str
        Of the axis in [friction.NAME].

    Returns
    -------
    DriveFriction

    Raises
    ------
    InputError
        If the records cannot be used, or determine no friction.
    """
    if law is not None and not (isinstance(law, str) and law in LAWS):
        raise InputError(f"law {formatted(law)} is none of {', '.join(LAWS)}")
    if isinstance(files, DriveRecords):
        given = files
    else:
        given = drive_records(paths_given(files, "a record of a drive"), drive)
    settings = _settings(given.records, inertia, low_pass)
    found = _identified(given, settings, law, name)
    try:
        tops = flat_tops(given.records, settings.low_pass)
    except MeasurementError:
        return found
    others = lower_low_passes(given.records, settings) if low_pass is None else []
    better = remedy(given.records, found.kept, settings, tops, others)
    if better is None:
        return replace(found, flat_tops=tops)
    explained = _identified(replace(given, records=better.records), better.settings, law, name)
    return replace(explained, flat_tops=tops, instead_of=found)


def _identified(
    given: DriveRecords, settings: FitSettings, law: str | None, name: str
) -> DriveFriction:
    records = given.records
    tried = []
    for one in LAWS if law is None else (law,):
        try:
            fit = LAWS[one](records, settings)
        except (MeasurementError, ValueError) as error:
            tried.append(TriedFriction(one, None, None, _reason(error, records)))
            continue
        tried.append(TriedFriction(one, fit, _holdout(one, records, settings)))
    kept = _kept(tried, law, records, settings)
    return DriveFriction(
        given, settings, tuple(tried), kept, _at_other_cutoffs(kept, given, settings), name
    )


def _reason(error: Exception, records: Sequence[DriveRecord]) -> str:
    return str(error).removeprefix(f"{records[0].name}: ").removeprefix("drive records: ")


def _settings(
    records: Sequence[DriveRecord], inertia: float | None, low_pass: float | None
) -> FitSettings:
    inertia = None if inertia is None else number_given(inertia, "--inertia")
    low_pass = None if low_pass is None else number_given(low_pass, "--low-pass")
    rate = min(1.0 / record.sample_time for record in records)
    cutoff = min(_HIGHEST_CUTOFF, _CUTOFF_SHARE * rate) if low_pass is None else low_pass
    if not 0.0 < cutoff < 0.5 * rate:
        raise InputError(
            f"--low-pass {cutoff:g} Hz: above 0 and below half the sampling rate, {0.5 * rate:g} "
            "Hz, is required"
        )
    if inertia is not None and not inertia > 0.0:
        raise InputError(f"--inertia {inertia:g}: above 0 is required")
    fastest = max(float(np.max(np.abs(record.velocity))) for record in records)
    return FitSettings(LowPass(cutoff), _SLOW * fastest, inertia)


def _parts(records: Sequence[DriveRecord]) -> list[DriveRecord]:
    """Records, cut in time where there are too few to hold one out."""
    if len(records) >= _PARTS:
        return list(records)
    count = -(-_PARTS // len(records))
    parts = []
    for record in records:
        ends = np.linspace(record.time[0], record.time[-1], count + 1)
        parts += [record.part(ends[k], ends[k + 1]) for k in range(count)]
    return parts


def _holdout(name: str, records: Sequence[DriveRecord], settings: FitSettings) -> float | None:
    """Error of the effort of parts held out one by one, over its deviation; None where none can."""
    try:
        parts = _parts(records)
    except MeasurementError:
        return None
    left, whole = [], []
    settings = replace(settings, starts=1)
    for k, part in enumerate(parts):
        try:
            fit = LAWS[name](parts[:k] + parts[k + 1 :], settings)
            error, effort = _error(fit, part, settings)
        except (MeasurementError, ValueError):
            continue
        left.append(error)
        whole.append(effort)
    if len(left) < 2:
        return None
    effort = np.concatenate(whole)
    return float(np.sqrt(np.mean(np.concatenate(left) ** 2)) / max(np.std(effort), 1e-300))


def _error(fit: FittedFriction, record: DriveRecord, settings: FitSettings) -> tuple[Array, Array]:
    """Error and effort of the samples of a record that move."""
    low_pass = settings.low_pass
    effort = low_pass.apply(record.effort, record.sample_time)
    moving = np.abs(record.velocity) >= settings.minimum_speed
    moving &= ~record.near_excluded(low_pass.settling)
    return (fit.effort(record, low_pass) - effort)[moving], effort[moving]


def _kept(
    tried: Sequence[TriedFriction],
    law: str | None,
    given: Sequence[DriveRecord],
    settings: FitSettings,
) -> FittedFriction:
    fitted = [one for one in tried if one.fit is not None]
    if not fitted:
        raise InputError(f"the records determine no friction: {tried[0].reason}")
    if law is not None:
        return fitted[0].fit
    sure = [
        one
        for one in fitted
        if all(_decided(one.fit, key) for key in _OWN[one.name])
        and _presliding_is_seen(one.fit, given, settings)
    ]
    if not sure:
        raise InputError(
            "the records determine no friction: no interval of a parameter leaves out 0; record "
            "longer moves, or both directions"
        )
    judged = [one for one in sure if one.holdout is not None]
    if not judged:
        return sure[-1].fit
    best = min(one.holdout for one in judged)
    return next(one.fit for one in judged if one.holdout <= _AS_GOOD * best)


def _decided(fit: FittedFriction, parameter: str) -> bool:
    """Whether the interval of a parameter has ends and leaves out 0, or Coulomb friction."""
    one = fit.estimates[parameter]
    above = fit.estimates["coulomb"].upper if parameter == "static" else 0.0
    return parameter not in fit.undecided and one.lower > above and np.isfinite(one.upper)


def _presliding_is_seen(
    fit: FittedFriction, records: Sequence[DriveRecord], settings: FitSettings
) -> bool:
    """Whether bristles bend further than the noise of the positions; and break away, not in."""
    law, low_pass = fit.law, settings.low_pass
    if not isinstance(law, LuGre):
        return True
    noise = min(
        float(np.std(one.position - low_pass.apply(one.position, one.sample_time)))
        for one in records
    )
    bent = law.coulomb / law.bristle_stiffness
    return bent > _SEEN * noise and fit.estimates["static"].upper >= fit.estimates["coulomb"].lower


def _at_other_cutoffs(
    kept: FittedFriction, given: DriveRecords, settings: FitSettings
) -> dict[float, FittedFriction]:
    """The same law with half and double the cut-off frequency, where the records bear it."""
    found = {}
    for factor in (0.5, 2.0):
        low_pass = LowPass(factor * settings.low_pass.cutoff)
        try:
            fit = LAWS[kept.name](given.records, replace(settings, low_pass=low_pass, starts=1))
        except (MeasurementError, ValueError):
            continue
        found[low_pass.cutoff] = fit
    return found
