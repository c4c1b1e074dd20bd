"""Whether runs begin from rest, recognised by what they hold."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

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
#: displacement at the beginning, over its rms, up to which a tool is at rest, and by how many
#: standard deviations of the noise it may be more
_AT_REST, _BY_NOISE = 0.1, 2.0
#: samples of the beginning, over which the tool hardly moves
_FIRST = 4
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
        spindle_angle=described.spindle_angle or _angle_channel(measurement),
        speed_tolerance=described.speed_tolerance or _TOLERANCE,
    )
    some = measurement.runs[:: max(1, -(-len(measurement.runs) // _MOST_RUNS))]
    some = measurement.with_runs([one for one in some if not _at_rest(one)])
    try:
        rest = _errors_from_rest(some, described)
        as_rest = _rms(rest)
        if as_rest < _FITS:
            return record, []
        # of the same channels of the same runs
        settled_cut = _errors_as_cut(some, settled)
    except (InputError, RunError):
        return record, []  # a case that cannot be simulated is reported where it is used
    shared = rest.keys() & settled_cut.keys()
    as_rest, as_cut = (_rms({key: of[key] for key in shared}) for of in (rest, settled_cut))
    if as_rest < _FITS or as_cut > _BETTER * as_rest:
        return record, []
    description = (
        "the runs do not begin from rest at full immersion with the first tooth at +y: so the "
        f"declared case leaves {100.0 * as_rest:.0f} % of the signals, in a settled cut at a start "
        f"angle of its own for each run {100.0 * as_cut:.0f} %; they are judged as settled cuts"
    )
    return settled, [SignalFinding(NOTE, "", "spindle_angle", description)]


def _rms(errors: Mapping[Any, float]) -> float:
    return float(np.sqrt(np.mean(np.square(list(errors.values()))))) if errors else 0.0


def _errors_from_rest(
    measurement: Measurement, described: RecordDescription
) -> dict[tuple[str, str], float]:
    """Error of the declared case from rest over the signal, by run and channel."""
    found = {}
    for run in measurement.runs:
        turned, components = in_case_axes(run, described.channels)
        turned = replace(turned, components=components)
        predicted = from_rest(run.of(measurement.case), turned)
        for name in components:
            found[run.name, name] = _relative(turned, predicted, name)
    return found


def _errors_as_cut(
    measurement: Measurement, settled: RecordDescription
) -> dict[tuple[str, str], float]:
    """Error of the declared case as a settled cut over the signal, by run and channel."""
    cut_out, _ = settled_records(measurement, settled)
    found = {}
    for run in cut_out.runs:
        predicted = run.record.predicted(run.of(measurement.case))
        for name in run.components:
            found[run.name, name] = _relative(run, predicted, name)
    return found


def _at_rest(run: Run) -> bool:
    """Whether displacements show that a run begins at rest."""
    moved = [run.signals[name] for name in ("x", "y") if name in run.signals]
    return bool(moved) and all(_begins_at_zero(values) for values in moved)


def _begins_at_zero(values: Array) -> bool:
    # what changes from sample to sample is noise, and motion where it is coarsely sampled
    noise = float(np.median(np.abs(np.diff(values)))) / (0.6745 * math.sqrt(2.0))
    limit = _AT_REST * float(np.sqrt(np.mean(values**2)))
    begin = abs(float(np.mean(values[:_FIRST])))
    return begin < limit + _BY_NOISE * noise / math.sqrt(_FIRST)


def _angle_channel(measurement: Measurement) -> str:
    """Channel of the spindle angle where every run has the usual one."""
    usual = "spindle_angle"
    return usual if all(usual in run.signals for run in measurement.runs) else UNKNOWN


def _relative(run: Run, predicted: dict[str, Array], name: str) -> float:
    """Error over the signal, without offset and drift, which neither tells a beginning by."""
    measured = run.signals[name]
    level = max(float(np.std(measured)), 1e-300)
    residual = measured - predicted[name]
    along = np.linspace(-1.0, 1.0, residual.size)
    residual = residual - np.polyval(np.polyfit(along, residual, 1), along)
    return float(np.sqrt(np.mean(residual**2))) / level
