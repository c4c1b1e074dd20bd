"""Measurements that would tell apart what the data cannot: trials in which predictions differ."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.description.units import rpm
from chatter.explain.kinds.kind import Kind
from chatter.explain.measurement import Measurement, Run

#: conditions of a cut that a trial may change, each by these factors
_VARIED = {
    "cut.spindle_speed": ("rpm", rpm(1.0)),
    "cut.axial_depth": ("mm", 1e3),
    "cut.feed_per_tooth": ("mm", 1e3),
    "cut.radial_depth": ("mm", 1e3),
}
_FACTORS = (0.5, 0.7, 1.4, 2.0)
_TURNS = 10.0
#: of the trial of an axis: rate of samples, Hz, time at rest and in motion, s
_RATE, _LASTING = 1000.0, 1.0
#: points of a trial of verdicts, a side
_POINTS = 12
#: times the noise by which predictions must differ for a trial to be proposed
_TELLS = 2.0


class Trial(NamedTuple):
    """A measurement that might be made."""

    says: str
    run: Run
    noise: Mapping[str, float]


def separation(
    measurement: Measurement,
    kind: Kind,
    noise: Mapping[str, Mapping[str, float]],
    one: Case,
    other: Case,
) -> dict[str, Any] | None:
    """Trial in which two cases that fit alike differ most; None where none of them tells.

    Parameters
    ----------
    measurement : Measurement
        That both cases fit.
    kind : Kind
    noise : mapping
        Run -> channel -> standard deviation.
    one, other : Case

    Returns
    -------
    dict
        "says": what to measure; "channel"; "over_noise": by how many standard deviations of the
        noise the predictions differ there (rms).
    """
    best: dict[str, Any] | None = None
    for trial in TRIALS[measurement.kind](measurement, noise):
        try:
            first = kind.predict(trial.run.of(one), trial.run)
            second = kind.predict(trial.run.of(other), trial.run)
        except (InputError, RunError):
            # what cannot be cut cannot be measured
            continue
        for channel, level in trial.noise.items():
            apart = float(np.sqrt(np.mean((first[channel] - second[channel]) ** 2))) / level
            if apart > max(_TELLS, best["over_noise"] if best else 0.0):
                best = {"says": trial.says, "channel": channel, "over_noise": apart}
    return best


def told_apart(name: str, trial: Mapping[str, Any] | None) -> str:
    """Sentence on what would tell an effect from the one that was named."""
    if trial is None:
        return f"none of the trials thought of would tell it from {name}"
    return (
        f"{trial['says']} would tell it from {name}: {trial['channel']} differs by "
        f"{trial['over_noise']:.3g} times its noise"
    )


def _cuts(measurement: Measurement, noise: Mapping[str, Mapping[str, float]]) -> list[Trial]:
    """Cuts as one that was made, with one condition changed."""
    run = measurement.runs[len(measurement.runs) // 2]
    made = run.of(measurement.case)
    step = float(np.median(np.diff(run.signals["whole time"])))
    levels = {name: level for name, level in noise[run.name].items() if name in run.signals}
    trials = []
    for path, (unit, factor) in _VARIED.items():
        value = made.get(path)
        for times in _FACTORS if value else ():
            most = made.tool.diameter if path == "cut.radial_depth" else math.inf
            if value * times > most:
                continue
            changed = {**run.overrides, path: float(value * times)}
            speed = made.cut.spindle_speed * (times if path == "cut.spindle_speed" else 1.0)
            time = np.arange(0.0, _TURNS * 2.0 * math.pi / speed, step)
            empty = {name: np.zeros(time.size) for name in levels}
            signals = {"time": time, "whole time": time, **empty}
            name = path.partition(".")[2].replace("_", " ")
            says = f"a cut like {run.name} with a {name} of {value * times * factor:.4g} {unit}"
            trials.append(Trial(says, replace(run, overrides=changed, signals=signals), levels))
    return trials


def _moves(measurement: Measurement, noise: Mapping[str, Mapping[str, float]]) -> list[Trial]:
    """An axis at rest, and slow and fast moves both ways."""
    run = measurement.runs[0]
    level = {"force": noise[run.name]["force"]}
    fastest = max(float(np.abs(one.signals["velocity"]).max()) for one in measurement.runs)
    time = np.arange(0.0, _LASTING, 1.0 / _RATE)
    speeds = {"at rest": 0.0, "slowly to and fro": 0.02 * fastest, "to and fro": fastest}
    return [
        Trial(f"the force of the axis {how}, at {speed * 1e3:.3g} mm/s", _move(time, speed), level)
        for how, speed in speeds.items()
    ]


def _move(time: NDArray[np.float64], speed: float) -> Run:
    turn = 2.0 * math.pi / _LASTING
    position = -speed / turn * np.cos(turn * time)
    velocity = speed * np.sin(turn * time)
    signals = {
        "motion position": position,
        "motion velocity": velocity,
        "motion acceleration": speed * turn * np.cos(turn * time),
        "motion step": np.array([1.0 / _RATE]),
        "motion begun": np.array([0.0]),
    }
    return Run("trial", {}, signals)


def _verdicts(
    measurement: Measurement,
    noise: Mapping[str, Mapping[str, float]],  # noqa: ARG001
) -> list[Trial]:
    """Verdicts at single points over the speeds and depths that were tested."""
    speeds = np.concatenate([run.signals["spindle_speed"] for run in measurement.runs])
    depths = np.concatenate([run.signals["axial_depth"] for run in measurement.runs])
    trials = []
    for speed in np.geomspace(speeds.min(), speeds.max(), _POINTS):
        for depth in np.geomspace(depths.min(), depths.max(), _POINTS):
            says = f"a cut at {rpm(speed):.0f} rpm and {depth * 1e3:.3g} mm"
            point = {"spindle_speed": np.array([speed]), "axial_depth": np.array([depth])}
            # a verdict tells where the probabilities of its outcomes lie apart by most of one
            trials.append(Trial(says, Run("trial", {}, point), {"stable": 0.25}))
    return trials


def _nothing(*_: Any) -> list[Trial]:
    return []


Trials = Callable[[Measurement, Mapping[str, Mapping[str, float]]], Sequence[Trial]]

#: kind of measurement -> trials that are thought of
TRIALS: dict[str, Trials] = {
    "milling": _cuts,
    "axis": _moves,
    "stability": _verdicts,
    "frf": _nothing,
}
