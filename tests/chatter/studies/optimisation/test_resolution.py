"""Elements, and speeds, as coarse as gives the same limits."""

import math

import numpy as np
import pytest

from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model
from chatter.studies.optimisation.element_size import max_wavelengths
from chatter.studies.optimisation.limits import limits_of
from chatter.studies.optimisation.sampled_cuts import samples_of
from chatter.studies.optimisation.stable_depths import first_limits, stable_depths, widest_stride
from tests.chatter.studies.optimisation.cuts import MODES, end_mill

RPM = math.pi / 30.0
#: a machine: low modes that decide, and a fast one that hardly takes part
ON_A_MACHINE = [
    {"frequency": "60 Hz", "damping": 0.05, "stiffness": "4 N/um", "direction": [1, 0, 0]},
    {"frequency": "75 Hz", "damping": 0.04, "stiffness": "5 N/um", "direction": [0, 1, 0]},
    {"frequency": "2 kHz", "damping": 0.03, "stiffness": "900 N/um", "direction": [0, 1, 0]},
]


def test_a_fast_mode_that_hardly_takes_part_needs_no_short_elements():
    model = milling_model(end_mill({"structure.mode": ON_A_MACHINE}))
    speeds = np.linspace(500.0, 2500.0, 30) * RPM
    depths = np.linspace(0.0, 10e-3, 41)[1:]
    wavelengths = max_wavelengths(model, speeds, depths)
    assert wavelengths >= 2.0
    found = first_limits(element_cut(model, 10e-3, wavelengths=wavelengths), speeds, depths)
    # the finest that any command takes
    exact = first_limits(element_cut(model, 10e-3, *collocation.FINER[1]), speeds, depths)
    limited = np.isfinite(exact)
    assert limited.any()
    assert np.array_equal(limited, np.isfinite(found))
    assert found[limited] == pytest.approx(exact[limited], rel=1e-3)


def test_elements_are_as_short_as_the_samples_need_them():
    fast = {**ON_A_MACHINE[2], "stiffness": "400 +- 150 N/um"}
    section = {"speeds": {"from": "500 rpm", "to": "2500 rpm"}, "depths": {"to": "10 mm"}}
    case = end_mill({"structure.mode": [*ON_A_MACHINE[:2], fast], "optimum": section})
    model = milling_model(case)
    sampled = samples_of(model, 200, 1).models
    stiffest = max(sampled, key=lambda one: one.structure.modes[2].stiffness)
    nominal, limits = limits_of(case, model), limits_of(case, model, sampled)
    assert limits.wavelengths < nominal.wavelengths
    speeds = np.linspace(500.0, 2500.0, 30) * RPM
    depths = np.linspace(0.0, 10e-3, 41)[1:]
    exact = first_limits(element_cut(stiffest, 10e-3, *collocation.FINER[1]), speeds, depths)
    found = first_limits(
        element_cut(stiffest, 10e-3, wavelengths=limits.wavelengths), speeds, depths
    )
    limited = np.isfinite(exact)
    assert limited.any()
    assert found[limited] == pytest.approx(exact[limited], rel=1e-3)


def test_speeds_are_stepped_over_while_lobes_are_wider():
    damped = {"structure.mode": [{**mode, "damping": 0.003} for mode in MODES]}
    cut = element_cut(milling_model(end_mill(damped)), 5e-3)

    def stride(rpm):
        return widest_stride(cut, rpm * RPM * 1.0075 ** np.arange(40))

    # 1010 Hz: two cycles from tooth to tooth at 10000 rpm, forty at 500
    assert stride(10000.0) == 4
    assert stride(500.0) == 1
    # with 10 % of damping the wave has died out by then: no lobes at all
    dead = {"structure.mode": [{**mode, "damping": 0.1} for mode in MODES]}
    cut = element_cut(milling_model(end_mill(dead)), 5e-3)
    assert stride(500.0) == 4


def test_the_followed_limits_are_those_of_every_speed():
    model = milling_model(end_mill())
    speeds = 6000.0 * RPM * 1.0075 ** np.arange(60)
    depths = np.linspace(0.0, 8e-3, 41)[1:]
    cut = element_cut(model, 8e-3)
    assert widest_stride(cut, speeds) > 1
    followed = stable_depths(cut, speeds, depths)
    alone = [
        stable_depths(cut, speeds[point : point + 1], depths).crossings[0] for point in range(60)
    ]
    for one, other in zip(followed.crossings, alone, strict=True):
        assert len(one) == len(other)
        assert one == pytest.approx(other, rel=2e-3)
