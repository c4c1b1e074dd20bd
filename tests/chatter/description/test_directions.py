"""A direction is three numbers or the name of an axis, in cases and in machine files."""

import jsonschema
import pytest
from pydantic import TypeAdapter

from chatter.description.case import loads
from chatter.description.directions import Direction, UnitVector

CASE = """
[[structure.mode]]
frequency = "500 Hz"
damping = 0.02
stiffness = "10 N/um"
direction = {}
"""
AXES = [
    ('"x"', (1, 0, 0)),
    ('"y"', (0, 1, 0)),
    ('"z"', (0, 0, 1)),
    ("[0.6, 0.8, 0]", (0.6, 0.8, 0)),
]


@pytest.mark.parametrize(("given", "vector"), AXES)
def test_axes_of_a_mode_by_name(given, vector):
    assert loads(CASE.format(given)).structure.mode[0].direction == pytest.approx(vector)


def test_a_name_and_its_numbers_are_one_case():
    case = loads(CASE.format("[0, 1, 0]"))
    assert case.patch({"structure.mode[0].direction": "y"}) == case


@pytest.mark.parametrize("of", [Direction, UnitVector])
def test_the_schema_allows_what_is_read(of):
    adapter = TypeAdapter(of)
    for given in ("x", [0.0, 0.0, 1.0]):
        adapter.validate_python(given)
        jsonschema.validate(given, adapter.json_schema())
    assert adapter.validate_python("z") == (0.0, 0.0, 1.0)


def test_a_direction_of_a_machine_may_have_any_length():
    assert TypeAdapter(Direction).validate_python([0, 3, 4]) == pytest.approx((0, 0.6, 0.8))
