"""A long run is recorded in full detail, whatever divisors its steps have."""

import math

import numpy as np
import pytest

from chatter import Case
from chatter.simulation.setup import set_up

MODES = [
    {"frequency": "0.8 Hz", "damping": 0.04, "stiffness": "2000 N/um", "direction": [1, 0, 0]},
    {"frequency": "2.1 kHz", "damping": 0.005, "stiffness": "900 N/um", "direction": [0, 1, 0]},
]


@pytest.mark.parametrize("teeth", [1, 3, 5, 7])
def test_a_record_has_enough_rows_a_turn_and_no_more_than_it_may(teeth):
    case = Case.from_dict(
        {
            "tool": {"teeth": teeth, "diameter": "50 mm"},
            "material": {"Ktc": "800 MPa", "Krc": "250 MPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": "600 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "2 mm",
                "radial_depth": "5 mm",
            },
            "structure": {"mode": MODES},
        }
    )
    for speed in np.linspace(420.0, 1260.0, 60):
        here = case.patch({"cut.spindle_speed": speed * math.pi / 30.0})
        resolution = set_up(here).resolution
        # 120 steps within a period of the fastest mode, and hardly more
        wanted = 120.0 * 2100.0 * 60.0 / speed
        assert wanted <= resolution.steps_per_revolution < 1.2 * wanted + 100
        assert resolution.steps_per_revolution % math.lcm(4, teeth) == 0
        assert resolution.steps_per_revolution % resolution.stride == 0
        rows = resolution.steps_per_revolution / resolution.stride
        # six samples from tooth to tooth are the least that a verdict takes
        assert rows >= 150.0
        assert rows * resolution.revolutions <= 120_000
