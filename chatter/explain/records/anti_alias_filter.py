"""Order of the filter before the converter, told by how a case fits all the records together."""

from dataclasses import replace

from chatter.description.case import Case
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.alignment import ORDERS
from chatter.explain.records.steady_record import SteadyRecord

#: share of the misfit that another order must take away: less is as well explained by the case
_LEAST_GAIN = 0.05


def with_filter_by(measurement: Measurement, case: Case) -> Measurement:
    """Return the measurement with the order of the filter by which a case fits its records best.

    One converter makes all the records of a measurement. Corner frequency, start angle and offsets
    are found anew for each order.
    """
    wholes = {id(whole): whole for whole in map(_whole, measurement.runs) if _is_steady(whole)}
    if not wholes:
        return measurement
    now = next(iter(wholes.values())).record.recorded.order
    misfit = {order: _misfit(list(wholes.values()), case, order) for order in ORDERS}
    best = min(misfit, key=lambda order: misfit[order])
    if misfit[best] > (1.0 - _LEAST_GAIN) * misfit[now]:
        return measurement
    changed = {key: _filtered(whole, best) for key, whole in wholes.items()}
    runs = []
    for run in measurement.runs:
        whole = changed.get(id(_whole(run)))
        if whole is None:
            runs.append(run)
        elif run.whole is None:
            runs.append(whole)
        else:
            runs.append(replace(run, record=whole.record, whole=whole))
    return measurement.with_runs(runs)


def _whole(run: Run) -> Run:
    return run.whole or run


def _is_steady(run: Run) -> bool:
    return isinstance(run.record, SteadyRecord)


def _misfit(runs: list[Run], case: Case, order: int) -> float:
    """Sum of squares of what differs between runs and their predictions."""
    return sum(run.record.with_filter_of(order).aligned(run.of(case)).misfit for run in runs)


def _filtered(run: Run, order: int) -> Run:
    return replace(run, record=run.record.with_filter_of(order))
