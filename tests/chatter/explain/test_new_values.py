"""New values of a repaired case are written in units that people use, with six digits."""

import pytest

from chatter import Case
from chatter.explain.new_values import in_declared_unit, in_usual_units

TEXT = """
title = "3rd cut"   # kept

[tool]
teeth = 2
diameter = "16 mm"
helix = "30 deg"

[material]
Ktc = "700 MPa"     # declared
Krc = "200 MPa"

[cut]
mode = "down"
spindle_speed = "9000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "2 mm"
radial_depth = "4 mm"

[[structure.mode]]
frequency = "800 Hz"
damping = 0.02
mass = 0.5
direction = [1, 0, 0]
"""


def test_new_values_are_in_usual_units_and_declared_ones_as_they_were():
    declared = Case.from_text(TEXT)
    found = declared.patch(
        {
            "tool.runout": {"offset": 0.0000234567812, "angle": 0.523598775598},
            "material.Ktc": 731234567.89,
            "process_damping.coefficient": 61234.56789,
            "structure.mode[0].frequency": 812.345678912,
            "structure.mode[1]": {
                "frequency": 1404.99987654,
                "damping": 0.03123456789,
                "stiffness": 23456789.123,
                "direction": [0.0, 1.0, 0.0],
            },
        }
    )
    written = in_usual_units(found, declared).to_toml()
    for line in (
        'offset = "23.4568 um"',
        'angle = "30 deg"',
        'Ktc = "731.235 MPa"     # declared',
        'coefficient = "61.2346 N/mm"',
        'frequency = "812.346 Hz"',
        'frequency = "1405 Hz"',
        "damping = 0.0312346",
        'stiffness = "23.4568 N/um"',
        'title = "3rd cut"   # kept',
        'Krc = "200 MPa"',
        "mass = 0.5",
    ):
        assert line in written
    again = Case.from_text(written)
    for path in ("tool.runout.offset", "material.Ktc", "structure.mode[1].stiffness"):
        assert again.get(path) == pytest.approx(found.get(path), rel=1e-5)


def test_a_case_as_declared_stays_as_it_is():
    declared = Case.from_text(TEXT)
    assert in_usual_units(declared, declared).to_toml() == declared.to_toml()


def test_a_value_has_the_unit_that_the_case_has_there():
    """25.4 mm are an inch; a bare number is in SI, and the usual unit is taken."""
    inches = Case.from_text(TEXT.replace('axial_depth = "2 mm"', 'axial_depth = "0.05 in"'))
    assert in_declared_unit(inches, "cut.axial_depth", 1.524e-3) == "0.06 in"
    assert in_declared_unit(Case.from_text(TEXT), "cut.axial_depth", 1.524e-3) == "1.524 mm"
    bare = Case.from_text(TEXT.replace('axial_depth = "2 mm"', "axial_depth = 0.002"))
    assert in_declared_unit(bare, "cut.axial_depth", 1.524e-3) == "1.524 mm"
