"""Columns of drive records: what headings tell, what is asked for, and motor against slide."""

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.drive_friction.drive_records import DriveSettings, drive_records

#: of the recorded axis
LEAD, TORQUE_CONSTANT, RATED = 0.01, 0.8, 2.5
TIME = np.arange(0.0, 1.0, 1e-3)
POSITION = 0.05 * (1.0 - np.cos(2.0 * np.pi * TIME))
VELOCITY = 0.05 * 2.0 * np.pi * np.sin(2.0 * np.pi * TIME)
FORCE = 200.0 * np.sign(VELOCITY) + 300.0 * VELOCITY
#: torque x angle = force x travel: N m for a newton at 10 mm a revolution
TORQUE = FORCE * LEAD / (2.0 * np.pi)


def write(path, heading, *columns):
    np.savetxt(path, np.column_stack(columns), "%.9g", ",", header=heading, comments="")
    return path


def one(path, **settings):
    found = drive_records([path], DriveSettings(**settings))
    return found.records[0], found.rotary


@pytest.mark.parametrize(
    ("heading", "columns", "settings"),
    [
        ("time [s],position [mm],force [N]", (TIME, 1e3 * POSITION, FORCE), {}),
        (
            "time [s],X set [m],X motor [m],X scale [m],X tool [m],X velocity [m/s],X effort [N*m]",
            (TIME, 0.0 * FORCE, POSITION, POSITION, POSITION, VELOCITY, TORQUE),
            {"lead": LEAD},
        ),
        ("t [ms],velocity [mm/s],force [kN]", (1e3 * TIME, 1e3 * VELOCITY, 1e-3 * FORCE), {}),
        (
            "time [s],motor speed [rpm],torque [Nm]",
            (TIME, 60.0 * VELOCITY / LEAD, TORQUE),
            {"lead": LEAD},
        ),
        (
            "time [us],v act. X [m/min],i act. X [A]",
            (1e6 * TIME, 60.0 * VELOCITY, TORQUE / TORQUE_CONSTANT),
            {"lead": LEAD, "torque_constant": TORQUE_CONSTANT},
        ),
        (
            "time [ms],Servo motor speed [r/min],Torque [%]",
            (1e3 * TIME, 60.0 * VELOCITY / LEAD, 100.0 * TORQUE / RATED),
            {"lead": LEAD, "rated_torque": RATED},
        ),
        (
            "t/ms,s actual X/mm,v nominal X/(mm/min),v actual X/(mm/min),I actual X/A",
            (1e3 * TIME, 1e3 * POSITION, 0.0 * FORCE, 6e4 * VELOCITY, TORQUE / TORQUE_CONSTANT),
            {"lead": LEAD, "torque_constant": TORQUE_CONSTANT},
        ),
        (
            "tempo (s),posizione X (mm),velocità (mm/s),forza (N)",
            (TIME, 1e3 * POSITION, 1e3 * VELOCITY, FORCE),
            {},
        ),
        (
            "Temps/ms,position/mm,vitesse de consigne/(mm/s),vitesse/(mm/s),couple/Nm",
            (1e3 * TIME, 1e3 * POSITION, 0.0 * FORCE, 1e3 * VELOCITY, TORQUE),
            {"lead": LEAD},
        ),
        (
            "time [s],s act. Y [mm],load [A]",
            (TIME, 1e3 * POSITION, -FORCE / 90.0),
            {"effort": "-load", "force_constant": 90.0},
        ),
        (
            "time [s],s act. Y [mm],load,force command [N]",
            (TIME, 1e3 * POSITION, FORCE, 0.0 * FORCE),
            {"effort": "load [N]"},
        ),
    ],
)
def test_the_same_motion_however_it_was_recorded(tmp_path, heading, columns, settings):
    record, rotary = one(write(tmp_path / "move.csv", heading, *columns), **settings)
    assert not rotary
    np.testing.assert_allclose(record.effort, FORCE, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(record.velocity, VELOCITY, atol=2e-3)
    np.testing.assert_allclose(record.position, POSITION, atol=1e-5)


def test_without_a_lead_a_motor_stays_in_radians(tmp_path):
    path = write(tmp_path / "m.csv", "time [s],n act [1/min],torque [N*m]", TIME, 600.0 * VELOCITY,
                 TORQUE)  # fmt: skip
    record, rotary = one(path)
    assert rotary
    np.testing.assert_allclose(record.velocity, 20.0 * np.pi * VELOCITY, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(record.effort, TORQUE, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("heading", "settings", "told"),
    [
        ("time [s],velocity [mm/s],load", {}, "say which column it is by --effort"),
        ("time [s],height [mm],force [N]", {}, "say which column it is by --velocity"),
        ("time [s],v act. X [mm/s],torque", {}, '"torque" has no unit; effort is in units of N'),
        ("time [s],v act. X [N],force [N]", {}, '"v act. X [N]" has the unit "N"; velocity is in'),
        ("time [s],velocity [mm/s],torque [%]", {}, "its size is missing: --rated-torque"),
        ("time [s],velocity [mm/s],current [A]", {}, "its size is missing: --torque-constant"),
        ("time [s],velocity [mm/s],torque [N*m]", {}, "travel for a revolution of the motor"),
        ("sample,velocity [mm/s],force [N]", {}, "no column of time"),
        ("time [N],velocity [mm/s],force [N]", {}, "a time is in s, ms or us"),
        ("time [s],velocity [mm/s],force [N]", {"effort": "torque"}, "no column is so headed"),
    ],
)
def test_what_a_file_does_not_tell_is_asked_for(tmp_path, heading, settings, told):
    path = write(tmp_path / "move.csv", heading, TIME, VELOCITY, FORCE)
    with pytest.raises(InputError) as refused:
        one(path, **settings)
    assert str(path) in str(refused.value)
    assert told in str(refused.value)


def test_two_columns_of_a_role_are_not_guessed_between(tmp_path):
    path = write(tmp_path / "m.csv", "time [s],v act. X [mm/s],v act. Y [mm/s],force [N]", TIME,
                 1e3 * VELOCITY, VELOCITY, FORCE)  # fmt: skip
    with pytest.raises(InputError, match=r'"v act. Y \[mm/s\]" may each be the velocity; say whic'):
        one(path)
    record, _ = one(path, velocity="v act. X")
    np.testing.assert_allclose(record.velocity, VELOCITY, atol=1e-8)


def test_records_of_different_motions_are_refused(tmp_path):
    slide = write(tmp_path / "a.csv", "time [s],velocity [m/s],force [N]", TIME, VELOCITY, FORCE)
    motor = write(tmp_path / "b.csv", "time [s],speed [rad/s],torque [N*m]", TIME, VELOCITY, FORCE)
    with pytest.raises(InputError, match=r"b.csv: is about the motor, .*a.csv is along the slide"):
        drive_records([slide, motor])
