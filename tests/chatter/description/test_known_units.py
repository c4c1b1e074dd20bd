"""What is known of units by heart is what the units library says, to the last digit."""

import pytest

from chatter.description.known_units import MEASURED, SI_VALUE
from chatter.description.quantities import EitherQuantityField
from chatter.description.units import (
    DIMENSIONS,
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


EITHER = [
    ("damping", "rotational_damping"),
    ("stiffness", "rotational_stiffness"),
    ("force", "torque"),
    ("inverse_velocity", "inverse_angular_speed"),
    ("length", "angle"),
    ("inverse_length", "inverse_angle"),
    ("velocity", "angular_speed"),
]


@pytest.mark.parametrize(("first", "second"), EITHER)
@pytest.mark.parametrize("turned", [False, True])
def test_either_of_two_dimensions_is_the_one_that_the_library_finds(first, second, turned):
    one, other = (second, first) if turned else (first, second)
    field = EitherQuantityField(one, others=(other,))
    for dimension in (one, other):
        for unit in (DIMENSIONS[dimension].unit, *SI_VALUE.get(dimension, ())):
            assert field.matching(f"3 {unit}").dimension == dimension
            refused = other if dimension == one else one
            with pytest.raises(QuantityError):
                asked_of_library(unit, refused)


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
