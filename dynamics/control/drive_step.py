"""One step of time of sampled cascades: leaves for the time loop, without allocation.

At a step that is a sample of a loop the loop reads, computes and puts out; between samples its
output is held. Delays are rings of past samples, one slot longer than the longest delay.
"""

from numba.extending import register_jitable

from dynamics.compiled import INLINED
from dynamics.control.drive_table import (
    CURRENT_INPUT,
    CURRENT_OUTPUT,
    LAST_ANGLE,
    MEASURED_CURRENT,
    MEASURED_POSITION,
    MEASURED_VELOCITY,
    PLANT_FIRST,
    PLANT_SECOND,
    POSITION_OUTPUT,
    REFERENCE_FIRST,
    REFERENCE_SECOND,
    SET_POSITION,
    SET_TORQUE,
    SET_VELOCITY,
    TORQUE_FED,
    TORQUE_INJECTED,
    TORQUE_SET,
    TORQUE_SUM,
    VELOCITY_OUTPUT,
    VELOCITY_SET,
    VOLTAGE_SUM,
)
from dynamics.control.filters import second_order_sample
from dynamics.control.measurement import quantised


@register_jitable(**INLINED)
def clipped(value, limit):
    """Value within plus and minus a limit."""
    return max(-limit, min(limit, value))


@register_jitable(**INLINED)
def summed_unless_limited(total, increment, others, limit):
    """Sum of an integral part, and output with it; the sum grows no further than to the limit.

    `others` is the rest of the output; the limit holds for either sign.
    """
    summed = total + increment
    if increment > 0.0 and others + summed > limit:
        summed = max(total, limit - others)
    elif increment < 0.0 and others + summed < -limit:
        summed = min(total, -limit - others)
    return summed, clipped(others + summed, limit)


@register_jitable(**INLINED)
def delayed(table, k, channel, sample, value):
    """Keep a sample and return the one that lies the channel's delay back."""
    slots = table.history.shape[2]
    table.history[k, channel, sample % slots] = value
    return table.history[k, channel, (sample - table.delays[k, channel]) % slots]


@register_jitable(**INLINED)
def position_sample(table, k, sample, x_set, v_set, a_set, x_motor, x_scale):
    """Set point of the motor's velocity, rad/s, and torque fed forward, N m."""
    angle = quantised(x_motor, table.resolution[k, 0])
    measured = table.transmission[k] * angle
    if table.scale[k] > 0.0:
        measured = quantised(x_scale, table.resolution[k, 1])
    deviation = delayed(table, k, SET_POSITION, sample, x_set) - delayed(
        table, k, MEASURED_POSITION, sample, measured
    )
    v = delayed(table, k, POSITION_OUTPUT, sample, table.position_gain[k] * deviation)
    v += table.velocity_fed[k] * delayed(table, k, SET_VELOCITY, sample, v_set)
    table.state[k, VELOCITY_SET] = clipped(v, table.velocity_limit[k]) / table.transmission[k]
    table.state[k, TORQUE_FED] = table.torque_fed[k] * a_set


@register_jitable(**INLINED)
def velocity_sample(table, k, sample, x_motor, v_motor):
    """Torque set point before the filters, N m."""
    angle = quantised(x_motor, table.resolution[k, 0])
    speed = v_motor
    if table.difference[k] > 0.0:
        speed = (angle - table.state[k, LAST_ANGLE]) * table.difference[k]
    table.state[k, LAST_ANGLE] = angle
    measured = delayed(table, k, MEASURED_VELOCITY, sample, speed)
    set_point = table.state[k, VELOCITY_SET]
    reference, first, second = second_order_sample(
        table.reference[k, 0],
        table.reference[k, 1],
        table.reference[k, 2],
        table.reference[k, 3],
        table.reference[k, 4],
        table.state[k, REFERENCE_FIRST],
        table.state[k, REFERENCE_SECOND],
        set_point,
    )
    table.state[k, REFERENCE_FIRST] = first
    table.state[k, REFERENCE_SECOND] = second
    fed = delayed(table, k, SET_TORQUE, sample, table.state[k, TORQUE_FED])
    total, torque = summed_unless_limited(
        table.state[k, TORQUE_SUM],
        table.integral[k] * (reference - measured),
        table.proportional[k] * (set_point - measured) + fed,
        table.torque_limit[k],
    )
    table.state[k, TORQUE_SUM] = total
    table.state[k, TORQUE_SET] = delayed(table, k, VELOCITY_OUTPUT, sample, torque)


@register_jitable(**INLINED)
def current_sample(table, k, sample):
    """Input of the current plant: filtered torque set point, or voltage of the PI controller."""
    torque = table.state[k, TORQUE_SET] + table.state[k, TORQUE_INJECTED]
    for index in range(table.filters.shape[1]):
        torque, first, second = second_order_sample(
            table.filters[k, index, 0],
            table.filters[k, index, 1],
            table.filters[k, index, 2],
            table.filters[k, index, 3],
            table.filters[k, index, 4],
            table.filter_state[k, index, 0],
            table.filter_state[k, index, 1],
            torque,
        )
        table.filter_state[k, index, 0] = first
        table.filter_state[k, index, 1] = second
    torque = clipped(torque, table.torque_limit[k])
    measured = delayed(table, k, MEASURED_CURRENT, sample, table.state[k, PLANT_FIRST])
    deviation = torque / table.input_law[k, 4] - measured
    total, regulated = summed_unless_limited(
        table.state[k, VOLTAGE_SUM],
        table.input_law[k, 2] * deviation,
        table.input_law[k, 1] * deviation,
        table.input_law[k, 3],
    )
    table.state[k, VOLTAGE_SUM] = total
    output = table.input_law[k, 0] * torque + regulated
    table.state[k, CURRENT_INPUT] = delayed(table, k, CURRENT_OUTPUT, sample, output)


@register_jitable(**INLINED)
def current_plant_step(table, k, v_motor):
    """Torque of this step, N m; the plant moves on to the next."""
    held = table.state[k, CURRENT_INPUT]
    x, y = table.state[k, PLANT_FIRST], table.state[k, PLANT_SECOND]
    torque = table.plant[k, 6] * x + table.plant[k, 7] * y + table.plant[k, 8] * held
    driven = held - table.input_law[k, 5] * v_motor
    table.state[k, PLANT_FIRST] = (
        table.plant[k, 0] * x + table.plant[k, 1] * y + table.plant[k, 4] * driven
    )
    table.state[k, PLANT_SECOND] = (
        table.plant[k, 2] * x + table.plant[k, 3] * y + table.plant[k, 5] * driven
    )
    return torque


@register_jitable(**INLINED)
def control_step(table, k, step_number, x_set, v_set, a_set, x_motor, v_motor, x_scale):
    """Torque of a drive during one step of time, N m; to be called once a step, in order.

    Of drive k. `step_number` counts from 0; loops sample where it is a multiple of their steps per
    sample. Set point of the axis, m, m/s, m/s^2 (rad and kin for a rotary axis), read with the
    position loop; angle and velocity of the motor at the beginning of the step, rad and rad/s;
    position at the scale, m.
    """
    if step_number % table.samples[k, 0] == 0:
        sample = step_number // table.samples[k, 0]
        position_sample(table, k, sample, x_set, v_set, a_set, x_motor, x_scale)
    if step_number % table.samples[k, 1] == 0:
        velocity_sample(table, k, step_number // table.samples[k, 1], x_motor, v_motor)
    if step_number % table.samples[k, 2] == 0:
        current_sample(table, k, step_number // table.samples[k, 2])
    return current_plant_step(table, k, v_motor)
