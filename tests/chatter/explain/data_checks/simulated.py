"""Small measurements from simulations and formulas, with noise, into which tests put faults."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from chatter import simulate
from chatter.description.case import Case, loads
from chatter.explain.checking import checked
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.measurement import Measurement, Run

CASE = """
title = "small"
[tool]
kind = "end mill"
teeth = 4
diameter = "16 mm"
helix = "30 deg"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "250 MPa"
Kte = "20 N/mm"
Kre = "25 N/mm"
[cut]
mode = "down"
spindle_speed = "4000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "6 mm"
[[structure.mode]]
frequency = "700 Hz"
damping = 0.03
mass = "0.6 kg"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "600 Hz"
damping = 0.04
mass = "0.6 kg"
direction = [0, 1, 0]
"""
RUNS = (
    {"cut.spindle_speed": "4000 rpm", "cut.radial_depth": "6 mm"},
    {"cut.spindle_speed": "3300 rpm", "cut.radial_depth": "9 mm"},
    {"cut.spindle_speed": "4700 rpm", "cut.radial_depth": "4 mm"},
    {"cut.spindle_speed": "3600 rpm", "cut.radial_depth": "7 mm"},
)
NOISE = 0.02
RATE = 12800.0

Edit = Callable[[dict], dict]


def declared_case() -> Case:
    return loads(CASE)


def recorded(case: Case, overrides: dict, seed: int) -> dict[str, np.ndarray]:
    """Signals of eight revolutions, with noise."""
    own = case.patch({**overrides, "simulation": {"revolutions": 8}})
    result = simulate(own)
    time = np.arange(0.0, result.time[-1], 1.0 / RATE)
    random = np.random.default_rng(seed)
    signals = {"time": time, "spindle_angle": time * own.cut.spindle_speed}
    for names, values in ((("Fx", "Fy"), result.force), (("x", "y"), result.displacement)):
        for axis, name in enumerate(names):
            clean = np.interp(time, result.time, values[:, axis])
            level = NOISE * np.sqrt(np.mean(clean**2))
            signals[name] = clean + level * random.standard_normal(time.size)
    return signals


@lru_cache
def healthy() -> Measurement:
    """Runs of the declared case."""
    return milling()


def milling(**changes: object) -> Measurement:
    """Runs of a case with `changes` that the declared case does not know of."""
    case = declared_case()
    real = case.patch({key.replace("__", "."): value for key, value in changes.items()})
    runs = tuple(
        Run(f"run{k + 1}.csv", overrides, recorded(real, overrides, k))
        for k, overrides in enumerate(RUNS)
    )
    return Measurement("milling", "small", Path(), case, runs)


def edited(measurement: Measurement, edit: Edit, runs: Sequence[int] | None = None) -> Measurement:
    """Measurement with the signals of some runs (all by default) changed."""
    return replace(
        measurement,
        runs=tuple(
            replace(run, signals=edit(dict(run.signals))) if runs is None or k in runs else run
            for k, run in enumerate(measurement.runs)
        ),
    )


def declared(measurement: Measurement, runs: Sequence[int] | None = None, **keys) -> Measurement:
    """Measurement in which some runs are declared otherwise."""
    values = {key.replace("__", "."): value for key, value in keys.items()}
    return replace(
        measurement,
        runs=tuple(
            replace(run, overrides={**run.overrides, **values})
            if runs is None or k in runs
            else run
            for k, run in enumerate(measurement.runs)
        ),
    )


def worst(measurement: Measurement) -> SignalFinding:
    """First finding of the checks."""
    return checked(measurement).findings[0]
