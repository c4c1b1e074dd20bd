"""Compute points one by one, keeping each as it is finished."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from chatter.errors import InputError, RunError
from chatter.stability.sweep import Progress, no_progress
from chatter.what_if.design import DesignPoint
from chatter.what_if.finished import FinishedPoints, key_of
from chatter.what_if.measures import Curve, Measure, Outcome
from chatter.what_if.subject import fingerprint, patched

if TYPE_CHECKING:
    from chatter.what_if.subject import Subject

#: called with the number of points that were finished before, and of all
Resumed = Callable[[int, int], None]


def no_report(before: int, total: int) -> None:
    """Report nothing."""


def outcomes_of(
    subject: Subject,
    points: Sequence[DesignPoint],
    measure: Measure,
    method: str | None = None,
    only: tuple[str, ...] = (),
    folder: str | Path | None = None,
    progress: Progress = no_progress,
    resumed: Resumed = no_report,
) -> list[Outcome]:
    """Outcome of every point; those that the folder holds already are not computed again.

    Parameters
    ----------
    subject : Case or MachineFile
    points : sequence of DesignPoint
    measure : Measure
    method : str, optional
        Of stability.
    only : tuple of str
        Names of FRFs.
    folder : path, optional
        Where finished points are kept.
    progress, resumed : callable, optional

    Raises
    ------
    InputError
        If a patch is wrong (before anything is computed), or no point can be computed.
    RunError
        If it is interrupted, or every run fails.
    """
    subjects = [patched(subject, point.patch) for point in points]
    store = FinishedPoints(folder)
    asked = (measure.name, method or "", ",".join(only))
    keys = [key_of(fingerprint(each), *asked) for each in subjects]
    before = sum(key in store for key in keys)
    if before:
        resumed(before, len(points))
    errors: list[InputError | RunError] = []
    try:
        for done, (key, each) in enumerate(zip(keys, subjects, strict=True)):
            progress(done, len(points))
            if key in store:
                continue
            outcome = _outcome(measure, each, method, only, errors)
            # what failed is not kept on disk: it is tried again
            keep = store.remember if outcome.failure else store.add
            keep(key, asdict(outcome))
    except KeyboardInterrupt:
        raise store.interrupted(keys, "points") from None
    progress(len(points), len(points))
    if errors and all(store[key]["failure"] for key in keys):
        raise errors[0]
    return [_read(store[key]) for key in keys]


def _outcome(
    measure: Measure,
    subject: Subject,
    method: str | None,
    only: tuple[str, ...],
    errors: list[InputError | RunError],
) -> Outcome:
    try:
        return measure.evaluate(subject, method, only)
    except (InputError, RunError) as error:
        errors.append(error)
        return Outcome(failure=str(error))


def _read(record: dict) -> Outcome:
    curves = tuple(Curve(**curve) for curve in record["curves"])
    return Outcome(record["numbers"], record["words"], curves, record["failure"], record["units"])
