"""Machines whose drives have backlash: lost motion, preload, limit cycles, travel, cost."""

import numpy as np
import pytest
from scipy.optimize import brentq

from chatter.compile.machine_parts import assembled_machine
from chatter.description.errors import InputError
from chatter.description.machine.machine_file import load_machine
from chatter.engine.loop_stability import least_stable_motion
from chatter.simulation.virtual_tests.from_file import file_move, frfs
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.drive.backlash import Backlash

GAP, NUT, DAMPING, COULOMB = 12e-6, 80e6, 8e3, 60.0
TABLE = """
title = "table on a drive"
step = "100 us"

[body.table]
mass = "150 kg"
size = ["600 mm", "400 mm", "80 mm"]
centre = ["0 mm", "0 mm", "0 mm"]

[connector.guides]
between = ["table", "ground"]
positions = [["-200 mm", "-150 mm", "0 mm"], ["200 mm", "-150 mm", "0 mm"],
             ["-200 mm", "150 mm", "0 mm"], ["200 mm", "150 mm", "0 mm"]]
stiffness = { x = "250 N/um", z = "350 N/um" }
damping = { x = "3 kN*s/m", z = "5 kN*s/m" }

[axis.Y]
direction = [0, 1, 0]
moving = "table"
at = ["0 mm", "0 mm", "0 mm"]
"""
SCREW = """
[axis.Y.drive]
kind = "ball screw"
lead = "10 mm"
motor_inertia = "0.0045 kg*m^2"
screw_inertia = "0.0015 kg*m^2"
nut_stiffness = {nut}
axial_damping = {damping}
backlash = {gap}
"""
SHAFT = """shaft = { diameter = "15 mm", length = "1000 mm", nut_at = "300 mm" }
"""
RACK = """
[axis.Y.drive]
kind = "rack and pinion"
pinion_radius = "50 mm"
gear_ratio = 10
mesh_stiffness = "40 N/um"
mesh_damping = "4 kN*s/m"
backlash = "30 um"
motors = [
    {{ inertia = "0.003 kg*m^2", towards_pinion = [0, 0, 1], preload = {preload} }},
    {{ inertia = "0.003 kg*m^2", towards_pinion = [0, 0, 1], preload = {opposite} }},
]
"""
CONTROL = """
[axis.Y.control]
position = {{ gain = {gain}, sample_time = "1 ms" }}
velocity = {{ proportional_gain = "1 N*m*s/rad", integral_time = "40 ms", sample_time = "200 us", torque_limit = "25 N*m" }}
current = {{ kind = "first order", time_constant = "0.4 ms", sample_time = "200 us" }}
measuring = {{ position = "{by}" }}
"""  # noqa: E501
FRICTION = f"""
[friction.guide]
law = "tanh-hysteresis"
on = {{ axis = "Y" }}
coulomb = {COULOMB}
hysteresis_slope = 1e6
"""
SLOW_SINE = """
[move.slow]
kind = "sine"
axes = ["Y"]
amplitude = "2 mm"
velocity = "6 mm/s"
periods = 2
"""
LONG_SINE = """
[move.long]
kind = "sine"
axes = ["Y"]
amplitude = "100 mm"
velocity = "125 mm/s"
periods = 1
"""


def file_of(folder, *parts):
    path = folder / "machine.toml"
    path.write_text(TABLE + "".join(parts), encoding="utf-8")
    return load_machine(path)


def screw(gap=GAP, share=1.0):
    return SCREW.format(nut=NUT * share, damping=DAMPING * share, gap=gap)


def control(gain=20.0, by="encoder"):
    return CONTROL.format(gain=gain, by=by)


def lost_motion(file):
    """Way of the motor, m, between the positions of the slide forward and backward, midway."""
    move = file_move(file, "slow", file.move["slow"])
    lag = (move.motor - move.scale)[:, 0]
    last = move.time > 2.2
    fast = np.abs(move.velocity[:, 0]) > 0.9 * np.max(np.abs(move.velocity))
    forward = lag[last & fast & (move.velocity[:, 0] > 0.0)]
    backward = lag[last & fast & (move.velocity[:, 0] < 0.0)]
    return np.mean(forward) - np.mean(backward)


def test_lost_motion_of_a_slow_reversal_is_the_gap(tmp_path):
    """The slide lags by half the gap and what the friction strains the nut by, either way."""
    file = file_of(tmp_path, screw(), control(), FRICTION, SLOW_SINE)
    assert lost_motion(file) == pytest.approx(GAP + 2.0 * COULOMB / NUT, rel=2e-3)
    without = file_of(tmp_path, screw(0.0), control(), FRICTION, SLOW_SINE)
    assert lost_motion(without) == pytest.approx(2.0 * COULOMB / NUT, rel=5e-3)


def test_no_backlash_is_the_machine_without_the_key(tmp_path):
    moves = []
    for drive in (screw(0.0), screw(0.0).replace("backlash = 0.0", "")):
        file = file_of(tmp_path, drive, control(), FRICTION, SLOW_SINE)
        moves.append(file_move(file, "slow", file.move["slow"]))
    np.testing.assert_array_equal(moves[0].scale, moves[1].scale)
    np.testing.assert_array_equal(moves[0].effort, moves[1].effort)


@pytest.mark.parametrize("kind", ["linear motor", "rotary"])
def test_other_drives_have_none(tmp_path, kind):
    text = f'[axis.Y.drive]\nkind = "{kind}"\nbacklash = "10 um"\n'
    with pytest.raises(InputError, match="backlash"):
        file_of(tmp_path, text)


def pushed(file, force, duration):
    """Deflection of the slide, m, under a force that grows slowly and then stays, motors held."""
    machine = assembled_machine(file)
    count = round(duration / file.step)
    load = force * np.clip(np.arange(count + 1) / (0.5 * count), 0.0, 1.0)
    scale = machine.drives[0].scale
    ran = run_machine(machine, file.step, RunInputs(duration, loads={"push": (scale, load)}))
    lag = ran.displacement["scale Y"] - 0.005 * ran.displacement["drive Y"]
    return np.mean(lag[-round(0.1 / file.step) :])


@pytest.mark.parametrize(
    ("force", "gap"), [(1500.0, 0.0), (-1500.0, 0.0), (3500.0, 30e-6), (-3500.0, 30e-6)]
)
def test_preloaded_pinions_keep_contact_up_to_twice_their_preload(tmp_path, force, gap):
    """Two meshes carry the load; beyond the preload one of them crosses to its other flank.

    Stretches g/2 + (F/2 + P)/k and -g/2 + (F/2 - P)/k have the mean F/2k; from F = 2 P on
    the second is g/2 + (F/2 - P)/k, and the mean g/2 more.
    """
    preload = 1200.0 * 0.005
    drive = RACK.format(preload=preload, opposite=-preload)
    file = file_of(tmp_path, drive, control())
    expected = force / (2.0 * 40e6) + 0.5 * gap * np.sign(force)
    assert pushed(file, force, 2.0) == pytest.approx(expected, rel=5e-3)


def test_pinions_without_preload_have_the_play_at_once(tmp_path):
    file = file_of(tmp_path, RACK.format(preload=0.0, opposite=0.0), control())
    expected = 0.5 * 30e-6 + 800.0 / (2.0 * 40e6)
    assert pushed(file, 800.0, 2.0) == pytest.approx(expected, rel=5e-3)


def after_a_push(file):
    """Stretch of the nut, m, from 2 s after a push on the slide on."""
    machine = assembled_machine(file)
    load = np.zeros(40001)
    load[:500] = 200.0 * np.sin(2.0 * np.pi * np.arange(500) / 500.0)
    loads = {"push": (machine.drives[0].scale, load)}
    ran = run_machine(machine, file.step, RunInputs(4.0, loads=loads))
    return ran.displacement["backlash Y: nut"][20000:]


def test_limit_cycle_of_a_loop_over_the_gap(tmp_path):
    """Controlled by its scale the axis hunts where the equivalent spring is just not stable.

    The amplitude is that at which the describing function, of spring and damper alike, leaves the
    linear loop neither growth nor decay.
    """

    def growth(share):
        linear = file_of(tmp_path, screw(0.0, share), control(60.0, "scale"))
        return least_stable_motion(assembled_machine(linear), linear.step)

    share = brentq(lambda one: growth(one).growth_rate, 0.05, 0.3, xtol=1e-3)
    law = Backlash(NUT, DAMPING, GAP)
    amplitude = brentq(
        lambda one: law.describing_function(one) - share * NUT, 0.51 * GAP, 20.0 * GAP
    )
    stretch = after_a_push(file_of(tmp_path, screw(), control(60.0, "scale")))
    assert np.max(stretch) == pytest.approx(amplitude, rel=0.05)
    assert np.min(stretch) == pytest.approx(-amplitude, rel=0.05)
    up = np.flatnonzero((stretch[:-1] < 0.0) & (stretch[1:] >= 0.0))
    frequency = (up.size - 1) / ((up[-1] - up[0]) * 1e-4)
    # the stretch is more of a triangle than of a sine
    assert frequency == pytest.approx(growth(share).frequency, rel=0.15)


def test_no_limit_cycle_by_the_encoder(tmp_path):
    """Controlled by the motor's encoder the loop is closed before the gap, and comes to rest."""
    stretch = after_a_push(file_of(tmp_path, screw(), control(60.0, "encoder")))
    assert np.max(np.abs(stretch[-5000:])) < 0.5 * GAP


@pytest.mark.parametrize("place", [0.12, 0.2, 0.28])
def test_the_gap_is_the_same_wherever_the_nut_is(tmp_path, place):
    """Along a thin screw, whose stiffness falls to a half, at the same place forward and backward.

    The inertia of the slide strains the screw alike both ways, and takes it off no flank.
    """
    file = file_of(tmp_path, screw() + SHAFT, control(), FRICTION, LONG_SINE)
    move = file_move(file, "long", file.move["long"])
    position, velocity = move.scale[:, 0] + 0.3, move.velocity[:, 0]
    lag = (move.motor - move.scale)[:, 0]
    way = {}
    for name, there in (("forward", velocity > 0.01), ("backward", velocity < -0.01)):
        there &= move.time > 0.3
        order = np.argsort(position[there])
        way[name] = np.interp(place, position[there][order], lag[there][order])
    section, polar = np.pi / 4.0 * 0.015**2, np.pi / 32.0 * 0.015**4
    twist = (0.01 / (2.0 * np.pi)) ** 2 * 2.6 / polar
    compliance = 1.0 / NUT + place / 210e9 * (1.0 / section + twist)
    expected = GAP + 2.0 * COULOMB * compliance
    assert way["forward"] - way["backward"] == pytest.approx(expected, rel=3e-3)


def test_linear_answers_say_that_the_gap_is_closed(tmp_path):
    """The linearised FRF is that of the machine without backlash, and a note says so."""
    frf = """
[frf.motor]
excite = "motor:Y"
read = "motor:Y"
by = "linearised"
band = ["20 Hz", "400 Hz"]
"""
    found = [
        frfs(file := file_of(tmp_path, screw(gap), control(), frf), file.frf) for gap in (GAP, 0.0)
    ]
    np.testing.assert_array_equal(*(one["motor"].harmonic.values for one in found))
    (note,) = found[0].summary()["notes"]
    assert "Y: nut 12 um" in note
    assert "closed" in note
    assert "notes" not in found[1].summary()


def test_a_reduced_machine_keeps_the_gap(tmp_path):
    """Modes up to 100 Hz, of which none is that of the screw, lose nothing of the lost motion."""
    text = 'highest_frequency = "100 Hz"\n'
    path = tmp_path / "machine.toml"
    parts = TABLE + screw() + control() + FRICTION + SLOW_SINE
    path.write_text(text + parts, encoding="utf-8")
    assert lost_motion(load_machine(path)) == pytest.approx(GAP + 2.0 * COULOMB / NUT, rel=5e-3)
