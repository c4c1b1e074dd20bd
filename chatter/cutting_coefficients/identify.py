"""`coefficients`: laws compared by the mean forces of a series of cuts, the one to keep."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from chatter.cutting_coefficients.fit import FittedLaw, fitted_law
from chatter.cutting_coefficients.in_the_cut import in_the_cut
from chatter.cutting_coefficients.laws import BY_DIRECTION, LAWS, TriedLaw, of_directions
from chatter.cutting_coefficients.mean_forces import MeanForce, mean_forces
from chatter.cutting_coefficients.number_of_cuts import number_of_cuts
from chatter.cutting_coefficients.records_of_cuts import read_records
from chatter.cutting_coefficients.result import Coefficients
from chatter.cutting_coefficients.varied_cut import with_parts
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.measurement import Measurement
from chatter.explain.records.description import FORCE

#: cuts of which each can be left out in turn
_ENOUGH_CUTS = 3
#: share of the error of one law for all directions, below which each has its own form
_BETTER = 0.8


def coefficients(
    records: str | Path | Measurement,
    case: str | Path | Case | None = None,
    hold_out: Sequence[str] = (),
    columns: str | None = None,
) -> Coefficients:
    """Cutting coefficients from the mean forces of a series of cuts.

    Means over whole revolutions of the rigid tool: start angle, runout that lets no tooth miss, the
    resonances of a dynamometer and vibration drop out of them (Altintas 2012, Manufacturing
    Automation, section 2.8). Linear and exponential laws are fitted, with and without edge forces,
    and that is kept which predicts best the cuts held out one by one (Akaike's criterion where
    there are too few). Beside it every direction is fitted by a line or a power of its own.

    Parameters
    ----------
    records : path or Measurement
        Measurement folder of kind "milling": a case with tool and cut, and runs that differ by
        feed, depth or width; forces with known directions, their senses may be unknown. Or one
        file of forces, whose columns feed_per_tooth, feed_rate, axial_depth and radial_depth tell
        how the cut was varied.
    case : path or Case, optional
        In place of the case that measurement.toml names, or of a file without one.
    hold_out : sequence of str
        Files of runs that are not fitted, and predicted by the others (`with_waveforms`).
    columns : str, optional
        Headings of a file without, such as "time [s], Fx [N], Fy [N]".

    Returns
    -------
    Coefficients

    Raises
    ------
    InputError
        If the records cannot be used, or determine no law.
    """
    if not isinstance(records, Measurement):
        records = read_records(records, case, columns)
    records.case.require("tool", "cut")
    _refuse_unknown_directions(records)
    given = [in_the_cut(records, run) for run in with_parts(records).runs]
    zeroed = all(one.is_zeroed for one in given)
    records, apart = _parted(records.with_runs([one.run for one in given]), hold_out)
    means = mean_forces(records)
    cases = {run.name: run.of(records.case) for run in records.runs}
    directions = [one.direction for one in means]
    fits = _fitted(of_directions(LAWS, directions), means, cases)
    if not fits:
        raise InputError(
            f"{records.folder}: {len(means)} mean forces of {number_of_cuts(len(cases))} determine "
            "no force law; forces along x and y of one cut are the least"
        )
    errors = [_holdout(fit, means, cases) for fit in fits]
    best = min(range(len(fits)), key=lambda k: _rank(fits[k], errors[k], len(means)))
    kept, error = fits[best], errors[best]
    by_direction = _fitted(of_directions(BY_DIRECTION, directions), means, cases)
    own = min(by_direction, key=lambda one: one.chi_square, default=None)
    beside = None if own is None else _holdout(own, means, cases)
    if own is not None and _is_needed(own, beside, kept, error, len(means)):
        kept, error = own, beside
        fits.append(own)
    return Coefficients(records, tuple(means), tuple(fits), kept, error, own, beside, apart, zeroed)


def _refuse_unknown_directions(records: Measurement) -> None:
    """Raise InputError where a force has no direction: mean forces do not tell it."""
    channels = {} if records.record is None else records.record.channels
    problems = [
        f"{records.folder}: channels.{name}.direction: is unknown, and coefficients need it; state "
        "it in the axes of the case, such as [0, 1, 0]; where its sense alone is unknown, "
        'sign = "unknown" beside it'
        for name, one in channels.items()
        if one.quantity == FORCE and one.direction is None
    ]
    if problems:
        raise InputError(problems)


def _is_needed(
    own: FittedLaw,
    beside: dict[str, float] | None,
    kept: FittedLaw,
    error: dict[str, float] | None,
    count: int,
) -> bool:
    """Whether the forces ask for a form of each direction in the place of one law for all.

    Where the readings contradict the law, no coefficient is below zero, and the cuts held out are
    predicted better by a margin.
    """
    if not kept.leaves_more_than_scatter(count) or np.any(own.values[own.law.cutting] < 0.0):
        return False
    if beside is None or error is None:
        return False
    return math.hypot(*beside.values()) < _BETTER * math.hypot(*error.values())


def _parted(
    records: Measurement, hold_out: Sequence[str]
) -> tuple[Measurement, Measurement | None]:
    """Runs that are fitted, and those that are not."""
    names = [run.name for run in records.runs]
    for name in hold_out:
        if name not in names:
            raise InputError(
                f"{records.folder}: {name} is held out, and is no run; there are {', '.join(names)}"
            )
    if not hold_out:
        return records, None
    fitted = [run for run in records.runs if run.name not in hold_out]
    if not fitted:
        raise InputError(f"{records.folder}: all runs are held out; none is left to fit")
    apart = [run for run in records.runs if run.name in hold_out]
    return records.with_runs(fitted), records.with_runs(apart)


def _fitted(
    laws: Sequence[TriedLaw], means: Sequence[MeanForce], cases: dict[str, Case]
) -> list[FittedLaw]:
    return [fit for law in laws if (fit := fitted_law(law, means, cases)) is not None]


def _rank(
    fit: FittedLaw, holdout: dict[str, float] | None, count: int
) -> tuple[float, bool, float, int]:
    """Error of the cuts held out, where there are enough; else what is not refuted, by a criterion.

    Two feeds determine a line with edge forces and leave nothing to judge it by; a law without them
    that the readings contradict is not better for being judged.
    """
    error = math.inf if holdout is None else math.hypot(*holdout.values())
    refuted = math.isinf(error) and bool(fit.leaves_more_than_scatter(count))
    return error, refuted, fit.criterion(count), fit.law.parameters


def _holdout(
    fit: FittedLaw, means: Sequence[MeanForce], cases: dict[str, Case]
) -> dict[str, float] | None:
    """Error of the mean forces of each cut by the law fitted to the others, over their size."""
    if len(cases) < _ENOUGH_CUTS:
        return None
    found = {}
    for name in cases:
        others = [one for one in means if one.run != name]
        rest = {key: case for key, case in cases.items() if key != name}
        again = fitted_law(fit.law, others, rest)
        if again is None:
            return None
        own = [one for one in means if one.run == name]
        predicted = again.mean_forces_of(own, cases[name])
        measured = np.array([one.value for one in own])
        found[name] = float(np.linalg.norm(predicted - measured) / np.linalg.norm(measured))
    return found
