"""Quantities with units: values, spellings, refusals, round trips."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from chatter.description.units import DIMENSIONS, QuantityError, parse, unit_factor, write

#: units that users write, by dimension, with the SI value of one
UNITS = {
    "length": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "inch": 0.0254, "micrometer": 1e-6},
    "angle": {"rad": 1.0, "deg": math.pi / 180.0, "°": math.pi / 180.0, "mrad": 1e-3},
    "angular_speed": {
        "rpm": math.pi / 30.0,
        "rad/s": 1.0,
        "1/min": math.pi / 30.0,
        "rev/min": math.pi / 30.0,
        "Hz": 2.0 * math.pi,
        "deg/s": math.pi / 180.0,
    },
    "frequency": {"Hz": 1.0, "kHz": 1e3, "rad/s": 0.5 / math.pi, "1/s": 1.0, "rpm": 1.0 / 60.0},
    "mass": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "line_force": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3},
    "stiffness": {"N/m": 1.0, "N/um": 1e6, "N/µm": 1e6, "kN/mm": 1e6, "N m^-1": 1.0},
    "damping": {"N*s/m": 1.0, "N s/m": 1.0, "N·s/m": 1.0, "kg/s": 1.0},
    "pressure": {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9, "N/mm^2": 1e6, "N/mm²": 1e6, "N/mm**2": 1e6},
    "force": {"N": 1.0, "kN": 1e3},
    "torque": {"N*m": 1.0, "N m": 1.0, "N*mm": 1e-3},
    "power": {"W": 1.0, "kW": 1e3, "N*m/s": 1.0},
    "time": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "velocity": {"m/s": 1.0, "mm/min": 1e-3 / 60.0, "m/min": 1.0 / 60.0},
    "pressure_gradient": {"N/m^3": 1.0, "N/mm^3": 1e9},
    "drag": {"N*s^2/m^2": 1.0},
    "number": {"%": 0.01, "": 1.0, "ppm": 1e-6},
    "moment_of_inertia": {"kg*m^2": 1.0, "kg m²": 1.0, "kg*cm^2": 1e-4, "g*mm^2": 1e-9},
    "density": {"kg/m^3": 1.0, "g/cm^3": 1e3, "t/m^3": 1e3},
    "gain": {"1/s": 1.0, "m/min/mm": 1e3 / 60.0, "(m/min)/mm": 1e3 / 60.0},
    "rotational_stiffness": {"N*m/rad": 1.0, "kN*m/rad": 1e3, "N*m/mrad": 1e3, "N*m": 1.0},
    "rotational_damping": {"N*m*s/rad": 1.0, "N*m/rpm": 30.0 / math.pi, "N*m*s": 1.0},
    "inverse_length": {"1/m": 1.0, "1/mm": 1e3, "mm^-1": 1e3},
    "inverse_angle": {"1/rad": 1.0, "1/deg": 180.0 / math.pi},
    "inverse_velocity": {"s/m": 1.0, "s/mm": 1e3},
    "inverse_angular_speed": {"s/rad": 1.0, "1/rpm": 30.0 / math.pi},
    "resistance": {"ohm": 1.0, "V/A": 1.0},
    "inductance": {"H": 1.0, "mH": 1e-3},
    "voltage": {"V": 1.0, "kV": 1e3},
    "torque_constant": {"N*m/A": 1.0},
    "force_constant": {"N/A": 1.0},
    "back_emf": {"V*s/rad": 1.0, "V/(rad/s)": 1.0, "V/rpm": 30.0 / math.pi},
    "linear_back_emf": {"V*s/m": 1.0},
    "acceleration": {"m/s^2": 1.0, "mm/s^2": 1e-3},
    "jerk": {"m/s^3": 1.0},
    "line_force_rate": {"N/m/s": 1.0, "N/mm/s": 1e3},
    "rate": {"1/s": 1.0, "1/min": 1.0 / 60.0},
}
PAIRS = [(dimension, unit) for dimension, units in UNITS.items() for unit in units]


def test_every_dimension_is_tested_and_its_example_reads():
    assert set(UNITS) == set(DIMENSIONS)
    for name, entry in DIMENSIONS.items():
        assert parse(entry.example, name).value > 0.0
        assert parse(2.5, name).value == 2.5
        if entry.unit:
            assert unit_factor(entry.unit, name) == pytest.approx(1.0, rel=1e-15)


@pytest.mark.parametrize(("dimension", "unit"), PAIRS)
def test_si_value_of_units(dimension, unit):
    expected = UNITS[dimension][unit]
    assert parse(f"1 {unit}", dimension).value == pytest.approx(expected, rel=1e-14)
    assert parse(f"-2.5e1  {unit} ", dimension).value == pytest.approx(-25.0 * expected, rel=1e-14)


@given(pair=st.sampled_from(PAIRS), value=st.floats(1e-9, 1e9) | st.floats(-1e9, -1e-9))
def test_round_trip_through_text(pair, value):
    dimension, unit = pair
    read = parse(write(value, unit, dimension), dimension)
    assert read.value == pytest.approx(value, rel=1e-12)
    assert read.unit == unit


@given(st.integers(1, 10**6), st.sampled_from(["mm", "um"]))
def test_decimal_numbers_stay_decimal(count, unit):
    # what is written as 5 um is the double nearest to 5e-6
    assert parse(f"{count} {unit}", "length").value == float(f"{count}e-{3 if unit == 'mm' else 6}")


def test_deviation():
    read = parse("1650 +- 80 MPa", "pressure")
    assert (read.value, read.deviation, read.unit) == (1650e6, 80e6, "MPa")
    assert parse("1650 ± 80 MPa", "pressure") == read
    assert parse("1650 +/- 80 MPa", "pressure") == read


def test_no_space_before_the_unit():
    assert parse("2.5mm", "length").value == 2.5e-3
    assert parse("30°", "angle").value == pytest.approx(math.pi / 6.0, rel=1e-15)


def test_zero_needs_no_unit():
    assert parse("0", "length").value == 0.0
    assert parse(0, "angle").value == 0.0


@pytest.mark.parametrize(
    ("given_text", "dimension", "words"),
    [
        ("20 kg", "length", ["20 kg", "a mass", "a length is required", "2 mm"]),
        ("20", "length", ["no unit", "a length is required"]),
        ("20 furlongz", "length", ["unknown unit", "furlongz"]),
        ("20 mm mm", "length", ["area"]),
        ("mm", "length", ["not a quantity"]),
        ("", "length", ["not a quantity"]),
        ("twenty mm", "length", ["not a quantity"]),
        ("1,5 mm", "length", ["decimal comma"]),
        ("1 000 mm", "length", ["1 000 mm"]),
        ("nan mm", "length", ["finite"]),
        ("inf mm", "length", ["finite"]),
        ("1e400 mm", "length", ["finite"]),
        ("1e308 km", "length", ["finite"]),
        (math.nan, "length", ["finite"]),
        (-math.inf, "length", ["finite"]),
        (10**400, "length", ["finite"]),
        (True, "number", ["true"]),
        (None, "length", ["not a quantity"]),
        ([1.0], "length", ["not a quantity"]),
        ({"value": 1.0}, "length", ["a table"]),
        ("3 rad", "number", ["plain number"]),
        ("3 mm", "number", ["plain number"]),
        ("3", "angle", ["no unit", "angle"]),
        ("3 Hz", "angle", ["a frequency", "angle"]),
        ("30 %", "angle", ["angle"]),
        ("10 mm/rev", "length", ["per angle or turn", "a length is required"]),
        ("5 N*m/deg", "torque", ["per angle or turn", "a torque is required"]),
        ("40", "inverse_angle", ["no unit"]),
        ("5 N*m", "force", ["a torque", "a force is required"]),
        ("5 N", "rotational_stiffness", ["a force", "a rotational stiffness is required"]),
        ("20 degC", "length", ["degC"]),
        ("3 dB", "number", ["dB"]),
        ("1650 +- -80 MPa", "pressure", ["negative"]),
        ("1650 +- 80", "pressure", ["no unit"]),
        ("1650 +- 1e400 MPa", "pressure", ["finite"]),
        ("5 m**999999999", "length", ["unknown unit"]),
        ("5 m**9**9**9", "length", ["unknown unit"]),
        ("5 __import__('os')", "length", ["unknown unit"]),
        ("5 m; import os", "length", ["unknown unit"]),
        ("1 " + "m" * 500, "length", ["not a quantity"]),
        ("1 ((((((m", "length", ["unknown unit"]),
        ("1 /", "length", ["unknown unit"]),
        ("1 mm\x00", "length", ["1 mm?"]),
    ],
)
def test_refusals(given_text, dimension, words):
    with pytest.raises(QuantityError) as caught:
        parse(given_text, dimension)
    message = str(caught.value)
    for word in words:
        assert word in message
    assert "\n" not in message
    assert message.isprintable()


def _read_or_refusal(text, dimension):
    """What is read, or the sentence that refuses it."""
    try:
        return parse(text, dimension)
    except QuantityError as error:
        return str(error)


@given(st.text(max_size=40), st.sampled_from(sorted(DIMENSIONS)))
def test_any_text_is_a_finite_quantity_or_refused(text, dimension):
    read = _read_or_refusal(text, dimension)
    if isinstance(read, str):
        assert read.isprintable()
    else:
        assert math.isfinite(read.value)
        assert math.isfinite(read.deviation)


@given(
    st.from_regex(r"[0-9]{1,3} [a-zA-Z/*^0-9 ()%]{1,12}", fullmatch=True),
    st.sampled_from(sorted(DIMENSIONS)),
)
def test_any_unit_is_read_or_refused(text, dimension):
    read = _read_or_refusal(text, dimension)
    assert read.isprintable() if isinstance(read, str) else math.isfinite(read.value)
