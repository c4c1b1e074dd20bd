"""Torque impulses are released as the tool comes to an angle of the spindle."""

import math

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.description.machine.frequency_response import FrfSection
from chatter.simulation.virtual_tests.virtual_tests import FrfTest, _at_angle

STEP = 5e-5


@pytest.mark.parametrize(("settling", "angle"), [(0.0, 0.5 * math.pi), (0.37, 1.0)])
def test_the_spindle_stands_at_the_angle_when_a_pulse_begins(settling, angle):
    speed = 180.0 * math.pi / 30.0
    test = FrfTest(
        "boring",
        "torque impulse",
        "Y",
        np.zeros(1),
        20.0,
        (10.0, 100.0),
        1.0,
        3,
        settling,
        spindle_speed=speed,
        at_angle=angle,
    )
    train = _at_angle(test, 0.01, STEP)
    turned = speed * (round(settling / STEP) + train.starts) * STEP
    off = (turned - angle + math.pi) % (2.0 * math.pi) - math.pi
    assert len(train.starts) >= 3
    assert np.all((off >= -1e-9) & (off <= speed * STEP + 1e-9))
    assert np.all(np.diff(train.starts) * STEP >= 1.0 - STEP)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"at_angle": "90 deg"}, "is missing; impulses"),
        ({"spindle_speed": "180 rpm"}, "is missing; impulses"),
        ({"by": "hammer", "excite": "table:y", "at_angle": 1.0, "spindle_speed": 1.0}, "impulse"),
    ],
)
def test_what_belongs_together_is_told(keys, words):
    given = {"excite": "motor:Y", "read": "table:y", "by": "torque impulse", "band": [10.0, 100.0]}
    with pytest.raises((InputError, ValueError), match=words):
        FrfSection.model_validate(given | keys)
