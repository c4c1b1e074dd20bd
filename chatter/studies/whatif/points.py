"""Compute points one by one, keeping each as it is finished."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import Executor
from chatter.studies.model import fingerprint, patched
from chatter.studies.result_cache import ResultCache
from chatter.studies.whatif.design import DesignPoint
from chatter.studies.whatif.measures import Curve, Measure, Outcome, measure_of

if TYPE_CHECKING:
    from chatter.studies.model import Model

#: called with the number of points that were finished before, and of all
Resumed = Callable[[int, int], None]


def no_report(before: int, total: int) -> None:
    """Report nothing."""


def outcomes_of(
    model: Model,
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
    model : Case or MachineFile
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
    models = [patched(model, point.patch) for point in points]
    evaluate = partial(_record, measure.name, method, only)
    with ResultCache(folder, measure.name, method or "", ",".join(only)) as cache:
        keys = [cache.key(fingerprint(each)) for each in models]
        before = cache.finished(keys)
        if before:
            resumed(before, len(points))
        records = cache.evaluate(evaluate, models, keys, "points", cluster, progress)
    if all(record["failure"] for record in records):
        first = records[0]
        raise (
            InputError(first["wrong_input"]) if first["wrong_input"] else RunError(first["failure"])
        )
    return [_outcome(record) for record in records]


def _record(
    measure: str, method: str | None, only: tuple[str, ...], model: Model
) -> dict[str, Any]:
    """Record of a point, with what is wrong with its input."""
    messages: tuple[str, ...] = ()
    try:
        outcome = measure_of(measure, model).evaluate(model, method, only)
    except InputError as error:
        outcome, messages = Outcome(failure=str(error)), error.messages
    except RunError as error:
        outcome = Outcome(failure=str(error))
    return {**asdict(outcome), "input_errors": messages}


def _outcome(record: dict[str, Any]) -> Outcome:
    curves = tuple(Curve(**curve) for curve in record["curves"])
    return Outcome(record["numbers"], record["words"], curves, record["failure"], record["units"])
