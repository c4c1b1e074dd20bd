"""Backlash of a spring: force, describing function, and the implicit problem of a step."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from dynamics.drive.backlash import Backlash, backlash_table, opening_force, opening_step
from dynamics.drive.ball_screw import BallScrew
from dynamics.drive.parts import DrivenAxis
from dynamics.drive.rack_and_pinion import RackAndPinion, RackMotor
from dynamics.drive.screw_on_beam import ScrewOnBeam
from dynamics.structure.linear_structure import StructureError

STIFFNESS, DAMPING, GAP = 8e7, 2e3, 12e-6
LAW = Backlash(STIFFNESS, DAMPING, GAP)
AXIS = DrivenAxis("Y", (0.0, 1.0, 0.0), "table", "ground", (0.0, 0.0, 0.0))
STEP = 1e-4


def table(law=LAW):
    return backlash_table([[law]], [0], [-1], [np.zeros(1)])


def limited(stretch):
    return np.clip(stretch, -0.5 * GAP, 0.5 * GAP)


def test_a_dead_zone_with_its_spring_beyond():
    stretch = np.array([-10e-6, -6e-6, -1e-6, 0.0, 6e-6, 9e-6])
    np.testing.assert_allclose(
        LAW.elastic_force(stretch), [-4e-6 * STIFFNESS, 0.0, 0.0, 0.0, 0.0, 3e-6 * STIFFNESS]
    )


@pytest.mark.parametrize("amplitude", [3e-6, 6e-6, 7e-6, 12e-6, 60e-6])
def test_describing_function_is_the_first_harmonic(amplitude):
    def fundamental(angle):
        return float(LAW.elastic_force(amplitude * np.sin(angle))) * np.sin(angle)

    edges = np.arcsin(min(1.0, 0.5 * GAP / amplitude))
    first, _ = quad(fundamental, 0.0, 0.5 * np.pi, points=[edges], epsabs=1e-9)
    expected = 4.0 / np.pi * first / amplitude
    assert LAW.describing_function(amplitude) == pytest.approx(expected, rel=1e-9, abs=1e-3)


def test_describing_function_far_beyond_the_gap():
    """The spring lacks 4/pi of half the gap over the amplitude."""
    share = 1.0 - LAW.describing_function(1e-2) / STIFFNESS
    assert share == pytest.approx(4.0 / np.pi * 0.5 * GAP / 1e-2, rel=1e-5)


def test_the_opening_force_is_the_mean_over_the_motion():
    """k times the mean of the stretch limited to the gap, c times the mean rate of it."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        start, motion = rng.uniform(-15e-6, 15e-6), rng.uniform(-20e-6, 20e-6)
        flanks = [
            share
            for edge in (-0.5 * GAP, 0.5 * GAP)
            if 0.0 < (share := (edge - start) / motion) < 1
        ]
        mean, _ = quad(lambda s: limited(start + s * motion), 0.0, 1.0, points=flanks or None)  # noqa: B023
        across = limited(start + motion) - limited(start)
        expected = STIFFNESS * mean + DAMPING * across / STEP
        found = opening_force(table(), 0, start, motion, STEP)
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("share", [0.01, 0.3, 0.95])
def test_a_step_is_solved_together_with_its_motion(share):
    """The force is the mean one over the motion that it leads to, by bisection of that equation."""
    law = table()
    compliance = share / (0.5 * STIFFNESS + DAMPING / STEP)
    rng = np.random.default_rng(5)
    for _ in range(300):
        start, free = rng.uniform(-15e-6, 15e-6), rng.uniform(-25e-6, 25e-6)

        def missed(motion):
            force = opening_force(law, 0, start, motion, STEP)  # noqa: B023
            return motion - free - compliance * force  # noqa: B023

        motion = brentq(missed, -1e-3, 1e-3, xtol=1e-22, rtol=1e-14)
        found = opening_step(law, 0, start, free, compliance, STEP)
        expected = opening_force(law, 0, start, motion, STEP)
        assert found == pytest.approx(expected, rel=1e-7, abs=1e-7 * STIFFNESS * GAP)


def test_on_a_flank_the_force_is_constant():
    for side in (1.0, -1.0):
        for free in (2e-6, -2e-6):
            force = opening_step(table(), 0, side * 12e-6, free, 1e-12, STEP)
            assert force == side * 0.5 * GAP * STIFFNESS


def test_stiffness_follows_the_axis():
    at = np.array([-0.1, 0.0, 0.3])
    laws = [Backlash(value, 0.0, GAP) for value in (4e7, 5e7, 9e7)]
    from dynamics.drive.backlash import stiffness_at

    found = backlash_table([laws], [0], [1], [at])
    assert found.stiffness[0] == 5e7
    for travel, expected in ((-0.2, 4e7), (-0.05, np.sqrt(20.0) * 1e7), (0.3, 9e7), (1.0, 9e7)):
        assert stiffness_at(found, 0, travel) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "wrong", [{"stiffness": 0.0}, {"damping": -1.0}, {"gap": 0.0}, {"gap": np.nan}]
)
def test_refused_numbers(wrong):
    values = {"stiffness": STIFFNESS, "damping": DAMPING, "gap": GAP} | wrong
    with pytest.raises(StructureError, match=next(iter(wrong))):
        Backlash(**values)


def screw(**more):
    return BallScrew(
        lead=10e-3, motor_inertia=4e-3, screw_inertia=1e-3, nut_stiffness=STIFFNESS, **more
    )


def rack(**more):
    motors = [RackMotor(1e-2, (0.0, 0.0, 1.0), preload=one) for one in (12.0, -12.0)]
    return RackAndPinion(
        pinion_radius=0.1, gear_ratio=20.0, motors=motors, gearbox_stiffness=1e6, **more
    )


def on_beam(**more):
    return ScrewOnBeam(
        "screw", 10e-3, (1e8, 1e8), STIFFNESS, (0.0, 0.0), 0.2,
        motor_inertia=1e-3, coupling_stiffness=1e4, **more,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("drive", "gaps"),
    [
        (screw, {"Y: nut": GAP}),
        (rack, {"Y: gearbox 1": GAP, "Y: gearbox 2": GAP}),
        (on_beam, {"Y: thread": GAP}),
    ],
)
def test_drives_have_it_where_they_push(drive, gaps):
    with_gap = {one.name: one for one in drive(backlash=GAP).parts(AXIS).couplings}
    without = {one.name: one for one in drive().parts(AXIS).couplings}
    assert {name: one.backlash for name, one in with_gap.items() if one.backlash} == gaps
    assert all(one.backlash == 0.0 for one in without.values())
    for name, one in with_gap.items():
        assert (one.stiffness, one.damping) == (without[name].stiffness, without[name].damping)


@pytest.mark.parametrize("drive", [screw, rack, on_beam])
def test_a_negative_gap_is_refused(drive):
    with pytest.raises(StructureError, match="backlash"):
        drive(backlash=-1e-6)
