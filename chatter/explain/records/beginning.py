"""Whether runs begin from rest, recognised by what they hold."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError, RunError
from chatter.explain.data_checks.finding import NOTE, SignalFinding
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.case_axes import in_case_axes
from chatter.explain.records.description import CUT, UNKNOWN, RecordDescription
from chatter.explain.records.from_rest import from_rest
from chatter.explain.records.recognition import settled_records

Array = NDArray[np.float64]

#: runs that are looked at
_MOST_RUNS = 4
#: error as a settled cut over that from rest below which a run did not begin from rest (a runout
#: that is missing leaves 0.6 of it to both), and error from rest below which it did
_BETTER, _FITS = 0.7, 0.35
#: displacement at the first sample, over its rms, up to which a tool is at rest
_AT_REST = 0.1
#: speeds that are sought around the declared one where nothing is told
_TOLERANCE = 0.005


def beginning_of(
    measurement: Measurement, record: RecordDescription | None
) -> tuple[RecordDescription | None, list[SignalFinding]]:
    """Description of records that are said, or by silence assumed, to begin from rest.

    One that begins in the cut at an unknown angle where the declared case fits so, and does not fit
    from rest; else as it was given.
    """
    cut = measurement.case.cut
    if cut is None or cut.speed_variation is not None or measurement.case.stock is not None:
        return record, []
    if record is not None and record.is_settled_only:
        return record, []
    described = record or RecordDescription()
    settled = replace(
        described,
        begins=CUT,
        spindle_angle=UNKNOWN,
        speed_tolerance=described.speed_tolerance or _TOLERANCE,
    )
    some = measurement.runs[:: max(1, -(-len(measurement.runs) // _MOST_RUNS))]
    try:
        errors = _errors(measurement.with_runs(list(some)), described, settled)
    except (InputError, RunError):
        return record, []  # a case that cannot be simulated is reported where it is used
    if not errors.size:
        return record, []
    as_rest, as_cut = np.sqrt(np.mean(errors**2, axis=0))
    if as_rest < _FITS or as_cut > _BETTER * as_rest:
        return record, []
    description = (
        "the runs do not begin from rest at full immersion with the first tooth at +y: so the "
        f"declared case leaves {100.0 * as_rest:.0f} % of the signals, in a settled cut at a start "
        f"angle of its own for each run {100.0 * as_cut:.0f} %; they are judged as settled cuts"
    )
    return settled, [SignalFinding(NOTE, "", "spindle_angle", description)]


def _errors(
    measurement: Measurement, described: RecordDescription, settled: RecordDescription
) -> Array:
    """Errors (n, 2) of the declared case over the signals: from rest, and as a settled cut."""
    found = []
    cut_out, _ = settled_records(measurement, settled)
    by_name = {run.name: run for run in cut_out.runs}
    for run in measurement.runs:
        turned, components = in_case_axes(run, described.channels)
        turned = replace(turned, components=components)
        other = by_name.get(run.name)
        if other is None or _at_rest(turned):
            continue
        declared = measurement.case
        rest = from_rest(run.of(declared), turned)
        cut = other.record.predicted(other.of(declared))
        for name in components:
            found.append((_relative(turned, rest, name), _relative(other, cut, name)))
    return np.array(found).reshape(-1, 2)


def _at_rest(run: Run) -> bool:
    """Whether displacements show that a run begins at rest."""
    moved = [run.signals[name] for name in ("x", "y") if name in run.signals]
    return bool(moved) and all(
        abs(float(values[0])) < _AT_REST * float(np.sqrt(np.mean(values**2))) for values in moved
    )


def _relative(run: Run, predicted: dict[str, Array], name: str) -> float:
    measured = run.signals[name]
    level = max(float(np.std(measured)), 1e-300)
    return float(np.sqrt(np.mean((measured - predicted[name]) ** 2))) / level
