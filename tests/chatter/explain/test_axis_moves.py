"""Moves of an axis whose truth is written down: when each channel was recorded, cogging, rest."""

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.effects.sines_of_position import strongest_sines
from chatter.explain.explanation import explain
from chatter.explain.kinds import axis_record
from chatter.explain.kinds.axis import Axis
from chatter.explain.measurement import Measurement, Run
from dynamics.friction.axis_force import AxisForce

MASS, VISCOUS, COULOMB, STEP = 150.0, 900.0, 80.0, 1e-3
NOISE = 1.0
CASE = loads("""title = "axis"
[axis]
moving_mass = "154 kg"
viscous_friction = "880 N*s/m"
coulomb_friction = "78 N"
""")
#: frequency, Hz, and half the travel, m, of sines
MOVES = ((0.91, 0.02), (1.697, 0.012), (0.527, 0.03), (2.313, 0.008), (5.87, 0.001), (1.21, 0.02))


def force_at(time, rate, half, cogging=0.0, period=0.01):
    """Force of a mass that rubs, on a sine, exactly."""
    position = half * (1.0 - np.cos(rate * time))
    velocity = half * rate * np.sin(rate * time)
    force = MASS * half * rate**2 * np.cos(rate * time) + VISCOUS * velocity
    force = force + COULOMB * np.tanh(velocity / 2e-5)
    return force + cogging * np.sin(2.0 * np.pi * position / period + 0.7)


def moves(delay=0.0, **more) -> Measurement:
    """Moves of the axis; their force was recorded later than their motion."""
    random = np.random.default_rng(4)
    runs = []
    for number, (frequency, half) in enumerate(MOVES):
        time, rate = STEP * np.arange(2500), 2.0 * np.pi * frequency
        position = half * (1.0 - np.cos(rate * time))
        signals = {
            "time": time,
            "position": position + 2e-8 * random.standard_normal(time.size),
            "force": force_at(time - delay, rate, half, **more)
            + NOISE * random.standard_normal(time.size),
        }
        runs.append(Run(f"move{number + 1}.csv", {}, signals))
    return Measurement("axis", "made up", None, CASE, tuple(runs))


@pytest.mark.parametrize("delay", [3e-4, -2.5e-4])
def test_the_delay_between_the_channels_is_found_and_does_not_bias_the_mass(delay):
    found = explain(moves(delay))
    assert found.verdict == "nothing-missing"
    assert found.case.axis.force_delay == pytest.approx(delay, abs=3e-5)
    assert found.case.axis.moving_mass == pytest.approx(MASS, rel=5e-4)
    assert found.case.axis.viscous_friction == pytest.approx(VISCOUS, rel=3e-3)


def test_cogging_of_many_periods_over_the_travel_is_named():
    """Of 24 periods over the longest move."""
    found = explain(moves(cogging=12.0, period=2.5e-3))
    (effect,) = found.summary()["effects"]
    assert effect["name"] == "cogging"
    numbers = effect["parameters"]
    assert numbers["period"]["value"] == pytest.approx(2.5e-3, rel=1e-3)
    assert numbers["amplitude"]["value"] == pytest.approx(12.0, rel=0.02)
    assert numbers["phase"]["value"] == pytest.approx(0.7, abs=0.05)


def test_sines_of_a_position_are_found_by_their_periods():
    random = np.random.default_rng(2)
    position = random.uniform(0.01, 0.09, 6000)
    turn = 2.0 * np.pi * position
    force = 5.0 * np.sin(turn / 7.3e-3) + 3.0 * np.cos(turn / 1.1e-3)
    first, second = strongest_sines(position, force, np.ones(position.size))[:2]
    assert first[2] == pytest.approx(7.3e-3, rel=0.02)
    assert second[2] == pytest.approx(1.1e-3, rel=0.005)
    assert np.hypot(*first[:2]) == pytest.approx(5.0, rel=0.15)
    assert strongest_sines(np.full(9, 0.01), np.ones(9), np.ones(9)) == []


def test_an_axis_at_rest_says_nothing_of_a_dry_friction():
    time = STEP * np.arange(2000)
    moved = np.where(time < 1.0, 0.0, 0.01 * (1.0 - np.cos(2.0 * np.pi * (time - 1.0))))
    run = Run("move.csv", {}, {"time": time, "position": moved, "force": np.ones(2000)})
    record = axis_record.prepared(run, 0.0, AxisForce(MASS, VISCOUS, COULOMB)).record
    weights = axis_record.force_weights(record, AxisForce(MASS, VISCOUS, COULOMB))
    at = time[:: time.size // weights.size]
    assert weights[(at > 0.1) & (at < 0.9)].max() < 0.1
    assert weights[(at > 1.1) & (at < 1.4)].min() > 0.5


def test_a_motor_that_creeps_takes_long_to_cross_a_gap():
    """At 0.04 mm/s a gap of 0.04 mm takes a second, in which the slide rests."""
    time, speed, gap = STEP * np.arange(12000), 4e-5, 4e-5
    motor = np.where(time < 6.0, speed * time, speed * (12.0 - time))
    slide = np.where(time < 6.0, motor, np.minimum(speed * 6.0, motor + gap))
    signals = {
        "time": time,
        "position": slide,
        "velocity": np.gradient(motor, STEP),
        "force": COULOMB * np.sign(np.gradient(slide, STEP)),
    }
    run = Run("move.csv", {}, signals)
    made = axis_record.prepared(run, 0.0, AxisForce(MASS, VISCOUS, COULOMB))
    made = axis_record.with_motor(made, run, signals["force"])
    weight, at = made.weights["backlash"], made.signals["time"]
    assert weight[(at > 6.0) & (at < 7.0)].max() < 0.1
    assert weight[(at > 3.0) & (at < 4.0)].min() == 1.0


def test_the_delay_is_asked_for_of_every_record():
    names = [one.name for one in Axis().nuisance_parameters(moves())]
    assert names[-1] == "axis.force_delay"


def test_quadratic_drag_is_named_alone():
    """Without a Stribeck friction beside it, whose interval would reach nothing."""
    random = np.random.default_rng(9)
    made = moves()
    runs = []
    for run in made.runs:
        velocity = np.gradient(run.signals["position"], STEP)
        drag = 6000.0 * velocity * np.abs(velocity)
        force = run.signals["force"] + drag + 0.5 * random.standard_normal(velocity.size)
        runs.append(Run(run.name, {}, {**run.signals, "force": force}))
    summary = explain(made.with_runs(runs)).summary()
    assert summary["verdict"] == "explained"
    assert [one["name"] for one in summary["effects"]] == ["quadratic_drag"]
    (number,) = summary["effects"][0]["parameters"].values()
    assert number["value"] == pytest.approx(6000.0, rel=0.03)
