"""A mode that a case lacks, from verdicts that integration in time gave with it."""

import pytest

from chatter.explain.cutting_tests.evidence import penalised_cost
from chatter.explain.cutting_tests.fit_to_tests import fit_tests_widely
from chatter.explain.cutting_tests.mode_of_tests import MissingModeOfTests
from chatter.explain.cutting_tests.starts import ANNEALED, starts_with
from chatter.explain.kinds.stability import Stability
from chatter.explain.measurement_file import read_measurement
from chatter.explain.prediction import Predictions
from chatter.explain.selection.problem import Problem
from tests.places import DATA

#: of the machine that was integrated, beside the two modes that are declared
FREQUENCY, COMPLIANCE = 817.8, 5.77e-8


@pytest.fixture(scope="module")
def problem():
    kind = Stability()
    measurement = kind.prepared(read_measurement(DATA / "cutting-tests-missing-mode"))
    noise = {run.name: kind.first_noise(run) for run in measurement.runs}
    return Problem(measurement, Predictions(kind), noise)


def test_verdicts_say_where_a_mode_is_missing(problem):
    effect, runs = MissingModeOfTests(1.0), problem.measurement.runs
    (_, start), *_ = starts_with(problem, effect, [{}])
    trial = problem.with_effect(effect)
    found = fit_tests_widely(trial, runs, start, ANNEALED)
    assert found.by_name["missing_mode.frequency"] == pytest.approx(FREQUENCY, rel=0.02)
    # verdicts tell a compliance within a half
    assert found.by_name["missing_mode.compliance"] == pytest.approx(COMPLIANCE, rel=0.5)
    refitted = fit_tests_widely(problem, runs, {}, ANNEALED)
    # odds of more than a hundred to one
    assert penalised_cost(problem, refitted) - penalised_cost(trial, found) > 10.0


def test_fewer_frequencies_are_tried_where_predictions_cost_more(problem):
    measurement = problem.measurement
    many, few = (len(MissingModeOfTests(share).starts(measurement)) for share in (1.0, 0.05))
    assert many > 2 * few > 0
