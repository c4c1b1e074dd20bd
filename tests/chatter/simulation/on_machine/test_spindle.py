"""The spindle dips under the torque of the cut as its inertia and its controller say."""

import numpy as np
import pytest

from chatter.simulation.simulate import simulate
from tests.chatter.simulation.on_machine.coupled_machines import (
    body,
    cut_case,
    spindle,
    spring,
    written,
)

RADIUS, FEED, KTC = 10e-3, 0.1e-3, 8e8
SPEED = 100.0 * np.pi
#: a slot whose edges lag by just a pitch: the torque does not change with the angle
TORQUE = 2.0 * KTC * FEED * RADIUS**2
INERTIA, GAIN = 0.2, 10.0


def run(folder, direction=(0.0, 0.0, -1.0), inertia=INERTIA, integral=None, revolutions=8):
    machine = written(
        folder,
        {
            "tool_point": "tip",
            "body": {"head": body(1e6)},
            "connector": {"foot": spring("head", "ground")},
            "point": {"tip": {"on": "head", "at": [0.0, 0.0, -0.2]}},
            "axis": {"S": spindle("head", direction, inertia, GAIN, integral)},
        },
    )
    return simulate(
        cut_case(
            {"machine": str(machine), "settling": 0.01},
            tool={"diameter": 2.0 * RADIUS, "helix": "45 deg"},
            cut={"mode": "slot", "radial_depth": 2.0 * RADIUS, "axial_depth": np.pi / 2 * RADIUS},
            material={"Ktc": KTC, "Krc": 3e8, "Kac": 0.0},
            slices=32,
            revolutions=revolutions,
        )
    )


@pytest.mark.parametrize("direction", [(0.0, 0.0, -1.0), (0.0, 0.0, 1.0)])
def test_the_dip_is_that_of_an_inertia_under_a_proportional_controller(tmp_path, direction):
    result = run(tmp_path, direction)
    assert result.torque[:20] == pytest.approx(np.full(20, TORQUE), rel=2e-3)
    dip = SPEED - result.spindle_speed
    expected = TORQUE / GAIN * (1.0 - np.exp(-GAIN * result.time / INERTIA))
    # the chip grows as the teeth come later: by the share of the dip
    assert np.abs(dip - expected).max() < 0.012 * TORQUE / GAIN
    # at the very beginning nothing but the inertia resists
    assert np.gradient(dip, result.time)[1] == pytest.approx(TORQUE / INERTIA, rel=0.01)


def test_the_droop_stays_with_a_proportional_and_goes_with_an_integral_controller(tmp_path):
    droop = TORQUE / GAIN
    proportional = run(tmp_path, revolutions=12)
    assert SPEED - proportional.spindle_speed[-1] == pytest.approx(droop, rel=0.012)
    integral = run(tmp_path, integral=0.02, revolutions=25)
    assert (SPEED - integral.spindle_speed).max() > 0.3 * droop
    assert abs(SPEED - integral.spindle_speed[-1]) < 2e-3 * droop
    # the motor then gives what the cut takes; power is that torque at that speed
    assert abs(integral.torque_of("S")[-1]) == pytest.approx(TORQUE, rel=2e-3)
    assert integral.power[-1] == pytest.approx(TORQUE * SPEED, rel=2e-3)


def test_motor_torque_is_about_the_axis_as_given(tmp_path):
    """About the way from spindle to tip the tool turns forwards, about the other way backwards."""
    down = run(tmp_path, (0.0, 0.0, -1.0), revolutions=4)
    up = run(tmp_path, (0.0, 0.0, 1.0), revolutions=4)
    assert down.torque_of("S")[-1] > 0.5 * TORQUE
    assert up.torque_of("S") == pytest.approx(-down.torque_of("S"), rel=1e-9)
    assert up.spindle_speed == pytest.approx(down.spindle_speed, rel=1e-12)


def test_an_infinite_inertia_keeps_its_speed(tmp_path):
    dips = [
        SPEED - run(tmp_path, inertia=inertia, revolutions=1).spindle_speed.min()
        for inertia in (1e3, 1e6)
    ]
    assert dips[0] == pytest.approx(TORQUE / 1e3 * 0.02, rel=0.01)
    assert dips[1] == pytest.approx(TORQUE / 1e6 * 0.02, rel=0.01)
