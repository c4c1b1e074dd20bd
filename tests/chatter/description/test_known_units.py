"""What is known of units by heart is what the units library says, to the last digit."""

import pytest

from chatter.description.known_units import MEASURED, SI_VALUE
from chatter.description.units import (
    QuantityError,
    asked_of_library,
    dimension_of,
    measured_by_library,
    measured_unit,
    unit_factor,
)

PAIRS = [(unit, dimension) for dimension, units in SI_VALUE.items() for unit in units]


@pytest.mark.parametrize(("unit", "dimension"), PAIRS)
def test_si_value_is_that_of_the_library(unit, dimension):
    assert unit_factor(unit, dimension) == asked_of_library(unit, dimension)


@pytest.mark.parametrize("unit", MEASURED)
def test_measured_unit_is_that_of_the_library(unit):
    asked = measured_by_library(unit)
    assert measured_unit(unit) == asked
    if unit != "g":
        assert dimension_of(unit) == asked.dimension


@pytest.mark.parametrize("unit", ["mm", "rpm", "MPa", "kN"])
def test_a_known_unit_is_refused_where_another_dimension_is_required(unit):
    for dimension in ("density", "power", "drag", "voltage"):
        with pytest.raises(QuantityError, match="required"):
            unit_factor(unit, dimension)
