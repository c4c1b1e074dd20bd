"""MAT files that programs write: functions of Testlab, and several plain matrices."""

import numpy as np
import pytest
import scipy.io

from chatter.description.errors import InputError
from chatter.io.formats.format_list import read_frfs
from chatter.io.signals import read_signals

STEP = 1.0 / 2048.0
FORCE = np.array([0.0, 20.0, 5.0, 0.0, 0.0, 0.0])
MOTION = np.array([0.0, 1.0, 3.0, -2.0, 1.0, -0.5])
COLUMNS = "time [ms], force [kN], acceleration [g]"


def function(values, name, unit, step=STEP, axis_unit="s", start=0.0):
    return {
        "x_values": {
            "start_value": start,
            "increment": step,
            "number_of_values": float(len(values)),
            "quantity": {"label": axis_unit},
        },
        "y_values": {"values": values, "quantity": {"label": unit}},
        "function_record": {"name": name, "type": "Time"},
    }


def saved(path, **variables):
    scipy.io.savemat(path, variables)
    return path


def matrix(scale):
    return np.column_stack([np.arange(6) * 0.5, scale * FORCE, scale * MOTION])


def test_functions_of_testlab_are_channels_in_their_units(tmp_path):
    path = saved(
        tmp_path / "tap.mat",
        Signal_0=function(FORCE, "Force", "kN", start=0.25),
        Signal_1=function(MOTION, "Acc", "g", start=0.25),
    )
    found = read_signals(path)
    np.testing.assert_allclose(found["time"], 0.25 + STEP * np.arange(6))
    np.testing.assert_allclose(found["force"], 1e3 * FORCE)
    np.testing.assert_allclose(found["Acc"], 9.80665 * MOTION)


def test_channels_of_one_function_have_their_names(tmp_path):
    names = np.array(["Left", "Right"], dtype=object)
    both = function(np.column_stack([MOTION, 2.0 * MOTION]), names, "m/s^2")
    found = read_signals(saved(tmp_path / "cut.mat", Signal=both))
    assert list(found) == ["time", "Left", "Right"]
    np.testing.assert_allclose(found["Right"], 2.0 * MOTION)


def test_functions_of_other_times_are_records(tmp_path):
    path = saved(
        tmp_path / "two.mat",
        Run_1=function(FORCE, "Force", "N"),
        Run_2=function(MOTION, "Force", "N", step=2.0 * STEP),
    )
    with pytest.raises(InputError, match=r"holds 2 records: Run_1, Run_2; name one"):
        read_signals(path)
    found = read_signals(path.with_name("two.mat#Run_2"))
    assert found["time"][1] == pytest.approx(2.0 * STEP)
    np.testing.assert_allclose(found["force"], MOTION)


def test_frfs_of_testlab_are_read(tmp_path):
    response = np.array([1.0 + 0.5j, 2.0 - 1.0j, -1.0 - 3.0j, 0.5 - 0.2j])
    path = saved(
        tmp_path / "frf.mat",
        FRF=function(response, "Tool:1:+X/Tool:1:+X", "(m/s^2)/N", 2.5, "Hz", 10.0),
    )
    (frf,) = read_frfs(path)
    np.testing.assert_allclose(frf.frequency, [10.0, 12.5, 15.0, 17.5])
    np.testing.assert_allclose(frf.values, response)
    assert frf.quantity == "accelerance"


@pytest.mark.parametrize(
    ("axis", "message"),
    [
        ({"axis_unit": "rpm"}, "unit 'rpm' of the axis; s and Hz are read"),
        ({"step": 0.0}, "increment above zero"),
    ],
)
def test_an_axis_that_is_not_read_is_named(tmp_path, axis, message):
    path = saved(tmp_path / "order.mat", Order=function(MOTION, "Acc", "g", **axis))
    with pytest.raises(InputError, match=rf"order\.mat: Order\.x_values.*{message}"):
        read_signals(path)


def test_matrices_with_a_time_of_their_own_are_records(tmp_path):
    path = saved(tmp_path / "taps.mat", A=matrix(1.0), B=matrix(3.0))
    with pytest.raises(InputError, match=r'holds 2 records: A, B; name one, ".*taps.mat#A"'):
        read_signals(path, columns=COLUMNS)
    found = read_signals(path.with_name("taps.mat#B"), columns=COLUMNS)
    np.testing.assert_allclose(found["time"], np.arange(6) * 0.5e-3)
    np.testing.assert_allclose(found["force"], 3e3 * FORCE)
    np.testing.assert_allclose(found["acceleration"], 3.0 * 9.80665 * MOTION)


def test_matrices_without_a_time_stay_columns_of_one_record(tmp_path):
    path = saved(tmp_path / "one.mat", F=matrix(1.0)[:, 1:], A=matrix(2.0)[:, 1:], fs=1000.0)
    stated = "time [s], F1 [N], F2 [N], A1 [m/s^2], A2 [m/s^2]"
    found = read_signals(path, columns=stated)
    np.testing.assert_allclose(found["A2"], 2.0 * MOTION)
