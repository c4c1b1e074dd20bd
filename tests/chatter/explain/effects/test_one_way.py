"""A stroke one way: what its rests tell of a constant force, and friction of a direction."""

from dataclasses import replace

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.criteria import MOST_PROBABLE
from chatter.explain.effects.effect_list import EFFECTS
from chatter.explain.explanation import explain
from chatter.explain.kinds.axis import Axis
from chatter.explain.measurement import Measurement, Run
from chatter.explain.reported_effects import confounded, probability

MASS, VISCOUS, NOISE, STEP = 25.0, 60.0, 1.0, 1e-3
CASE = loads("""title = "axis"
[axis]
moving_mass = "24.7 kg"
viscous_friction = "60 N*s/m"
""")


def stroke(friction=0.0, weight=0.0) -> Measurement:
    """Stroke of 0.19 m between two rests; a friction holds nothing at the first of them."""
    random = np.random.default_rng(5)
    time = STEP * np.arange(800)
    share = np.clip((time - 0.15) / 0.5, 0.0, 1.0)
    # a quintic: speed and acceleration are zero at both ends
    position = 0.19 * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    velocity = np.gradient(position, STEP)
    force = MASS * np.gradient(velocity, STEP) + VISCOUS * velocity + weight
    force = force + friction * np.tanh(velocity / 2e-4) + NOISE * random.standard_normal(time.size)
    run = Run("move1.csv", {}, {"time": time, "position": position, "force": force})
    return Measurement("axis", "one way", None, CASE, (run,))


def applies(name: str, measurement: Measurement, *others: str) -> bool:
    return EFFECTS[name].applies_beside(Axis().prepared(measurement), others)


def test_a_friction_is_named_that_a_stroke_one_way_shows():
    (stage,) = explain(stroke(friction=12.0)).found.accepted
    assert stage.best.effect.name == "coulomb_friction"
    assert probability(stage, MOST_PROBABLE) > 0.95
    assert confounded(stage) == []
    friction = stage.best.fit.by_name["coulomb_friction.coulomb_friction"]
    assert friction == pytest.approx(12.0, abs=1.5)


def test_a_force_at_rest_leaves_a_constant_force_possible():
    assert applies("offset", stroke(weight=12.0))
    assert not applies("offset", stroke(friction=12.0))


def test_beside_a_dry_friction_every_force_is_possible():
    rubbing = stroke(friction=12.0)
    assert applies("offset", rubbing, "coulomb_friction")
    assert applies("asymmetry", rubbing, "coulomb_friction")
    declared = replace(rubbing, case=CASE.patch({"axis.coulomb_friction": "11 N"}))
    assert applies("offset", declared)
    assert applies("asymmetry", declared)


def test_no_friction_differs_with_the_direction_where_there_is_none():
    assert not applies("asymmetry", stroke(weight=12.0))
