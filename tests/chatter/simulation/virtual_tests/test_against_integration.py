"""A whole machine in time against integrators of differential equations, written here."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.control.cascade import Feedforward
from dynamics.friction.lugre import LuGre
from dynamics.friction.tanh_hysteresis import TanhHysteresis
from dynamics.machine.description import Friction, Machine
from dynamics.structure.linear_structure import LinearStructure
from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.set_points import set_points

LEAD = 10e-3 / (2.0 * np.pi)
J, M, B = 6e-3, 300.0, 1500.0
K, C, K_FEET, C_FEET = 1.2e8, 3e4, 1.5e8, 5e4
GAIN, K_V, T_N = 2.0, 30.0, 0.03
T_P, T_V = 1e-3, 2e-4
BRISTLE, BRISTLE_LOSS, VISCOUS, COULOMB, STATIC, STRIBECK = 5e6, 2e3, 800.0, 100.0, 130.0, 5e-3
FRICTION = LuGre(BRISTLE, BRISTLE_LOSS, VISCOUS, COULOMB, STATIC, STRIBECK)
MOVE = JerkLimitedMove(np.zeros(1), np.array([4e-3]), 0.05, 1.0, 60.0)
DURATION = 0.1


def integrated(friction):
    """Cascade by hand, sampled; between samples an integrator of stiff differential equations."""

    def rates(_, y, torque):
        angle, table, bed, w, v_table, v_bed, z = y
        nut = K * (LEAD * angle - table + bed) + C * (LEAD * w - v_table + v_bed)
        resisting, bending = 0.0, 0.0
        if friction:
            v = v_table - v_bed
            steady = COULOMB + (STATIC - COULOMB) * np.exp(-((v / STRIBECK) ** 2))
            bending = v - abs(v) * z * BRISTLE / steady
            resisting = BRISTLE * z + BRISTLE_LOSS * bending + VISCOUS * v
        return [
            w,
            v_table,
            v_bed,
            (torque - LEAD * nut) / J,
            (nut - resisting) / M,
            (-nut + resisting - K_FEET * bed - C_FEET * v_bed) / B,
            bending,
        ]

    y, summed, course = np.zeros(7), 0.0, []
    every = round(T_P / T_V)
    torque_fed = 0.0
    for k in range(round(DURATION / T_V)):
        if k % every == 0:
            motion = MOVE.at(k * T_V)
            measured = y[1] - y[2]
            wanted = (K_V * (motion.position[0] - measured) + 0.8 * motion.velocity[0]) / LEAD
            torque_fed = 5e-3 * motion.acceleration[0] / LEAD
        deviation = wanted - y[3]
        summed += GAIN * T_V / T_N * deviation
        torque = GAIN * deviation + summed + torque_fed
        answer = solve_ivp(
            rates,
            (0.0, T_V),
            y,
            "LSODA" if friction else "DOP853",
            args=(torque,),
            rtol=1e-9,
            atol=1e-13,
        )
        y = answer.y[:, -1]
        course.append([*y, torque])
    return np.array(course)


def by_engine(machine, step):
    points = set_points(MOVE, T_P, step)
    stride = round(T_V / step)
    outputs = dict(zip(("table", "bed"), np.eye(3)[1:], strict=True))
    return run_machine(machine, step, RunInputs(DURATION, points, outputs=outputs, stride=stride))


@pytest.fixture
def control(controller):
    return controller(feedforward=Feedforward(velocity=0.8, inertia=5e-3), times=(T_P, T_V, T_V))


def largest_errors(run, course):
    return [
        np.max(np.abs(found - wanted)) / np.max(np.abs(wanted))
        for found, wanted in (
            (run.displacement["drive Y"], course[:, 0]),
            (run.displacement["table"], course[:, 1]),
            (run.displacement["bed"], course[:, 2]),
            (run.velocity["drive Y"], course[:, 3]),
            (run.velocity["bed"], course[:, 5]),
            (run.force["drive Y"], course[:, 7]),
        )
    ]


def test_without_friction_exact_at_any_step(screw_axis, control):
    course = integrated(friction=False)
    for step in (T_V, 1e-4):
        assert np.max(largest_errors(by_engine(screw_axis(control), step), course)) < 1e-6


def test_with_lugre_friction_it_converges(screw_axis, control):
    course = integrated(friction=True)
    machine = screw_axis(control, [("guide", FRICTION, np.array([0.0, 1.0, -1.0]))])
    coarse, fine = (
        np.max(largest_errors(by_engine(machine, step), course)) for step in (1e-4, 1e-5)
    )
    assert coarse < 1e-4
    # second order in the step
    assert fine < 0.03 * coarse
    # friction matters: the run without it is far off
    free = by_engine(screw_axis(control), 1e-4)
    assert np.max(largest_errors(free, course)) > 0.02


def test_tanh_hysteresis_by_its_rate_equation():
    """Block on a spring, struck: r rises along each branch by r' = 2 a (1 - ((r - r0)/2)^2) x'."""
    mass, stiffness, a, coulomb = 5.0, 2e5, 3e4, 20.0
    viscous, slow, decay, speed = 30.0, 200.0, 50.0, 0.05

    def rates(_, y, start, half):
        x, v, r = y
        height = 1.0 if half else 2.0
        rise = 2.0 * a * (1.0 - ((r - start) / height) ** 2)
        along = max(r * np.sign(v), 0.0)
        resisting = coulomb * r + (viscous + slow * np.exp(-decay * abs(v))) * v * along
        return [v, -(stiffness * x + resisting) / mass, rise * v]

    def stops(_, y, start, half):
        return y[1]

    stops.terminal = True
    end, now, y, start, half = 0.06, 0.0, np.array([0.0, speed, 0.0]), 0.0, True
    times, places = [], []
    while now < end:
        stops.direction = -1.0 if y[1] > 0.0 or not times else 0.0
        part = solve_ivp(
            rates,
            (now, end),
            y,
            "DOP853",
            args=(start, half),
            events=stops,
            rtol=1e-10,
            atol=1e-14,
            dense_output=True,
            max_step=1e-4,
        )
        times.append((now, part.t[-1], part.sol))
        now, y = part.t[-1], part.y[:, -1].copy()
        # past the stop by a hair, the other way
        y[1] = -1e-12 * np.sign(part.y[1, -2])
        start, half = y[2], False
    assert len(times) > 3
    law = TanhHysteresis(coulomb, viscous, slow, decay, a)
    structure = LinearStructure(mass * np.eye(1), np.zeros((1, 1)), stiffness * np.eye(1), {})
    machine = Machine(structure, (), (Friction("floor", law, np.ones(1)),), (), (), None)
    step = 1e-5
    run = struck(machine, step, end, speed)[:-1]
    at = step * np.arange(1, len(run) + 1)
    for first, last, answer in times:
        chosen = (at > first) & (at <= last)
        places.append(answer(at[chosen])[0])
    wanted = np.concatenate(places)
    assert np.max(np.abs(run - wanted)) < 2e-3 * np.max(wanted)


def struck(machine, step, duration, speed):
    """Displacement after a start at speed, by the kernels as plain Python."""
    from chatter.engine.loop import Laws, run
    from dynamics.machine.tables import machine_tables

    tables = machine_tables(machine, step, velocity=np.array([speed]))
    laws, course = Laws(tables.explicit, (), tables.implicit), []
    for number in range(round(duration / step)):
        run.py_func(laws, tables.bus, number, 0, 1)
        course.append(tables.bus.u[0])
    return np.array(course)
