"""Verdicts on simulated cuts whose truth is the multiplier of the linear equation."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from chatter.description.errors import InputError
from chatter.detection.chatter_detection import detect_chatter
from chatter.detection.cut_record import CutRecord
from chatter.detection.deviations import directions_of
from tests.chatter.detection import made_up_signals as made

TRUTH_TURNS = 400


def record_of(cut, depth, turns, rng, noise=0.0, known=True, forces_alone=False):
    time, angle, displacements, forces = made.uniform(
        cut, *made.simulate(cut, depth, turns), noise, rng
    )
    return CutRecord(
        time, angle, None if forces_alone else displacements, cut.tooth_angles, cut.feed, forces,
        np.array(cut.runout) if known else None,
    )  # fmt: skip


def benchmark(**changes):
    """Insperger and Stepan (2004): 922 Hz along the feed, two teeth, half-immersion down."""
    stiffness = 0.03993 * (2.0 * math.pi * 922.0) ** 2
    cut = made.Cut(
        stiffness=(stiffness, math.inf), frequency=(922.0, 1.0), damping=(0.011, 0.01),
        Ktc=600e6, Krc=200e6, speed=10000.0 * math.pi / 30.0, feed=0.1e-3,
        entry=math.pi / 2, leave=math.pi, lags=(0, 360), runout=(0.0, 0.0),
    )  # fmt: skip
    return cut._replace(**changes)


def repeats_with_turn(cut, depth):
    """Whether a very long run ends in a motion that repeats with the turn."""
    _, _, position, _ = made.simulate(cut, depth, TRUTH_TURNS)
    last, before = position[-cut.steps :], position[-2 * cut.steps : -cut.steps]
    return np.abs(last - before).max() < 1e-4 * np.abs(last).max()


def test_simulator_decays_like_the_free_mode_where_next_to_nothing_is_cut():
    cut = benchmark()
    a_turn = -0.011 * 2.0 * math.pi * 922.0 * 2.0 * math.pi / cut.speed
    assert made.growth_a_turn(cut, 1e-8, 40) == pytest.approx(a_turn, rel=2e-3)


def zeroth_order_semi_discretization(cut, depth, steps=200):
    """Spectral radius over a tooth period, one mode along x (Insperger and Stepan, 2004)."""
    mass = cut.stiffness[0] / (2.0 * math.pi * cut.frequency[0]) ** 2
    omega = 2.0 * math.pi * cut.frequency[0]
    pitch = 2.0 * math.pi / len(cut.lags)
    step = pitch / cut.speed / steps
    whole = np.eye(steps + 2)
    for i in range(steps):
        phi = (i + 0.5) / steps * pitch + np.arange(len(cut.lags)) * pitch
        inside = (phi >= cut.entry) & (phi <= cut.leave)
        s, c = np.sin(phi[inside]), np.cos(phi[inside])
        cutting = depth / mass * np.sum(s * (cut.Ktc * c + cut.Krc * s))
        free = np.array(
            [[0, 1, 0], [-(omega**2) - cutting, -2 * cut.damping[0] * omega, cutting], [0, 0, 0]]
        )
        map_ = expm(free * step)
        once = np.zeros((steps + 2, steps + 2))
        once[:2, :2] = map_[:2, :2]
        once[:2, -2:] = 0.5 * map_[:2, 2:]
        once[2, 0] = 1.0
        once[3:, 2:-1] = np.eye(steps - 1)
        whole = once @ whole
    return np.abs(np.linalg.eigvals(whole)).max()


@pytest.mark.parametrize("depth", [0.3e-3, 1e-3, 2e-3])
def test_simulator_agrees_with_semi_discretization(depth):
    cut = benchmark(steps=2880, lags=(0, 1440))
    a_turn = 2.0 * math.log(zeroth_order_semi_discretization(cut, depth))
    assert made.growth_a_turn(cut, depth, 200) == pytest.approx(a_turn, rel=0.02)


def random_records(seed, count):
    """Records from rest with their truth, none within 1 percent of the limit."""
    rng = np.random.default_rng(seed)
    while count > 0:
        cut = made.random_cut(rng, rng.choice(["odd", "even", "unequal", "any"]))
        depth = made.limit_depth(cut) * rng.choice([rng.uniform(0.4, 1.0), rng.uniform(0.85, 1.7)])
        growth = made.growth_a_turn(cut, depth)
        has_runout = rng.random() < 0.4
        if has_runout:
            cut = made.with_runout(cut, rng)
        stable = repeats_with_turn(cut, depth)
        # far from rest a cut can chatter that is stable near its forced motion, and the reverse
        if abs(growth) < 0.01 or (growth < 0.0) != stable:
            continue
        count -= 1
        turns, noise = int(rng.integers(20, 80)), rng.choice([0.0, 0.01, 0.05])
        yield stable, has_runout, record_of(cut, depth, turns, rng, noise)


@pytest.mark.parametrize(
    ("count", "least"), [(20, 19), pytest.param(60, 58, marks=pytest.mark.nightly)]
)
def test_random_records(count, least):
    right = 0
    for stable, has_runout, record in random_records(7, count):
        detection = detect_chatter(record)
        assert not (stable and has_runout and not detection.stable), detection.reason
        right += detection.stable == stable
        assert 0.0 <= detection.confidence <= 1.0
        assert math.isnan(detection.chatter_frequency) == detection.stable
    assert right >= least


@pytest.mark.parametrize("teeth", [2, 3, 4])
@pytest.mark.parametrize("known", [True, False])
def test_runout_of_a_feed_per_tooth_is_no_chatter(teeth, known):
    rng = np.random.default_rng(teeth)
    lags = tuple(range(0, 720, 720 // teeth))
    cut = benchmark(lags=lags, runout=(0.0,) * teeth)
    # where the offset keeps teeth out of the cut the limit is lower than that of the true tool
    depth = 0.35 * made.limit_depth(cut)
    cut = cut._replace(runout=tuple(cut.feed * np.cos(0.4 - cut.tooth_angles)))
    assert repeats_with_turn(cut, depth)
    detection = detect_chatter(record_of(cut, depth, 40, rng, 0.02, known))
    assert detection.stable
    assert detection.bifurcation == "none"
    assert np.ptp(detection.once_per_tooth[-teeth:], axis=0).max() > 1e-6
    assert detection.metrics["off_harmonic_share"] < 0.01


def hopf_cut():
    cut = benchmark(speed=12000.0 * math.pi / 30.0)
    depth = 1.4 * made.limit_depth(cut)
    return cut, depth


@pytest.mark.parametrize("runout", [0.0, 5e-6])
def test_hopf_frequency_is_the_strongest_line_of_a_long_run(runout):
    cut, depth = hopf_cut()
    cut = cut._replace(runout=(runout, -runout))
    time, _, position, _ = made.simulate(cut, depth, TRUTH_TURNS)
    half = len(time) // 2
    window = np.blackman(half)
    spectrum = np.abs(np.fft.rfft((position[-half:, 0] - position[-half:, 0].mean()) * window))
    frequency = np.fft.rfftfreq(half, time[1] - time[0])
    harmonic = frequency / (cut.speed / (2.0 * math.pi))
    spectrum[np.abs(harmonic - np.round(harmonic)) < 0.03] = 0.0
    expected = frequency[np.argmax(spectrum)]
    detection = detect_chatter(record_of(cut, depth, 40, np.random.default_rng(0), 0.02))
    assert detection.verdict == "chatter"
    assert detection.bifurcation == "hopf"
    assert detection.chatter_frequency == pytest.approx(expected, rel=3e-3)


def flip_cut(lags):
    """A light cut where the tooth passes twice in three halves of a natural period or so."""
    teeth = len(lags)
    cut = benchmark(
        lags=lags, runout=(0.0,) * teeth, entry=math.pi - 0.45, leave=math.pi,
        speed=2.0 * math.pi * 922.0 * 2.0 / 1.03 / teeth,
    )  # fmt: skip
    return cut, 1.3 * made.limit_depth(cut)


@pytest.mark.parametrize("teeth", [1, 2, 3, 4])
def test_flip_lies_at_an_odd_multiple_of_half_the_tooth_frequency(teeth):
    cut, depth = flip_cut(tuple(range(0, 720, 720 // teeth)))
    detection = detect_chatter(record_of(cut, depth, 60, np.random.default_rng(1), 0.01))
    assert (detection.verdict, detection.bifurcation) == ("chatter", "flip")
    halves = detection.chatter_frequency / (0.5 * teeth * cut.speed / (2.0 * math.pi))
    assert halves == pytest.approx(round(halves), abs=3e-3)
    assert round(halves) % 2 == 1


def test_growth_rate_is_that_of_the_multiplier():
    cut, _ = hopf_cut()
    depth = 0.8 * made.limit_depth(cut)
    expected = made.growth_a_turn(cut, depth, 200) * cut.speed / (2.0 * math.pi)
    detection = detect_chatter(record_of(cut, depth, 30, np.random.default_rng(2)))
    assert detection.stable
    assert detection.growth_rate == pytest.approx(expected, rel=0.15)


def test_forces_alone():
    cut, depth = hopf_cut()
    rng = np.random.default_rng(3)
    assert not detect_chatter(record_of(cut, depth, 40, rng, 0.02, forces_alone=True)).stable
    assert detect_chatter(record_of(cut, 0.4 * depth, 60, rng, 0.02, forces_alone=True)).stable


def test_speed_that_varies_is_no_chatter():
    cut, depth = hopf_cut()
    record = record_of(cut._replace(swing=1e-3), 0.4 * depth, 60, np.random.default_rng(4), 0.01)
    assert detect_chatter(record).stable


def test_sections_lie_at_whole_revolutions():
    time = np.linspace(0.0, 1.0, 4001)
    angle = 2.0 * math.pi * 20.0 * time + 1.0
    record = CutRecord(time, angle, np.column_stack([np.cos(angle), np.sin(angle)]), [0.0], 1e-4)
    samples = detect_chatter(record).once_per_revolution
    assert samples == pytest.approx(np.tile([1.0, 0.0], (20, 1)), abs=1e-6)


def test_period_of_three_revolutions():
    time = np.linspace(0.0, 3.0, 9001)
    angle = 2.0 * math.pi * 20.0 * time
    detection = detect_chatter(
        CutRecord(time, angle, np.cos(angle) + 0.5 * np.cos(7 * angle / 3), [0], 1e-4)
    )
    assert (detection.bifurcation, detection.period, detection.period_unit) == (
        "period-n", 3, "revolution",
    )  # fmt: skip
    assert detection.chatter_frequency == pytest.approx(20.0 * 7 / 3, rel=1e-4)


GOOD = {
    "time": np.linspace(0.0, 1.0, 2001),
    "spindle_angle": np.linspace(0.0, 100.0, 2001),
    "displacements": np.zeros((2001, 2)),
    "tooth_angles": [0.0, math.pi],
    "feed_per_tooth": 1e-4,
}


def test_a_tool_at_rest_is_stable():
    assert detect_chatter(CutRecord(**GOOD)).stable


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("time", np.linspace(0.0, 1.0, 2000), "samples"),
        ("time", np.linspace(0.0, 1.0, 2001) ** 2, "uniform"),
        ("spindle_angle", np.zeros(2001), "increase"),
        ("spindle_angle", np.linspace(0.0, 10.0, 2001), "revolutions"),
        ("spindle_angle", np.linspace(0.0, 1e4, 2001), "samples per revolution"),
        ("displacements", np.full((2001, 2), np.nan), "finite"),
        ("displacements", np.zeros((2001, 4)), "columns"),
        ("displacements", None, "neither"),
        ("tooth_angles", [], "tooth"),
        ("tooth_angles", "two", "numbers"),
        ("feed_per_tooth", 0.0, "above zero"),
        ("runout", [0.0], "2 teeth"),
    ],
)
def test_wrong_input_is_named(key, value, words):
    with pytest.raises(InputError, match=words):
        CutRecord(**{**GOOD, key: value})


@pytest.mark.parametrize("shape", [(5, 40), (3000, 6)])
def test_directions_are_those_of_the_singular_value_decomposition(shape):
    """Of a long record of short periods there are as many as a period has samples."""
    matrix = np.random.default_rng(2).standard_normal(shape)
    left, singular = directions_of(matrix)
    vectors, values, _ = np.linalg.svd(matrix, full_matrices=False)
    assert left.shape == vectors.shape
    assert singular == pytest.approx(values, rel=1e-9)
    assert np.abs(np.sum(left * vectors, axis=0)) == pytest.approx(1.0, abs=1e-9)
