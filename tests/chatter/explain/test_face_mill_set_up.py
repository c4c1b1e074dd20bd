"""FRFs, a move and a cut of the face mill on its machine, in one folder."""

import math

import numpy as np
import pytest

import chatter
from benchmarks.face_mill_set_up import SMALL, TRIALS, write_set_up
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement_file import read_measurement
from chatter.explain.prediction import Predictions


@pytest.fixture(scope="module")
def complete(tmp_path_factory):
    """Data of the machine as it is declared, by half its step."""
    folder = tmp_path_factory.mktemp("complete")
    write_set_up(folder, TRIALS["nothing"], 1, SMALL)
    return folder


def test_the_parts_of_one_move_and_one_cut_are_predicted(complete):
    """A kind of too few runs to hold any out is judged in parts, each of the kind of the whole."""
    kind = KINDS["set-up"]
    measurement = kind.prepared(read_measurement(complete))
    parts = [run for run in measurement.runs if run.part is not None]
    assert {run.kind for run in parts} == {"drive", "milling"}
    predictions = Predictions(kind)
    for run in parts:
        predicted = predictions.of(measurement.case, run)
        for channel in kind.channels(run):
            error = predicted[channel] - run.signals[channel]
            # 2 % of noise, and half the step in what made the data
            assert math.sqrt(np.mean(error**2)) < 0.05 * run.level(channel)


def test_an_frf_of_another_case_is_not_that_of_the_last(complete):
    """What is kept of a case is not given out for one that differs."""
    kind = KINDS["set-up"]
    measurement = kind.prepared(read_measurement(complete))
    case, predictions = measurement.case, Predictions(kind)
    moved, resting = (
        next(run for run in measurement.runs if run.condition == one)
        for one in ("moving", "at_rest")
    )
    path = "machine.axis.Y.drive.nut_stiffness"
    declared = predictions.of(case, moved)["real"]
    softer = predictions.of(case.patch({path: 0.5 * case.get(path)}), moved)["real"]
    assert np.abs(softer - declared).max() > 0.1 * np.abs(declared).max()
    assert np.abs(predictions.of(case, resting)["real"] - declared).max() > 0.0
    assert predictions.of(case, moved)["real"] == pytest.approx(declared)


@pytest.mark.nightly
def test_nothing_is_missing_where_all_kinds_say_so(complete):
    found = chatter.explain(complete)
    assert found.verdict == "nothing-missing"
    assert not found.found.accepted
