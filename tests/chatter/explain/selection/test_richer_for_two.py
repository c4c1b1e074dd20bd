"""A richer member of a family takes the place of a simpler one and what stood for the rest."""

from chatter.explain.effects.axis import Asymmetry, Offset
from chatter.explain.effects.effect import free
from chatter.explain.selection import candidates
from tests.chatter.explain.selection.test_search import SAMPLES, found_in, measured


class OfBoth(Asymmetry):
    """An asymmetry that brings a drag of its own."""

    def parameters(self, measurement):
        return [*super().parameters(measurement), free("drag", 0.0, 0.1, "", lower=0.0)]

    def patch(self, case, values):
        one, drag = (float(values[key]) for key in ("asymmetry", "drag"))
        return {"axis.asymmetry": one, "axis.quadratic_drag": drag}


class Simple(Asymmetry):
    """The asymmetry alone."""

    @property
    def richer(self):
        return (OfBoth(),)


def like_the_drag(random):
    """The drag is mostly what the offset does, but for less than the noise."""
    one, other, rest = random.standard_normal((3, SAMPLES))
    return one, other, 2.0 * other + rest


def names(monkeypatch, values):
    effects = [Simple(), Offset()]
    monkeypatch.setattr(candidates, "candidates", lambda measurement: effects)
    return found_in(measured(like_the_drag, values)).effect_names


def test_one_richer_effect_is_named_instead_of_two(monkeypatch):
    assert names(monkeypatch, (2.0, 0.0, 0.4)) == ("asymmetry",)


def test_two_effects_stay_two_where_both_are_there(monkeypatch):
    assert set(names(monkeypatch, (2.0, 0.8, 0.0))) == {"asymmetry", "offset"}
