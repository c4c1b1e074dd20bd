"""What the edges couple is shared by speeds whose elements are the same in spindle angle."""

import math

import numpy as np

from chatter.description.case import Case
from chatter.stability.methods.collocation.coupling_assembly import coupling_assemblies
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import multipliers
from chatter.stability.methods.collocation.varying_speed import periods
from chatter.stability.model import milling_model
from chatter.stability.spindle_rotation import PeriodFit

MODES = [
    {"frequency": 900.0, "damping": 0.02, "stiffness": 2e7, "direction": [1, 0, 0]},
    {"frequency": 1010.0, "damping": 0.03, "stiffness": 2.2e7, "direction": [0, 1, 0]},
]


def cut_of(helix, **keys):
    document = {
        "tool": {"teeth": 4, "diameter": "16 mm", "helix": helix},
        "material": {"Ktc": "1800 MPa", "Krc": "700 MPa", "Kac": "200 MPa"},
        "cut": {
            "mode": "down", "spindle_speed": "2000 rpm", "feed_per_tooth": "0.08 mm",
            "axial_depth": "2 mm", "radial_depth": "8 mm",
        }
        | keys,
        "structure": {"mode": MODES},
    }  # fmt: skip
    return element_cut(milling_model(Case.from_dict(document)), 4e-3, 4, 1.0)


def varied_cut(helix):
    cut = cut_of(helix, speed_variation={"amplitude": 0.1, "frequency": "5 Hz"})
    return cut.with_fit(PeriodFit(tuning=5e-2))


def test_speeds_whose_periods_are_alike_share_a_depth():
    """25.5 to 25.7 tool periods a variation are 26 of them, as the frequency may move by 5 %."""
    cut, speeds = varied_cut("30 deg"), np.array([25.5, 25.6, 25.7]) * 5.0 * math.pi / 2.0
    assert np.all(periods(cut, speeds)[0] == 26)
    found = coupling_assemblies(cut, speeds, np.full(3, 1e-3))
    assert found.of_point.tolist() == [0, 0, 0]
    # at another depth helical edges couple otherwise
    found = coupling_assemblies(cut, speeds, np.array([1e-3, 1e-3, 2e-3]))
    assert found.of_point.tolist() == [0, 0, 1]


def test_a_point_is_the_same_alone_and_beside_others_of_its_periods():
    for helix in ("0 deg", "30 deg"):
        cut = varied_cut(helix)
        speeds = np.repeat(np.array([20.0, 25.5, 25.6, 25.7, 31.3]) * 5.0 * math.pi / 2.0, 3)
        depths = np.tile([0.5e-3, 1e-3, 2e-3], 5)
        alone = [multipliers(cut, speeds[[i]], depths[[i]])[0] for i in range(15)]
        assert multipliers(cut, speeds, depths).tobytes() == np.array(alone).tobytes()
