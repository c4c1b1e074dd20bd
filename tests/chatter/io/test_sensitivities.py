"""Files with volts: the sensitivity that the user states gives the quantity; it is asked for."""

import numpy as np
import pytest
import scipy.io.wavfile

from chatter.description.errors import InputError
from chatter.io.hammer_records import read_hammer_record
from chatter.io.signals import read_signals
from chatter.monitoring.detect import detect
from chatter.studies.modal_test import modes
from dynamics.frf.container import MeasurementError
from tests.chatter.io.formats.test_files_people_have import (
    ACCELERATION,
    FORCE,
    GRAVITY,
    TIME,
    as_lvm,
    assert_is_the_record,
)

#: of a hammer with 2.25 mV/N and a sensor with 10 mV/g
FORCE_MV, ACCELERATION_MV = 2.25 * FORCE, 10.0 * ACCELERATION / GRAVITY
STATED = "time [s], force [2.25 mV/N], acceleration [10 mV/g]"


def as_text(path, heading, scale):
    rows = np.column_stack([TIME, scale * FORCE_MV, scale * ACCELERATION_MV])
    np.savetxt(path, rows, delimiter=",", header=heading, comments="", fmt="%.12g")
    return path


@pytest.mark.parametrize(
    ("heading", "scale"),
    [
        ("Time [s],Hammer [mV],Acc [mV]", 1.0),
        ("Time [s],Hammer [V],Acc [V]", 1e-3),
        ("Time,Hammer,Acc", 1e-3),  # no unit is volts
    ],
)
@pytest.mark.parametrize(
    "stated", [STATED, "time [s], force [444.4444444 N/V], acceleration [100 g/V]"]
)
def test_volts_are_forces_and_accelerations_by_their_sensitivities(
    tmp_path, heading, scale, stated
):
    path = as_text(tmp_path / "tap.csv", heading, scale)
    assert_is_the_record(read_hammer_record(path, columns=stated))


def test_volts_of_labview(tmp_path):
    path = as_lvm(tmp_path / "tap.lvm")
    text = path.read_text(encoding="utf-8").replace("kN\tg", "Volts\tVolts")
    path.write_text(text, encoding="utf-8")
    # the file has kN and g as volts
    record = read_hammer_record(path, columns="time [s], force [1 mV/N], acceleration [1 V/g]")
    assert_is_the_record(record)


def test_volts_are_not_taken_for_newtons(tmp_path):
    path = as_text(tmp_path / "tap.csv", "Time [s],Hammer [mV],Acc [mV]", 1.0)
    with pytest.raises(MeasurementError, match=r"column 2 is in mV .* \[2\.5 mV/N\]"):
        read_hammer_record(path, columns="time [s], force [N], acceleration [m/s^2]")


def test_a_sensitivity_of_what_is_no_voltage_is_refused(tmp_path):
    path = as_text(tmp_path / "tap.csv", "Time [s],Hammer [N],Acc [mV]", 1.0)
    with pytest.raises(MeasurementError, match="column 2 is in N in the file"):
        read_hammer_record(path, columns=STATED)


def test_forces_in_volts_are_read_by_a_sensitivity_and_ask_for_it(tmp_path):
    path = as_text(tmp_path / "cut.csv", "Time [s],Fx [mV],ax [mV]", 1.0)
    found = read_signals(path, columns="time [s], Fx [2.25 mV/N], ax [10 mV/g]")
    np.testing.assert_allclose(found["Fx"], FORCE, atol=1e-6)
    np.testing.assert_allclose(found["ax"], ACCELERATION, atol=1e-6)
    with pytest.raises(
        InputError, match=r'a force is required.*"Fx \[500 N/V\]".*columns of the run'
    ):
        read_signals(path)


def test_modes_of_volts_ask_for_the_sensitivities(tmp_path):
    path = as_text(tmp_path / "tap.csv", "Time [s],Hammer [mV],Acc [mV]", 1.0)
    with pytest.raises(InputError, match=r"of volts state the sensitivities: --columns"):
        modes([path])


def as_sound(path):
    """Force and acceleration in 16 bits, of which full scale is 4000 N and 2000 m/s^2."""
    shares = np.column_stack([FORCE / 4000.0, ACCELERATION / 2000.0])
    rate = round(1.0 / (TIME[1] - TIME[0]))
    scipy.io.wavfile.write(path, rate, np.round(shares * 32768.0).astype(np.int16))
    return path


def test_a_share_of_full_scale_is_a_force_by_what_full_scale_is(tmp_path):
    assert np.abs(FORCE).max() < 4000.0
    assert np.abs(ACCELERATION).max() < 2000.0
    path = as_sound(tmp_path / "cut.wav")
    found = read_signals(path, columns="time [s], Fx [4000 N/FS], ax [0.5 FS/(km/s^2)]")
    np.testing.assert_allclose(found["Fx"], FORCE, atol=4000.0 / 32768.0)
    np.testing.assert_allclose(found["ax"], ACCELERATION, atol=2000.0 / 32768.0)


def test_a_share_of_full_scale_is_not_taken_for_newtons(tmp_path):
    path = as_sound(tmp_path / "cut.wav")
    with pytest.raises(InputError, match=r"column 2 is a share of full scale .*\[250 N/FS\]"):
        detect(path, "1000 rpm", 2, columns="time [s], force [N], ax [m/s^2]")
    with pytest.raises(InputError, match=r"a sensitivity above zero, of full scale"):
        detect(path, "1000 rpm", 2, columns="time [s], force [2 mV/N], ax [1 m/s^2/FS]")
    # without a unit it stays what it is
    assert read_signals(path, columns="time [s], left, right").keys() == {"time", "left", "right"}
