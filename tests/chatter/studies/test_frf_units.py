"""Units in which FRFs are read."""

from __future__ import annotations

import pytest

from chatter.studies.frf_units import frf_unit


@pytest.mark.parametrize(
    ("given", "read", "number"),
    [
        ("m/N", "um/N", 1e6),
        ("m/s/N", "mm/s/N", 1e3),
        ("m/s^2/N", "m/s^2/N", 1.0),
        ("m/(N*m)", "um/(N*m)", 1e6),
        ("rad/(N*m)", "urad/(N*m)", 1e6),
        ("rad/s/(N*m)", "mrad/s/(N*m)", 1e3),
        # no FRF
        ("m/s", "m/s", 1.0),
        ("N/m", "N/m", 1.0),
    ],
)
def test_units_of_frfs(given, read, number):
    assert frf_unit(given) == (read, number)
