"""What is not known acts on the limits too: against a normal distribution, and a count in full."""

import math

import numpy as np
import pytest
from scipy.stats import norm

import chatter
from chatter.stability.model import milling_model
from chatter.studies.optimisation.limits import limits_of
from chatter.studies.optimisation.sampled_cuts import SampledCuts, samples_of
from tests.chatter.studies.optimisation.cuts import end_mill

RPM = math.pi / 30.0
NO_EDGE = {"material.Kte": 0.0, "material.Kre": 0.0}
STIFF = [
    {"frequency": "1200 Hz", "damping": 0.05, "stiffness": "2000 N/um", "direction": axis}
    for axis in ([1, 0, 0], [0, 1, 0])
]


@pytest.mark.parametrize(
    ("limit", "value", "removal"),
    [
        # power is K_tc times the volume removed per time, torque K_tc b a f N / 2 pi
        ("max_power", "400 W", 400.0),
        ("max_torque", "0.5 N*m", 0.5 * 9600.0 * RPM),
    ],
)
def test_the_spindle_is_kept_at_the_quantile_of_the_cutting_force(limit, value, removal):
    section = {"speeds": {"from": "9200 rpm", "to": "9600 rpm"}, "depths": {"to": "4 mm"}}
    changes = {**NO_EDGE, "structure.mode": STIFF, "material.Ktc": "800 +- 80 MPa"}
    case = end_mill({**changes, "optimum": {**section, limit: value, "confidence": 0.9}})
    found = chatter.optimum(case, samples=200)
    largest = (800.0 + 80.0 * norm.ppf(0.9)) * 1e6
    # samples of a Latin hypercube, and the last step of depth
    assert found.best.removal_rate == pytest.approx(removal / largest, rel=0.012)
    known = found.best.probability
    assert known.stable == 1.0
    assert 0.9 <= known.value < 0.92
    assert "confidence" in found.best.active
    # the nominal cut keeps a share of its limit free, the quantile next to nothing
    assert found.best.usage[limit] == pytest.approx(800e6 / largest, rel=0.012)
    most = getattr(case.optimum, limit)
    assert known.quantiles[limit] == pytest.approx(most, rel=0.012)
    assert known.quantiles[limit] <= most * (1.0 + 1e-9)


def test_a_softer_structure_that_may_be_bends_more():
    # far below resonance the tool bends by the force over the stiffness
    changes = {
        "structure.mode": [
            {**mode, "frequency": "3 kHz", "stiffness": "40 N/um"} for mode in STIFF
        ],
        "cut.spindle_speed": "3000 rpm",
    }
    speeds = {"from": "3000 rpm", "to": "3060 rpm"}
    section = {
        "speeds": speeds,
        "depths": {"to": "1.5 mm", "count": 10},
        "max_deflection": "1.5 um",
    }
    case = end_mill({**changes, "optimum": {**section, "confidence": 0.9}})
    sure = chatter.optimum(case)
    softer = {f"structure.mode[{number}].stiffness": "40 +- 4 N/um" for number in (0, 1)}
    unsure = chatter.optimum(case.patch(softer), samples=60)
    assert sure.best.usage["max_deflection"] == pytest.approx(1.0, abs=5e-3)
    assert unsure.best.point.axial_depth < 0.97 * sure.best.point.axial_depth
    # the tool bends mostly along one axis: about as much as that is softer
    weakest = 1.0 / (1.0 + 0.1 * norm.ppf(0.1))
    assert 1.0 < 1.0 / unsure.best.usage["max_deflection"] < 1.03 * weakest


def test_cuts_that_are_left_early_are_those_that_a_full_count_refuses():
    changes = {"material.Ktc": "800 +- 60 MPa", "structure.mode[1].frequency": "1010 +- 15 Hz"}
    section = {"speeds": {"from": "7200 rpm", "to": "8000 rpm"}, "depths": {"to": "9 mm"}}
    limits = {"max_power": "1.2 kW", "max_surface_error": "12 um"}
    case = end_mill({**changes, "optimum": {**section, **limits, "confidence": 0.8}})
    model = milling_model(case)
    drawn = samples_of(model, 40, 3)
    draw = np.random.default_rng(5)
    speeds, depths = draw.uniform(7200, 8000, 60) * RPM, draw.uniform(1e-3, 8e-3, 60)
    order = np.argsort(-speeds * depths)
    speeds, depths = speeds[order], depths[order]
    sampled = SampledCuts(model, limits_of(case, model), drawn, 8e-3)
    everyone = np.arange(40)
    stable = sampled.stable(everyone, speeds, depths)
    share = sampled.within(sampled.steady(everyone, speeds, depths, stable), stable).mean(axis=0)
    sure = np.flatnonzero(share >= 0.8)
    assert 0 < sure[0] < 59
    assert stable.mean(axis=0)[: sure[0]].max() > 0.8
    assert sampled.first_sure(speeds, depths) == sure[0]
    # what earlier cuts have taught of the samples changes the order alone
    assert sampled.first_sure(speeds, depths) == sure[0]
    assert sampled.first_sure(speeds[: sure[0]], depths[: sure[0]]) is None
