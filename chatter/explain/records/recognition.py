"""From runs as they were read to runs that can be judged."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.units import rpm
from chatter.explain.data_checks.finding import FATAL, NOTE, RUN, SignalFinding
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.alignment import Recorded
from chatter.explain.records.case_axes import in_case_axes
from chatter.explain.records.description import (
    SPINDLE_POWER,
    TACHO,
    UNKNOWN,
    Channel,
    RecordDescription,
)
from chatter.explain.records.orientation import oriented
from chatter.explain.records.settling import Settling, too_slow
from chatter.explain.records.slow_channels import POWER, power_channel, with_power, with_torques
from chatter.explain.records.spindle import TachoReading, speed_by_repetition, tacho_reading
from chatter.explain.records.stages import Stages, stages_of
from chatter.explain.records.steady_cut import revolutions_to_settle, steady_cut
from chatter.explain.records.steady_record import SteadyRecord, smallest_symmetry

Array = NDArray[np.float64]

#: noise that is assumed, as a share of a channel, at the least
_LEAST_NOISE = 5e-3
#: unsteadiness and drift of a run that is no settled cut, and times those of the others
_UNSTEADY, _DRIFTING, _MORE_UNSTEADY = 0.06, 0.04, 4.0
#: share of the records that must be predicted for an orientation, and by which it beats others
_LEAST_SHARE, _CLEARER = 0.3, 0.05
#: length of the mean of what a tacho tells against what the cut tells, from which they agree
_AGREE = 0.7


@dataclass(frozen=True, eq=False)
class _Settled:
    """A run cut down to its settled part."""

    run: Run  # with the speed found; its channels as they were recorded
    case: Case  # with the overrides of the run
    stages: Stages
    tacho: TachoReading | None
    description: str
    revolutions: int  # of the cut in the record
    idle: float | None = None  # power of the spindle in the air, W

    def recorded(self, names: Sequence[str]) -> Recorded:
        """Channels as predictions are laid beside them."""
        signals = np.array([self.run.signals[name] for name in names])
        time = self.run.signals["time"]
        usable = np.ones(time.size) if self.run.usable is None else self.run.usable
        turn = smallest_symmetry(self.case)
        deviation = _deviations(signals, time, 2.0 * math.pi / self.case.cut.spindle_speed)
        return Recorded(time, signals, deviation, usable, self.case.cut.spindle_speed, turn)


def settled_records(
    measurement: Measurement, record: RecordDescription
) -> tuple[Measurement, list[SignalFinding]]:
    """Runs cut down to their settled part, in the axes of the case, with their own speeds.

    And what was found out about them. InputError where a channel is missing that is described.
    """
    channels = _present(measurement, record.channels)
    vectors = {name: one for name, one in channels.items() if one.is_vector}
    findings: list[SignalFinding] = []
    settled = [_settled(measurement, run, record, channels) for run in measurement.runs]
    settled, new = _without_unsteady(settled)
    findings += new
    settled, new = _without_too_slow(settled)
    findings += new
    unknown = {k: v for k, v in vectors.items() if v.direction is None or not v.has_sign}
    if unknown and settled:
        channels, new = _with_orientation(channels, vectors, settled)
        findings += new
        if any(one.severity == FATAL for one in new):
            return measurement, findings
    found = [_steady(one, channels, record) for one in settled]
    findings += _unpredicted(channels, found)
    found, new = _with_tachos(found, [one.tacho for one in settled])
    findings += new
    findings += [
        SignalFinding(NOTE, one.run.name, "", f"{one.run.name}: {one.description}")
        for one in settled
    ]
    return measurement.with_runs(found), findings


def from_rest_records(
    measurement: Measurement, record: RecordDescription
) -> tuple[Measurement, list[SignalFinding]]:
    """Runs from rest whose channels are turned into the axes of the case."""
    found = []
    for run in measurement.runs:
        turned, components = in_case_axes(run, record.channels)
        turned = replace(turned, components=components)
        speed = run.of(measurement.case).cut.spindle_speed
        turned = with_power(turned, record.channels, measurement.idle_power, speed)
        found.append(with_torques(turned, record.channels, measurement.case))
    return measurement.with_runs(found), _unpredicted(record.channels, found)


def _present(measurement: Measurement, channels: Mapping[str, Channel]) -> dict[str, Channel]:
    """Channels that every run has; a channel that the checks have excluded anywhere is left."""
    return {
        name: one
        for name, one in channels.items()
        if all(name in run.signals for run in measurement.runs)
    }


def _unpredicted(channels: Mapping[str, Channel], runs: Sequence[Run]) -> list[SignalFinding]:
    """Notes on channels that nothing is predicted for."""
    found = []
    for name, one in channels.items():
        shown = POWER if one.quantity == SPINDLE_POWER else name
        if one.is_vector or one.quantity == TACHO or any(shown in run.components for run in runs):
            continue
        words = f"{name}: {one.quantity} is not predicted of this case"
        if one.quantity == SPINDLE_POWER:
            words = (
                f"{name}: the power in the air is not known; give idle_power to judge the cut by it"
            )
        found.append(SignalFinding(NOTE, "", name, words))
    return found


def _names(run: Run, channels: Mapping[str, Channel]) -> list[str]:
    """Channels of a run by which its stages are told."""
    described = [name for name, one in channels.items() if one.is_vector]
    return described or list(in_case_axes(run, {})[1])


def _settled(
    measurement: Measurement, run: Run, record: RecordDescription, channels: Mapping[str, Channel]
) -> _Settled:
    """Settled part of a run, and its speed."""
    time, names = run.signals["time"], _names(run, channels)
    signals = np.array([run.signals[name] for name in names])
    declared = run.of(measurement.case)
    tacho = next(
        (
            tacho_reading(time, run.signals[name])
            for name, one in channels.items()
            if one.quantity == TACHO and name in run.signals
        ),
        None,
    )
    stages = stages_of(declared, time, signals, record.begins)
    part = stages.settled
    speed = _speed(time[part], signals[:, part], declared, record, tacho)
    own = {
        "cut.spindle_speed": float(speed),
        # the feed drive keeps its speed
        "cut.feed_per_tooth": float(
            declared.cut.feed_per_tooth * declared.cut.spindle_speed / speed
        ),
    }
    case = declared.patch(own)
    stages = stages_of(case, time, signals, record.begins)
    description = (
        f"{stages.description(time)}; {rpm(speed):.6g} rpm "
        f"{'by the tacho' if tacho else 'by the period of the signal'} "
        f"({100.0 * (speed / declared.cut.spindle_speed - 1.0):+.2f} %)"
    )
    cut_out = _cut_out(run, stages, names)
    overrides = {**run.overrides, **own}
    idle = measurement.idle_power
    power = power_channel(channels)
    air = _air(stages)
    if idle is None and power is not None and air.stop >= _LEAST_AIR:
        idle = float(np.mean(run.signals[power][air]))
    cut_out = replace(cut_out, overrides=overrides)
    step = float(time[-1] - time[0]) / (time.size - 1)
    revolutions = int((stages.leave - stages.entry) * step * speed / (2.0 * math.pi))
    return _Settled(cut_out, case, stages, tacho, description, revolutions, idle)


def _speed(
    time: Array, signals: Array, case: Case, record: RecordDescription, tacho: TachoReading | None
) -> float:
    """Speed, rad/s: near that of the tacho, whose pulses are no finer than the samples."""
    if tacho is not None:
        return speed_by_repetition(time, signals, tacho.speed, 0.0)
    return speed_by_repetition(time, signals, case.cut.spindle_speed, record.speed_tolerance)


def _cut_out(run: Run, stages: Stages, names: Sequence[str]) -> Run:
    """Run of the settled part alone, its offsets in the air taken off."""
    signals = {name: values[stages.settled] for name, values in run.signals.items()}
    air = _air(stages)
    if air.stop >= _LEAST_AIR:
        for name in names:
            signals[name] = signals[name] - float(np.median(run.signals[name][air]))
    usable = None if run.usable is None else run.usable[stages.settled]
    return replace(run, signals=signals, usable=usable)


def _air(stages: Stages) -> slice:
    """Samples before the cut; what is not quite in the air yet does not count."""
    return slice(0, int(0.8 * stages.entry))


#: samples in the air that tell an offset
_LEAST_AIR = 20


def _without_unsteady(settled: Sequence[_Settled]) -> tuple[list[_Settled], list[SignalFinding]]:
    """Runs whose cut settles, where most do."""
    typical = float(np.median([one.stages.unsteadiness for one in settled]))
    drift = float(np.median([one.stages.drift for one in settled]))
    kept, found = [], []
    for one in settled:
        unsteady, drifting = one.stages.unsteadiness, one.stages.drift
        if unsteady > max(_UNSTEADY, _MORE_UNSTEADY * typical):
            words = f"{100.0 * unsteady:.0f} % of the signal does not repeat with the revolution"
            others = f"{100.0 * typical:.1f} %: the cut chatters or has not settled"
        elif drifting > max(_DRIFTING, _MORE_UNSTEADY * drift):
            words = f"{100.0 * drifting:.0f} % of the signal drifts from period to period"
            others = f"{100.0 * drift:.1f} %: the cut has not settled or beats"
        else:
            kept.append(one)
            continue
        words = f"{one.run.name}: {words}, of the other runs {others}"
        found.append(SignalFinding(RUN, one.run.name, "", words))
    return kept, found


def _without_too_slow(settled: Sequence[_Settled]) -> tuple[list[_Settled], list[SignalFinding]]:
    """Runs that settle within their records, by the case as declared."""
    found = too_slow(
        [Settling(one.run.name, one.case, one.revolutions) for one in settled], "declared"
    )
    slow = {one.run for one in found}
    return [one for one in settled if one.run.name not in slow], found


def _with_orientation(
    channels: Mapping[str, Channel], vectors: Mapping[str, Channel], settled: Sequence[_Settled]
) -> tuple[dict[str, Channel], list[SignalFinding]]:
    """Channels with the directions and signs that fit best."""
    names = ", ".join(k for k, v in vectors.items() if v.direction is None or not v.has_sign)
    cuts = [steady_cut(one.case, revolutions_to_settle(one.case)) for one in settled]
    records = [one.recorded(list(vectors)) for one in settled]
    found = oriented(vectors, list(zip(records, cuts, strict=True)))
    words = "; ".join(
        f"{name} along [{', '.join(f'{v:.3f}' for v in found.channels[name].direction)}]"
        for name, one in vectors.items()
        if one.direction is None or not one.has_sign
    )
    if found.share < _LEAST_SHARE:
        description = (
            f"the orientation of {names} cannot be told: the best one predicts "
            f"{100.0 * max(found.share, 0.0):.0f} % of the signals"
        )
        return dict(channels), [SignalFinding(FATAL, "", names, description)]
    description = (
        f"orientation of {names} found: {words}; it predicts {100.0 * found.share:.0f} % of the "
        f"signals, the next {100.0 * max(found.next_share, 0.0):.0f} %"
    )
    if found.share - found.next_share < _CLEARER:
        description += ": the two hardly differ"
    return {**channels, **found.channels}, [SignalFinding(NOTE, "", names, description)]


def _steady(one: _Settled, channels: Mapping[str, Channel], record: RecordDescription) -> Run:
    """Run in the axes of the case, with what its prediction needs."""
    turned, components = in_case_axes(one.run, channels)
    rows = replace(one, run=turned).recorded(list(components))
    angle = _known_angle(turned, record)
    rows = replace(rows, angle=angle)
    steady = SteadyRecord(
        components, rows, revolutions_to_settle(one.case), one.revolutions, one.description
    )
    signals = dict(turned.signals)
    laid = steady.aligned(one.case)
    signals["spindle_angle"] = laid.angle
    # predictions begin with the filter that the declared case tells
    steady = replace(steady, recorded=replace(rows, filter_ratio=rows.sampling / laid.corner))
    turned = replace(turned, signals=signals, components=components)
    turned = with_power(turned, channels, one.idle, one.case.cut.spindle_speed)
    return replace(turned, record=replace(steady, has_power=POWER in turned.components))


def _known_angle(run: Run, record: RecordDescription) -> Array | None:
    """Angle of the spindle where a channel has it."""
    usual = "spindle_angle"
    if record.spindle_angle == UNKNOWN or (not record.spindle_angle and usual not in run.signals):
        return None
    name = record.spindle_angle or usual
    if name not in run.signals:
        raise InputError(
            f"{run.name}: record.spindle_angle: there is no channel {record.spindle_angle}; there "
            f"are {', '.join(run.signals)}"
        )
    return np.unwrap(run.signals[name])


def _with_tachos(
    runs: list[Run], tachos: Sequence[TachoReading | None]
) -> tuple[list[Run], list[SignalFinding]]:
    """Runs whose tachos tell which tooth is where, the same in all."""
    if not runs or any(tacho is None for tacho in tachos):
        return runs, []
    by_tacho = []
    for run, tacho in zip(runs, tachos, strict=True):
        time = run.signals["time"]
        by_tacho.append(tacho.speed * (0.5 * (time[0] + time[-1]) - tacho.pulse))
    middle = [0.5 * (angle[0] + angle[-1]) for angle in _angles(runs)]
    turn = runs[0].record.recorded.pitch
    apart = (np.array(middle) - np.array(by_tacho)) * 2.0 * math.pi / turn
    mean = np.mean(np.exp(1j * apart))
    if abs(mean) < _AGREE:
        description = (
            "the tacho and the cut do not turn together from run to run: the tacho is used for "
            "the speed alone"
        )
        return runs, [SignalFinding(NOTE, "", "", description)]
    offset = float(np.angle(mean)) * turn / (2.0 * math.pi)
    found = []
    for run, angle in zip(runs, by_tacho, strict=True):
        rows = replace(run.record.recorded, expected=angle + offset)
        found.append(replace(run, record=replace(run.record, recorded=rows)))
    return found, []


def _angles(runs: Sequence[Run]) -> list[Array]:
    return [run.signals["spindle_angle"] for run in runs]


def _deviations(signals: Array, time: Array, turn: float) -> Array:
    """Typical deviation (c,) from revolution to revolution, SI."""
    earlier = np.array([np.interp(time - turn, time, row) for row in signals])
    later = time - time[0] > turn
    change = (signals - earlier)[:, later] if later.any() else np.zeros((len(signals), 1))
    level = np.maximum(np.std(signals, axis=1), 1e-300)
    return np.maximum(np.sqrt(np.mean(change**2, axis=1) / 2.0), _LEAST_NOISE * level)
