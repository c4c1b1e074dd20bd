"""Residuals with something planted in them, and without."""

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.explain.kinds.axis_record import AxisRecord
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement import Measurement, Run
from chatter.explain.residuals.channel_residual import ChannelResidual
from chatter.explain.residuals.residual import Residual

MILLING = {
    "tool": {"teeth": 4, "diameter": "16 mm"},
    "material": {"Ktc": "600 MPa", "Krc": "200 MPa"},
    "cut": {
        "mode": "down", "spindle_speed": "6000 rpm", "feed_per_tooth": "0.1 mm",
        "axial_depth": "1 mm", "radial_depth": "4 mm",
    },
    "structure": {
        "mode": [{"frequency": "700 Hz", "damping": 0.03, "mass": "0.5 kg", "direction": [1, 0, 0]}]
    },
}  # fmt: skip
AXIS = {"axis": {"moving_mass": "100 kg", "viscous_friction": "500 N*s/m"}}
RUNS = 8


def residual_from(kind, case, runs, measured, predicted, deviation):
    """Residual of signals by run and channel."""
    measurement = Measurement(kind, "made up", None, case, tuple(runs))
    parts = [
        ChannelResidual(
            run, run.of(case), channel, values, predicted[run.name][channel],
            np.full(values.size, deviation), deviation,
        )
        for run in runs
        for channel, values in measured[run.name].items()
    ]  # fmt: skip
    return Residual(measurement, KINDS[kind], case, tuple(parts))


@pytest.fixture
def milling():
    """Runs at several speeds and feeds; ``plant`` (run, time, predicted) -> what is added."""

    def made(plant=lambda case, time, predicted: 0.0, seed=0, colour=0.0):
        rng = np.random.default_rng([17, seed])
        case = Case.from_dict(MILLING)
        runs, measured, predicted = [], {}, {}
        for number in range(RUNS):
            speed, feed = rng.uniform(4000, 8000), rng.uniform(0.05, 0.15)
            overrides = {"cut.spindle_speed": f"{speed} rpm", "cut.feed_per_tooth": f"{feed} mm"}
            name = f"run{number}"
            time = np.arange(0.0, 12.0 * 60.0 / speed, 1.0 / 12800.0)
            angle = speed * np.pi / 30.0 * time
            force = 100.0 * feed / 0.1 * np.maximum(np.sin(4.0 * angle), 0.0)
            run = Run(name, overrides, {"time": time, "spindle_angle": angle}, 0.5 * number)
            noise = rng.standard_normal(time.size)
            for place in range(1, time.size if colour else 0):
                noise[place] += colour * noise[place - 1]
            added = plant(run.of(case), time, force)
            runs.append(run)
            predicted[name] = {"Fx": force}
            measured[name] = {"Fx": force + noise + added}
        return residual_from("milling", case, runs, measured, predicted, 1.0)

    return made


@pytest.fixture
def axis():
    """Moves to and fro; ``plant`` (run) -> what is added to the force."""

    def made(plant=lambda run: 0.0, seed=0):
        rng = np.random.default_rng([23, seed])
        case = Case.from_dict(AXIS)
        runs, measured, predicted, begun = [], {}, {}, 0.0
        for number in range(RUNS):
            time = np.arange(0.0, rng.uniform(3.0, 6.0), 4e-3)
            travel, turns = rng.uniform(0.02, 0.2), rng.uniform(0.4, 1.0)
            position = travel * np.sin(2.0 * np.pi * turns * time + rng.uniform(0, 6))
            signals = {
                "time": time, "position": position, "velocity": np.gradient(position, time),
            }  # fmt: skip
            record = AxisRecord(None, 4e-3, begun)
            begun += time[-1]
            force = 500.0 * signals["velocity"]
            name = f"move{number}"
            runs.append(Run(name, {}, signals, record=record))
            predicted[name] = {"force": force}
            measured[name] = {"force": force + rng.standard_normal(time.size) + plant(runs[-1])}
        return residual_from("axis", case, runs, measured, predicted, 1.0)

    return made
