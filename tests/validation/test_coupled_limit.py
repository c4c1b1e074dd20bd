"""Limit of the coupled simulation against semi-discretization of the linearised machine."""

import numpy as np
import pytest

import chatter
from chatter import Case
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.cut_run import CutRun
from chatter.simulation.setup import set_up
from chatter.stability.methods.semi_discretization.arrays import milling_arrays
from chatter.stability.methods.semi_discretization.multipliers import multipliers
from chatter.stability.model import milling_model

STIFF = 1e11
JOINT = {"x": 6e7, "y": 9e7, "z": STIFF, "rx": STIFF, "ry": STIFF, "rz": STIFF}


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """Elastic head over a table on a linear drive; velocity loop without integral, no friction."""
    place = [0.0, 0.0, 0.0]
    guide = {way: k for way, k in (JOINT | {"y": STIFF}).items() if way != "x"}
    described = {
        "tool_point": "tip",
        "workpiece": "work",
        "damping_ratio": 0.03,
        "body": {
            "head": {"mass": 30.0, "inertia": [1.0] * 3, "centre": place},
            "table": {"mass": 300.0, "inertia": [20.0] * 3, "centre": place},
        },
        "connector": {
            "neck": {"between": ["head", "ground"], "at": place, "stiffness": JOINT},
            "guide": {"between": ["table", "ground"], "at": place, "stiffness": guide},
        },
        "point": {"tip": {"on": "head", "at": place}, "work": {"on": "table", "at": place}},
        "axis": {
            "X": {
                "direction": [1, 0, 0],
                "moving": "table",
                "at": place,
                "carries": ["table"],
                "drive": {"kind": "linear motor"},
                "control": {
                    "position": {"gain": 30.0, "sample_time": 1e-3},
                    "velocity": {"proportional_gain": 3e4, "sample_time": 1e-4},
                    "current": {"sample_time": 5e-5},
                    "feedforward": {"velocity": 1.0},
                },
            }
        },
    }
    path = tmp_path_factory.mktemp("machine") / "machine.toml"
    MachineFile.from_dict(described).save(path)
    return path


def case_at(machine, speed, depth=1e-3):
    return Case.from_dict(
        {
            "tool": {"teeth": 4, "diameter": "20 mm", "helix": "10 deg"},
            "material": {"Ktc": "8 GPa", "Krc": "3 GPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": f"{speed} rpm",
                # growth does not hang on the feed; little of it keeps the teeth in the cut
                "feed_per_tooth": "0.002 mm",
                "axial_depth": depth,
                "radial_depth": "10 mm",
            },
            "structure": {"machine": str(machine), "settling": 0.5},
            "simulation": {"duration": 0.8},
        }
    )


def moved(case, push):
    """Displacement of the tool, pushed as the cut begins, m."""
    setup = set_up(case)
    run, s = CutRun(setup, 1, setup.steps), setup.structure.tables.bus
    tool = [setup.structure.tables.port[f"tool {axis}"] for axis in "xy"]
    s.state[:] += push * s.constant[tool].sum(axis=0)
    s.u[:] = s.state @ s.displacement
    s.v[:] = s.state @ s.velocity
    assert run.steps(setup.steps) == setup.steps
    assert setup.resolution.stride == 1
    return run.rows[1:, 3:5], setup


def growth(case):
    """Rate at which a small push changes the motion of the tool, 1/s."""
    (still, setup), (pushed, _) = moved(case, 0.0), moved(case, 1e-3)
    apart = np.linalg.norm(pushed - still, axis=1)
    a_turn = round(2.0 * np.pi / (setup.spindle.speed * setup.step))
    whole = len(apart) // a_turn
    size = np.sqrt(np.mean(apart[: whole * a_turn].reshape(whole, a_turn) ** 2, axis=1))
    late = slice(whole // 3, None)
    return np.polyfit(a_turn * setup.step * np.arange(whole)[late], np.log(size[late]), 1)[0]


def rate_by_multiplier(case, depth):
    """Rate of the dominant multiplier of semi-discretization, 1/s."""
    speed = case.cut.spindle_speed
    multiplier = multipliers(
        milling_arrays(milling_model(case)), np.array([speed]), np.array([depth])
    )[0]
    return np.log(abs(multiplier)) * speed * case.tool.teeth / (2.0 * np.pi)


@pytest.mark.parametrize("speed", [3300, 4100])
def test_limit_within_two_percent(machine, speed):
    """Growth a little below the limit leads to it: above, the start leaves the linear range."""
    case = case_at(machine, speed)
    limit = chatter.check(case).critical_depth
    below, above = (rate_by_multiplier(case, share * limit) for share in (0.98, 1.02))
    slope = (above - below) / 0.04
    rate = growth(case_at(machine, speed, 0.92 * limit))
    assert 0.92 - rate / slope == pytest.approx(1.0, abs=0.02)
