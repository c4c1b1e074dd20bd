"""A richer member of a family in the place of two effects, where the two do not do better."""

import numpy as np
import pytest

from chatter.explain.effects.axis import Asymmetry, Offset
from chatter.explain.effects.effect import free
from chatter.explain.selection.candidates import fitted, stage_with
from chatter.explain.selection.one_for_two import one_for_two
from chatter.explain.selection.path import Path
from tests.chatter.explain.selection.test_search import SAMPLES, measured, problem_of


class WithDrag(Asymmetry):
    """The first shape and the third, for which the second may stand."""

    mistaken_for = ("offset",)

    def parameters(self, measurement):
        return [free("asymmetry", 0.0, 0.1, ""), free("drag", 0.0, 0.1, "")]

    def starts(self, measurement):
        return [{"asymmetry": 1.0, "drag": drag} for drag in (0.0, 1.0, 2.0, 4.0)]

    def patch(self, case, values):
        return {"axis.asymmetry": values["asymmetry"], "axis.quadratic_drag": values["drag"]}


class Simple(Asymmetry):
    """The first shape alone."""

    @property
    def richer(self):
        return (WithDrag(),)


def alike(random):
    """The second shape is the third but for a tenth."""
    one, other, rest = random.standard_normal((3, SAMPLES))
    return one, other + 0.1 * rest, other


def path_of_two(values):
    """Path of the simple member and the effect that may stand for the rest."""
    base, split = problem_of(measured(alike, values))
    simple, offset = Simple(), Offset()
    problem = base.with_effect(simple).with_effect(offset)
    now = problem.fit(split.fitted, {})
    stages = []
    for effect in (simple, offset):
        without = problem.without_effect(effect)
        before = without.fit(split.fitted, now.by_name)
        own = fitted(without, effect, split, now.by_name)
        stages.append(stage_with(without, before, split, [own]))
    return Path(stages, problem, now), split


def test_a_richer_member_takes_the_place_of_a_member_and_what_stood_for_the_rest():
    """Made with 2 and 3 of the first and the third shape."""
    path, split = path_of_two((2.0, 0.0, 3.0))
    found = one_for_two(path, split, lambda *_: None)
    assert [stage.best.effect.name for stage in found.stages] == ["asymmetry"]
    assert found.now.by_name == pytest.approx(
        {"asymmetry.asymmetry": 2.0, "asymmetry.drag": 3.0}, abs=0.02
    )
    assert found.over_noise(split.holdout) == pytest.approx(1.0, abs=0.02)
    assert path.over_noise(split.holdout) == pytest.approx(
        np.sqrt(1.0 + (3.0 * 0.1) ** 2), abs=0.02
    )


def test_two_effects_that_do_clearly_better_stay():
    """Made with the first and the second shape."""
    path, split = path_of_two((2.0, 3.0, 0.0))
    assert one_for_two(path, split, lambda *_: None) is path
