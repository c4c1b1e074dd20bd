"""FRFs by tests in time against the harmonic response of the linearised machine."""

from dataclasses import replace

import numpy as np
import pytest

from chatter.compile.linearised_friction import linearised_frf
from chatter.description.errors import InputError
from chatter.simulation.virtual_tests.frf import FrfCurve, FrfResult, peaks
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from chatter.simulation.virtual_tests.virtual_tests import FrfTest, frf_by_test
from dynamics.frf.container import Frf
from dynamics.friction.lugre import LuGre

STEP = 1e-4
BAND = (20.0, 120.0)
TABLE = np.array([0.0, 1.0, 0.0])
RELATIVE = np.array([0.0, 1.0, -1.0])
FRICTION = LuGre(5e6, 2e3, 800.0, 100.0, 130.0, 5e-3)


@pytest.fixture
def machine(screw_axis, controller):
    return screw_axis(controller())


@pytest.fixture
def rubbing(screw_axis, controller):
    return screw_axis(controller(), [("guide", FRICTION, RELATIVE)])


def force_test(kind, level=100.0, **keys):
    return FrfTest("test", kind, TABLE, TABLE, level, BAND, 1.0, **({"settling": 0.2} | keys))


def deviation(found, machine, read=TABLE, excited=TABLE, **state):
    """Largest deviation in the band over the largest response near it."""
    inside = (found.frequency >= BAND[0]) & (found.frequency <= BAND[1])
    lines = found.frequency[inside]
    wanted = linearised_frf(machine, STEP, lines, excited, read, **state)
    return np.max(np.abs(found.values[inside] - wanted) / np.abs(wanted))


def test_harmonic_response_against_its_own_formula(machine):
    """Closed loop by hand: cascade in the z-domain, matrices of the structure."""
    f = np.linspace(*BAND, 7)
    w = 2.0 * np.pi * f
    t_p, t_v, lead = 1e-3, 2e-4, 10e-3 / (2.0 * np.pi)

    def held(time, finer):
        return np.mean(np.exp(-1j * np.outer(w, finer * np.arange(round(time / finer)))), axis=1)

    regulator = 2.0 * (1.0 + t_v / 0.03 / (1.0 - np.exp(-1j * w * t_v)))
    held_torque = regulator * held(t_v, STEP)
    held_torque = held_torque * (1.0 - np.exp(-1j * w * STEP)) / (1j * w * STEP)
    per_speed = -held_torque
    per_scale = -held_torque * held(t_p, t_v) * 30.0 / lead
    structure = machine.structure
    for place, line in enumerate(w):
        loop = np.zeros((3, 3), dtype=complex)
        loop[0] = [1j * line * per_speed[place], per_scale[place], -per_scale[place]]
        dynamic = structure.stiffness - line**2 * structure.mass + 1j * line * structure.damping
        wanted = np.linalg.solve(dynamic - loop, TABLE)[1]
        found = linearised_frf(machine, STEP, f[place : place + 1], TABLE, TABLE)[0]
        assert found == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("kind", ["hammer", "chirp", "multisine"])
def test_linear_machine_within_one_percent(machine, kind):
    found = frf_by_test(machine, STEP, force_test(kind))
    assert deviation(found, machine) < 0.01


def test_blows_that_have_not_died_away_get_a_longer_period(machine):
    """A machine of 1 % damping was refused by the blows that nobody had asked for."""
    short = replace(force_test("hammer"), period=0.125)
    with pytest.raises(InputError, match=r"record for longer.*\(period: 0.125 s\)"):
        frf_by_test(machine, STEP, short)
    found = frf_by_test(machine, STEP, short, longest_period=1.0)
    assert deviation(found, machine) < 0.02
    # lines of a record that is twice as long, or longer by further doublings
    doublings = np.log2(8.0 / (found.frequency[1] - found.frequency[0]))
    assert doublings >= 1.0
    assert doublings == pytest.approx(round(doublings), abs=1e-6)


def test_between_two_places(machine):
    test = replace(force_test("hammer"), excited=RELATIVE)
    found = frf_by_test(machine, STEP, test)
    assert deviation(found, machine, excited=RELATIVE) < 0.01


def test_moving_axis_within_one_percent(rubbing):
    """In motion the friction slides; its slope takes the place of its stiffness."""
    moving = {"velocity": {"Y": 0.01}}
    found = frf_by_test(rubbing, STEP, force_test("multisine", 2.0, **moving))
    assert deviation(found, rubbing, **moving) < 0.01
    assert deviation(found, rubbing) > 0.1


def test_torque_of_an_axis(machine):
    """What is identified in the closed loop is what the motor feels with its loop open."""
    test = replace(force_test("torque multisine", 1.0), excited="Y", settling=0.5)
    found = frf_by_test(machine, STEP, test)
    motor = np.array([1.0, 0.0, 0.0])
    free = replace(machine, drives=())
    assert deviation(found, free, excited=motor) < 0.01
    assert deviation(found, machine, excited=motor) > 0.1


def test_torque_of_an_axis_that_is_not_controlled(screw_axis):
    test = replace(force_test("torque multisine"), excited="Y")
    with pytest.raises(InputError, match='axis "Y" is not under control'):
        frf_by_test(screw_axis(), STEP, test)


def test_friction_at_rest_as_the_amplitude_vanishes(rubbing):
    small, large = (
        deviation(frf_by_test(rubbing, STEP, force_test("multisine", level)), rubbing)
        for level in (0.5, 5000.0)
    )
    assert small < 0.01
    assert large > 0.05


def test_as_friction_vanishes(rubbing, screw_axis, controller):
    free = replace(rubbing, frictions=())
    errors = []
    for scale in (1.0, 1e-1, 1e-3):
        law = LuGre(*(scale * np.array([5e6, 2e3, 800.0, 100.0, 130.0])), 5e-3)
        machine = screw_axis(controller(), [("guide", law, RELATIVE)])
        errors.append(deviation(frf_by_test(machine, STEP, force_test("multisine")), free))
    assert errors[0] > 0.05
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.01


def test_amplitude_by_the_describing_function(screw_axis, controller):
    """A sine at one frequency: first harmonic within 0.5 % of the harmonic balance."""
    law = LuGre(5e7, 2e3, 800.0, 1500.0, 1800.0, 5e-3)
    rubbing = screw_axis(controller(), [("guide", law, RELATIVE)])
    f, count = 60.0, 10_000
    time = STEP * np.arange(count + 1)
    wave = np.exp(-2j * np.pi * f * time)
    changed = []
    stuck = linearised_frf(rubbing, STEP, np.array([f]), TABLE, TABLE)[0]
    for level in (1e3, 4e3, 10e3):
        force = level * np.sin(2.0 * np.pi * f * time)
        inputs = RunInputs(count * STEP, loads={"force": (TABLE, force)}, outputs={"table": TABLE})
        run = run_machine(rubbing, STEP, inputs)
        steady = slice(-5000, None)
        response = 2.0 * np.mean(run.displacement["table"][steady] * wave[1:][steady])
        at_friction = abs(
            2.0 * np.mean(run.displacement["friction guide"][steady] * wave[1:][steady])
        )
        found = response / (-1j * level)
        wanted = linearised_frf(rubbing, STEP, np.array([f]), TABLE, TABLE, amplitude=at_friction)[
            0
        ]
        assert found == pytest.approx(wanted, rel=0.005)
        changed.append(abs(found - stuck) / abs(stuck))
    # little slip at first; at the end the friction has given way
    assert changed[0] < 0.02
    assert changed[-1] > 0.04


def test_peaks_of_one_mode():
    """m x'' + c x' + k x = f: height 1/(2 z k), frequency w sqrt(1 - 2 z^2), damping z."""
    f = np.linspace(50.0, 150.0, 2001)
    z, k = 0.02, 1e7
    values = 1.0 / k / (1.0 - (f / 100.0) ** 2 + 2j * z * f / 100.0)
    (peak,) = peaks(Frf(f, values, "receptance"))
    assert peak["frequency_Hz"] == pytest.approx(100.0 * np.sqrt(1.0 - 2.0 * z**2), rel=1e-5)
    assert peak["magnitude"] == pytest.approx(1.0 / (2.0 * z * np.sqrt(1.0 - z**2) * k), rel=1e-5)
    assert peak["damping"] == pytest.approx(z, rel=0.01)


def test_files_of_a_result(tmp_path):
    f = np.linspace(10.0, 20.0, 11)
    curve = FrfCurve("tool/table:y", "at rest", Frf(f, 1e-8 / (f + 2j), "receptance"))
    written = FrfResult("m", [curve, curve.as_quantity("mobility")]).save(tmp_path)
    assert all(path.exists() for path in written)
    header, first, *_ = (tmp_path / "tool-table-y.csv").read_text().splitlines()
    assert header.startswith("frequency [Hz],real [")
    assert float(first.split(",")[0]) == 10.0
