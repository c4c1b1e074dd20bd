"""Cascade in time: dead times, limits, measuring systems, closed loops against exact poles."""

import dataclasses
import math

import numpy as np
import pytest
from numba import njit

from dynamics.control.cascade import (
    DriveController,
    Feedforward,
    LoopTiming,
    PositionController,
    VelocityController,
)
from dynamics.control.current_loop import RegulatedMotor, SecondOrderCurrentLoop
from dynamics.control.drive_step import control_step
from dynamics.control.drive_table import control_table
from dynamics.control.filters import ReferenceModel, low_pass, notch
from dynamics.control.measurement import MeasuringSystem
from dynamics.control.sampling import ControlError

H = 125e-6
ONE = LoopTiming(H)
SPEED = DriveController(
    PositionController(0.0, ONE),
    VelocityController(2.0, ONE),
    MeasuringSystem(1.0),
    ONE,
    feedforward=Feedforward(velocity=1.0),
)


@njit(error_model="numpy")
def fixed_motor(table, signals):
    torque = np.zeros(signals.shape[0])
    for n in range(signals.shape[0]):
        s = signals[n]
        torque[n] = control_step(table, 0, n, s[0], s[1], s[2], s[3], s[4], s[5])
    return torque


@njit(error_model="numpy")
def on_inertia(table, inertia, load, step, transmission, sets, motion, start):
    """Motor of an inertia under held torque, exact: at each step, and behind the last."""
    path = np.zeros((sets.shape[0], 2))
    x, v = motion
    for n in range(sets.shape[0]):
        path[n, 0], path[n, 1] = x, v
        torque = control_step(
            table, 0, start + n, sets[n, 0], sets[n, 1], sets[n, 2], x, v, transmission * x
        )
        a = (torque + load) / inertia
        x, v = x + v * step + 0.5 * a * step * step, v + a * step
    return path, np.array([x, v])


def step_of(channel, count, start=0):
    signals = np.zeros((count, 6))
    signals[start:, channel] = 1.0
    return signals


def with_timing(drive, **loops):
    position = dataclasses.replace(drive.position, timing=loops.get("position", ONE))
    velocity = dataclasses.replace(drive.velocity, timing=loops.get("velocity", ONE))
    current = loops.get("current", ONE)
    return dataclasses.replace(drive, position=position, velocity=velocity, current_timing=current)


@pytest.mark.parametrize(
    ("loops", "channel", "steps"),
    [
        ({}, 4, 0),
        ({"velocity": LoopTiming(H, measuring=3)}, 4, 3),
        ({"velocity": LoopTiming(H, measuring=1, computing=2, transmission=4)}, 4, 7),
        ({"current": LoopTiming(H, computing=1, transmission=5)}, 4, 6),
        ({"position": LoopTiming(H, computing=5)}, 1, 0),
        ({"velocity": LoopTiming(H, computing=5, measuring=9)}, 1, 5),
    ],
)
def test_dead_time_is_exact_in_samples(loops, channel, steps):
    torque = fixed_motor(control_table([with_timing(SPEED, **loops)], H), step_of(channel, 30))
    sign = -1.0 if channel == 4 else 1.0
    np.testing.assert_array_equal(torque, sign * 2.0 * (np.arange(30) >= steps))


def test_dead_times_of_slow_loops_count_in_their_samples():
    drive = dataclasses.replace(
        with_timing(
            SPEED,
            position=LoopTiming(16 * H, measuring=1, computing=2),
            velocity=LoopTiming(4 * H, computing=3),
        ),
        position=PositionController(10.0, LoopTiming(16 * H, measuring=1, computing=2)),
    )
    torque = fixed_motor(control_table([drive], H), step_of(3, 120))
    np.testing.assert_array_equal(torque, -20.0 * (np.arange(120) >= 3 * 16 + 3 * 4))
    # a step just after a sample waits for the next one
    torque = fixed_motor(control_table([drive], H), step_of(3, 120, start=1))
    np.testing.assert_array_equal(torque, -20.0 * (np.arange(120) >= 4 * 16 + 3 * 4))


def test_delays_of_set_point_and_feedforward():
    drive = dataclasses.replace(
        SPEED,
        position=PositionController(10.0, LoopTiming(2 * H), set_point_delay=3),
        feedforward=Feedforward(velocity=0.5, velocity_delay=2, inertia=4.0, torque_delay=7),
    )
    for channel, steps, height in ((0, 6, 20.0), (1, 4, 1.0), (2, 7, 4.0)):
        torque = fixed_motor(control_table([drive], H), step_of(channel, 40))
        np.testing.assert_array_equal(torque, height * (np.arange(40) >= steps))


def test_integral_part_grows_as_a_ramp_of_the_integral_time():
    drive = dataclasses.replace(SPEED, velocity=VelocityController(2.0, ONE, integral_time=0.01))
    torque = fixed_motor(control_table([drive], H), step_of(1, 100))
    n = np.arange(100)
    np.testing.assert_allclose(torque, 2.0 + 2.0 * (n + 1) * H / 0.01, rtol=1e-12)


def test_integral_part_does_not_wind_up_and_leaves_the_limit_at_once():
    velocity = VelocityController(2.0, ONE, integral_time=0.01, torque_limit=5.0)
    drive = dataclasses.replace(SPEED, velocity=velocity)
    signals = step_of(1, 4000)
    signals[2000:, 1] = -1.0
    table = control_table([drive], H)
    torque = fixed_motor(table, signals)
    assert np.abs(torque).max() == 5.0
    # the sum has rested at 5 - 2 N m; the deviation of -1 acts at once, and sums up once
    assert torque[2000] == pytest.approx(3.0 - 2.0 - 0.025)
    # and sum back through zero takes no longer than it took to grow
    falls = np.argmax(torque[2000:] <= -4.999)
    assert falls == pytest.approx((3.0 + 3.0) / 0.025, abs=2)


def test_torque_limit_holds_behind_a_filter_that_overshoots():
    velocity = dataclasses.replace(SPEED.velocity, torque_limit=1.5)
    drive = dataclasses.replace(SPEED, velocity=velocity, filters=(low_pass(300.0, 0.2),))
    torque = fixed_motor(control_table([drive], H), step_of(1, 200))
    assert torque.max() == 1.5
    assert torque[-1] == pytest.approx(1.5, abs=1e-3)


def test_velocity_limit():
    position = PositionController(100.0, ONE, velocity_limit=0.25)
    drive = dataclasses.replace(SPEED, position=position, measuring=MeasuringSystem(0.5))
    torque = fixed_motor(control_table([drive], H), step_of(0, 5))
    np.testing.assert_array_equal(torque, 2.0 * 0.25 / 0.5)


def test_encoder_and_scale_round_to_their_counts():
    signals = np.zeros((3, 6))
    signals[:, 3] = signals[:, 5] = [0.0, 0.0149, 0.0151]
    position = PositionController(1.0, ONE)
    for side in ("encoder", "scale"):
        measuring = MeasuringSystem(1.0, side, encoder_resolution=0.01, scale_resolution=0.01)
        drive = dataclasses.replace(SPEED, position=position, measuring=measuring)
        torque = fixed_motor(control_table([drive], H), signals)
        np.testing.assert_allclose(torque, [0.0, -0.02, -0.04], atol=1e-15)


def test_difference_of_counts_is_a_velocity_in_counts_per_sample():
    measuring = MeasuringSystem(1.0, velocity="difference", encoder_resolution=1e-4)
    drive = dataclasses.replace(SPEED, measuring=measuring)
    signals = np.zeros((801, 6))
    signals[:, 3] = 0.33e-4 * np.arange(801)
    torque = fixed_motor(control_table([drive], H), signals)[1:]
    assert set(np.round(-torque / 2.0 * H / 1e-4, 9)) == {0.0, 1.0}
    assert -torque.mean() / 2.0 == pytest.approx(0.33e-4 / H, rel=0.01)


def closed_loop_matrix(drive, inertia, samples):
    """Transition of motor and drive states over some steps, column by column from unit states."""
    columns = []
    table = control_table([drive], H)
    written = (table.state, table.history, table.filter_state)
    ends = np.cumsum([2, *(part.size for part in written)])
    for unit in np.eye(ends[-1]):
        for part, values in zip(written, np.split(unit, ends[:-1])[1:], strict=True):
            part[...] = values.reshape(part.shape)
        sets = np.zeros((samples, 3))
        motion = on_inertia(table, inertia, 0.0, H, 1.0, sets, (unit[0], unit[1]), 0)[1]
        columns.append(np.concatenate([motion, *(part.ravel() for part in written)]))
    return np.array(columns).T


def test_poles_on_an_inertia_are_those_of_the_z_domain():
    inertia, kv, kp, tn = 0.02, 60.0, 9.0, 0.015
    drive = dataclasses.replace(
        SPEED,
        position=PositionController(kv, ONE),
        velocity=VelocityController(kp, ONE, integral_time=tn),
    )
    measured = np.linalg.eigvals(closed_loop_matrix(drive, inertia, 1))
    z = np.poly1d([1.0, 0.0])
    one = np.poly1d([1.0])
    # held torque on an inertia: x = h^2 (z+1)/(2 J (z-1)^2) M, v = h/(J (z-1)) M
    d = z - one
    pi = kp * (d + H / tn * z)  # over d
    numerator = pi * (kv * H * H / 2.0 * (z + one) + H * d) * (1.0 / inertia)
    exact = np.roots((d * d * d + numerator).coeffs)
    for pole in exact:
        assert np.abs(measured - pole).min() < 1e-9
    # nothing enters the states of the plant and of the voltage that an ideal current loop has not
    unused = [1.0, math.exp(-H)]
    for pole in measured[np.abs(measured) > 1e-4]:
        assert np.abs(np.array([*exact, *unused]) - pole).min() < 1e-9


def test_dead_time_poles_on_an_inertia():
    inertia, kp, dead = 0.02, 30.0, 2
    velocity = VelocityController(kp, LoopTiming(H, computing=dead))
    drive = dataclasses.replace(SPEED, velocity=velocity)
    # history rings of 3 slots return to themselves after 3 samples
    measured = np.linalg.eigvals(closed_loop_matrix(drive, inertia, dead + 1))
    # v: (z - 1) z^2 + h Kp/J
    exact = np.roots([1.0, -1.0, 0.0, H * kp / inertia]) ** (dead + 1)
    for pole in exact:
        assert np.abs(measured - pole).min() < 1e-7


def test_following_error_is_velocity_over_gain_and_vanishes_with_feedforward():
    v, kv, n = 0.2, 50.0, 16000
    base = dataclasses.replace(
        SPEED,
        position=PositionController(kv, LoopTiming(16 * H)),
        velocity=VelocityController(9.0, ONE, integral_time=0.015),
        measuring=MeasuringSystem(0.003),
        current=SecondOrderCurrentLoop(1000.0),
    )
    t = H * np.arange(n)
    sets = np.stack([v * t, np.full(n, v), np.zeros(n)], axis=1)
    for fed, error in ((0.0, v / kv), (1.0, 0.0)):
        drive = dataclasses.replace(base, feedforward=Feedforward(velocity=fed))
        path = on_inertia(control_table([drive], H), 0.02, 0.0, H, 0.003, sets, (0.0, 0.0), 0)[0]
        at = (n - 1) // 16 * 16
        assert v * t[at] - 0.003 * path[at, 0] == pytest.approx(error, abs=1e-7)


def test_reference_model_takes_the_overshoot_out_of_a_velocity_step():
    inertia, kp, tn, n = 0.02, 4.0, 0.006, 800
    sets = np.zeros((n, 3))
    sets[:, 1] = 1.0
    loop = kp / inertia / (2 * math.pi)  # corner of the proportional loop, Hz

    def velocity(model):
        controller = VelocityController(kp, ONE, tn, reference_model=model)
        drive = dataclasses.replace(SPEED, velocity=controller)
        return on_inertia(control_table([drive], H), inertia, 0.0, H, 1.0, sets, (0.0, 0.0), 0)[0]

    without, with_model = velocity(None)[:, 1], velocity(ReferenceModel(2 * loop, 2.0))[:, 1]
    assert without.max() > 1.1
    assert with_model.max() < 1.02
    assert with_model[-1] == pytest.approx(1.0, abs=1e-3)


def test_drives_in_one_table_do_not_touch_each_other():
    table = control_table([SPEED, dataclasses.replace(SPEED, filters=(notch(300.0, 0.1, 0.5),))], H)
    before = [np.array(column[1]) for column in table]
    fixed_motor(table, step_of(1, 50))
    for column, kept in zip(table, before, strict=True):
        np.testing.assert_array_equal(column[1], kept)
    with pytest.raises(ValueError, match="read-only"):
        table.proportional[0] = 1.0


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (
            lambda: control_table([SPEED], 100e-6),
            r"position loop: sample time 0\.000125 s.*0\.0001",
        ),
        (lambda: with_timing(SPEED, velocity=LoopTiming(2 * H)), "position loop.*velocity loop"),
        (
            lambda: with_timing(SPEED, current=LoopTiming(1.5 * H)),
            "velocity loop: sample time.*current loop",
        ),
        (lambda: control_table([SPEED], math.nan), "step is nan"),
        (lambda: control_table([], H), "no drive"),
        (lambda: LoopTiming(H, computing=1.5), "computing dead time is 1.5"),
        (lambda: LoopTiming(H, measuring=-1), "measuring dead time is -1"),
        (lambda: PositionController(-1.0, ONE), "gain"),
        (lambda: VelocityController(1.0, ONE, integral_time=0.0), "integral time"),
        (lambda: MeasuringSystem(0.0), "transmission"),
        (lambda: MeasuringSystem(1.0, "resolver"), "encoder or scale"),
        (lambda: dataclasses.replace(SPEED, filters=(low_pass(5e3),)), "Nyquist"),
        (lambda: RegulatedMotor(0.0, 1e-3, 1.0, 1.0), "resistance"),
    ],
)
def test_nonsense_is_refused_by_name(build, message):
    with pytest.raises(ControlError, match=message):
        build()


def test_kernel_compiles_once_for_other_drives_and_counts_no_references():
    fixed_motor(control_table([SPEED], H), step_of(1, 5))
    count = len(fixed_motor.signatures)
    fixed_motor(control_table([SPEED, SPEED], 2 * H / 2), step_of(1, 5))
    assert len(fixed_motor.signatures) == count
