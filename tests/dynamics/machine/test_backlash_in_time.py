"""A mass that rattles in a gap, step by step: closed forms, energy, order, harmonic balance.

The kernels run as plain Python here.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from dynamics.drive.backlash import Backlash
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.machine.description import BacklashAt, Friction, Machine
from dynamics.machine.groups import friction_commit, friction_forces, load_forces
from dynamics.machine.ports import correct, predict
from dynamics.machine.steps import begin_step, end_step
from dynamics.machine.tables import machine_tables
from dynamics.structure.linear_structure import LinearStructure

MASS, STIFFNESS, GAP = 150.0, 8e7, 12e-6
NATURAL = np.sqrt(STIFFNESS / MASS)
ROW = np.array([1.0])


class Clock:
    """Number of a step, for loads."""

    def __init__(self, number):
        self.number = number


def rattling(gap=GAP, damping=0.0, grounded=0.0, frictions=()):
    """One mass on a spring with backlash; the closed spring is in the structure."""
    structure = LinearStructure(
        np.array([[MASS]]), np.array([[damping + grounded]]), np.array([[STIFFNESS]]), {}
    )
    backlash = () if gap == 0.0 else (
        BacklashAt("nut", Backlash(STIFFNESS, damping, gap), ROW, "Y"),
    )  # fmt: skip
    return Machine(structure, (), tuple(frictions), (), (), None, backlashes=backlash)


def run(machine, step, count, velocity=None, load=None):
    """Displacement, velocity and opening force (count,) of the one freedom."""
    loads = {} if load is None else {"load": (ROW, load)}
    speed = None if velocity is None else np.array([velocity])
    tables = machine_tables(machine, step, loads=loads, outputs={"u": ROW}, velocity=speed)
    bus, p = tables.bus, tables.port["u"]
    found = np.empty((count, 3))
    for number in range(count):
        begin_step(bus)
        for group in tables.explicit:
            load_forces(group, bus, Clock(number))
        predict(bus)
        correct(bus)
        for group in tables.implicit:
            friction_forces(group, bus, None)
            friction_commit(group, bus, None)
        held = bus.force[tables.port["backlash nut"]] if machine.backlashes else 0.0
        found[number] = bus.u[p], bus.v[p], held
        end_step(bus)
    return found


def stored(u, v):
    """Kinetic energy and that of the spring beyond the gap."""
    beyond = np.maximum(np.abs(u) - 0.5 * GAP, 0.0)
    return 0.5 * MASS * v**2 + 0.5 * STIFFNESS * beyond**2


def rattled(speed, time):
    """Displacement of the undamped mass from the middle of the gap: lines and half sines."""
    across, contact = GAP / speed, np.pi / NATURAL
    half_period = across + contact
    # from the middle of the gap on
    turns, rest = np.divmod(time, half_period)
    inside, after = rest < 0.5 * across, rest > 0.5 * across + contact
    u = 0.5 * GAP + speed / NATURAL * np.sin(NATURAL * (rest - 0.5 * across))
    u = np.where(inside, speed * rest, u)
    u = np.where(after, speed * (half_period - rest), u)
    return np.where(turns % 2 == 0, u, -u)


def test_energy_is_kept_whatever_the_step():
    speed = 5e-3
    for step in (2e-5, 2e-4, 2e-3):
        found = run(rattling(), step, 1500, speed)
        energy = stored(found[:, 0], found[:, 1])
        np.testing.assert_allclose(energy, 0.5 * MASS * speed**2, rtol=1e-9)
        assert np.max(np.abs(found[:, 0])) > 0.6 * GAP


def test_motion_of_the_closed_form_and_order_of_its_error():
    """Lines within the gap, half sines beyond it; the error falls with the square of the step."""
    speed, duration = 5e-3, 0.05
    errors = []
    for step in (2e-4, 1e-4, 5e-5, 2.5e-5):
        count = round(duration / step)
        time = step * np.arange(1, count + 1)
        found = run(rattling(), step, count, speed)[:, 0]
        errors.append(np.max(np.abs(found - rattled(speed, time))))
    assert errors[-1] < 2e-3 * GAP
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.mean(orders) == pytest.approx(2.0, abs=0.35)


def test_a_damped_contact_gives_back_what_half_a_damped_swing_does():
    """From flank to flank each contact leaves exp(-pi zeta/sqrt(1 - zeta^2)) of the speed."""
    ratio = 0.1
    damping = 2.0 * ratio * MASS * NATURAL
    step, speed = 5e-6, 20e-3
    found = run(rattling(damping=damping), step, 4000, speed)
    inside = np.abs(found[:, 0]) < 0.45 * GAP
    speeds = np.abs(found[inside, 1])
    crossings = np.split(speeds, np.flatnonzero(np.diff(np.flatnonzero(inside)) > 1) + 1)
    assert len(crossings) >= 4
    kept = np.exp(-np.pi * ratio / np.sqrt(1.0 - ratio**2))
    for number, one in enumerate(crossings[:4]):
        np.testing.assert_allclose(one, speed * kept**number, rtol=2e-3)


def test_energy_of_damped_contacts_never_grows():
    for step in (2e-5, 2e-4, 2e-3):
        found = run(rattling(damping=4e3), step, 1500, 20e-3)
        energy = stored(found[:, 0], found[:, 1])
        assert np.max(np.diff(energy)) <= 1e-12 * energy[0]


def test_next_to_no_gap_is_the_linear_spring():
    """The motion differs by no more than the gap asks for; none at all without a gap."""
    load = 2e3 * np.sin(2.0 * np.pi * 90.0 * 1e-4 * np.arange(801))
    linear = run(rattling(0.0), 1e-4, 800, load=load)[:, 0]
    for gap in (1e-9, 1e-12):
        found = run(rattling(gap), 1e-4, 800, load=load)[:, 0]
        assert np.max(np.abs(found - linear)) < 20.0 * gap


def test_a_load_that_keeps_contact_hides_the_gap():
    """On one flank the mass swings as on its spring, about half the gap."""
    step, count, preload, pulse = 1e-4, 4000, 2000.0, 200.0
    load = np.full(count + 1, preload)
    grounded = MASS * NATURAL
    settled = run(rattling(grounded=grounded), step, count, load=load)[:, 0]
    assert settled[-1] == pytest.approx(0.5 * GAP + preload / STIFFNESS, rel=1e-9)
    load[2000:] += pulse * np.sin(2.0 * np.pi * 60.0 * step * np.arange(count + 1 - 2000))
    found = run(rattling(grounded=grounded), step, count, load=load)[2000:, 0]
    linear = run(rattling(0.0, grounded=grounded), step, count, load=load)[2000:, 0]
    np.testing.assert_allclose(found - linear, 0.5 * GAP, rtol=1e-6)


@pytest.mark.parametrize("amplitude", [8e-6, 14e-6, 40e-6])
def test_fundamental_of_the_force_is_that_of_the_describing_function(amplitude):
    """Well above resonance the stretch is a sine, whatever the contact does."""
    omega, step, periods = 3.0 * NATURAL, 1e-5, 60
    grounded = 0.3 * MASS * omega
    force = abs(STIFFNESS - MASS * omega**2 + 1j * omega * grounded) * amplitude
    count = round(periods * 2.0 * np.pi / omega / step)
    time = step * np.arange(count + 1)
    found = run(rattling(grounded=grounded), step, count, load=force * np.sin(omega * time))
    last = slice(count - round(30 * 2.0 * np.pi / omega / step), count)
    halfway = 0.5 * (found[1:, 0] + found[:-1, 0])[last.start - 1 : last.stop - 1]
    transmitted = STIFFNESS * halfway - found[last, 2]
    turn = np.exp(-1j * omega * (time[1:][last] - 0.5 * step))
    stretch, pulled = 2.0 * np.mean(halfway * turn), 2.0 * np.mean(transmitted * turn)
    expected = Backlash(STIFFNESS, 0.0, GAP).describing_function(abs(stretch))
    assert abs(stretch) > 0.5 * GAP
    assert (pulled / stretch).real == pytest.approx(expected, rel=0.02)
    # a spring: nothing is lost
    assert abs((pulled / stretch).imag) < 0.02 * expected


def test_friction_holds_the_mass_within_the_gap():
    """Dry friction stops the mass between the flanks, where no spring draws it back."""
    dry = Friction("guide", CoulombStribeck(60.0, 60.0, 1e-3, 0.0), ROW)
    found = run(rattling(frictions=(dry,)), 1e-4, 3000, 1.5e-3)
    # kinetic energy is used up by the friction, 60 N over the way
    assert found[-1, 1] == pytest.approx(0.0, abs=1e-9)
    way = 0.5 * MASS * 1.5e-3**2 / 60.0
    assert way < 0.5 * GAP
    assert found[-1, 0] == pytest.approx(way, rel=0.03)


def test_equivalent_spring_of_a_free_rattle():
    """The period grows as the describing function says, within a few percent."""
    amplitude = 30e-6
    speed = NATURAL * (amplitude - 0.5 * GAP)
    period = 2.0 * (GAP / speed + np.pi / NATURAL)
    equivalent = Backlash(STIFFNESS, 0.0, GAP).describing_function(amplitude)
    assert 2.0 * np.pi * np.sqrt(MASS / equivalent) == pytest.approx(period, rel=0.01)
    found = run(rattling(), 2e-5, 2000, speed)[:, 0]
    time = 2e-5 * np.arange(1, 2001)
    up = np.flatnonzero((found[:-1] < 0.0) & (found[1:] >= 0.0))
    crossed = time[up] - found[up] * 2e-5 / (found[up + 1] - found[up])
    assert np.mean(np.diff(crossed)) == pytest.approx(period, rel=1e-3)
    assert brentq(
        lambda a: Backlash(STIFFNESS, 0.0, GAP).describing_function(a) - equivalent, 2e-5, 1e-4
    ) == pytest.approx(amplitude, rel=1e-9)
