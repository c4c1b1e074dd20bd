"""Elements and coupling assemblies of edges whose engagement changes many times in a revolution."""

import math

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.stability.methods.collocation.coupling_assembly import coupling_assemblies
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import points_of_periods
from chatter.stability.model import milling_model

RPM = math.pi / 30.0
DEPTH = 8e-3
#: levels of ever smaller elements beside a border
LEVELS = 5


def serrated_cut(law):
    case = Case.from_dict(
        {
            "tool": {
                "teeth": 4, "diameter": "20 mm", "helix": "30 deg",
                "serration": {"depth": "0.3 mm", "wavelength": "2.5 mm"},
            },
            "material": {"Ktc": "800 MPa", "Krc": "300 MPa", "Kac": "150 MPa"} | law,
            "cut": {
                "mode": "down", "spindle_speed": "6000 rpm", "feed_per_tooth": "0.1 mm",
                "axial_depth": DEPTH, "radial_depth": "6 mm",
            },
            "structure": {
                "mode": [
                    {"frequency": "650 Hz", "damping": 0.03, "stiffness": "4 N/um",
                     "direction": [1, 0, 0]},
                ]
            },
        }
    )  # fmt: skip
    return element_cut(milling_model(case), DEPTH)


@pytest.fixture(scope="module")
def with_size_effect():
    return serrated_cut({"law": "exponential", "h0": "0.1 mm", "exponent": 0.7})


def elements(cut):
    points = points_of_periods(cut, np.array([9000.0 * RPM]), np.array([DEPTH]))
    return int(points[0]) // cut.points.weight.size


def test_elements_shrink_towards_the_ends_of_the_cut_alone(with_size_effect):
    """Elements were crowded at every wave, and most of the time of limits went into them."""
    ends = 4 * 2 * 2  # tip and top of every tooth enter and leave
    graded = elements(with_size_effect) - elements(serrated_cut({"law": "linear"}))
    assert 0 < graded <= 2 * LEVELS * ends


def test_speeds_share_the_couplings_of_constant_delays(with_size_effect):
    """They were assembled anew for every step of the speed, which only varying delays ask for."""
    speeds = np.array([3000.0, 4500.0, 6000.0, 9000.0]) * RPM
    shared = coupling_assemblies(with_size_effect, speeds, np.full(speeds.size, DEPTH))
    assert shared.of_point.tolist() == [0, 0, 0, 0]
