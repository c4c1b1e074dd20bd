"""Candidates of a set-up on a machine, screened by its FRFs before cuts are simulated."""

from dataclasses import replace

import pytest

from chatter.explain.effects.effect_list import candidates
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement_file import read_measurement
from chatter.explain.prediction import Predictions
from chatter.explain.selection.cheaper_runs import screened_candidates
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import split_runs
from tests.chatter.explain.test_machine_moves import (
    FRICTION,
    MACHINE,
    case_in,
    cuts,
    moves,
    set_up,
    taps,
)

NUT = "Y_nut_stiffness"


def screened(path, truth):
    """Candidates by data of a true case, by effect and parameter, in their order."""
    set_up(path, taps(path, truth), cuts(path, truth))
    kind = KINDS["set-up"]
    measurement = kind.prepared(read_measurement(path))
    split = split_runs(measurement)
    noise = {run.name: kind.first_noise(run) for run in measurement.runs}
    problem = Problem(measurement, Predictions(kind), noise)
    now = problem.fit(split.fitted, {})
    found = screened_candidates(problem, now, split.fitted, candidates(measurement))
    return {
        f"{one.effect.name}.{parameter.name}": one
        for one in found
        for parameter in one.effect.parameters(problem.measured_by(one.effect))
    }


@pytest.mark.nightly
def test_what_frfs_exclude_is_not_simulated(tmp_path):
    """FRFs are as declared; whether tool and workpiece touch they do not tell."""
    truth = case_in(tmp_path, MACHINE + FRICTION)
    touching = truth.patch({"contact.stiffness": 5e6, "contact.damping": 2e3})
    named = screened(tmp_path, touching)
    assert "contact.stiffness" in named
    assert any(key.startswith("runout.") for key in named)
    # a nut is known by them to less than a percent
    assert f"joint_stiffness.{NUT}" not in named


def test_what_frfs_ask_for_comes_first(tmp_path):
    """A nut of 70 % of its declared stiffness."""
    declared = case_in(tmp_path, MACHINE + FRICTION)
    path = "machine.axis.Y.drive.nut_stiffness"
    named = screened(tmp_path, declared.patch({path: 0.7 * declared.get(path)}))
    first = next(iter(named))
    assert first == f"joint_stiffness.{NUT}"
    (begin,) = named[first].begins
    assert begin[first] == pytest.approx(0.7, rel=0.03)
    # it takes the FRFs to their noise, and nothing else does
    assert list(named) == [first]
    # what shows in cuts alone waits until the FRFs are explained
    assert not any(key.startswith(("runout.", "pitch.")) for key in named)


def test_runs_are_predicted_once_for_what_they_do_not_depend_on(tmp_path):
    """Neither the material nor the contact is felt by an axis that moves in the air."""
    case = case_in(tmp_path, MACHINE + FRICTION)
    set_up(tmp_path, moves(tmp_path, case), taps(tmp_path, case))
    kind = KINDS["set-up"]
    runs = {run.name: run for run in kind.prepared(read_measurement(tmp_path)).runs}
    move, rest, moving = (
        runs[f"{name}.csv"] for name in ("move0", "tap_at_rest_0", "tap_moving_0")
    )
    predictions = Predictions(kind)
    nut = "machine.axis.Y.drive.nut_stiffness"

    def shared(run, values):
        return predictions.of(case, run) is predictions.of(case.patch(values), run)

    cuts_otherwise = {"material.Ktc": "800 MPa", "tool.runout": {"offset": 1e-5}}
    for run in (move, rest, moving):
        assert shared(run, cuts_otherwise)
        assert shared(run, {"contact.stiffness": 1e6, "contact.damping": 1e3})
        assert not shared(run, {nut: 0.9 * case.get(nut)})
    # frictions that move with the feed slide
    assert shared(rest, {"cut.feed_per_tooth": "0.2 mm"})
    assert not shared(moving, {"cut.feed_per_tooth": "0.2 mm"})
    in_cut = replace(moving, condition="in_cut")
    assert not shared(in_cut, {"contact.stiffness": 1e6, "contact.damping": 1e3})
