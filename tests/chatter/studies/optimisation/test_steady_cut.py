"""Steady motion of stable cuts: against simulated cuts, and where the answer is known."""

import math

import numpy as np
import pytest

import chatter
from chatter.stability.model import milling_model
from chatter.studies.optimisation.steady_cut import SteadyModel
from tests.chatter.studies.optimisation.cuts import MODES, end_mill


def steady(case):
    model = SteadyModel(milling_model(case), case.cut.spindle_speed)
    found = model.cuts(np.array([case.cut.spindle_speed]), case.cut.axial_depth)
    return {name: float(values[0]) for name, values in found._asdict().items()}


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"cut.mode": "up", "cut.spindle_speed": "10400 rpm"},
        {"cut.mode": "slot", "cut.radial_depth": None, "cut.axial_depth": "0.5 mm"},
        # shallow, so that no tooth meets an older surface than that of the one before it
        {"tool.pitch": ["112 deg", "120 deg", "128 deg"], "cut.axial_depth": "0.2 mm"},
        {"tool.runout": {"offset": "8 um", "angle": "40 deg"}},
        {"tool.helix": "45 deg", "cut.axial_depth": "2 mm", "cut.radial_depth": "1 mm"},
    ],
)
def test_steady_cut_is_that_of_the_simulation(changes):
    case = end_mill(changes)
    found, run = steady(case), chatter.simulate(case)
    assert run.detection.verdict == "stable"
    settled = run.settled
    deflection = np.linalg.norm(run.displacement[settled], axis=1).max()
    walls = [wall.largest_location_error for wall in run.finish.walls]
    assert found["power"] == pytest.approx(run.power[settled].mean(), rel=6e-3)
    assert found["torque"] == pytest.approx(run.torque[settled].mean(), rel=6e-3)
    assert found["deflection"] == pytest.approx(deflection, rel=1e-2)
    # feed marks and the moving foot of the passes are in the simulated wall alone
    assert found["surface_error"] == pytest.approx(
        max(walls, key=abs), abs=0.006 * deflection + 0.1e-6
    )


def test_a_stiff_structure_follows_the_force_and_leaves_the_wall_by_it():
    # far above all harmonics a mode is a spring: u = F/k, and the wall is off by that of y
    stiff = [
        {"frequency": 4e5, "damping": 0.1, "stiffness": 2e7, "direction": axis}
        for axis in ([1, 0, 0], [0, 1, 0])
    ]
    case = end_mill({"structure.mode": stiff, "tool.helix": "30 deg", "cut.mode": "up"})
    model = SteadyModel(milling_model(case), case.cut.spindle_speed)
    depth, k = case.cut.axial_depth, 2e7
    force = model.rigid_cut(depth, int(model.harmonic[-1])).force(model.harmonic)
    theta = np.linspace(0.0, 2.0 * math.pi, 4001)
    wave = np.exp(1j * np.outer(theta, model.harmonic)) * np.where(model.harmonic == 0, 1.0, 2.0)
    push = (wave @ force.force[:, :2]).real
    found = steady(case)
    assert found["deflection"] == pytest.approx(np.linalg.norm(push, axis=1).max() / k, rel=2e-3)
    # an edge points at the wall of up milling, +y, when its slice comes to the top
    lag = math.tan(math.radians(30.0)) / 8e-3
    passing = lag * np.linspace(0.0, depth, 41)
    y = np.interp(np.mod(passing, 2.0 * math.pi), theta, push[:, 1]) / k
    assert found["surface_error"] == pytest.approx(y[np.abs(y).argmax()], rel=5e-2)


def test_resonance_of_a_harmonic_turns_the_wall_over():
    # Schmitz and Mann (2006): below the resonance of a tooth harmonic the tool follows the force,
    # above it moves against it, so that the location error changes its sign
    mode = {**MODES[1], "damping": 0.01}
    case = end_mill({"structure.mode": [mode], "tool.helix": "0 deg", "cut.radial_depth": "1 mm"})
    model = SteadyModel(milling_model(case), 500.0)
    # the teeth pass at 1010 Hz: 20 200 rpm
    speeds = 20200.0 * np.array([0.985, 1.015]) * math.pi / 30.0
    below, above = model.cuts(speeds, 0.1e-3).surface_error
    assert below * above < 0.0


def test_process_damping_takes_from_the_motion():
    case = end_mill({"cut.spindle_speed": "2020 rpm"})
    damped = case.patch({"process_damping": {"coefficient": "2e5 N/m"}})
    assert steady(damped)["deflection"] < 0.98 * steady(case)["deflection"]
