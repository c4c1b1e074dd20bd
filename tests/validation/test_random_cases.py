"""Semi-discretization against 200 random cases of the independent reference."""

import math

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.stability.methods.semi_discretization.arrays import milling_arrays
from chatter.stability.methods.semi_discretization.multipliers import (
    converged_multiplier,
    multipliers,
)
from chatter.stability.model import milling_model
from tests.validation.reference.cases import case_file, load
from tests.validation.reference.milling import spectral_radius

CASES = load()


def test_the_store_is_what_the_reference_gives():
    for case, stored in CASES[::40]:
        assert spectral_radius(case, nodes=12, waves_a_piece=0.4) == pytest.approx(stored, rel=1e-8)


def test_the_cases_are_varied():
    radii = np.array([radius for _, radius in CASES])
    assert len(CASES) == 200
    assert 40 < np.sum(radii > 1.0) < 160
    assert sum(case.helix > 0.0 for case, _ in CASES) > 60
    assert sum(case.process_damping > 0.0 for case, _ in CASES) > 40
    assert sum(any(abs(mode[3][2]) > 0.1 for mode in case.modes) for case, _ in CASES) > 40


def test_spectral_radius_of_200_random_cases():
    errors = []
    for case, expected in CASES:
        model = milling_model(loads(case_file(case)))
        found = converged_multiplier(milling_arrays(model), case.speed, case.depth)
        errors.append(abs(abs(found.value) - expected) / max(1.0, expected))
    # the tolerance asked for is 2e-5; a wrong sign, factor or unit is off by far more than 1e-3
    assert max(errors) < 1e-4


def test_second_order_convergence_of_plain_semi_discretization():
    orders = []
    for case, expected in CASES[::5]:
        arrays = milling_arrays(milling_model(loads(case_file(case))))
        point = np.array([case.speed]), np.array([case.depth])
        waves = 2.0 * math.pi * case.speed**-1 * max(m[0] for m in case.modes) / case.teeth
        base = max(80, math.ceil(40 * waves))
        steps = (base, 2 * base, 4 * base)
        errors = [abs(abs(multipliers(arrays, *point, n)[0]) - expected) for n in steps]
        if errors[-1] > 1e-9:
            orders.append(math.log2(errors[0] / errors[2]) / 2.0)
    assert len(orders) > 20
    assert np.median(orders) == pytest.approx(2.0, abs=0.1)
    assert np.quantile(orders, 0.1) > 1.7
