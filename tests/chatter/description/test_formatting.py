"""Values as messages show them."""

import pytest

from chatter.description.formatting import distinct_from


@pytest.mark.parametrize(
    ("value", "beside", "text"),
    [
        (1.2, 2.5, "1.2"),
        (1.2, 1.19971, "1.2"),
        (1.19971, 1.2, "1.1997"),
        (1.00011, 1.0, "1.0001"),
        (0.99998712, 1.0, "0.99999"),
        (1.2, 1.2, "1.2"),
        (float("nan"), 1.0, "nan"),
        (1.2, float("inf"), "1.2"),
    ],
)
def test_digits_tell_a_number_from_the_one_beside_it(value, beside, text):
    assert distinct_from(value, beside) == text
