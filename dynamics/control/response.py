"""Closed-form frequency response of the sampled cascade: the linear counterpart of its step.

Each loop is its z-domain response at its own sample time; between loops stand the hold over the
finer samples and the dead times. Exact for the component of the torque at the frequency of the
input, within limits and without resolution (see `sampling`).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.control.cascade import DriveController
from dynamics.control.filters import sampled_response
from dynamics.control.sampling import delay_response, sample_and_hold_response

Response = NDArray[np.complex128]


class ControllerResponse(NamedTuple):
    """Torque, N m, at the steps of time per input at the steps of time; each (n,) complex.

    Times `zero_order_hold_response` it acts on a continuous structure. Feedback is negative in
    it: the torque is the sum over all inputs.
    """

    x_set: Response  # N m/m
    v_set: Response  # N m s/m
    a_set: Response  # N m s^2/m
    x_motor: Response  # N m/rad
    v_motor: Response  # N m s/rad
    x_scale: Response  # N m/m

    def per_motor_angle(self, frequencies: ArrayLike) -> Response:
        """Return the torque per motor angle, velocity being its derivative; N m/rad, Hz."""
        w = 2.0 * np.pi * np.asarray(frequencies, dtype=np.float64)
        return self.x_motor + 1j * w * self.v_motor


def controller_response(
    controller: DriveController, step: float, frequencies: ArrayLike
) -> ControllerResponse:
    """Return the response of the cascade from each of its inputs to the torque.

    Parameters
    ----------
    controller : DriveController
    step : float
        Step of the simulation, s.
    frequencies : (n,) array_like of float
        Hz, above 0 if there is an integral part. May exceed the Nyquist frequency of a loop;
        half multiples of a loop's sampling frequency are excluded: there an image falls on the
        frequency itself.

    Raises
    ------
    ControlError
        If a sample time is no whole multiple of the step.
    """
    f = np.asarray(frequencies, dtype=np.float64)
    per_position, per_velocity, _ = controller.steps_per_sample(step)
    position, velocity, _ = controller.timings
    measuring, fed = controller.measuring, controller.feedforward
    t_p, t_v = position.sample_time, velocity.sample_time

    torque = _torque_per_set_torque(controller, step, f)
    per_set, per_speed = _velocity_controller(controller, f)
    held = sample_and_hold_response(f, t_v, per_position // per_velocity)
    per_velocity_set = torque * per_set * held / measuring.transmission
    gain = controller.position.gain * delay_response(f, t_p, position.output_delay)
    per_measured = -per_velocity_set * gain * delay_response(f, t_p, position.measuring)

    inertia = fed.inertia / measuring.transmission
    per_measured_speed = torque * per_speed * delay_response(f, t_v, velocity.measuring)
    z1 = delay_response(f, t_v, 1)
    nothing = np.zeros_like(torque)
    on_scale = measuring.position == "scale"
    by_difference = measuring.velocity == "difference"
    return ControllerResponse(
        x_set=per_velocity_set * gain * delay_response(f, t_p, controller.position.set_point_delay),
        v_set=per_velocity_set * fed.velocity * delay_response(f, t_p, fed.velocity_delay),
        a_set=torque * held * inertia * delay_response(f, t_v, fed.torque_delay),
        x_motor=(nothing if on_scale else per_measured * measuring.transmission)
        + (per_measured_speed * (1.0 - z1) / t_v if by_difference else nothing),
        v_motor=(nothing if by_difference else per_measured_speed)
        + _torque_per_back_emf(controller, step, f),
        x_scale=per_measured if on_scale else nothing,
    )


def _velocity_controller(
    controller: DriveController, f: NDArray[np.float64]
) -> tuple[Response, Response]:
    """Torque set point per velocity set point and per measured velocity, N m s/rad."""
    spec = controller.velocity
    t_v = spec.timing.sample_time
    summed = np.zeros(f.shape, dtype=np.complex128)
    if controller.integral_gain > 0.0:
        summed = controller.integral_gain / (1.0 - delay_response(f, t_v, 1))
    reference = np.ones_like(summed)
    if spec.reference_model is not None:
        reference = sampled_response(spec.reference_model.sampled(t_v), f, t_v)
    proportional = spec.proportional_gain
    return proportional + summed * reference, -(proportional + summed)


def _torque_per_set_torque(
    controller: DriveController, step: float, f: NDArray[np.float64]
) -> Response:
    """Torque per output of the velocity controller: dead time, hold, filters, current loop."""
    _, per_velocity, per_current = controller.steps_per_sample(step)
    _, velocity, current = controller.timings
    t_c = current.sample_time
    law = controller.current.input_law(t_c)
    plant = controller.current.plant()
    path = delay_response(f, velocity.sample_time, velocity.output_delay)
    path = path * sample_and_hold_response(f, t_c, per_velocity // per_current)
    for spec in controller.filters:
        path = path * sampled_response(spec.sampled(t_c), f, t_c)
    regulator = _regulator(controller, f)
    path = path * (law.through + regulator / law.torque_constant)
    path = path * delay_response(f, t_c, current.output_delay) / (1.0 + _loop(controller, f))
    path = path * sample_and_hold_response(f, step, per_current)
    return path * (plant.response(f, step) @ plant.torque + plant.feedthrough)


def _torque_per_back_emf(
    controller: DriveController, step: float, f: NDArray[np.float64]
) -> Response:
    """Torque per motor velocity through the induced voltage, N m s/rad."""
    timing = controller.current_timing
    law = controller.current.input_law(timing.sample_time)
    if law.back_emf == 0.0:
        return np.zeros(f.shape, dtype=np.complex128)
    plant = controller.current.plant()
    states = plant.response(f, step)
    dead = delay_response(f, timing.sample_time, timing.output_delay + timing.measuring)
    regulated = _regulator(controller, f) * dead / (1.0 + _loop(controller, f))
    held = sample_and_hold_response(f, step, controller.steps_per_sample(step)[2])
    answer = 1.0 - regulated * held * states[..., 0]
    return -law.back_emf * (states @ plant.torque) * answer


def _regulator(controller: DriveController, f: NDArray[np.float64]) -> Response:
    """Voltage per current deviation of the PI current controller, V/A; 0 where there is none."""
    t_c = controller.current_timing.sample_time
    law = controller.current.input_law(t_c)
    regulator = np.full(f.shape, law.proportional, dtype=np.complex128)
    if law.integral > 0.0:
        regulator += law.integral / (1.0 - delay_response(f, t_c, 1))
    return regulator


def _loop(controller: DriveController, f: NDArray[np.float64]) -> Response:
    """Open current loop, sampled at the current loop."""
    timing = controller.current_timing
    dead = delay_response(f, timing.sample_time, timing.output_delay + timing.measuring)
    measured = controller.current.plant().response(f, timing.sample_time)[..., 0]
    return _regulator(controller, f) * dead * measured
