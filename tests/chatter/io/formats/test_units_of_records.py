"""Units of measured files: quantity and factor, each against its definition."""

import numpy as np
import pytest

from chatter.io.formats.units import channel_unit, frf_unit
from dynamics.frf.container import MeasurementError

INCH, POUND_FORCE, GRAVITY = 0.0254, 0.45359237 * 9.80665, 9.80665  # exact by definition


@pytest.mark.parametrize(
    ("unit", "quantity", "factor"),
    [
        ("m/N", "receptance", 1.0),
        ("mm/N", "receptance", 1e-3),
        ("um/N", "receptance", 1e-6),
        ("µm/N", "receptance", 1e-6),
        ("μm/N", "receptance", 1e-6),  # Greek mu, not the micro sign
        ("nm/N", "receptance", 1e-9),
        ("m/kN", "receptance", 1e-3),
        ("in/lbf", "receptance", INCH / POUND_FORCE),
        ("in/lb", "receptance", INCH / POUND_FORCE),
        ("mil/lbf", "receptance", 1e-3 * INCH / POUND_FORCE),
        ("m/s/N", "mobility", 1.0),
        ("(mm/s)/N", "mobility", 1e-3),
        ("m/(N s)", "mobility", 1.0),
        ("m/Ns", "mobility", 1.0),
        ("ips/lbf", "mobility", INCH / POUND_FORCE),
        ("m/s^2/N", "accelerance", 1.0),
        ("(m/s^2)/N", "accelerance", 1.0),
        ("(m/s2)/N", "accelerance", 1.0),
        ("m/s²/N", "accelerance", 1.0),
        ("m/s**2/N", "accelerance", 1.0),
        ("m·s⁻²·N⁻¹", "accelerance", 1.0),
        ("mm/s²/N", "accelerance", 1e-3),
        ("g/N", "accelerance", GRAVITY),
        ("g/lbf", "accelerance", GRAVITY / POUND_FORCE),
        ("1/kg", "accelerance", 1.0),
        ("kg^-1", "accelerance", 1.0),
    ],
)
def test_unit_of_an_frf(unit, quantity, factor):
    assert frf_unit(unit) == (quantity, pytest.approx(factor, rel=1e-12))


@pytest.mark.parametrize(
    ("unit", "channel", "factor"),
    [
        ("s", "time", 1.0),
        ("ms", "time", 1e-3),
        ("µs", "time", 1e-6),
        ("Hz", "frequency", 1.0),
        ("kHz", "frequency", 1e3),
        ("rad/s", "frequency", 1 / (2 * np.pi)),
        ("rpm", "frequency", 1 / 60),
        ("N", "force", 1.0),
        ("kN", "force", 1e3),
        ("lbf", "force", POUND_FORCE),
        ("g", "acceleration", GRAVITY),
        ("g0", "acceleration", GRAVITY),
        ("gn", "acceleration", GRAVITY),
        ("g_n", "acceleration", GRAVITY),
        ("m/s^2", "acceleration", 1.0),
        ("mm/s", "velocity", 1e-3),
        ("um", "displacement", 1e-6),
    ],
)
def test_unit_of_a_channel(unit, channel, factor):
    assert channel_unit(unit) == (channel, pytest.approx(factor, rel=1e-12))


@pytest.mark.parametrize("unit", ["N/m", "kg", "rad/N", "V/N", "m", "s"])
def test_other_dimensions_are_refused(unit):
    with pytest.raises(MeasurementError, match=unit):
        frf_unit(unit)


@pytest.mark.parametrize(
    "unit",
    [
        "",
        "furlong per fortnight",
        "9^9^9^9",
        "m^99999/N",
        "m/N; x",
        "((((",
        "/",
        "m^2^2/N",
        "m" * 99,
    ],
)
def test_text_that_is_no_unit_is_refused(unit):
    with pytest.raises(MeasurementError, match="unit"):
        frf_unit(unit)
