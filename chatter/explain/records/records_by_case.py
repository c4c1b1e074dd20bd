"""What a case that was found tells of its records: how long they settle, and their filter."""

from collections.abc import Mapping

from chatter.description.case import Case
from chatter.description.errors import RunError
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.anti_alias_filter import order_of_filter
from chatter.explain.records.steady_cut import REVOLUTIONS, revolutions_to_settle
from chatter.explain.records.steady_record import SteadyRecord


def with_records_by(measurement: Measurement, case: Case) -> Measurement:
    """Return the measurement with its settled records as a case tells them; itself if as they are.

    A cut is simulated until it has settled by that case too: the declared case, by whose damping
    the revolutions were counted, may settle sooner. The anti-alias filter is that by which the case
    fits all the records best.
    """
    steady = _steady_runs(measurement)
    if not steady:
        return measurement
    settled = {key: _settled_by(run, case) for key, run in steady.items()}
    whole = [run.with_record(settled[key]) for key, run in steady.items()]
    order = order_of_filter(whole, case)
    return _with_records(measurement, {k: v.with_filter_of(order) for k, v in settled.items()})


def settled_further(measurement: Measurement) -> Measurement:
    """Return the measurement with its cuts simulated until a case of less damping has settled too.

    A fit by cuts that have not settled can be drawn to a damping by which they have.
    """
    found = {}
    for key, run in _steady_runs(measurement).items():
        longer = [one for one in REVOLUTIONS if one > run.record.revolutions]
        found[key] = run.record.with_revolutions(min(longer, default=run.record.revolutions))
    return _with_records(measurement, found)


def _steady_runs(measurement: Measurement) -> dict[int, Run]:
    """Whole runs with a settled record, each record once, by its identity."""
    return {id(run.record): run.whole or run for run in measurement.runs if _is_steady(run)}


def _with_records(measurement: Measurement, found: Mapping[int, SteadyRecord]) -> Measurement:
    """Measurement with other records; itself where none differs."""
    runs = [
        run.with_record(found[id(run.record)]) if id(run.record) in found else run
        for run in measurement.runs
    ]
    is_as_before = all(
        one.record is run.record for one, run in zip(runs, measurement.runs, strict=True)
    )
    return measurement if is_as_before else measurement.with_runs(runs)


def _settled_by(run: Run, case: Case) -> SteadyRecord:
    """Record of a run whose cut is simulated until it settles, never shorter than before."""
    try:
        needed = revolutions_to_settle(run.of(case))
    except RunError:  # it never does
        return run.record
    return run.record.with_revolutions(max(needed, run.record.revolutions))


def _is_steady(run: Run) -> bool:
    return isinstance(run.record, SteadyRecord)
