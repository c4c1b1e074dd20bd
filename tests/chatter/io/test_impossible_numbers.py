"""Numbers that no instrument records are refused by file and place, not computed with."""

import numpy as np
import pytest
import scipy.io

from chatter.io.formats.format_list import read_frfs
from chatter.io.hammer_records import read_hammer_record
from dynamics.frf.container import Frf, MeasurementError


def blow(count=4096, rate=51200.0):
    """Time, force and acceleration of a mass on a spring that is struck, as files hold them."""
    time = np.arange(count) / rate
    force = np.where(time < 4e-4, np.sin(np.pi * time / 4e-4) * 100.0, 0.0)
    return time, force, np.exp(-50.0 * time) * np.sin(2.0 * np.pi * 800.0 * time)


def test_a_damaged_line_of_a_table_is_named(tmp_path):
    file = tmp_path / "tap.csv"
    rows = [f"{t:.9f},{f:.6g},{a:.6g}" for t, f, a in zip(*blow(), strict=True)]
    rows[9] = "0.000175781,1e300,0"
    file.write_text("time [s],force [N],acceleration [m/s^2]\n" + "\n".join(rows) + "\n")
    with pytest.raises(MeasurementError, match=r"tap\.csv: line 11: 1e\+300 is no measured number"):
        read_hammer_record(file)


def test_a_damaged_line_of_an_frf_is_named():
    frequency = np.arange(10.0, 20.0)
    values = np.full(10, 1e-7 + 0j)
    values[3] = 1e300
    with pytest.raises(MeasurementError, match=r"beam: line 4 of the FRF, 1e\+300 at 13 Hz"):
        Frf(frequency, values, source="beam")


def test_a_gap_marked_in_a_table_of_frfs_is_named(tmp_path):
    file = tmp_path / "tip.csv"
    rows = [f"{f},{1e-7},{0.0}" for f in range(10, 40)]
    rows[4] = "14,9.96921e+36,0"
    file.write_text("frequency [Hz],real [m/N],imag [m/N]\n" + "\n".join(rows) + "\n")
    with pytest.raises(MeasurementError, match=r"tip\.csv: line 6: 9\.96921e\+36"):
        read_frfs(file)


@pytest.mark.parametrize("scale", [1e-200, 1e-12])
def test_times_that_no_recorder_takes_are_questioned(tmp_path, scale):
    time, force, acceleration = blow()
    file = tmp_path / "tap.mat"
    named = {"time_s": time * scale, "force_N": force, "acceleration_m_s2": acceleration}
    scipy.io.savemat(file, named)
    with pytest.raises(MeasurementError, match=r"tap\.mat: .*unit of the time"):
        read_hammer_record(file)


def test_an_frf_that_no_instrument_tells_from_nothing_is_refused(tmp_path):
    frequency = np.linspace(100.0, 2000.0, 400)
    values = 1e-200 / (900.0**2 - frequency**2 + 40j * frequency)
    path = tmp_path / "tap.npz"
    columns = {"frequency [Hz]": frequency, "real [m/N]": values.real, "imag [m/N]": values.imag}
    np.savez(path, **columns)
    with pytest.raises(MeasurementError, match=r"tap\.npz.*: the FRF is .* no instrument tells"):
        read_frfs(path)


def test_an_frf_of_no_frequency_is_refused():
    frequency = np.arange(10.0, 20.0) * 1e-200
    with pytest.raises(
        MeasurementError, match=r"beam: the last line of the FRF is at 1\.9e-199 Hz"
    ):
        Frf(frequency, np.full(10, 1e-7 + 0j), source="beam")
