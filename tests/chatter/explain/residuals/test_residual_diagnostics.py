"""Views find what was planted, and stay silent on noise."""

import numpy as np
import pytest

from chatter.explain.residuals.dependence import Sample, dependence
from chatter.explain.residuals.over_runs import rank_correlation
from chatter.explain.residuals.residual_dependence import residual_dependence
from chatter.explain.residuals.signature import diagnosed, no_significant_dependence

TURN = 2.0 * np.pi


def telling(residual):
    return {finding.name: finding for finding in diagnosed(residual) if finding.significant}


# milling -----------------------------------------------------------------------------------------


def test_noise_says_nothing_in_milling(milling):
    told = [telling(milling(seed=seed)) for seed in range(6)]
    # seven views of six sets
    assert sum(map(len, told)) <= 1


def test_a_coloured_rest_hangs_on_no_angle_or_way(milling):
    told = [telling(milling(seed=seed, colour=0.95)) for seed in range(6)]
    # it is above the noise and lies at low frequency, which is said, and nothing else
    assert all("run and channel" in found for found in told)
    others = [set(found) - {"run and channel", "frequency"} for found in told]
    assert sum(map(len, others)) <= 1


def test_silent_views_are_told_in_one_sentence(milling):
    findings = diagnosed(milling())
    sentence = no_significant_dependence(findings)
    assert sentence.count("No significant dependence on") == 1
    for words in ("frequency", "angle of the spindle", "time within a run", "cut time"):
        assert words in sentence


def test_once_a_turn_is_found_over_the_spindle_angle_and_its_harmonics(milling):
    found = telling(
        milling(lambda case, time, f: 3.0 * np.sin(case.cut.spindle_speed * time + 1.0))
    )
    # a sine of amplitude 3 beside noise of 1 holds 4.5 of 5.5 parts of the square
    assert found["spindle angle"].numbers["Fx"]["share"] == pytest.approx(4.5 / 5.5, abs=0.06)
    assert "tooth angle" not in found
    shares = found["frequency"].numbers["Fx"]["shares_beyond_noise"]
    assert shares["other harmonics of the spindle"] > 0.95
    assert found["frequency"].numbers["Fx"]["strongest_orders"][0] == 1


def test_once_a_tooth_is_found_over_the_tooth_angle(milling):
    found = telling(milling(lambda case, t, f: 3.0 * np.cos(4 * case.cut.spindle_speed * t)))
    assert found["tooth angle"].numbers["Fx"]["share"] > 0.7
    shares = found["frequency"].numbers["Fx"]["shares_beyond_noise"]
    assert shares["harmonics of the tooth frequency"] > 0.95


@pytest.mark.parametrize(
    ("frequency", "where"), [(1234.0, "other lines"), (700.0, "near natural frequencies")]
)
def test_a_frequency_is_found_where_it_is(milling, frequency, where):
    found = telling(milling(lambda case, time, f: 3.0 * np.sin(TURN * frequency * time)))
    numbers = found["frequency"].numbers["Fx"]
    assert numbers["shares_beyond_noise"][where] > 0.8
    if where == "other lines":
        assert numbers["lines_follow"]["rule"] == "one frequency"
        assert numbers["lines_follow"]["value"] == pytest.approx(frequency, rel=0.01)
        assert "Hz in 8 runs, whatever the speed" in found["frequency"].description


def hard_spots(case, time, force):
    feed_speed = 4 * case.cut.feed_per_tooth * case.cut.spindle_speed / TURN
    return 0.2 * force * np.sin(TURN * feed_speed * time / 0.8e-3 + 0.7)


def test_a_period_along_the_feed_is_found(milling):
    found = telling(milling(hard_spots))
    numbers = found["period in feed distance"].numbers
    assert numbers["form"] == "in proportion"
    assert numbers["period"] == pytest.approx(0.8e-3, rel=0.03)
    assert "0.8" in found["period in feed distance"].description
    assert "run and channel" in found


def test_the_lead_tells_the_period_and_its_shape(milling):
    residual = milling(hard_spots)
    found = residual_dependence(residual, diagnosed(residual))
    assert found.finding.significant
    assert found.summary()["over"] == ["feed distance"]
    assert found.summary()["period"] == pytest.approx(0.8e-3, rel=0.03)
    assert "with a period of 0.8" in found.finding.description
    values = np.array(found.rows)[:, 1]
    assert 0.5 * np.ptp(values) == pytest.approx(20.0, rel=0.15)  # percent of predicted
    assert found.summary()["share_beyond_noise"] > 0.85


def test_growth_with_cut_time_is_found(milling):
    grown = {}

    def wear(case, time, force):
        number, _ = grown.setdefault(id(case), (len(grown), case))  # kept: no other has its id
        return 0.03 * number * force

    found = telling(milling(wear))
    best = [one for one in found["runs"].numbers["correlations"] if one["with"] == "cut time"]
    assert best[0]["rank_correlation"] == pytest.approx(1.0)
    assert "rises with the cut time" in found["runs"].description


def test_what_dies_away_is_found_over_time(milling):
    found = telling(milling(lambda case, t, f: 6.0 * np.exp(-t / 0.02) * np.sin(TURN * 1500.0 * t)))
    assert "first third" in found["time"].description


# axis --------------------------------------------------------------------------------------------


def test_noise_says_nothing_on_an_axis(axis):
    told = [telling(axis(seed=seed)) for seed in range(10)]
    assert sum(map(len, told)) <= 2


@pytest.mark.parametrize(
    ("plant", "view"),
    [
        (lambda r: 4.0 * np.sign(r.signals["velocity"]), "direction"),
        (lambda r: 40.0 * r.signals["velocity"] ** 2 * np.sign(r.signals["velocity"]), "velocity"),
        (lambda r: 5.0 * (r.signals["position"] > 0.05), "position"),
    ],
)
def test_what_an_axis_lacks_is_found_over_its_variable(axis, plant, view):
    assert view in telling(axis(plant))


def test_a_period_of_position_is_found(axis):
    found = telling(axis(lambda r: 3.0 * np.sin(TURN * r.signals["position"] / 16e-3)))
    assert found["period in position"].numbers["period"] == pytest.approx(16e-3, rel=0.02)


def test_warming_up_is_found_over_the_moves(axis):
    def plant(run):
        return 10.0 * np.exp(-run.record.begun / 15.0) * np.sign(run.signals["velocity"])

    found = telling(axis(plant))
    assert "falls with the time since the first move" in found["runs"].description


def test_two_variables_together_are_found(axis):
    residual = axis(lambda r: 6.0 * np.sign(r.signals["velocity"]) * np.sign(r.signals["position"]))
    found = residual_dependence(residual, diagnosed(residual))
    assert found.finding.significant
    assert found.summary()["share"] > 0.8


# chance ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("colour", [0.0, 0.95])
def test_noise_of_any_colour_hangs_on_nothing(colour):
    found = 0
    for seed in range(60):
        rng = np.random.default_rng([5, seed])
        samples = []
        for _ in range(6):
            noise = rng.standard_normal(800)
            for place in range(1, noise.size if colour else 0):
                noise[place] += colour * noise[place - 1]
            angle = rng.uniform(0.02, 0.05) * np.arange(800)
            place = (np.mod(angle, TURN) / TURN * 20).astype(int)
            samples.append(Sample(noise, np.ones(800), place))
        found += dependence(samples, 20).significant
    assert found <= 3


def test_a_constant_hangs_on_nothing():
    rng = np.random.default_rng(3)
    samples = [
        Sample(5.0 + rng.standard_normal(500), np.ones(500), rng.integers(0, 8, 500))
        for _ in range(5)
    ]
    assert not dependence(samples, 8).significant


def test_rank_correlation_of_few_runs_is_never_sure():
    assert rank_correlation(np.arange(4.0), np.arange(4.0)).probability == 1.0
    # of seven runs in order, chance gives as much once in 2520 times
    assert rank_correlation(np.arange(7.0), np.arange(7.0)).probability < 3e-3
