"""Numbers of findings."""

import pytest

from dynamics.frf.hammer.written_number import written


@pytest.mark.parametrize(
    ("value", "text"),
    [(2530.4, "2530"), (-12345.6, "-12300"), (9996.0, "10000"), (0.004567, "0.00457"),
     (47.123, "47.1"), (2.5e7, "2.5e+07")],
)  # fmt: skip
def test_thousands_are_written_out(value, text):
    """A jump of 2.5e+03 m/s^2."""
    assert written(value) == text
