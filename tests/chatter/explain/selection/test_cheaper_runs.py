"""Candidates of a set-up on a machine, screened by its FRFs before cuts are simulated."""

import pytest

from chatter.explain.effects.effect_list import candidates
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement_file import read_measurement
from chatter.explain.prediction import Predictions
from chatter.explain.selection.cheaper_runs import screened_candidates
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import split_runs
from tests.chatter.explain.test_machine_moves import FRICTION, MACHINE, case_in, cuts, set_up, taps

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
    # what shows in cuts alone waits until the FRFs are explained
    assert not any(key.startswith(("runout.", "pitch.")) for key in named)
