"""Laws of friction that records were made with come back, and no more than was there."""

import json

import numpy as np
import pytest
import tomlkit

import chatter
from chatter.description.errors import InputError
from chatter.description.machine.friction import FrictionSection
from chatter.drive_friction.drive_records import DriveRecords
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.identification.dynamic_fit import friction_along
from dynamics.friction.identification.record import DriveRecord
from dynamics.friction.lugre import LuGre
from tests.command_line import chatter_command
from tests.places import DATA

MASS, OFFSET, STEP = 120.0, 15.0, 5e-4
#: amplitudes, m, and frequencies, Hz, of sine moves from sliding to presliding
SINES = ((0.05, 1.0), (0.02, 0.5), (5e-4, 0.5), (2e-5, 0.5))
TRUTHS = {
    "coulomb": CoulombStribeck(60.0, 60.0, 1.0, 400.0),
    "stribeck": CoulombStribeck(60.0, 90.0, 8e-3, 400.0),
    "lugre": LuGre(8e6, 3000.0, 400.0, 60.0, 90.0, 4e-3),
}


def sine(law, amplitude, frequency, noise=2.0):
    """Record of two periods from rest; the motion is known exactly, the force has noise (N)."""
    omega = 2.0 * np.pi * frequency
    time = np.arange(0.0, 2.0 / frequency, STEP)
    position = amplitude * (1.0 - np.cos(omega * time))
    velocity = amplitude * omega * np.sin(omega * time)
    acceleration = amplitude * omega**2 * np.cos(omega * time)
    scatter = noise * np.random.default_rng(3).standard_normal(time.size)
    force = MASS * acceleration + friction_along(law, position, STEP) + OFFSET + scatter
    return DriveRecord(time, position, velocity, force, name=f"sine {1e3 * amplitude:g} mm")


def records(law):
    return DriveRecords(tuple(sine(law, *one) for one in SINES), rotary=False)


@pytest.fixture(scope="module")
def found():
    return {name: chatter.friction(records(law), name="X") for name, law in TRUTHS.items()}


@pytest.mark.parametrize("name", TRUTHS)
def test_the_law_and_its_values_come_back(found, name):
    kept, truth = found[name].kept, TRUTHS[name]
    assert kept.name == name
    assert kept.estimates["inertia"].value == pytest.approx(MASS, rel=5e-3)
    assert kept.estimates["offset"].value == pytest.approx(OFFSET, rel=0.02)
    for key, one in kept.estimates.items():
        if hasattr(truth, key):
            rough = 0.05 if key.startswith(("bristle", "stribeck")) else 0.01
            assert one.value == pytest.approx(getattr(truth, key), rel=rough), key
    assert found[name].residual < 0.02


@pytest.mark.parametrize("name", TRUTHS)
def test_intervals_are_narrow_and_near_the_truth(found, name):
    """Means of a few thousand samples of 2 N noise: tenths of a newton at the most."""
    one = found[name].kept.estimates["coulomb"]
    half = 0.5 * (one.upper - one.lower)
    assert half < 0.5
    assert abs(one.value - 60.0) < 3.0 * half + 0.1


@pytest.mark.parametrize("name", TRUTHS)
def test_the_section_is_one_of_a_machine_file(found, name):
    written = tomlkit.parse(found[name].friction_toml()).unwrap()["friction"]["X"]
    section = FrictionSection.model_validate(written)
    assert section.on.axis == "X"
    velocity = np.array([-0.2, -0.01, 0.001, 0.1])
    wanted = TRUTHS[name].steady_state_force(velocity)
    np.testing.assert_allclose(section.spec().steady_state_force(velocity), wanted, rtol=0.02)


def test_viscous_friction_alone_has_no_coulomb_friction():
    law = CoulombStribeck(0.0, 0.0, 1.0, 400.0)
    found = chatter.friction(records(law))
    assert found.kept.name == "viscous"
    assert found.kept.estimates["viscous"].value == pytest.approx(400.0, rel=5e-3)
    assert found.summary()["laws"][0]["holdout_error"] < 0.05


def test_a_known_mass_is_taken_as_it_is():
    given = records(TRUTHS["coulomb"])
    found = chatter.friction(given, inertia=MASS, law="coulomb")
    assert "inertia" not in found.kept.estimates
    assert found.kept.inertia == MASS
    # 10 kg too much take their force of acceleration from nothing else: the residual shows it
    wrong = chatter.friction(given, inertia=MASS + 10.0, law="coulomb")
    assert wrong.residual > 3.0 * found.residual


def test_effort_with_the_wrong_sign_is_told():
    turned = DriveRecords(
        tuple(
            DriveRecord(one.time, one.position, one.velocity, -one.effort, name=one.name)
            for one in records(TRUTHS["coulomb"]).records
        ),
        rotary=False,
    )
    notes = chatter.friction(turned, law="coulomb").notes
    assert any("wrong sign" in note for note in notes)


def test_a_law_that_does_not_exist_is_refused():
    with pytest.raises(InputError, match=r'law "dahl" is none of viscous, coulomb'):
        chatter.friction(records(TRUTHS["coulomb"]), law="dahl")


def stroke(path):
    """One stroke with what is published of a real rack-and-pinion axis, and a ripple of 8 N.

    24.7 kg, 10 N of dry and 67.4 N s/m of viscous friction, 0.66 m/s and back to rest.
    """
    time = np.arange(0.0, 0.54, 5e-4)
    ramp = np.clip(np.minimum(time - 0.02, 0.52 - time) / 0.25, 0.0, 1.0)
    velocity = 0.66 * np.convolve(ramp, np.full(21, 1.0 / 21.0), mode="same")
    position = np.concatenate(([0.0], np.cumsum(2.5e-4 * (velocity[1:] + velocity[:-1]))))
    force = 24.7 * np.gradient(velocity, time) + 67.4 * velocity + 10.0 * (velocity > 1e-3)
    force += 8.0 * np.sin(2.0 * np.pi * position / 0.0067) * (velocity > 0.01)
    force += np.random.default_rng(1).standard_normal(time.size)
    table = np.column_stack((time, 1e3 * position, 1e3 * velocity, force))
    heading = "time [s],position [mm],velocity [mm/s],force [N]"
    np.savetxt(path, table, "%.7g", ",", header=heading, comments="")
    return path


def test_one_stroke_names_its_coulomb_friction(tmp_path):
    path = stroke(tmp_path / "stroke.csv")
    result = chatter_command("friction", path, "--json", "--out", tmp_path, "--name", "X")
    assert result.exit_code == 0, result.stderr
    summary = json.loads(result.stdout)
    assert summary["law"] == "coulomb"
    by_name = {one["name"]: one for one in summary["parameters"]}
    for name, truth in (("inertia", 24.7), ("viscous", 67.4), ("coulomb", 10.0)):
        lower, upper = by_name[name]["ci95"]
        assert 0.0 < lower < truth < upper, name
    assert any("one way only" in note for note in summary["notes"])
    for name in ("friction.json", "friction.toml", "friction.png"):
        assert (tmp_path / name).stat().st_size > 100


def test_the_table_in_words(tmp_path):
    path = stroke(tmp_path / "stroke.csv")
    result = chatter_command("friction", path, "--inertia", "24.7 kg", "--out", tmp_path)
    assert result.exit_code == 0
    assert "coulomb friction along the slide, 1 record" in result.stdout
    assert "no reversal of the motion shows presliding" in result.stdout


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--inertia", "24.7 N"], "--inertia: "),
        (["--lead", "0 mm"], "--lead: 0 mm is not above 0"),
        (["--low-pass", "5 kHz"], "below half the sampling rate, 1000 Hz"),
        (["--effort", "load"], '--effort "load": no column is so headed'),
        (["--law", "dahl"], 'law "dahl" is none of'),
    ],
)
def test_wrong_input_is_told_in_a_sentence(tmp_path, words, told):
    path = stroke(tmp_path / "stroke.csv")
    result = chatter_command("friction", path, *words, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert told in result.stderr
    assert "Traceback" not in result.stderr


def test_a_folder_of_another_kind_is_refused():
    folder = DATA / "measurements" / "set-121"
    with pytest.raises(InputError, match=r'"\w+"; friction is identified from kind = "axis"'):
        chatter.friction(folder)


@pytest.mark.parametrize(
    ("name", "law", "inertia", "viscous", "coulomb"),
    [
        pytest.param("set-111", "coulomb", 169.266, 761.023, 70.9227, marks=pytest.mark.nightly),
        ("set-112", "lugre", 137.952, 1085.79, 109.646),
        pytest.param("set-113", "coulomb", 247.579, 1000.15, 159.886, marks=pytest.mark.nightly),
    ],
)
def test_moves_of_another_simulation(name, law, inertia, viscous, coulomb):
    """Sets that were made by other numerics, with noise; the values are those of their truth."""
    found = chatter.friction(DATA / "measurements" / name)
    kept = found.kept
    assert kept.name == law
    assert kept.estimates["inertia"].value == pytest.approx(inertia, rel=0.01)
    assert kept.estimates["viscous"].value == pytest.approx(viscous, rel=0.015)
    assert kept.estimates["coulomb"].value == pytest.approx(coulomb, rel=0.015)
    if law == "lugre":
        assert kept.estimates["bristle_stiffness"].value == pytest.approx(2.74065e6, rel=0.02)


def test_means_at_constant_speed_are_points_of_the_friction_curve():
    """Trapezoidal moves; the force of the law at constant speed is 60 N + 400 N s/m times it."""
    law, ramp, duration = TRUTHS["coulomb"], 0.1, 0.6
    moves = []
    for speed in (0.02, -0.02, 0.15, -0.15):
        time = np.arange(0.0, duration, STEP)
        rise = np.clip(np.minimum(time, duration - time) / ramp, 0.0, 1.0)
        velocity = speed * rise
        position = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * STEP)])
        force = MASS * np.gradient(velocity, STEP) + friction_along(law, position, STEP) + OFFSET
        force = force + 2.0 * np.random.default_rng(5).standard_normal(time.size)
        moves.append(DriveRecord(time, position, velocity, force, name=f"{speed:g} m/s"))
    points = chatter.friction(DriveRecords(tuple(moves), rotary=False)).summary()["constant_speed"]
    assert [one["velocity"] for one in points] == pytest.approx(
        [0.02, -0.02, 0.15, -0.15], rel=0.01
    )
    wanted = [68.0, -68.0, 120.0, -120.0]
    assert [one["friction"] for one in points] == pytest.approx(wanted, abs=1.0)
    assert [one["by_law"] for one in points] == pytest.approx(wanted, abs=1.0)
