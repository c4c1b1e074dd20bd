"""Sampled cascade control of feed drives and spindles: what turns set points into torque.

================ ===================================================================
module           responsibility
================ ===================================================================
sampling         sample times as whole steps, holds and delays in the z-domain
filters          second-order filters and the reference model: coefficients, leaf, response
current_loop     how the torque follows its set point: ideal, lag, or PI on a motor
measurement      encoder and scale: ratio, resolution, velocity from positions
cascade          the specification of a drive: controllers, limits, dead times
drive_table      specification -> columns
drive_step       one step of time of the cascade (kernel)
response         closed-form frequency response of the same cascade
================ ===================================================================

A drive is specified by `DriveController`; `control_table` makes the columns for k drives at a
step of time, `control_step` is called at each step, `controller_response` is its linear
counterpart.
"""
