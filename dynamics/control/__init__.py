"""Sampled cascade control of feed drives and spindles: what turns set points into torque.

================ ===================================================================
module           responsibility
================ ===================================================================
sampling         sample times as whole steps, holds and delays in the z-domain
filters          general second-order filters: coefficients, leaf, response
reference_model  the second-order lag before the integral part
current_loop     how the torque follows its set point: ideal, lag, or PI on a motor
measurement      encoder and scale: ratio, resolution, velocity from positions
cascade          the specification of a drive: controllers, limits, dead times
drive_table      specification -> columns, and a drive at rest
drive_step       one step of time of the cascade (kernel)
response         closed-form frequency response of the same cascade
brake            motor held by its brake instead of the cascade
================ ===================================================================

A drive is specified by `DriveController`; `control_table` makes the columns for k drives at a
step of time, `control_step` is called at each step, `controller_response` is its linear
counterpart.
"""

from dynamics.control.brake import MotorBrake, brake_table, brake_torque, engage_brake
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
from dynamics.control.drive_table import ControlTable, control_table, rest_at
from dynamics.control.filters import SecondOrderFilter, low_pass, notch
from dynamics.control.measurement import MeasuringSystem
from dynamics.control.reference_model import ReferenceModel
from dynamics.control.response import ControllerResponse, controller_response
from dynamics.control.sampling import ControlError

__all__ = [
    "ControlError",
    "ControlTable",
    "ControllerResponse",
    "DriveController",
    "Feedforward",
    "FirstOrderCurrentLoop",
    "IdealCurrentLoop",
    "LoopTiming",
    "MeasuringSystem",
    "MotorBrake",
    "PositionController",
    "ReferenceModel",
    "RegulatedMotor",
    "SecondOrderCurrentLoop",
    "SecondOrderFilter",
    "VelocityController",
    "brake_table",
    "brake_torque",
    "control_step",
    "control_table",
    "controller_response",
    "engage_brake",
    "low_pass",
    "notch",
    "rest_at",
]
