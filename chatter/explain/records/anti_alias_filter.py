"""Order of the filter before the converter, told by how a case fits all the records together."""

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
    # a record once, of whatever parts its run is judged in
    steady = {id(run.record): run.whole or run for run in measurement.runs if _is_steady(run)}
    if not steady:
        return measurement
    runs = list(steady.values())
    now = runs[0].record.filter_order
    of_runs = [run.record.misfits(run.of(case), ORDERS) for run in runs]
    misfit = {order: sum(one[order] for one in of_runs) for order in ORDERS}
    best = min(misfit, key=lambda order: misfit[order])
    if misfit[best] > (1.0 - _LEAST_GAIN) * misfit[now]:
        return measurement
    records = {key: run.record.with_filter_of(best) for key, run in steady.items()}
    return measurement.with_runs(
        [
            run.with_record(records[id(run.record)]) if id(run.record) in records else run
            for run in measurement.runs
        ]
    )


def _is_steady(run: Run) -> bool:
    return isinstance(run.record, SteadyRecord)
