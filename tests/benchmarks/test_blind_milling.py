"""The blind generator of milling sets against what is known in closed form."""

import math

import numpy as np
import pytest
import tomlkit

from benchmarks.blind_sets import milling
from benchmarks.blind_sets.__main__ import write_sets
from benchmarks.blind_sets.machines import CLASSES, draw_machine
from benchmarks.blind_sets.milling_effects import KNOWN
from benchmarks.blind_sets.milling_physics import SAMPLING, TURN, Cut, Plant, arc_of, run

DEPTH, FEED, RADIUS = 1e-3, 1e-4, 8e-3
KTC, KRC, KTE, KRE = 800e6, 200e6, 20e3, 30e3


def plant_of(teeth=4, mass=1e9, helix=30.0, **changes) -> Plant:
    """A tool on two modes, which nothing moves where the mass is what it is here."""
    return Plant(
        RADIUS,
        math.tan(math.radians(helix)) / RADIUS,
        np.arange(teeth) * TURN / teeth,
        np.ones(teeth),
        np.array([500.0, 600.0]),
        np.array([0.03, 0.02]),
        np.array([mass, mass]),
        np.eye(2),
        KTC,
        KRC,
        KTE,
        KRE,
    )._replace(**changes)


def cut_of(mode="down", radial=4e-3, rpm=3000.0, cut_time=0.0) -> Cut:
    return Cut(rpm * TURN / 60.0, FEED, DEPTH, radial, *arc_of(mode, radial, RADIUS), cut_time)


def whole_turns(record, cut, turns):
    """Mean of the forces over whole turns, N."""
    count = round(turns * TURN / cut.speed * SAMPLING)
    return record.Fx[:count].mean(), record.Fy[:count].mean()


@pytest.mark.parametrize("mode", ["up", "down"])
def test_mean_force_of_a_rigid_tool(mode):
    """Altintas, Manufacturing Automation (2012), eq. 2.26, with the signs of forces on the tool."""
    cut = cut_of(mode)
    mean = whole_turns(run(plant_of(), cut, 0.1), cut, 5)
    phi = np.array([cut.entry, cut.exit])

    def between(values):
        return float(values[1] - values[0])

    share = 4 * DEPTH / TURN
    sin2, flat = between(np.sin(phi) ** 2 / 2), between(phi / 2 - np.sin(2 * phi) / 4)
    sine, cosine = between(np.sin(phi)), between(np.cos(phi))
    fx = share * (-FEED * (KTC * sin2 + KRC * flat) - KTE * sine + KRE * cosine)
    fy = share * (FEED * (KTC * flat - KRC * sin2) - KTE * cosine - KRE * sine)
    # samples are 64 a tooth; the steps of the edge force at entry and exit fall between them
    assert mean == pytest.approx((fx, fy), rel=3e-3, abs=0.1)


def test_force_of_one_straight_edge_in_the_middle_of_a_slot():
    """A straight edge at phi = 90 deg: Fx = -F_r, Fy = F_t, with h the feed per tooth."""
    cut = cut_of("up", 2 * RADIUS, 12800 * 60 / 256)  # 256 samples a turn
    record = run(plant_of(1, helix=0.0), cut, 0.03)
    quarter = 64
    assert record.Fx[quarter] == pytest.approx(-DEPTH * (KRC * FEED + KRE), rel=1e-6)
    assert record.Fy[quarter] == pytest.approx(DEPTH * (KTC * FEED + KTE), rel=1e-6)


def test_exponential_law():
    """At phi = 90 deg the law is K h0 (h/h0)^p."""
    cut = cut_of("up", 2 * RADIUS, 12800 * 60 / 256)
    cut = cut._replace(feed=0.05e-3)
    record = run(plant_of(1, helix=0.0, exponent=0.7, Kte=0.0), cut, 0.03)
    assert record.Fy[64] == pytest.approx(DEPTH * KTC * 1e-4 * 0.5**0.7, rel=1e-6)


def test_runout_moves_chip_from_tooth_to_tooth():
    """Two teeth, offset towards the first: it takes 2 e more, the other 2 e less."""
    offset = 10e-6
    cut = cut_of("up", 2 * RADIUS, 12800 * 60 / 256)
    plant = plant_of(2, helix=0.0, runout_offset=offset, runout_angle=0.0, Kte=0.0)
    record = run(plant, cut, 0.05)
    first, second = record.Fy[256 + 64], record.Fy[256 + 64 + 128]
    assert first == pytest.approx(DEPTH * KTC * (FEED + 2 * offset), rel=1e-6)
    assert second == pytest.approx(DEPTH * KTC * (FEED - 2 * offset), rel=1e-6)


def test_free_decay_of_a_mode():
    plant = plant_of(mass=1.0, Ktc=0.0, Krc=0.0, Kte=0.0, Kre=0.0)
    record = run(plant, cut_of(), 0.05, start=np.array([1e-5, 0.0]))
    w, ratio = TURN * 500.0, 0.03
    wd = w * math.sqrt(1 - ratio**2)
    expected = np.cos(wd * record.time) + ratio * w / wd * np.sin(wd * record.time)
    expected *= 1e-5 * np.exp(-ratio * w * record.time)
    # Runge-Kutta 4 at 60 steps a vibration
    np.testing.assert_allclose(record.x, expected, atol=1e-5 * 2e-3)
    assert np.all(record.y == 0.0)


def test_friction_takes_away_a_fixed_amplitude_a_cycle():
    """Coulomb friction: a free vibration loses 4 F/k a cycle, whatever its amplitude."""
    force, w = 20.0, TURN * 500.0
    plant = plant_of(mass=1.0, Ktc=0.0, Krc=0.0, Kte=0.0, Kre=0.0, slide_friction=force)
    plant = plant._replace(damping=np.zeros(2), slide_velocity=1e-3)
    record = run(plant, cut_of(), 0.01, start=np.array([1e-4, 0.0]))
    cycles = record.x[[round(SAMPLING * n / 500.0) for n in range(4)]]
    # a sample is at most 2 deg off the peak, and tanh rounds the reversals
    np.testing.assert_allclose(-np.diff(cycles), 4 * force / w**2, rtol=0.06)


def test_sensor_at_rest_shows_the_static_force_and_rings_at_its_frequency():
    cut = cut_of("up", 2 * RADIUS, 300.0)
    still = run(plant_of(1, helix=0.0, Ktc=0.0, Krc=0.0, Kre=0.0), cut, 0.05)
    sensor = {"sensor_frequency": 1000.0, "sensor_damping": 0.05}
    shown = run(plant_of(1, helix=0.0, Ktc=0.0, Krc=0.0, Kre=0.0, **sensor), cut, 0.05)
    late = still.time > 0.03
    np.testing.assert_allclose(shown.Fx[late], still.Fx[late], atol=0.02 * DEPTH * KTE)
    # force steps from 0 to -Kte b; the first peak of a step response is at 1/(2 f)
    peak = int(np.argmin(shown.Fx[: round(SAMPLING / 1000.0)]))
    assert peak == pytest.approx(SAMPLING / 2000.0, abs=1)


def test_ripple_of_the_spindle_keeps_delay_and_chip_of_a_rigid_tool():
    """The chip of a tooth spacing hangs on the time since the last tooth; without ripple, f_t."""
    cut = cut_of("up", 2 * RADIUS, 12800 * 60 / 256)
    steady = run(plant_of(2), cut, 0.06)
    wobbly = run(plant_of(2, ripple_amplitude=1e-9, ripple_frequency=30.0), cut, 0.06)
    np.testing.assert_allclose(wobbly.Fy, steady.Fy, atol=1e-3)


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_every_known_effect_changes_the_plant_and_names_itself(name):
    rng = np.random.default_rng(3)
    machine = draw_machine(rng, (name,))
    plant = milling._plant(machine)
    about = milling.Conditions(100.0, 1e-4, 1e-3, 100.0, 1e-5, 1.0, 0.06)
    for effect, draw in KNOWN.items():
        drawn = draw(rng, plant, about, 1.0)
        assert drawn.name == effect
        assert drawn.parameters
        assert set(drawn.changes) <= set(Plant._fields)


def test_a_set_holds_no_truth_and_hangs_on_the_seed_alone(tmp_path):
    for name in ("one", "two"):
        write_sets(tmp_path / name, "milling", 1, 5, "runout")
    files = sorted(p.relative_to(tmp_path / "one") for p in (tmp_path / "one").rglob("*.*"))
    assert files
    for file in files:
        first, second = ((tmp_path / name / file) for name in ("one", "two"))
        if first.is_file():
            assert first.read_bytes() == second.read_bytes()
    place = tmp_path / "one" / "set-0001"
    assert {p.suffix for p in place.iterdir()} == {".csv", ".toml"}
    assert {p.name for p in place.glob("*.toml")} == {"case.toml", "measurement.toml"}
    assert "runout" not in "".join(p.read_text() for p in place.glob("*.toml"))
    truth = tomlkit.parse((tmp_path / "one/truth/set-0001/truth.toml").read_text())
    assert truth["effects"] == ["runout"]
    assert len(truth["noise_unseen"]) == milling.UNSEEN_RUNS
    unseen = list((tmp_path / "one/truth/set-0001/unseen").glob("*.csv"))
    assert len(unseen) == milling.UNSEEN_RUNS
    assert max(truth["effect_size"]["runout"]) > 3 * min(truth["noise"])
    assert 7 <= len(list(place.glob("run*.csv"))) <= 10
