"""Every kind of computation is asked for; the small cases of it are cases that can be read."""

import functools
import itertools

from chatter.description.law_section import FRICTION_LAWS
from chatter.first_steps import compile_kernels as compiling
from chatter.simulation.setup import set_up
from chatter.stability.registry import METHODS


def names():
    asked = (*compiling._of_stability(), *compiling._of_time(), *compiling._of_machines())
    return [question.name for question in asked]


def test_every_method_and_every_friction_law_is_asked_for():
    asked = names()
    assert len(set(asked)) == len(asked)
    assert {f"limit by {name}" for name in METHODS.names()} <= set(asked)
    built_in = {
        law.name for law in FRICTION_LAWS if law.__class__.__module__.startswith("dynamics")
    }
    assert built_in
    assert {f"{name} friction on a mode" for name in built_in} <= {
        name.removeprefix("cut, ") for name in asked
    }
    assert "cut on a machine" in asked


def test_questions_are_asked_in_turn_and_told(monkeypatch):
    asked, told = [], []

    def question(name):
        return compiling.Question(name, lambda: asked.append(name))

    monkeypatch.setattr(compiling, "_of_stability", lambda: iter([question("a"), question("b")]))
    monkeypatch.setattr(compiling, "_of_time", lambda: iter([question("c")]))
    monkeypatch.setattr(compiling, "_of_machines", lambda: iter(()))
    first = list(itertools.islice(compiling.compile_kernels(told.append), 1))
    assert [one.name for one in first] == ["a"]
    assert asked == ["a"]
    assert [one.name for one in compiling.compile_kernels()] == ["a", "b", "c"]
    assert told[0] == "compiling 1 of 3: a"


def test_small_cases_hold_what_their_names_say():
    case = compiling._case(patch=compiling._HELIX | compiling._EXPONENTIAL)
    assert (
        case.tool.helix[0] > 0.5 if hasattr(case.tool.helix, "__len__") else case.tool.helix > 0.5
    )
    assert case.material.law == "exponential"
    assert compiling._case(patch=compiling._CONTACT).contact is not None


def test_every_question_can_be_asked():
    """A case that cannot be set up would end `chatter compile` half way."""
    questions = [*compiling._of_stability(), *compiling._of_time()]
    cases = [one.ask.args[0] for one in questions if isinstance(one.ask, functools.partial)]
    assert len(cases) > 20
    for case in cases:
        assert set_up(case).step > 0.0


def test_questions_of_machines_are_answered():
    """A shipped machine that refuses its short test would end the command."""
    for question in compiling._of_machines():
        assert question.ask() is not None
