"""The search on sums of known shapes: what pays together, and what is next to none."""

from dataclasses import replace

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.effects import effect_list
from chatter.explain.effects.axis import Asymmetry, Offset, QuadraticDrag
from chatter.explain.effects.effect import free
from chatter.explain.kinds.kind import Kind
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter
from chatter.explain.prediction import Predictions
from chatter.explain.records.steady_record import SteadyRecord
from chatter.explain.selection import candidates
from chatter.explain.selection.candidates import fitted, stage_with
from chatter.explain.selection.established import gain_in_most, stages_of_kept_effects
from chatter.explain.selection.joint_steps import joint_steps
from chatter.explain.selection.linearised_step import linearised, promised_by_secants
from chatter.explain.selection.path import Path
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.search import judged_again, search
from chatter.explain.selection.split import split_runs

SAMPLES = 8000


class Sums(Kind):
    """Force that is a sum of shapes, one for each value of the case; noise of one."""

    name = "axis"
    columns = ()
    estimates_noise = False

    def channels(self, run):
        return ("force",)

    def known_noise(self, run):
        return {"force": 1.0}

    def nuisance_parameters(self, measurement):
        return []

    def predict(self, case, run):
        axis, shapes = case.axis, run.record
        given = (axis.asymmetry, axis.offset, axis.quadratic_drag)
        return {"force": shapes[0] + sum(v * s for v, s in zip(given, shapes[1:], strict=True))}


def measured(shapes_of, values, runs=6) -> Measurement:
    """Runs of a common force, and shapes times their values."""
    random = np.random.default_rng(8)
    case = loads('title = "sums"\n[axis]\nmoving_mass = "20 kg"\ncoulomb_friction = "1 N"')
    made = []
    for number in range(runs):
        shapes = (20.0 * np.sin(np.arange(SAMPLES) / 50.0), *shapes_of(random))
        force = shapes[0] + sum(v * s for v, s in zip(values, shapes[1:], strict=True))
        signals = {
            "time": 1e-3 * np.arange(SAMPLES),
            "force": force + random.standard_normal(SAMPLES),
            "velocity": np.ones(SAMPLES),
        }
        made.append(Run(f"run{number}", {}, signals, record=shapes))
    return Measurement("axis", "sums", None, case, tuple(made))


@pytest.fixture(autouse=True)
def three_effects(monkeypatch):
    effects = [Asymmetry(), Offset(), QuadraticDrag(lower=0.0)]
    monkeypatch.setattr(candidates, "candidates", lambda measurement: effects)


def unlike_shapes(random):
    """Three shapes that have nothing in common."""
    return random.standard_normal((3, SAMPLES))


def problem_of(measurement, kind=None):
    """Problem of a measurement, and its split into fitted and holdout runs."""
    kind = kind or Sums()
    noise = {run.name: kind.known_noise(run) for run in measurement.runs}
    return Problem(measurement, Predictions(kind), noise), split_runs(measurement)


def found_in(measurement):
    return search(measurement, Predictions(Sums()), lambda *_: None)


def opposite(random):
    """Two shapes that all but cancel, and one that is nothing like the force."""
    one, rest, other = random.standard_normal((3, SAMPLES))
    return 100.0 * one, -100.0 * one + 5.0 * rest, other


def test_effects_that_only_pay_together_are_found():
    """Of two that all but cancel each takes less than a hundredth of the misfit away alone."""
    measurement = measured(opposite, (1.0, 1.0, 0.0))
    found = found_in(measurement)
    assert set(found.effect_names) == {"asymmetry", "offset"}
    values = found.final.by_name
    assert values["asymmetry.asymmetry"] == pytest.approx(1.0, abs=0.02)
    assert values["offset.offset"] == pytest.approx(1.0, abs=0.02)
    assert found.is_at_noise


def test_a_joint_step_promises_what_linear_models_give():
    measurement = measured(opposite, (1.0, 1.0, 0.0))
    kind, split = Sums(), split_runs(measurement)
    noise = {run.name: kind.known_noise(run) for run in measurement.runs}
    problem = Problem(measurement, Predictions(kind), noise)
    now = problem.fit(split.fitted, {})
    steps = [(one, linearised(problem, one, now, split.fitted)) for one in (Asymmetry(), Offset())]
    (pair,) = joint_steps(now, steps, 40.0)
    # 5 in units of the noise; in each of four runs
    count = 4 * SAMPLES
    assert pair.gain == pytest.approx(25.0 * count, rel=0.03)
    assert pair.alone < 0.01 * pair.gain
    assert pair.values["asymmetry.asymmetry"] == pytest.approx(1.0, abs=0.02)


def test_what_was_found_is_judged_again_without_a_run_that_spoilt_it():
    """A run of something else; the others are at the noise of one with the effect that is true."""
    measurement = measured(unlike_shapes, (3.0, 0.0, 0.0), runs=8)
    spoilt = measurement.runs[4]
    other = 3.0 * np.random.default_rng(3).standard_normal(SAMPLES)
    signals = {**spoilt.signals, "force": spoilt.signals["force"] + other}
    runs = list(measurement.runs)
    runs[4] = replace(spoilt, signals=signals)
    found = found_in(measurement.with_runs(runs))
    assert found.effect_names == ("asymmetry",)
    assert not found.is_at_noise
    fewer = measurement.with_runs(runs[:4] + runs[5:])
    again = judged_again(found, fewer, lambda *_: None)
    assert again.is_at_noise
    assert again.effect_names == ("asymmetry",)
    names = [run.name for part in again.split for run in part]
    assert sorted(names) == sorted(run.name for run in fewer.runs)
    # weight of 3 on 7 runs of unit shapes: its standard deviation is one over the root of all
    deviation = (7 * SAMPLES) ** -0.5
    assert again.final.by_name["asymmetry.asymmetry"] == pytest.approx(3.0, abs=4.0 * deviation)
    # what was tried alone is judged by the same holdout runs: noise, and 9 without the effect
    count = again.problem.count(again.split.holdout)
    assert again.first.best.holdout == pytest.approx(count, rel=0.05)
    assert again.first.holdout == pytest.approx(10.0 * count, rel=0.05)


def test_what_holds_for_the_fitted_runs_alone_explains_nothing():
    """A fit to the other runs that is off by more than the noise, which one to all runs hides."""

    def shapes_of(random):
        return random.standard_normal((3, SAMPLES))

    found = found_in(measured(shapes_of, (3.0, 0.0, 0.0)))
    assert found.is_at_noise
    for change, holds in ((0.02, True), (2.0, False)):
        off = replace(found.of_fitted, values=found.of_fitted.values + change)
        assert replace(found, of_fitted=off).is_at_noise == holds


def test_what_an_effect_adds_is_not_out_of_a_tolerance():
    """Its usual size helps the search; nobody has declared it."""

    def shapes_of(random):
        return random.standard_normal((3, SAMPLES))

    found = found_in(measured(shapes_of, (3.0, 0.0, 0.0)))
    expected = tuple(replace(one, prior=True, size=0.01) for one in found.final.parameters)
    far = replace(found, final=replace(found.final, parameters=expected))
    assert max(abs(pull) for pull in far.final.pulls.values()) > 100.0
    assert far.out_of_tolerance == {}
    declared = tuple(replace(one, name="material.Ktc") for one in expected)
    far = replace(found, final=replace(found.final, parameters=declared))
    assert set(far.out_of_tolerance) == {"material.Ktc"}


def test_an_effect_that_nobody_could_notice_is_not_named_beside_another():
    """A twentieth of the noise: significant in so many samples, and nothing that matters."""

    def shapes_of(random):
        return random.standard_normal((3, SAMPLES))

    found = found_in(measured(shapes_of, (3.0, 0.05, 0.0)))
    assert found.effect_names == ("asymmetry",)
    assert found.is_at_noise


class AsymmetryOfDrag(Asymmetry):
    """Another variant of the asymmetry, which acts as the quadratic drag does."""

    def patch(self, case, values):
        return {"axis.quadratic_drag": float(values["asymmetry"])}


def test_another_variant_takes_the_place_of_one_that_stood_for_two(monkeypatch):
    """The first chosen is like the sum of two effects, of which its other variant is one."""

    def shapes_of(random):
        one, other, rest = random.standard_normal((3, SAMPLES))
        return one + 0.5 * other + 0.5 * rest, other, one

    family = [Asymmetry(), AsymmetryOfDrag()]
    monkeypatch.setattr(candidates, "candidates", lambda measurement: [*family, Offset()])
    monkeypatch.setattr(effect_list, "candidates", lambda measurement: [*family, Offset()])
    found = found_in(measured(shapes_of, (0.0, 5.0, 5.0)))
    assert {type(one) for one in found.problem.effects} == {Offset, AsymmetryOfDrag}
    assert found.is_at_noise
    assert found.final.by_name == pytest.approx(
        {"asymmetry.asymmetry": 5.0, "offset.offset": 5.0}, abs=0.05
    )


def test_what_is_found_is_kept_beside_something_else():
    """Of two thirds of the misfit one effect is the cause; of the rest, none that is known."""

    def shapes_of(random):
        # a line of another phase in every run
        phase = random.uniform(0.0, 2.0 * np.pi)
        ripple = 3.0 * np.sin(0.4 * np.arange(SAMPLES) + phase)
        return ripple, *random.standard_normal((2, SAMPLES))

    made = measured(shapes_of, (1.0, 3.0, 0.0))
    hidden = [
        Run(run.name, {}, run.signals, record=(run.record[0], np.zeros(SAMPLES), *run.record[2:]))
        for run in made.runs
    ]
    found = found_in(made.with_runs(hidden))
    assert found.effect_names == ("offset",)
    assert not found.is_at_noise
    assert found.is_certain
    assert found.final.by_name["offset.offset"] == pytest.approx(3.0, rel=0.02)


class Chosen(Offset):
    """An offset in one shape of many: none does anything before it has an amount."""

    name = "chosen"

    def applies(self, measurement):
        return True

    def parameters(self, measurement):
        which = free("which", 0.0, 1e-3, "", lower=0.0, upper=9.0)
        return [free("amount", 0.0, 0.1, "N"), which]

    def nothing(self, measurement):
        return {"amount": 0.0}

    def patch(self, case, values):
        right = round(values["which"]) == 7
        return {"axis.offset" if right else "axis.asymmetry": values["amount"]}

    def starts(self, measurement):
        return [{"which": float(number)} for number in range(10)]


def test_starts_that_do_nothing_yet_are_ranked_by_what_their_amounts_would_do():
    """The eighth of ten, of which four are followed."""
    problem, split = problem_of(measured(unlike_shapes, (0.0, 3.0, 0.0)))
    now = problem.fit(split.fitted, {})
    step = linearised(problem, Chosen(), now, split.fitted)
    assert step.values["chosen.which"] == pytest.approx(7.0, abs=0.1)
    assert step.values["chosen.amount"] == pytest.approx(3.0, abs=0.05)


def test_a_line_through_a_start_promises_what_the_effect_takes_away():
    """Three of a shape of one, in units of the noise, whichever start it is."""
    problem, split = problem_of(measured(unlike_shapes, (0.0, 3.0, 0.0)))
    now = problem.fit(split.fitted, {})
    count = len(split.fitted) * SAMPLES
    promised = promised_by_secants(problem, Chosen(), now, split.fitted)
    assert promised == pytest.approx(9.0 * count, rel=0.03)
    assert promised_by_secants(problem, Asymmetry(), now, split.fitted) < 0.01 * count


@pytest.mark.parametrize(
    ("values", "looked_at"),
    [
        # at the noise: one, so that the report can say how far nothing helps
        ((0.0, 0.0, 0.0), 1),
        # one takes all of the misfit away: none of the others can
        ((0.0, 3.0, 0.0), 1),
        # neither of two does
        ((2.0, 3.0, 0.0), 3),
    ],
)
def test_effects_are_looked_at_as_far_as_they_promise_something(monkeypatch, values, looked_at):
    asked = []

    def recorded(problem, effect, now, runs):
        asked.append(effect.name)
        return linearised(problem, effect, now, runs)

    monkeypatch.setattr(candidates, "linearised", recorded)
    problem, split = problem_of(measured(unlike_shapes, values))
    now = problem.fit(split.fitted, {})
    found = candidates.stage_of(problem, now, split, lambda *_: None, 0)
    assert len(asked) == looked_at
    if any(values):
        assert asked[0] == found.best.effect.name == "offset"


class BesideADeclaredMass(Sums):
    """The offset acts by a mass as declared alone; one that is drawn away stands for it."""

    def nuisance_parameters(self, measurement):
        return [Parameter("axis.moving_mass", 20.0, 0.2, 1.0, 100.0, True, "kg")]

    def predict(self, case, run):
        away = case.axis.moving_mass - 20.0
        acts = case.axis.offset * (abs(away) < 0.1)
        return {"force": run.record[0] + away * run.record[1] + acts * run.record[2]}


class Sizable(Offset):
    """An offset that is sought from a size as well."""

    def applies(self, measurement):
        return True

    def sizable_starts(self, measurement):
        return [{"offset": 2.0}]


@pytest.mark.parametrize(("effect", "found"), [(Offset(), 0.0), (Sizable(), 3.0)])
def test_declared_values_that_stand_for_an_effect_are_put_back(effect, found):
    """Mass and offset have shapes that are nine tenths alike; the offset of 3 draws the mass."""

    def alike(random):
        one, other = random.standard_normal((2, SAMPLES))
        return one, 0.9 * one + np.sqrt(1.0 - 0.9**2) * other, np.zeros(SAMPLES)

    problem, split = problem_of(measured(alike, (0.0, 3.0, 0.0)), BesideADeclaredMass())
    now = problem.fit(split.fitted, {})
    assert now.by_name["axis.moving_mass"] == pytest.approx(22.7, abs=0.1)
    step = linearised(problem, effect, now, split.fitted)
    assert step.values["offset.offset"] == pytest.approx(found, abs=0.05)
    if found:
        assert step.values["axis.moving_mass"] == pytest.approx(20.0, abs=0.05)


def test_a_stage_from_beside_an_effect_that_was_dropped_is_made_anew():
    """What was tried beside a model that is no more compares with nothing."""
    without, split = problem_of(measured(unlike_shapes, (0.0, 3.0, 0.0)))
    dropped, kept = Asymmetry(), Offset()
    beside = without.with_effect(dropped)
    before = beside.fit(split.fitted, {})
    stage = stage_with(beside, before, split, [fitted(beside, kept, split, {})])
    problem = without.with_effect(kept)
    path = Path([stage], problem, problem.fit(split.fitted, {}))
    (made,) = stages_of_kept_effects(path, split).stages
    assert set(made.before.by_name) == set()
    assert set(made.best.fit.by_name) == {"offset.offset"}
    assert made.best.evidence - made.evidence > 1000.0
    # nothing is made anew where nothing was dropped
    again = stages_of_kept_effects(Path([made], problem, path.now), split)
    assert again.stages == [made]


@pytest.mark.parametrize(
    ("gains", "most"),
    [
        # ranks of what is lost, of eight, add up to 5 or 6 (probability 0.039, 0.055), or 8 (0.098)
        ((-1.0, 2.0, 3.0, -4.0, 5.0, 6.0, 7.0, 8.0), True),
        ((1.0, 2.0, 3.0, 4.0, 5.0, -6.0, 7.0, 8.0), True),
        ((1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, -8.0), False),
        ((1.0, 2.0, 3.0, -0.1), False),
        ((1.0, 2.0, 3.0), True),
    ],
)
def test_most_runs_gain_where_chance_would_not_make_them(gains, most):
    assert gain_in_most(gains) is most


def series(*feeds, **others):
    """Runs named by their feeds, µm, and what else is different in them."""
    case = loads(
        'title = "a series"\n[cut]\nmode = "slot"\nspindle_speed = "6000 rpm"\n'
        'feed_per_tooth = "0.1 mm"\naxial_depth = "3 mm"'
    )
    runs = []
    for number, feed in enumerate(feeds):
        own = {f"cut.{key}": values[number] for key, values in others.items()}
        overrides = {"cut.feed_per_tooth": f"{feed} um", **own}
        runs.append(Run(str(feed), overrides, {"time": np.zeros(2)}))
    return Measurement("milling", "series", None, case, tuple(runs))


def held_out(measurement):
    return [run.name for run in split_runs(measurement).holdout]


def test_feeds_between_others_are_held_out_in_whatever_order_they_stand():
    assert held_out(series(25, 75, 125)) == ["75"]
    assert held_out(series(125, 25, 75)) == ["75"]
    # as text 100 is the lowest
    assert held_out(series(100, 25, 50)) == ["50"]
    assert held_out(series(25, 50, 75, 100, 125)) == ["50"]
    assert held_out(series(125, 100, 75, 50, 25, 150)) == ["125", "50"]


def test_runs_in_which_more_than_one_condition_varies_are_held_out_by_their_order():
    depths = ["1 mm", "2 mm", "3 mm"]
    assert held_out(series(25, 75, 125, axial_depth=depths)) == ["125"]
    # the same everywhere is no condition that varies
    assert held_out(series(25, 75, 125, axial_depth=["2 mm"] * 3)) == ["75"]
    # nor are the speeds of one setting, as records tell them
    speeds = ["5999.8 rpm", "5999.7 rpm", "5999.6 rpm"]
    assert held_out(series(25, 75, 125, spindle_speed=speeds)) == ["75"]
    assert held_out(series(25, 25, 75, 125)) == ["75"]


def settling_within(*revolutions):
    """Cuts of different depths and feeds, each with the revolutions until it has settled."""
    depths = [f"{1 + number} mm" for number in range(len(revolutions))]
    made = series(*range(50, 50 + len(revolutions)), axial_depth=depths)
    records = [SteadyRecord({}, None, one, 60) for one in revolutions]
    return made.with_runs(
        [run.with_record(one) for run, one in zip(made.runs, records, strict=True)]
    )


def test_the_cut_nearest_to_its_limit_is_fitted():
    assert held_out(settling_within(6, 6, 6, 6, 6, 6)) == ["52", "55"]
    assert held_out(settling_within(6, 6, 40, 6, 6, 6)) == ["51", "55"]
    assert held_out(settling_within(6, 12, 6, 6, 6, 18)) == ["52", "54"]
    # another that is fitted asks for as much
    assert held_out(settling_within(40, 6, 40, 6, 6, 6)) == ["52", "55"]


class Lower(Offset):
    """The offset as what a number falls short of one, which is its highest value."""

    def parameters(self, measurement):
        return [free("share", 1.0, 0.03, "", lower=0.0, upper=1.0)]

    def nothing(self, measurement):
        return {"share": 1.0}

    def patch(self, case, values):
        return {"axis.offset": 10.0 * (1.0 - float(values["share"]))}


def test_what_begins_at_nothing_promises_what_it_does_beside_rounding_and_at_a_bound():
    """Coarse predictions are corrected, so that no effect changes the residual by rounding."""
    problem, split = problem_of(measured(unlike_shapes, (0.0, 3.0, 0.0)))
    now = problem.fit(split.fitted, {})
    rounding = 1e-13 * np.random.default_rng(5).standard_normal(SAMPLES)
    coarse = replace(problem, correction={run.name: rounding for run in split.fitted})
    for effect in (Offset(), Lower()):
        promised = promised_by_secants(coarse, effect, now, split.fitted)
        assert promised == pytest.approx(9.0 * len(split.fitted) * SAMPLES, rel=0.03)


class Turned(Offset):
    """Two shapes in any proportion, sought by thirty starts."""

    def parameters(self, measurement):
        return [free("size", 1.0, 0.1, ""), free("angle", 0.0, 0.3, "rad")]

    def nothing(self, measurement):
        return {"size": 0.0}

    def patch(self, case, values):
        size, angle = float(values["size"]), float(values["angle"])
        return {"axis.asymmetry": size * np.cos(angle), "axis.offset": size * np.sin(angle)}

    def starts(self, measurement):
        return [{"angle": np.pi * k / 30} for k in range(30)]


def test_of_many_starts_few_runs_tell_which_are_worth_the_others():
    problem, split = problem_of(measured(unlike_shapes, (0.0, 3.0, 0.0), runs=9))
    now, runs = problem.fit(split.fitted, {}), len(split.fitted)
    made = problem.predictions.made
    promised = promised_by_secants(problem, Turned(), now, split.fitted)
    assert promised == pytest.approx(9.0 * runs * SAMPLES, rel=0.03)
    # thirty starts by two runs, eight of them by the others
    assert problem.predictions.made - made == 30 * 2 + 8 * (runs - 2)
