"""A machine that is rigid, or a set of modes, gives what the time domain of the cut alone gives."""

import itertools

import numpy as np
import pytest

from chatter.simulation.simulate import simulate
from tests.chatter.simulation.on_machine.coupled_machines import (
    STIFF,
    body,
    cut_case,
    linear_axis,
    spindle,
    spring,
    stepped,
    written,
)

MASS = 20.0
FREQUENCY = {"x": 310.0, "y": 420.0, "z": 530.0}
DAMPING = 0.03


@pytest.fixture(scope="module")
def modal(tmp_path_factory):
    """One body on springs, its tip at its centre: three modes, no control."""
    stiffness = {way: MASS * (2.0 * np.pi * f) ** 2 for way, f in FREQUENCY.items()}
    return written(
        tmp_path_factory.mktemp("modal"),
        {
            "tool_point": "tip",
            "damping_ratio": DAMPING,
            "body": {"head": body(MASS)},
            "connector": {"springs": spring("head", "ground", **stiffness)},
            "point": {"tip": {"on": "head", "at": [0.0, 0.0, 0.0]}},
        },
    )


@pytest.mark.parametrize("mode", ["up", "down"])
def test_a_body_on_springs_equals_its_modes(modal, mode):
    modes = [
        {"frequency": f, "damping": DAMPING, "mass": MASS, "direction": [w == a for a in "xyz"]}
        for w, f in FREQUENCY.items()
    ]
    for mode_given in modes:
        mode_given["direction"] = [float(part) for part in mode_given["direction"]]
    cut, run = {"mode": mode}, {"revolutions": 6, "steps": 400}
    coupled = simulate(cut_case({"machine": str(modal), "settling": 0}, cut=cut, **run))
    alone = simulate(cut_case({"mode": modes}, cut=cut, **run))
    assert coupled.setup.step == pytest.approx(alone.setup.step, rel=1e-12)
    assert np.allclose(coupled.time, alone.time, rtol=1e-12)
    scale = np.abs(alone.displacement).max(axis=0)
    assert np.all(scale > 1e-8)
    assert np.all(np.abs(coupled.displacement - alone.displacement) < 1e-9 * scale)
    size = np.abs(alone.force).max()
    # rounding decides on which side of an entry the instant of a row lies
    apart = np.abs(coupled.force - alone.force).max(axis=1) > 1e-8 * size
    assert apart.mean() < 0.02
    assert np.allclose(coupled.spindle_angle, alone.spindle_angle, rtol=1e-12)


def test_feed_and_axes_of_the_cut_turn_with_the_directions_given(modal):
    """Fed along y of the machine, the modes change places; x of the cut is y of the machine."""
    run = {"revolutions": 4, "steps": 400}
    there = {"machine": str(modal), "settling": 0}
    turned = simulate(cut_case({**there, "feed": [0, 1, 0]}, **run))
    modes = [
        {"frequency": FREQUENCY[way], "damping": DAMPING, "mass": MASS, "direction": direction}
        # y of the cut, z times x, is -x of the machine
        for way, direction in (("y", [1, 0, 0]), ("x", [0, -1, 0]), ("z", [0, 0, 1]))
    ]
    alone = simulate(cut_case({"mode": modes}, **run))
    scale = np.abs(alone.displacement).max(axis=0)
    assert np.all(np.abs(turned.displacement - alone.displacement) < 1e-9 * scale)


def elastic(folder):
    """Elastic head, table on a linear drive, spindle: all of them soft enough to matter."""
    return written(
        folder,
        {
            "tool_point": "tip",
            "workpiece": "work",
            "body": {"bed": body(400.0), "head": body(30.0), "table": body(80.0)},
            "connector": {
                "feet": spring("bed", "ground", damping={"x": 2e4, "y": 2e4}, x=2e8, y=2e8),
                "neck": spring("head", "bed", damping={"x": 3e3, "y": 3e3}, x=1.2e8, y=2e8),
                "guide": spring("table", "bed", damping={"y": 5e3}, x=0.0, y=4e8),
            },
            "point": {
                "tip": {"on": "head", "at": [0.0, 0.0, 0.0]},
                "work": {"on": "table", "at": [0.0, 0.0, 0.0]},
            },
            "axis": {
                "X": linear_axis((1, 0, 0), "table", "bed", ["table"]),
                "S": spindle("head", inertia=0.004, proportional=0.5),
            },
        },
    )


def test_second_order_in_the_step(tmp_path):
    """Controllers keep their sample times; the step of structure and cut is halved."""
    machine = elastic(tmp_path)
    signals = []
    for parts in (1, 2, 4, 8):
        case = cut_case(
            {"machine": str(machine), "settling": 0.4},
            cut={"mode": "up", "radial_depth": "8 mm"},
            steps=400 * parts,
            revolutions=2,
        )
        motion = stepped(case, 800 * parts)
        ports = [*(motion.u[f"tool {way}"] for way in "xyz"), motion.v["tool turn"]]
        signals.append(np.array([port[parts::parts] - port[0] for port in ports[:2]]))
    changes = [
        np.sqrt(np.mean((fine - coarse) ** 2, axis=1))
        for coarse, fine in itertools.pairwise(signals)
    ]
    order = np.log2(np.array(changes[:-1]) / np.array(changes[1:]))
    assert np.all(order > 1.6), order
    # the coarsest steps may come in faster
    assert np.all(order[-1] < 2.4), order


def test_a_rigid_machine_that_holds_its_speed_equals_a_rigid_tool(tmp_path):
    machine = written(
        tmp_path,
        {
            "tool_point": "tip",
            "body": {"head": body(1e6)},
            "connector": {"foot": spring("head", "ground")},
            "point": {"tip": {"on": "head", "at": [0.0, 0.0, -0.2]}},
            "axis": {"S": spindle("head", inertia=1e9)},
        },
    )
    assert STIFF == 1e13
    coupled = simulate(cut_case({"machine": str(machine), "settling": 0.01}, revolutions=3))
    alone = simulate(cut_case(None, steps=400, revolutions=3))
    assert "its path is prescribed" in " ".join(coupled.notes)
    for name in ("force", "torque"):
        one, other = getattr(coupled, name), getattr(alone, name)
        difference = np.abs(one - other).reshape(len(other), -1).max(axis=1)
        assert np.mean(difference > 1e-5 * np.abs(other).max()) < 0.02
    assert coupled.spindle_speed == pytest.approx(np.full(1201, 100.0 * np.pi), rel=1e-9)
