"""The oblique law from records whose forces are those of a shear stress and a friction angle."""

import json
import math

import pytest

import chatter
from chatter.cutting_coefficients.oblique_fit import merchant_shear_angle
from chatter.description.case import load
from chatter.description.errors import InputError
from tests.chatter.cutting_coefficients.test_coefficients import TRUE, UP_CUT, records
from tests.command_line import chatter_command

STRESS, FRICTION, RAKE, HELIX = 500e6, math.radians(25.0), math.radians(8.0), math.radians(30.0)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Coefficients by Budak, Altintas and Armarego 1996, eqs. 10 to 12; chip flow as the helix."""
    # Merchant: 36.5 degrees
    shear = math.radians(45.0 - 0.5 * (25.0 - 8.0))
    normal = math.atan(math.tan(FRICTION) * math.cos(HELIX))
    tilt = math.tan(HELIX)
    root = math.sqrt(math.cos(shear + normal - RAKE) ** 2 + tilt**2 * math.sin(normal) ** 2)
    scale = STRESS / math.sin(shear) / root
    monkeypatch.setitem(TRUE, "Ktc", scale * (math.cos(normal - RAKE) + tilt**2 * math.sin(normal)))
    monkeypatch.setitem(TRUE, "Krc", scale * math.sin(normal - RAKE) / math.cos(HELIX))
    monkeypatch.setitem(
        TRUE, "Kac", scale * (math.cos(normal - RAKE) * tilt - tilt * math.sin(normal))
    )
    return records(tmp_path, **UP_CUT)


def test_stress_and_friction_come_back_and_make_a_case(folder, tmp_path):
    out = tmp_path / "out"
    shown = chatter_command(
        "coefficients", folder, "--mean-forces", "--rake", "8 deg", "--out", out
    )
    assert shown.exit_code == 0, shown.stderr
    assert "oblique law" in shown.stdout
    found = json.loads((out / "coefficients.json").read_text())["oblique"]
    assert found["holds"]
    assert found["shear_angle_deg"] == pytest.approx(36.5, abs=0.7)
    values = {one["name"]: (one["value"], one["standard_deviation"]) for one in found["values"]}
    stress, friction = values["shear_stress"], values["friction_angle"]
    assert stress[0] == pytest.approx(500.0, rel=0.03)
    assert friction[0] == pytest.approx(25.0, abs=1.0)
    assert abs(stress[0] - 500.0) < 3.0 * stress[1]
    assert abs(friction[0] - 25.0) < 3.0 * friction[1]
    text = (tmp_path / "case.toml").read_text() + (out / "material-oblique.toml").read_text()
    (tmp_path / "whole.toml").write_text(text)
    case = load(tmp_path / "whole.toml")
    assert case.get("material.shear_stress") == pytest.approx(STRESS, rel=0.03)


def test_an_axial_force_of_another_helix_is_told(folder, tmp_path, monkeypatch):
    monkeypatch.setitem(TRUE, "Kac", 0.5 * TRUE["Kac"])
    (tmp_path / "other").mkdir()
    found = chatter.coefficients(records(tmp_path / "other", **UP_CUT)).with_rake(RAKE)
    assert not found.oblique.holds
    assert "does not hold" in found.oblique.material_toml()


def test_what_the_oblique_law_needs(folder):
    found = chatter.coefficients(folder)
    with pytest.raises(InputError, match="normal rake of 60 deg"):
        found.with_rake(math.radians(60.0))
    shown = chatter_command("coefficients", folder, "--mean-forces", "--rake", "8 mm")
    assert shown.exit_code == 2
    assert "--rake" in shown.stderr


def test_shear_angle_of_least_energy():
    # without friction and rake 45 degrees; each degree of friction takes half a degree
    assert merchant_shear_angle(0.0, 0.0) == pytest.approx(math.radians(45.0))
    assert merchant_shear_angle(math.radians(10.0), 0.0) == pytest.approx(math.radians(40.0))
    assert merchant_shear_angle(0.0, math.radians(10.0)) == pytest.approx(math.radians(50.0))
