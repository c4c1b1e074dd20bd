"""What is found beyond doubt is reported and added, though something else is left."""

import numpy as np
import pytest

import chatter
from benchmarks.blind_sets.frf import write_set
from chatter.description.case import loads
from chatter.explain.explanation import explain
from chatter.explain.measurement import Measurement, Run

MASS, VISCOUS, STEP = 20.0, 60.0, 1e-3
FREQUENCIES = (0.8, 1.2, 1.6, 2.0, 2.4, 2.8)


def axis_of(force, more=""):
    """Measurement of moves of an axis; force of (time, position, velocity) beside mass, viscous."""
    rng = np.random.default_rng(5)
    case = loads(
        f'title = "axis"\n[axis]\nmoving_mass = "20 kg"\nviscous_friction = "60 N*s/m"{more}'
    )
    runs = []
    for number, frequency in enumerate(FREQUENCIES, start=1):
        time = np.arange(900) * STEP
        rate = 2.0 * np.pi * frequency
        position = 0.02 * (1.0 - np.cos(rate * time))
        velocity, acceleration = (
            0.02 * rate * np.sin(rate * time),
            0.02 * rate**2 * np.cos(rate * time),
        )
        total = MASS * acceleration + VISCOUS * velocity + force(rng, time, position, velocity)
        signals = {
            "time": time,
            "position": position + 2e-8 * rng.standard_normal(time.size),
            "force": total + 0.2 * rng.standard_normal(time.size),
        }
        runs.append(Run(f"move{number}.csv", {}, signals))
    return Measurement("axis", "made up", None, case, tuple(runs))


def ringing(rng, time):
    """What no effect known here explains: a ripple in time that begins anywhere."""
    return 5.0 * np.sin(2.0 * np.pi * 27.0 * time + rng.uniform(0.0, 2.0 * np.pi))


def test_friction_beside_a_ringing_is_named_and_added():
    def force(rng, time, position, velocity):
        return 12.0 * np.tanh(velocity / 2e-5) + ringing(rng, time)

    result = explain(axis_of(force))
    summary = result.summary()
    assert summary["verdict"] == "explained-in-part"
    assert [one["name"] for one in summary["effects"]] == ["coulomb_friction"]
    assert summary["partial"] == []
    found = summary["effects"][0]["parameters"]["coulomb"]
    assert found["value"] == pytest.approx(12.0, rel=0.05)
    assert result.case.axis.coulomb_friction == pytest.approx(found["value"])
    error = summary["error"]
    assert error["noise_floor"] < error["after"] < 0.6 * error["before"]
    assert error["holdout_after"] < 0.6 * error["holdout_before"]
    # a refit against the residual would pull them
    assert summary["out_of_tolerance"] == []


def test_a_ringing_alone_is_named_by_nothing():
    def force(rng, time, position, velocity):
        return ringing(rng, time)

    summary = explain(axis_of(force)).summary()
    assert summary["verdict"] == "unexplained"
    assert summary["effects"] == []


def test_friction_that_falls_within_each_move_is_warm_up():
    def force(rng, time, position, velocity):
        friction = 9.0 * np.tanh(velocity / 2e-5)
        return friction + 0.8 * np.exp(-time / 0.3) * VISCOUS * velocity

    result = explain(axis_of(force, '\ncoulomb_friction = "9 N"'))
    summary = result.summary()
    assert [one["name"] for one in summary["effects"]] == ["warm_up"]
    assert result.case.axis.warm_up.begins == "move"
    found = summary["effects"][0]["parameters"]
    assert found["share"]["value"] == pytest.approx(0.8, rel=0.1)
    assert found["time"]["value"] == pytest.approx(0.3, rel=0.1)


def test_values_far_from_declared_do_not_explain():
    """Three times the friction declared is no refit within tolerances."""

    def force(rng, time, position, velocity):
        return 12.0 * np.tanh(velocity / 2e-5)

    summary = explain(axis_of(force, '\ncoulomb_friction = "4 N"')).summary()
    assert summary["verdict"] == "unexplained"
    (one,) = summary["out_of_tolerance"]
    assert one["path"] == "axis.coulomb_friction"
    assert one["refitted"] == pytest.approx(12.0, rel=0.05)


def test_friction_beside_a_ringing_is_not_certain_where_a_declared_value_is_wrong():
    """Twice the viscous friction declared: what draws that value may make the friction as well."""

    def force(rng, time, position, velocity):
        return 12.0 * np.tanh(velocity / 2e-5) + VISCOUS * velocity + ringing(rng, time)

    result = explain(axis_of(force))
    summary = result.summary()
    assert [one["path"] for one in summary["out_of_tolerance"]] == ["axis.viscous_friction"]
    assert summary["verdict"] == "unexplained"
    assert summary["effects"] == []
    assert [one["name"] for one in summary["partial"]] == ["coulomb_friction"]


def test_what_only_damps_in_the_cut_is_no_contact(tmp_path):
    """A loss that is the same at all frequencies: a damper without a spring came near it."""
    write_set(tmp_path, 3006, np.random.default_rng([2029, 6]), "friction_like_damping")
    summary = chatter.explain(tmp_path / "set-3006").summary()
    assert summary["verdict"] == "unexplained"
    assert summary["effects"] == []
