"""One stroke of a rack-and-pinion axis: friction found on one half and judged on the other.

The stroke is made up with what is published of a real one (repository KonradMnich/
friction-identification, commit 8b477df1): 24.7 kg, 10 N of dry and 67.4 N s/m of viscous friction,
0.66 m/s and back to rest in 0.54 s, a ripple of the force while moving. What the recording itself
gave stands in docs/validation.md.

The mass is taken as weighed: within one half the acceleration is all but constant, so that mass
and Coulomb friction look alike, and a mass fitted with viscous friction alone swallows the
Coulomb force and returns it with the wrong sign in the other half.
"""

import numpy as np
import pytest

from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.identification.dynamic_fit import AxisModel, fit_axis
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.linear_fit import fit_linear
from dynamics.friction.identification.record import DriveRecord
from dynamics.friction.lugre import LuGre

MASS = 24.7  # kg, published
COULOMB, VISCOUS = 10.0, 67.4  # N, N s/m, published
DECLARED_VISCOUS = 60.0  # N s/m, of the case beside the record
LOW_PASS = LowPass(60.0)
AUTHORS_BAND = LowPass(30.0)  # in which the authors identified their friction


@pytest.fixture(scope="module")
def halves():
    step, top_speed, rise, dwell = 5e-4, 0.66, 0.25, 0.02
    time = np.arange(0.0, 2.0 * (rise + dwell), step)
    ramp = np.clip(np.minimum(time - dwell, time[-1] - dwell - time) / rise, 0.0, 1.0)
    velocity = top_speed * np.convolve(ramp, np.full(21, 1.0 / 21.0), mode="same")
    acceleration = np.gradient(velocity, step)
    position = np.concatenate(([0.0], np.cumsum(0.5 * step * (velocity[1:] + velocity[:-1]))))
    dry = COULOMB * np.tanh(velocity / 2e-3)
    ripple = 3.0 * np.sin(2.0 * np.pi * position / 0.0067) * (velocity > 0.01)
    noise = np.random.default_rng(1).standard_normal((2, time.size)) * [[1.0], [2e-4]]
    force = MASS * acceleration + dry + VISCOUS * velocity + ripple + noise[0]
    stroke = DriveRecord(time, position, velocity + noise[1], force, name="stroke")
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


def test_mass_and_dry_friction_cannot_both_be_told_from_one_half(halves):
    known = fit_linear([halves["accelerating"]], ("inertia", "viscous", "coulomb"),
                       low_pass=LOW_PASS, minimum_speed=0.01)  # fmt: skip
    assert known.conditioning > 20.0
    whole = fit_linear(list(halves.values()), ("inertia", "viscous", "coulomb"),
                       low_pass=LOW_PASS, minimum_speed=0.01)  # fmt: skip
    assert whole.conditioning < 5.0
    assert whole.value("inertia") == pytest.approx(MASS, rel=0.08)
