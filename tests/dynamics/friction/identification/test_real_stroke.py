"""A real rack-and-pinion stroke: friction found on one half and judged on the other.

The mass is taken as weighed: within one half the acceleration is all but constant, so that mass
and Coulomb friction look alike, and a mass fitted with viscous friction alone swallows the
Coulomb force and returns it with the wrong sign in the other half.
"""

import csv

import numpy as np
import pytest

from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.identification.dynamic_fit import AxisModel, fit_axis
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.linear_fit import fit_linear
from dynamics.friction.identification.record import DriveRecord
from dynamics.friction.lugre import LuGre
from tests.places import SHARED

STROKE = SHARED / "data/axis-rack-and-pinion/move01.csv"
pytestmark = pytest.mark.skipif(not STROKE.exists(), reason="no recorded stroke")

MASS = 24.7  # kg, published
DECLARED_VISCOUS = 60.0  # N s/m, of the case beside the record
LOW_PASS = LowPass(60.0)
AUTHORS_BAND = LowPass(30.0)  # in which the authors identified their friction


@pytest.fixture(scope="module")
def halves():
    with STROKE.open() as lines:
        rows = list(csv.reader(lines))
    time, position, velocity, force = np.array(rows[1:], dtype=float).T
    stroke = DriveRecord(time, position / 1e3, velocity / 1e3, force, name="stroke")
    top = time[np.argmax(velocity)]
    return {"accelerating": stroke.part(0.03, top), "braking": stroke.part(top, 0.515)}


def only_viscous(viscous, mass=MASS):
    return AxisModel(CoulombStribeck(0.0, 0.0, 1e-3, viscous), mass)


def errors(model, record):
    """Relative error of the force as recorded, and of its part below 30 Hz."""
    predicted = model.effort(record, LOW_PASS)
    both = AUTHORS_BAND.apply(np.column_stack((predicted, record.effort)), record.sample_time)
    raw = np.sqrt(np.mean((predicted - record.effort) ** 2)) / np.std(record.effort)
    slow = np.sqrt(np.mean((both[:, 0] - both[:, 1]) ** 2)) / np.std(both[:, 1])
    return float(raw), float(slow)


@pytest.mark.parametrize(
    ("fitted", "judged"), [("accelerating", "braking"), ("braking", "accelerating")]
)
def test_friction_of_one_half_reproduces_the_other(halves, fitted, judged):
    known, unknown = halves[fitted], halves[judged]
    line = fit_linear([known], ("viscous",), low_pass=LOW_PASS, minimum_speed=0.01,
                      fixed={"inertia": MASS})  # fmt: skip
    both = fit_linear([known], ("viscous", "inertia"), low_pass=LOW_PASS, minimum_speed=0.01)
    dry = fit_linear([known], ("viscous", "coulomb"), low_pass=LOW_PASS, minimum_speed=0.01,
                     fixed={"inertia": MASS})  # fmt: skip
    law = CoulombStribeck(dry.value("coulomb"), dry.value("coulomb"), 1e-2, dry.value("viscous"))
    after = errors(AxisModel(law, MASS), unknown)
    before = {
        "declared": only_viscous(DECLARED_VISCOUS),
        "viscous fitted": only_viscous(line.value("viscous")),
        "mass and viscous fitted": only_viscous(both.value("viscous"), both.value("inertia")),
    }
    print(f"\nfitted on {fitted}, judged on {judged}: raw, below 30 Hz")
    print(f"  Coulomb {dry.estimates['coulomb']}\n  viscous {dry.estimates['viscous']}")
    for name, model in before.items():
        print(f"  {name:24s} {errors(model, unknown)}")
    print(f"  {'Coulomb and viscous':24s} {after}")
    for model in before.values():
        raw, slow = errors(model, unknown)
        assert after[0] < 0.9 * raw
        assert after[1] < 0.7 * slow
    # the search along the motion finds the same law
    fit = fit_axis([known], AxisModel(LuGre(1e8, 0.0, 50.0, 10.0, 10.0, 1e-2), MASS),
                   ("coulomb", "viscous"), low_pass=LOW_PASS, minimum_speed=0.01)  # fmt: skip
    assert fit.estimates["coulomb"].lower < dry.value("coulomb") < fit.estimates["coulomb"].upper


def test_both_halves_agree_on_dry_and_viscous_friction(halves):
    """Their 95 % intervals overlap and leave out 0."""
    found = [
        fit_linear([half], ("viscous", "coulomb"), low_pass=LOW_PASS, minimum_speed=0.01,
                   fixed={"inertia": MASS}).estimates
        for half in halves.values()
    ]  # fmt: skip
    for name in ("viscous", "coulomb"):
        assert max(e[name].lower for e in found) < min(e[name].upper for e in found)
        assert min(e[name].lower for e in found) > 0.0


def test_a_stribeck_peak_is_not_supported_by_both_halves(halves):
    """The hump of the start does not come back when braking: with it, the other half is worse."""
    free = ("bristle_stiffness", "coulomb", "static", "stribeck_velocity", "viscous")
    half = halves["accelerating"]
    peaked = AxisModel(LuGre(1e6, 0.0, 50.0, 12.0, 20.0, 0.02), MASS)
    flat = AxisModel(LuGre(1e8, 0.0, 50.0, 12.0, 12.0, 0.02), MASS)
    fit = fit_axis([half], peaked,
                   free, low_pass=LOW_PASS)  # fmt: skip
    assert "static" in fit.unsupported or "stribeck_velocity" in fit.unsupported
    plain = fit_axis([half], flat,
                     ("coulomb", "viscous"), low_pass=LOW_PASS)  # fmt: skip
    print(errors(fit.model, halves["braking"]), errors(plain.model, halves["braking"]))
    assert errors(fit.model, halves["braking"])[0] > errors(plain.model, halves["braking"])[0]


def test_mass_and_dry_friction_cannot_both_be_told_from_one_half(halves):
    known = fit_linear([halves["accelerating"]], ("inertia", "viscous", "coulomb"),
                       low_pass=LOW_PASS, minimum_speed=0.01)  # fmt: skip
    assert known.conditioning > 20.0
    whole = fit_linear(list(halves.values()), ("inertia", "viscous", "coulomb"),
                       low_pass=LOW_PASS, minimum_speed=0.01)  # fmt: skip
    print(whole.estimates, whole.conditioning)
    assert whole.conditioning < 5.0
    assert whole.value("inertia") == pytest.approx(MASS, rel=0.08)
