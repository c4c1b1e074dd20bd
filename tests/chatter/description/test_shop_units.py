"""Units as shops spell them: understood, or refused with what to write."""

import math

import pytest

from chatter.description.units import QuantityError, measured_unit, parse


@pytest.mark.parametrize(
    "unit",
    [
        *("rpm", "RPM", "Rpm", "r.p.m.", "rev/min", "r/min", "1/min", "/min", "min^-1", "min-1"),
        *("U/min", "u/min", "Umdr/min", "Upm", "UPM", "tr/min", "tr/mn", "t/min", "giri/min"),
        *("obr/min", "ot/min", "revs/min", "rotations/min", "min⁻¹", "rev min^-1"),
    ],
)
def test_a_turn_a_minute(unit):
    """ "1200 U/min" was of another dimension: the units library takes U for enzymes."""
    assert parse(f"1200 {unit}", "angular_speed").value == pytest.approx(40.0 * math.pi, rel=1e-14)


@pytest.mark.parametrize("unit", ["U/s", "tr/s", "rev/s", "rps", "1/s"])
def test_a_turn_a_second(unit):
    assert parse(f"20 {unit}", "angular_speed").value == pytest.approx(40.0 * math.pi, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("80 Nm", "torque", 80.0),
        ("1.5 kNm", "torque", 1500.0),
        ("15 PS", "power", 15 * 75 * 9.80665),
        ("15 KW", "power", 15e3),
        ("900 hz", "frequency", 900.0),
        ("16 MM", "length", 16e-3),
        ("100 ipm", "velocity", 100 * 0.0254 / 60),
        ("400 sfm", "velocity", 400 * 0.3048 / 60),
        ("0.004 ipt", "length", 0.004 * 0.0254),
        ("1/2 in", "length", 0.0127),
        ("1 1/4 in", "length", 0.03175),
        ("1-1/4 inch", "length", 0.03175),
        ('3/8"', "length", 0.009525),
        ('2 1/2"', "length", 0.0635),
        ('0.5"', "length", 0.0127),
        ("½ in", "length", 0.0127),
        ("1½ in", "length", 0.0381),
        ("-1/8 in", "length", -0.003175),
        ("1/64 in", "length", 0.000396875),
        ("50 1/s", "rate", 50.0),
        ("10 1/4 hp", "power", 10.25 * 745.6998715822702),
    ],
)
def test_spellings_of_the_shop(text, dimension, value):
    assert parse(text, dimension).value == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "dimension", "advice"),
    [
        ("0.05 mm/tooth", "length", 'write "0.05 mm"'),
        ("0.05 mm/z", "length", 'write "0.05 mm"'),
        ("0.2 mm/rev", "length", "over the number of teeth"),
        ("380 mm/rev", "velocity", "over the number of teeth"),
        ("30 Grad", "angle", 'write "30 deg", or "30 gon"'),
        ("1 650 MPa", "pressure", 'write "1650 MPa"'),
        ("12'000 rpm", "angular_speed", 'write "12000 rpm"'),
        ("12,000 rpm", "angular_speed", 'write "12000 rpm", or "12.000 rpm"'),
        ("1/2", "length", "has no unit"),
        ("1/0 in", "length", "is required"),
        ("1//2 in", "length", "is required"),
        ('1/2"', "angle", "is a length"),
    ],
)
def test_what_is_not_taken_says_what_to_write(text, dimension, advice):
    with pytest.raises(QuantityError) as error:
        parse(text, dimension)
    assert advice in str(error.value)


def test_a_speed_of_a_measured_file():
    found = measured_unit("U/min")
    assert found is not None
    assert found.factor == pytest.approx(math.pi / 30.0, rel=1e-14)
    # a ton a minute is no speed where the quantity may be any
    assert measured_unit("t/min").dimension == {"[mass]": 1, "[time]": -1}
