"""Moves of axes: where they end, signs of tool and workpiece, contour errors, rigid motion."""

import numpy as np
import pytest

from chatter.compile.linearised_friction import rigid_motion
from chatter.description.errors import InputError
from chatter.simulation.virtual_tests.move import MovePlan, move_axes
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.control.cascade import Feedforward
from dynamics.machine.description import Drive, Machine
from dynamics.structure.linear_structure import LinearStructure
from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.path import circle
from dynamics.trajectory.periodic import CircleMotion, SineMotion
from dynamics.trajectory.set_points import set_points

STEP = 1e-4
LEAD = 10e-3 / (2.0 * np.pi)


def tool_rows(machine):
    return np.array([machine.structure.port("tool", way, "table") for way in np.eye(3)])


def test_rigid_motion_strains_nothing_and_moves_by_one(screw_axis, controller):
    machine = screw_axis(controller())
    moved = rigid_motion(machine, {"Y": 2e-3})
    # the bed stands, the motor turns by the lead
    assert moved == pytest.approx([2e-3 / LEAD, 2e-3, 0.0], abs=1e-12)
    assert np.max(np.abs(machine.structure.stiffness @ moved)) < 1e-3
    # table forward: the tool goes back against it
    assert tool_rows(machine) @ moved == pytest.approx([0.0, -2e-3, 0.0], abs=1e-12)


def test_rigid_motion_of_axes_not_controlled(screw_axis, controller):
    with pytest.raises(InputError, match='axis "Y" cannot be moved: it is not under control'):
        rigid_motion(screw_axis(), {"Y": 1.0})
    held = screw_axis(controller())
    stiffness = held.structure.stiffness + np.diag([0.0, 1e7, 0.0])
    held = held.__class__(
        LinearStructure(held.structure.mass, held.structure.damping, stiffness, {}),
        held.drives, (), (), ("Y",), None,
    )  # fmt: skip
    with pytest.raises(InputError, match="axes Y cannot move freely"):
        rigid_motion(held, {"Y": 1.0})


def test_a_move_ends_at_its_target(screw_axis, controller):
    machine = screw_axis(controller(feedforward=Feedforward(1.0, 0, 6.8e-3)))
    target = 0.2
    move = JerkLimitedMove(np.zeros(1), np.array([target]), 0.3, 5.0, 200.0)
    plan = MovePlan(move, ["Y"], 1e-3, standstill=0.02, afterwards=0.6)
    result = move_axes("m", machine, STEP, plan, tool_rows(machine))
    for where in (result.wanted, result.motor, result.scale, result.tool):
        assert where[-1, 0] == pytest.approx(target, rel=1e-5)
    assert result.time[-1] == pytest.approx(move.duration + 0.02 + 0.6, abs=2e-3)
    # the tool coordinate is counted along the axis, although the table carries the workpiece
    assert np.max(np.abs(result.tool - result.scale)) < 1e-4
    assert result.velocity.max() == pytest.approx(0.3, rel=0.1)


def test_work_of_the_motor_is_kinetic_energy(screw_axis, controller):
    """In the middle of a move at constant speed, with hardly any loss."""
    machine = screw_axis(controller(feedforward=Feedforward(1.0, 0, 6.8e-3)))
    move = JerkLimitedMove(np.zeros(1), np.array([0.2]), 0.3, 5.0, 200.0)
    points = set_points(move, 1e-3, STEP)
    run = run_machine(machine, STEP, RunInputs(0.5 * move.duration, points))
    angle, torque = run.displacement["drive Y"], run.force["drive Y"]
    work = torque @ np.diff(angle, prepend=0.0)
    assert work == pytest.approx(0.5 * (300.0 + 6e-3 / LEAD**2) * 0.3**2, rel=1e-3)


def test_velocity_lag_without_feedforward(screw_axis, controller):
    """At constant speed the axis lags by v / K_v, and half a sample of the set point."""
    machine = screw_axis(controller())
    speed, gain = 0.02, 30.0
    move = JerkLimitedMove(np.zeros(1), np.array([0.03]), speed, 1.0, 50.0)
    result = move_axes("m", machine, STEP, MovePlan(move, ["Y"], 1e-3, afterwards=0.05))
    middle = np.searchsorted(result.time, 0.5 * move.duration)
    # read where the next set point, by a cycle further, already stands
    assert result.tracking_error[middle, 0] == pytest.approx(speed / gain, rel=0.01)


def two_axes(controller, gain, fed):
    """Two inertias without structure, each an axis of unit transmission in x and y."""
    points = {"table": np.zeros((6, 2)), "tool": np.zeros((6, 2))}
    points["tool"][0, 0] = points["tool"][1, 1] = 1.0
    structure = LinearStructure(np.diag([2.0, 3.0]), np.zeros((2, 2)), np.zeros((2, 2)), points)
    drives = tuple(
        Drive(
            name, name, row, row,
            controller(
                position_gain=gain, gain=inertia * 800.0, integral_time=np.inf,
                times=(STEP, STEP, STEP), transmission=1.0,
                feedforward=Feedforward(fed, 0, inertia * fed),
            ),
        )
        for name, row, inertia in zip("XY", np.eye(2), (2.0, 3.0), strict=True)
    )  # fmt: skip
    return Machine(structure, drives, (), (), ("X", "Y"), None)


def circle_error(controller, gain, fed):
    machine = two_axes(controller, gain, fed)
    radius, speed = 0.02, 0.05
    centre = np.array([-radius, 0.0])
    plan = MovePlan(
        CircleMotion(centre, radius, speed, 2.0), ["X", "Y"], STEP,
        afterwards=0.0, path=circle(centre, radius),
    )  # fmt: skip
    result = move_axes("m", machine, STEP, plan, tool_rows(machine))
    # the start from rest rings out within the first turn
    return result.contour[len(result.contour) // 2 : -100]


def test_contour_error_of_a_lagging_circle(controller):
    """Both axes lag alike: the radius is that of 1/(1 + s/K_v + s^2/(K_v a)), a = 800 1/s."""
    errors = []
    for gain in (50.0, 100.0):
        error = circle_error(controller, gain, 0.0)
        pulsation = 0.05 / 0.02
        answer = 1.0 / (1.0 - pulsation**2 / (gain * 800.0) + 1j * pulsation / gain)
        wanted = 0.02 * (1.0 - abs(answer))
        assert np.mean(np.abs(error)) == pytest.approx(wanted, rel=0.01)
        errors.append(np.mean(error))
    assert abs(errors[1]) < 0.3 * abs(errors[0])
    assert np.sign(errors[0]) == np.sign(errors[1])


def test_contour_error_vanishes_with_feedforward(controller):
    assert np.max(np.abs(circle_error(controller, 50.0, 1.0))) < 1e-8


def test_set_points_of_the_wrong_axes(screw_axis, controller):
    machine = screw_axis(controller())
    two = SineMotion(np.zeros(2), np.array([1e-3, 1e-3]), 1.0, 1.0)
    with pytest.raises(InputError, match="2 axes, but 1 are named: Y"):
        move_axes("m", machine, STEP, MovePlan(two, ["Y"], 1e-3))
    with pytest.raises(InputError, match='axis "Q" cannot be moved'):
        move_axes("m", machine, STEP, MovePlan(two, ["Y", "Q"], 1e-3))
    one = SineMotion(np.zeros(1), np.array([1e-3]), 1.0, 1.0)
    with pytest.raises(InputError, match="not a whole multiple"):
        move_axes("m", machine, STEP, MovePlan(one, ["Y"], 1.05e-3))
