"""Of the richer members of a family the one is taken that predicts the holdout runs better."""

from dataclasses import replace

import numpy as np

from chatter.explain.effects.axis import Asymmetry
from chatter.explain.effects.effect import free
from chatter.explain.selection.candidates import fitted, stage_with
from chatter.explain.selection.path import Path, in_other_forms
from chatter.explain.selection.split import split_runs
from tests.chatter.explain.selection.test_search import SAMPLES, measured, problem_of


class _WithAnother(Asymmetry):
    """An asymmetry that brings another shape with it."""

    key = ""

    def parameters(self, measurement):
        return [*super().parameters(measurement), free("other", 0.0, 0.1, "")]

    def patch(self, case, values):
        return {"axis.asymmetry": float(values["asymmetry"]), self.key: float(values["other"])}


class WithDrag(_WithAnother):
    key = "axis.quadratic_drag"


class WithOffset(_WithAnother):
    key = "axis.offset"


class Simple(Asymmetry):
    """The asymmetry alone."""

    @property
    def richer(self):
        return (WithDrag(), WithOffset())


def shapes_of(random):
    """The shape of the drag is that of the offset and of something else."""
    one, other, rest = random.standard_normal((3, SAMPLES))
    return one, other, other + rest


def test_a_member_that_loses_holdout_runs_does_not_hide_another_that_gains():
    """What only the fitted runs hold the drag takes best; holdout runs have the opposite of it."""
    measurement = measured(shapes_of, (2.0, 1.0, 0.0))
    held = {run.name for run in split_runs(measurement).holdout}
    runs = []
    for run in measurement.runs:
        rest = run.record[3] - run.record[2]
        force = run.signals["force"] + (-3.0 if run.name in held else 1.0) * rest
        runs.append(replace(run, signals={**run.signals, "force": force}))
    problem, split = problem_of(replace(measurement, runs=tuple(runs)))
    simple = Simple()
    now = problem.fit(split.fitted, {})
    found = fitted(problem, simple, split, {})
    stage = stage_with(problem, now, split, [found])
    path = Path([stage], problem.with_effect(simple), found.fit)

    richer = in_other_forms(path, split, lambda *_: None)

    (effect,) = richer.problem.effects
    assert isinstance(effect, WithOffset)
    # beside the rest, which is as large as the noise, in each of four runs
    np.testing.assert_allclose(richer.now.by_name["asymmetry.other"], 1.0, atol=0.05)
