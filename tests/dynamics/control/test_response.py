"""The sampled cascade run in time against its closed-form z-domain response."""

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
from dynamics.control.current_loop import (
    FirstOrderCurrentLoop,
    IdealCurrentLoop,
    RegulatedMotor,
    SecondOrderCurrentLoop,
)
from dynamics.control.drive_step import control_step
from dynamics.control.drive_table import control_table
from dynamics.control.filters import ReferenceModel, low_pass, notch
from dynamics.control.measurement import MeasuringSystem
from dynamics.control.response import controller_response

STEP = 31.25e-6
LEAD = 0.02 / (2.0 * math.pi)

PLAIN = DriveController(
    position=PositionController(50.0, LoopTiming(2e-3)),
    velocity=VelocityController(12.0, LoopTiming(250e-6), integral_time=0.01),
    measuring=MeasuringSystem(LEAD),
    current_timing=LoopTiming(62.5e-6),
)
RICH = DriveController(
    position=PositionController(
        50.0, LoopTiming(2e-3, measuring=1, computing=1, transmission=1), set_point_delay=3
    ),
    velocity=VelocityController(
        12.0,
        LoopTiming(250e-6, measuring=2, computing=1),
        integral_time=0.01,
        reference_model=ReferenceModel(120.0, 0.8),
    ),
    measuring=MeasuringSystem(LEAD, position="scale", velocity="difference"),
    current_timing=LoopTiming(62.5e-6, measuring=1, computing=1, transmission=2),
    current=SecondOrderCurrentLoop(900.0, 0.6),
    filters=(notch(520.0, 0.05, 0.4), low_pass(1500.0), notch(2100.0, 0.0, 0.2)),
    feedforward=Feedforward(velocity=0.9, velocity_delay=2, inertia=0.03, torque_delay=5),
)
MOTOR = RegulatedMotor(
    resistance=0.5,
    inductance=4e-3,
    torque_constant=1.4,
    proportional_gain=12.0,
    integral_time=2e-3,
    back_emf=0.8,
)
DRIVES = {
    "plain": PLAIN,
    "rich": RICH,
    "lag": dataclasses.replace(PLAIN, current=FirstOrderCurrentLoop(4e-4)),
    "motor": dataclasses.replace(PLAIN, current=MOTOR),
    "motor with dead times": dataclasses.replace(RICH, current=MOTOR),
    "negative transmission": dataclasses.replace(RICH, measuring=MeasuringSystem(-LEAD)),
}


@njit(error_model="numpy")
def run(table, k, signals):
    torque = np.zeros(signals.shape[0])
    for n in range(signals.shape[0]):
        s = signals[n]
        torque[n] = control_step(table, k, n, s[0], s[1], s[2], s[3], s[4], s[5])
    return torque


def steady_response(drive, step, channel, bins, periods, per_period):
    """Torque per input at bins of a period after the transient has died out."""
    n = np.arange(per_period)
    phases = np.random.default_rng(3).uniform(0, 2 * np.pi, len(bins))
    wave = sum(
        np.sin(2 * np.pi * b * n / per_period + p) for b, p in zip(bins, phases, strict=True)
    )
    signals = np.zeros((per_period * periods, 6))
    signals[:, channel] = np.tile(wave, periods)
    torque = run(control_table([PLAIN, drive], step), 1, signals)[-per_period:]
    # the constant that the integral part has gathered falls into bin 0
    return np.fft.fft(torque)[bins] / np.fft.fft(wave)[bins]


@pytest.mark.parametrize("name", DRIVES)
@pytest.mark.parametrize("channel", range(6))
def test_response_in_time_is_that_in_the_z_domain(name, channel):
    drive, per_period = DRIVES[name], 64 * 128  # 0.256 s, whole samples of each loop
    # images at bin + 128 m of the slowest loop, and of -bin, miss all other bins
    bins = np.array([3, 10, 37, 133, 291, 679, 1322])
    expected = np.array(controller_response(drive, STEP, bins / (per_period * STEP)))
    measured = steady_response(drive, STEP, channel, bins, 6, per_period)
    scale = np.abs(expected[channel]).max()
    np.testing.assert_allclose(measured, expected[channel], rtol=1e-9, atol=1e-9 * scale)


def test_images_avoid_each_other_in_the_multisine():
    images = {}
    for b in (3, 10, 37, 133, 291, 679, 1322):
        for sign in (1, -1):
            images.setdefault((sign * b) % 128, []).append(b)
    assert all(len(v) == 1 for v in images.values())


def test_ideal_single_rate_cascade_is_its_textbook_formula():
    f = np.array([5.0, 40.0, 300.0])
    h = 125e-6
    drive = DriveController(
        PositionController(30.0, LoopTiming(h)),
        VelocityController(8.0, LoopTiming(h), integral_time=0.02),
        MeasuringSystem(1.0),
        LoopTiming(h),
        IdealCurrentLoop(),
    )
    z = np.exp(2j * np.pi * f * h)
    pi = 8.0 * (1.0 + h / 0.02 * z / (z - 1.0))
    response = controller_response(drive, h, f)
    np.testing.assert_allclose(response.x_set, 30.0 * pi, rtol=1e-13)
    np.testing.assert_allclose(response.x_motor, -30.0 * pi, rtol=1e-13)
    np.testing.assert_allclose(response.v_motor, -pi, rtol=1e-13)
    np.testing.assert_allclose(
        response.per_motor_angle(f), -(30.0 + 2j * np.pi * f) * pi, rtol=1e-13
    )


def test_current_loops_approach_their_continuous_response_at_a_fine_step():
    f = np.array([20.0, 200.0, 900.0])
    s = 2j * np.pi * f
    step = 1e-7
    timing = LoopTiming(step)
    w = 2.0 * np.pi * 900.0
    pi = MOTOR.proportional_gain * (1.0 + 1.0 / (MOTOR.integral_time * s))
    opened = pi / (MOTOR.resistance + MOTOR.inductance * s)
    loops = {
        FirstOrderCurrentLoop(4e-4): 1.0 / (1.0 + 4e-4 * s),
        SecondOrderCurrentLoop(900.0, 0.6): 1.0 / ((s / w) ** 2 + 1.2 * s / w + 1.0),
        MOTOR: opened / (1.0 + opened),
    }
    for loop, expected in loops.items():
        drive = DriveController(
            PositionController(0.0, timing),
            VelocityController(1.0, timing),
            MeasuringSystem(1.0),
            timing,
            loop,
            feedforward=Feedforward(velocity=1.0),
        )
        measured = controller_response(drive, step, f).v_set
        np.testing.assert_allclose(measured, expected, rtol=2e-3)


@njit(error_model="numpy")
def shaken(table, inertia, step, load):
    """Velocity of a controlled inertia under a load held over each step."""
    speed = np.zeros(load.size)
    x, v = 0.0, 0.0
    for n in range(load.size):
        speed[n] = v
        torque = control_step(table, 0, n, 0.0, 0.0, 0.0, x, v, 0.0)
        a = (torque + load[n]) / inertia
        x, v = x + v * step + 0.5 * a * step * step, v + a * step
    return speed


@pytest.mark.parametrize(("slower", "bound"), [((1, 1), 1e-9), ((2, 8), 1e-4)])
def test_disturbance_response_of_a_closed_loop(slower, bound):
    # exact where all loops have one rate; else images of the loop itself are left out of it
    inertia, h, count = 0.02, 125e-6, 4096
    velocity, position = (LoopTiming(n * h, computing=1) for n in slower)
    drive = DriveController(
        PositionController(40.0, position),
        VelocityController(9.0, velocity, integral_time=0.02),
        MeasuringSystem(1.0),
        LoopTiming(h),
        SecondOrderCurrentLoop(900.0),
        (notch(1500.0, 0.1, 0.4),),
    )
    bins = np.array([5, 17, 61, 203, 467])
    n = np.arange(count)
    load = sum(np.sin(2 * np.pi * b * n / count + b) for b in bins)
    speed = shaken(control_table([drive], h), inertia, h, np.tile(load, 12))[-count:]
    measured = np.fft.fft(speed)[bins] / np.fft.fft(load)[bins]
    f = bins / (count * h)
    z = np.exp(2j * np.pi * f * h)
    per_speed, per_angle = h / inertia / (z - 1), h * h * (z + 1) / (2 * inertia * (z - 1) ** 2)
    response = controller_response(drive, h, f)
    closed = 1.0 - response.x_motor * per_angle - response.v_motor * per_speed
    assert np.abs(measured * closed / per_speed - 1.0).max() < bound


def test_python_and_compiled_step_agree_and_count_no_references():
    signals = np.random.default_rng(5).normal(size=(300, 6))
    drive = DRIVES["motor with dead times"]
    plain = run.py_func(control_table([drive, RICH], STEP), 1, signals)
    np.testing.assert_allclose(
        run(control_table([drive, RICH], STEP), 1, signals), plain, rtol=1e-12
    )

    @njit(error_model="numpy", _nrt=False)
    def loop(table, k, torque):
        for n in range(torque.size):
            torque[n] = control_step(table, k, n, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    loop(control_table([drive], STEP), 0, np.zeros(10))
    assert "NRT_incref" not in "".join(loop.inspect_llvm().values())
