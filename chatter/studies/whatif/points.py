"""Compute points one by one, keeping each as it is finished."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import Executor
from chatter.studies.executor import open_executor
from chatter.studies.finished_points import FinishedPoints, key_of
from chatter.studies.whatif.design import DesignPoint
from chatter.studies.whatif.measures import Curve, Measure, Outcome, measure_of
from chatter.studies.whatif.model import fingerprint, patched

if TYPE_CHECKING:
    from chatter.studies.whatif.model import Subject

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
    cluster: str | Executor | None = None,
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
    cluster : str or Executor, optional
        Where points are computed, as for `chatter.studies.executor.open_executor`.

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
    # two points of the same input are computed once
    missing = list(
        {key: each for key, each in zip(keys, subjects, strict=True) if key not in store}.items()
    )
    errors: dict[str, tuple[str, ...]] = {}
    done = len(points) - len(missing)
    progress(done, len(points))
    try:
        with open_executor(cluster if missing else None) as executor:
            evaluate = partial(_outcome, measure.name, method, only)
            wanted = [each for _, each in missing]
            for place, (outcome, wrong) in executor.results(evaluate, wanted):
                key = missing[place][0]
                # what failed is not kept on disk: it is tried again
                keep = store.remember if outcome["failure"] else store.add
                keep(key, outcome)
                errors.update({key: wrong} if wrong else {})
                done += 1
                progress(done, len(points))
    except KeyboardInterrupt:
        raise store.interrupted(keys, "points") from None
    if all(store[key]["failure"] for key in keys):
        first = next(key for key in keys if store[key]["failure"])
        raise InputError(errors[first]) if errors.get(first) else RunError(store[first]["failure"])
    return [_read(store[key]) for key in keys]


def _outcome(
    measure: str, method: str | None, only: tuple[str, ...], subject: Subject
) -> tuple[dict, tuple[str, ...]]:
    """Record of a point, and what is wrong with its input."""
    try:
        return asdict(measure_of(measure, subject).evaluate(subject, method, only)), ()
    except InputError as error:
        return asdict(Outcome(failure=str(error))), error.messages
    except RunError as error:
        return asdict(Outcome(failure=str(error))), ()


def _read(record: dict) -> Outcome:
    curves = tuple(Curve(**curve) for curve in record["curves"])
    return Outcome(record["numbers"], record["words"], curves, record["failure"], record["units"])
