"""Efforts at a limit: an axis that vibrates under a constant effort, and records that are cut."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

import chatter
from chatter.drive_friction.drive_records import DriveRecords
from dynamics.friction.identification.record import DriveRecord
from tests.chatter.drive_friction.test_identified_friction import MASS, OFFSET, SINES, TRUTHS, sine

STEP, LIMIT, VISCOUS = 1e-3, 3000.0, 600.0
#: mass at the encoder and behind the spring, kg, and the damping ratio of its vibration
MOTOR, TABLE, DAMPING = 300.0, 820.0, 0.01
#: s, force at its limit this way and that
HALF_PERIOD = 0.8


def two_masses(frequency):
    """Record of two masses on a spring under a force of two values, solved exactly."""
    reduced = MOTOR * TABLE / (MOTOR + TABLE)
    stiffness = (2.0 * np.pi * frequency) ** 2 * reduced
    damping = 2.0 * DAMPING * np.sqrt(stiffness * reduced)
    spring = np.array([[-stiffness, stiffness], [stiffness, -stiffness]])
    losses = np.array([[-damping - VISCOUS, damping], [damping, -damping]])
    masses = np.array([[MOTOR], [TABLE]])
    rates = np.block([[np.zeros((2, 2)), np.eye(2)], [spring / masses, losses / masses]])
    pushed = np.array([[0.0], [0.0], [1.0 / MOTOR], [0.0]])
    step = scipy.linalg.expm(STEP * np.block([[rates, pushed], [np.zeros((1, 5))]]))
    time = STEP * np.arange(6401)
    force = LIMIT * np.where(np.floor(time / HALF_PERIOD + 0.5) % 2 == 0, 1.0, -1.0)
    states = np.zeros((len(time), 4))
    for k in range(len(time) - 1):
        states[k + 1] = step[:4, :4] @ states[k] + step[:4, 4] * force[k]
    noise = np.random.default_rng(5).standard_normal(len(time))
    return DriveRecord(time, states[:, 0], states[:, 2], force + 2.0 * noise)


@pytest.mark.parametrize("frequency", [25.0, 40.0])
def test_an_axis_that_vibrates_under_a_constant_effort_is_weighed_by_its_mean_motion(frequency):
    given = DriveRecords((two_masses(frequency),), rotary=False)
    found = chatter.friction(given)
    inertia = found.kept.estimates["inertia"]
    assert inertia.value == pytest.approx(MOTOR + TABLE, rel=0.05)
    # the first low-pass lets the vibration pass: far less than both masses
    assert found.instead_of.kept.inertia < 0.75 * (MOTOR + TABLE)
    assert found.settings.low_pass.cutoff < frequency
    assert found.flat_tops.level == pytest.approx(LIMIT, rel=0.01)
    assert any("as at the limit of the drive; the axis vibrates" in note for note in found.notes)
    assert not any("not to be used" in note for note in found.notes)


def test_values_of_a_low_pass_that_is_given_are_not_to_be_used():
    given = DriveRecords((two_masses(25.0),), rotary=False)
    found = chatter.friction(given, low_pass=60.0)
    assert found.instead_of is None
    assert found.notes[0].endswith(
        "as at the limit of the drive: record slower moves or give a lower --low-pass"
    )
    assert "these values are not to be used" in found.friction_toml()


@pytest.mark.parametrize("share", [0.9, 0.7, 0.5, 0.3])
def test_a_cut_effort_is_left_out(share):
    whole = [sine(TRUTHS["coulomb"], *one) for one in SINES[:2]]
    limit = share * max(np.abs(one.effort).max() for one in whole)
    cut = tuple(replace(one, effort=np.clip(one.effort, -limit, limit)) for one in whole)
    found = chatter.friction(DriveRecords(cut, rotary=False))
    for name, truth in (("inertia", MASS), ("viscous", 400.0), ("coulomb", 60.0)):
        assert found.kept.estimates[name].value == pytest.approx(truth, rel=5e-3), name
    assert found.kept.offset == pytest.approx(OFFSET, rel=0.02)
    assert any("left out, as cut by a limit" in note for note in found.notes)
    assert found.unexplained < 0.02


def test_a_constant_acceleration_of_a_stiff_axis_stays_as_it_is():
    """A trapezoid of the velocity: the effort is flat at its largest, and the law holds there."""
    time = STEP * np.arange(2000)
    acceleration = np.where(time % 1.0 < 0.5, 3.0, -3.0) * np.where(time < 1.0, 1.0, -1.0)
    velocity = STEP * np.concatenate(([0.0], np.cumsum(acceleration)[:-1]))
    position = np.concatenate(([0.0], np.cumsum(0.5 * STEP * (velocity[1:] + velocity[:-1]))))
    effort = 500.0 * acceleration + 50.0 * np.sign(velocity) + 20.0 * velocity
    effort += np.random.default_rng(2).standard_normal(len(time))
    found = chatter.friction(DriveRecords((DriveRecord(time, position, velocity, effort),), False))
    assert found.kept.estimates["inertia"].value == pytest.approx(500.0, rel=0.01)
    assert found.instead_of is None
    assert not any("limit" in note or "not to be used" in note for note in found.notes)
