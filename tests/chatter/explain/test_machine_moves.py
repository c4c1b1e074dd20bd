"""Moves of an axis of a machine, FRFs and cuts of one set-up: predicted, and judged together."""

import math

import numpy as np
import pytest

import chatter
from chatter.compile.machine_response import machine_response
from chatter.description.case import load
from chatter.description.errors import InputError
from chatter.explain.effects.effect_list import candidates
from chatter.explain.measurement_file import read_measurement
from chatter.simulation.virtual_tests.recorded_move import recorded_move

LEAD, MASS, INERTIA, GAIN = 10e-3, 150.0, 6e-3, 20.0
COULOMB, VISCOUS = 60.0, 400.0
FRICTION = f"""
[friction.guide]
law = "tanh-hysteresis"
on = {{ axis = "Y" }}
coulomb = {COULOMB}
viscous = {VISCOUS}
hysteresis_slope = 1e4
"""
MACHINE = f"""
title = "table on a ball screw under a head on springs"
tool_point = "tool"
workpiece = "work"
step = "100 us"

[body.table]
mass = {MASS}
size = ["600 mm", "400 mm", "80 mm"]
centre = ["0 mm", "0 mm", "0 mm"]

[body.head]
mass = "80 kg"
size = ["300 mm", "300 mm", "300 mm"]
centre = ["0 mm", "0 mm", "300 mm"]

[connector.guides]
between = ["table", "ground"]
positions = [["-200 mm", "-150 mm", "0 mm"], ["200 mm", "-150 mm", "0 mm"],
             ["-200 mm", "150 mm", "0 mm"], ["200 mm", "150 mm", "0 mm"]]
stiffness = {{ x = "250 N/um", z = "350 N/um" }}
damping = {{ x = "3 kN*s/m", z = "5 kN*s/m" }}

[connector.column]
between = ["head", "ground"]
at = ["0 mm", "0 mm", "300 mm"]
stiffness = {{ x = "40 N/um", y = "30 N/um", z = "200 N/um", rx = "2e7 N*m/rad", ry = "2e7 N*m/rad", rz = "2e7 N*m/rad" }}
damping = {{ x = "3 kN*s/m", y = "3 kN*s/m", z = "6 kN*s/m", rx = "2 kN*m*s/rad", ry = "2 kN*m*s/rad", rz = "2 kN*m*s/rad" }}

[point.tool]
on = "head"
at = ["0 mm", "0 mm", "50 mm"]

[point.work]
on = "table"
at = ["0 mm", "0 mm", "50 mm"]

[axis.Y]
direction = [0, 1, 0]
moving = "table"
at = ["0 mm", "0 mm", "0 mm"]

[axis.Y.drive]
kind = "ball screw"
lead = {LEAD}
motor_inertia = {0.75 * INERTIA}
screw_inertia = {0.25 * INERTIA}
nut_stiffness = "80 N/um"
axial_damping = "2 kN*s/m"

[axis.Y.control]
position = {{ gain = {GAIN}, sample_time = "1 ms" }}
velocity = {{ proportional_gain = "1 N*m*s/rad", integral_time = "40 ms", sample_time = "200 us", torque_limit = "25 N*m" }}
current = {{ kind = "first order", time_constant = "0.4 ms", sample_time = "200 us" }}
"""  # noqa: E501
CASE = """
title = "end mill on a small machine"
[tool]
kind = "end mill"
teeth = 4
diameter = "20 mm"
helix = "0 deg"
[material]
law = "linear"
Ktc = "700 MPa"
Krc = "250 MPa"
Kte = "10 N/mm"
Kre = "10 N/mm"
[cut]
mode = "down"
spindle_speed = "1500 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "5 mm"
[structure]
machine = "machine.toml"
feed = [0, 1, 0]
"""
LINES = np.arange(10.0, 300.0, 4.0)
#: strokes, m, frequency, Hz, and time, s, of sines
SINES = ((10e-3, 1.0, 1.0), (2e-3, 2.0, 1.0), (20e-3, 1.0, 1.0))
NOISE_OF_TORQUE, NOISE_OF_POSITION = 0.02, 0.3e-6


def case_in(path, machine):
    path.mkdir(exist_ok=True)
    (path / "machine.toml").write_text(machine, encoding="utf-8")
    (path / "case.toml").write_text(CASE, encoding="utf-8")
    return load(path / "case.toml")


@pytest.fixture(scope="module")
def truth(tmp_path_factory):
    return case_in(tmp_path_factory.mktemp("truth"), MACHINE + FRICTION)


def moves(path, truth, seed=1) -> str:
    """Part of a set-up: sines of the axis, as its machine makes them, with noise."""
    random = np.random.default_rng(seed)
    text = '[[part]]\nkind = "axis"\n'
    for number, (stroke, frequency, duration) in enumerate(SINES):
        time = np.arange(0.0, duration, 1e-3)
        command = 0.5 * stroke * (1.0 - np.cos(2.0 * math.pi * frequency * time))
        made = recorded_move(truth, "Y", time, command)
        behind = np.interp(time, made.time, (made.wanted - made.motor)[:, 0], left=0.0)
        torque = np.interp(time, made.time, made.effort[:, 0], left=0.0)
        noise = random.standard_normal((2, time.size))
        position = command - behind + NOISE_OF_POSITION * noise[0]
        torque = torque + NOISE_OF_TORQUE * noise[1]
        rows = np.c_[time, 1e3 * command, 1e3 * position, torque]
        head = "time [s],command [mm],position [mm],torque [N*m]"
        file = f"move{number}.csv"
        np.savetxt(path / file, rows, delimiter=",", header=head, comments="")
        text += f'[[part.run]]\nfile = "{file}"\naxis = "Y"\n'
    return text


def taps(path, truth, seed=2) -> str:
    """Part of a set-up: FRFs along the feed, at rest and in motion, with a scatter of 2 %."""
    random = np.random.default_rng(seed)
    text = '[[part]]\nkind = "frf"\n'
    for condition in ("at_rest", "moving"):
        exact = machine_response(truth, condition, "x", "x", LINES)
        for repetition in range(2):
            noise = random.standard_normal((2, LINES.size)) * np.abs(exact) * 0.02 / np.sqrt(2)
            file = f"tap_{condition}_{repetition}.csv"
            rows = np.c_[LINES, exact.real + noise[0], exact.imag + noise[1]]
            head = "frequency [Hz],real [m/N],imag [m/N]"
            np.savetxt(path / file, rows, delimiter=",", header=head, comments="")
            text += f'[[part.run]]\nfile = "{file}"\ncondition = "{condition}"\ndirection = "x"\n'
    return text


def cuts(path, truth, seed=3) -> str:
    """Part of a set-up: forces and displacements of three short cuts, with noise of 2 %."""
    random = np.random.default_rng(seed)
    text = '[[part]]\nkind = "milling"\n'
    for number, (speed, depth) in enumerate(((1500, 1.0), (1800, 0.8), (1300, 1.2))):
        conditions = {"cut.spindle_speed": f"{speed} rpm", "cut.axial_depth": f"{depth} mm"}
        made = chatter.simulate(truth.patch({**conditions, "simulation.revolutions": 3}))
        time = np.arange(0.0, made.time[-1], 4e-4)
        exact = [made.force[:, 0], made.force[:, 1], 1e6 * made.displacement[:, 0]]
        rows = [time]
        for values in exact:
            signal = np.interp(time, made.time, values)
            rows.append(signal + 0.02 * signal.std() * random.standard_normal(time.size))
        head = "time [s],Fx [N],Fy [N],x [um]"
        file = f"cut{number}.csv"
        np.savetxt(path / file, np.array(rows).T, delimiter=",", header=head, comments="")
        text += f'[[part.run]]\nfile = "{file}"\nspindle_speed = "{speed} rpm"\n'
        text += f'axial_depth = "{depth} mm"\n'
    return text


def set_up(path, *parts) -> None:
    text = 'kind = "set-up"\ncase = "case.toml"\n' + "".join(parts)
    (path / "measurement.toml").write_text(text, encoding="utf-8")


def test_torque_and_lag_of_a_steady_move(truth):
    """At constant speed the drive overcomes the friction, and lags by the speed over the gain."""
    speed, acceleration = 0.05, 0.5
    time = np.arange(0.0, 1.0, 1e-3)
    ramp = speed / acceleration
    command = np.where(
        time < ramp, 0.5 * acceleration * time**2, speed * time - 0.5 * acceleration * ramp**2
    )
    made = recorded_move(truth, "Y", time, command)
    steady = made.time > 0.7
    ratio = LEAD / (2.0 * math.pi)
    friction = (COULOMB + VISCOUS * speed) * ratio
    assert made.effort[steady, 0].mean() == pytest.approx(friction, rel=2e-3)
    # a spline through the set points reverses at their end
    lag = (made.wanted - made.motor)[(made.time > 0.7) & (made.time < 0.95), 0]
    assert lag.mean() == pytest.approx(speed / GAIN, rel=0.01)
    # work: kinetic energy, and what the friction took over the way
    power = made.effort[:, 0] * made.velocity[:, 0] / ratio
    at = np.searchsorted(made.time, 0.9)
    work = float(np.sum(power[:at]) * 1e-3)
    way = made.motor[at, 0]
    kinetic = 0.5 * (MASS + INERTIA / ratio**2) * speed**2
    rubbed = COULOMB * way + VISCOUS * float(np.sum(made.velocity[:at, 0] ** 2) * 1e-3)
    assert work == pytest.approx(kinetic + rubbed, rel=0.01)


def test_friction_missing_in_moves_and_frfs(truth, tmp_path):
    """Coulomb friction holds as a spring in FRFs at rest, and is felt by the motor in moves."""
    case_in(tmp_path, MACHINE)
    set_up(tmp_path, moves(tmp_path, truth), taps(tmp_path, truth))
    found = chatter.explain(tmp_path)
    summary = found.summary()
    assert summary["verdict"] == "explained"
    (effect,) = summary["effects"]
    assert effect["name"] == "axis_friction"
    coulomb = effect["parameters"]["coulomb_Y"]
    assert coulomb["ci95"][0] <= COULOMB <= coulomb["ci95"][1]
    assert coulomb["value"] == pytest.approx(COULOMB, rel=0.02)
    assert effect["parameters"]["viscous_Y"]["value"] == pytest.approx(VISCOUS, rel=0.15)
    assert set(summary["error_by_kind"]) == {"drive", "frf"}
    for one in summary["error_by_kind"].values():
        assert one["after"] < 0.5 * one["before"]
        assert one["after"] < 1.2 * one["noise_floor"]
    moved = summary["error_by_kind"]["drive"]
    assert moved["holdout_after"] < 0.5 * moved["holdout_before"]


def test_nothing_is_missing_where_nothing_is(truth, tmp_path):
    case_in(tmp_path, MACHINE + FRICTION)
    parts = (moves(tmp_path, truth, 5), taps(tmp_path, truth, 6))
    set_up(tmp_path, *parts)
    assert chatter.explain(tmp_path).summary()["verdict"] == "nothing-missing"


@pytest.mark.parametrize(
    ("run", "columns", "words"),
    [
        ('axis = "Q"', "time [s],command [mm],torque [N*m]", 'axis: "Q" is none; there are Y'),
        ("", "time [s],torque [N*m]", "column command is missing"),
        ("", "time [s],command [mm],torque [N*m]", "command begins at 10 mm/s"),
    ],
)
def test_moves_that_are_wrong_are_told(tmp_path, run, columns, words):
    case_in(tmp_path, MACHINE)
    time = np.arange(0.0, 0.1, 1e-3)
    rows = np.c_[time, 10.0 * time, np.sin(time)][:, : columns.count(",") + 1]
    np.savetxt(tmp_path / "move.csv", rows, delimiter=",", header=columns, comments="")
    text = f'kind = "axis"\ncase = "case.toml"\n[[run]]\nfile = "move.csv"\n{run}\n'
    (tmp_path / "measurement.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        chatter.explain(tmp_path)
    assert words in str(caught.value)


def test_an_axis_of_a_machine_is_a_drive(tmp_path, truth):
    case_in(tmp_path, MACHINE)
    set_up(tmp_path, moves(tmp_path, truth))
    (part,) = read_measurement(tmp_path).parts
    assert part.kind == "drive"
    assert [run.axis for run in part.runs] == ["Y"] * 3


GAP = 12e-6
NUT = 'axial_damping = "2 kN*s/m"\n'
WITH_GAP = MACHINE.replace(NUT, NUT + f"backlash = {GAP}\n")
#: declared a few percent off, within tolerances
SOFTER = MACHINE.replace("80 N/um", "78 N/um")
TOLERANCES = """
[tolerance]
"machine.axis.Y.drive.nut_stiffness" = 0.05
"machine.friction.guide.coulomb" = 0.05
"""


def test_backlash_missing_in_moves(tmp_path):
    """A gap of 12 um in moves alone, the nut and the friction declared a few percent off."""
    (tmp_path / "truth").mkdir()
    (tmp_path / "declared").mkdir()
    made_by = case_in(tmp_path / "truth", WITH_GAP + FRICTION)
    folder = tmp_path / "declared"
    case_in(folder, SOFTER + FRICTION.replace(f"coulomb = {COULOMB}", "coulomb = 61.5"))
    set_up(folder, TOLERANCES, moves(folder, made_by, 8))
    summary = chatter.explain(folder).summary()
    assert summary["verdict"] == "explained"
    (effect,) = summary["effects"]
    assert effect["name"] == "backlash"
    assert effect["parameters"]["backlash_Y"]["value"] == pytest.approx(GAP, rel=0.02)
    error = summary["error"]
    assert error["holdout_after"] < 0.85 * error["holdout_before"]
    assert error["after"] < 1.2 * error["noise_floor"]


def test_backlash_is_looked_for_where_flanks_move(tmp_path, truth):
    """Of an axis that the records move, on a drive with flanks, where no gap is declared."""

    def found(machine, number):
        folder = tmp_path / str(number)
        folder.mkdir()
        case_in(folder, machine + FRICTION)
        set_up(folder, moves(folder, truth))
        measurement = read_measurement(folder).parts[0]
        return [one for one in candidates(measurement) if one.name == "backlash"], measurement

    ((effect,), measurement) = found(MACHINE, 1)
    (parameter,) = effect.parameters(measurement)
    assert (parameter.name, parameter.unit, parameter.lower) == ("backlash_Y", "m", 0.0)
    patched = measurement.case.patch(effect.patch(measurement.case, {"backlash_Y": 7e-6}))
    assert patched.machine_file().axis["Y"].drive.backlash == 7e-6
    assert found(WITH_GAP, 2)[0] == []


def test_a_friction_that_is_weaker_than_declared(tmp_path):
    """All forces of the friction of the guides are 0.7 of what the file says."""
    (tmp_path / "truth").mkdir()
    (tmp_path / "declared").mkdir()
    weaker = FRICTION.replace(f"{COULOMB}", f"{0.7 * COULOMB}").replace(
        f"{VISCOUS}", f"{0.7 * VISCOUS}"
    )
    made_by = case_in(tmp_path / "truth", MACHINE + weaker)
    folder = tmp_path / "declared"
    case_in(folder, MACHINE + FRICTION)
    set_up(folder, moves(folder, made_by, 2))
    summary = chatter.explain(folder).summary()
    assert summary["verdict"] == "explained"
    (effect,) = summary["effects"]
    assert effect["name"] == "declared_friction"
    assert effect["parameters"]["guide"]["value"] == pytest.approx(0.7, rel=0.02)


@pytest.mark.nightly
def test_a_friction_that_is_higher_at_low_speed(tmp_path):
    """Not declared: 60 N, and 120 N at the onset of sliding, which falls over 15 mm/s."""
    lugre = """
[friction.guide]
law = "lugre"
on = { axis = "Y" }
coulomb = 60.0
static = 120.0
stribeck_velocity = 0.015
viscous = 400.0
bristle_stiffness = 1.2e6
"""
    (tmp_path / "truth").mkdir()
    (tmp_path / "declared").mkdir()
    made_by = case_in(tmp_path / "truth", MACHINE + lugre)
    folder = tmp_path / "declared"
    case_in(folder, MACHINE)
    set_up(folder, moves(folder, made_by, 6))
    summary = chatter.explain(folder).summary()
    assert summary["verdict"] == "explained"
    (effect,) = summary["effects"]
    assert effect["name"] == "axis_friction"
    found = {name: one["value"] for name, one in effect["parameters"].items()}
    assert found["coulomb_Y"] == pytest.approx(60.0, rel=0.05)
    assert found["onset_Y"] == pytest.approx(60.0, rel=0.05)
    assert found["stribeck_velocity_Y"] == pytest.approx(0.015, rel=0.1)
    assert found["viscous_Y"] == pytest.approx(400.0, rel=0.15)
