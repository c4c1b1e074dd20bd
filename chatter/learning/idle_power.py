"""Power that the spindle takes in the air: taken off where it is stated, learnt where it is not.

A meter shows it together with the power of the cut. What the readings have in common beyond a share
of the predicted power tells it roughly (see `readings`): coefficients that wear or are declared
wrongly change that share from test to test. So it is learnt with them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from chatter.explain.cutting_tests.spindle_power import readings
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter
from chatter.explain.stability_margin import tests_of

POWER = "spindle_power"
#: name of the idle power that is learnt
IDLE_POWER = "idle power"
#: standard deviation of what readings have in common, over their median
_DEVIATION = 0.08


def with_power_understood(run: Run, measurement: Measurement) -> Run:
    """Tests with readings of power in W, without the idle power that is stated."""
    if POWER not in run.signals:
        return run
    tests = tests_of(measurement.case, run.signals)
    found = readings(measurement.case, tests, run.signals[POWER], measurement.idle_power)
    power = found.power if measurement.idle_power is not None else found.power + found.idle
    return replace(run, signals={**run.signals, POWER: power})


def idle_power(measurement: Measurement) -> list[Parameter]:
    """Idle power as a number to learn; none where it is stated or no power was read."""
    if measurement.idle_power is not None:
        return []
    return [_idle_power(run, measurement) for run in measurement.runs if run.record == POWER]


def _idle_power(run: Run, measurement: Measurement) -> Parameter:
    """Idle power that some readings have in common, between none and the least of them."""
    power = run.signals[POWER]
    common = readings(measurement.case, tests_of(measurement.case, run.signals), power, None).idle
    size, most = _DEVIATION * float(np.median(power)), float(power.min())
    return Parameter(IDLE_POWER, min(common, most), size, lower=0.0, upper=most, unit="W")
