"""Spindle speeds and frequencies are turns, whatever they are written in; units are only read."""

import math
import subprocess
import sys

import pytest

from chatter.description.units import QuantityError, parse

#: 14 turns a second
SPEED = 2.0 * math.pi * 14.0


@pytest.mark.parametrize(
    "text",
    [
        "840 rpm",
        "14 Hz",
        "14 rev/s",
        "5040 deg/s",
        "840 rev/min",
        "840 1/min",
        "14 1/s",
        f"{SPEED!r} rad/s",
        "0.84 krpm",
        "840 min^-1",
        "840 min⁻¹",
        "14 turn/s",
        "0.014 kHz",
    ],
)
def test_spindle_speed(text):
    assert parse(text, "angular_speed").value == pytest.approx(SPEED, rel=1e-14)


@pytest.mark.parametrize(
    "text",
    [
        f"{200.0 * math.pi!r} rad/s",
        "100 Hz",
        "0.1 kHz",
        "6000 rpm",
        "36000 deg/s",
        "100 1/s",
        "100 s**-1",
        "6000 1/min",
        "100 cycle/s",
    ],
)
def test_frequency(text):
    assert parse(text, "frequency").value == pytest.approx(100.0, rel=1e-14)


def test_bare_numbers_are_si():
    assert parse(87.96, "angular_speed").value == 87.96
    assert parse(100, "frequency").value == 100.0


@pytest.mark.parametrize(
    "unit",
    [
        "m**9**9**9**9",
        "9**9**9 m",
        "m**(9**9**9)",
        "m^9^9^9^9",
        "(m**9)**9**9**9**9",
        "m ** 9 ** 9",
        "m if 1 else m",
        "m; m",
        "m # m",
        "[m]",
        "m.__class__",
        "()",
        "m/0",
        "1",
        "m\\",
        "{m}",
    ],
)
def test_units_are_never_evaluated(unit):
    # the towers of powers would take longer than a lifetime
    with pytest.raises(QuantityError):
        parse(f"20 {unit}", "length")


def test_importing_cases_leaves_the_slow_libraries_alone():
    code = (
        "import sys, chatter.description; "
        "print([m for m in ('numba', 'scipy', 'matplotlib', 'pint') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
