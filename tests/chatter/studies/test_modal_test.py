"""Folders of raw hammer records: faults found, good ones kept, modes as they were made."""

import numpy as np
import pytest

import chatter
from chatter.description.errors import InputError
from tests.dynamics.frf.hammer import hammer_records as made


def write_set(folder, seed):
    """Seven records of three modes, two of them close, as CSV; names of the two faulty ones."""
    rng = np.random.default_rng(seed)
    faults = {"tap2.csv": made.double_hit, "tap5.csv": made.clipped}
    for number in range(1, 8):
        hit, name = made.random_hit(rng), f"tap{number}.csv"
        if name in faults:
            record = faults[name](rng, made.CLOSE, hit, made.Noise(), name).record
        else:
            record = made.record_of(rng, made.CLOSE, [hit], made.Noise(), name)
        time = np.arange(record.force.size) / record.sampling_rate
        np.savetxt(
            folder / name,
            np.column_stack((time, record.force, record.response)),
            delimiter=",", header="time [s],force [N],acceleration [m/s^2]", comments="",
        )  # fmt: skip
    return set(faults)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_hammer_sets(tmp_path, seed):
    faulty = write_set(tmp_path, seed)
    test = chatter.modes(tmp_path, direction="x")
    # every faulty record found, no good one lost
    assert {finding.record for finding in test.hammer.excluded} == faulty
    found = [mode for mode in test.fit.identified if not mode.warning]
    assert len(found) == len(made.CLOSE.modes)
    for mode, (frequency, damping, mass) in zip(found, made.CLOSE.modes, strict=True):
        assert mode.frequency == pytest.approx(frequency, rel=0.002)
        assert mode.damping == pytest.approx(damping, rel=0.05)
        assert mode.mass == pytest.approx(mass, rel=0.03)


def test_a_faulty_record_can_be_kept(tmp_path):
    faulty = min(write_set(tmp_path, 0))
    test = chatter.modes(tmp_path, keep=[faulty], direction="x")
    assert faulty in test.hammer.used
    assert faulty not in {finding.record for finding in test.hammer.excluded}


def test_unknown_record_to_keep(tmp_path):
    write_set(tmp_path, 0)
    with pytest.raises(InputError, match=r"tap99\.csv"):
        chatter.modes(tmp_path, keep=["tap99.csv"])


def test_keep_belongs_to_hammer_records(tmp_path):
    with pytest.raises(InputError, match="hammer records"):
        chatter.modes(tmp_path / "x.csv", keep=["a"])


def test_empty_folder(tmp_path):
    with pytest.raises(InputError, match="no hammer record"):
        chatter.modes(tmp_path)


def test_single_hammer_record_without_a_heading(tmp_path):
    """One file is as good as a folder; stated columns and units are those of the result."""
    write_set(tmp_path, 0)
    rows = np.loadtxt(tmp_path / "tap1.csv", delimiter=",", skiprows=1)
    path = tmp_path / "tap.txt"
    np.savetxt(path, rows * [1e3, 1e-3, 1.0])
    with_heading = chatter.modes(tmp_path / "tap1.csv", direction="x")
    test = chatter.modes(path, direction="x", columns="t [ms], force [kN], a [m/s^2]")
    assert test.hammer.used == ("tap.txt",)
    for one in (test, with_heading):
        for frequency, _, mass in made.CLOSE.modes:
            nearest = min(one.fit.identified, key=lambda m: abs(m.frequency - frequency))
            assert nearest.frequency == pytest.approx(frequency, rel=0.005)
            assert nearest.mass == pytest.approx(mass, rel=0.1)


def test_poles_given_are_the_modes(tmp_path):
    write_set(tmp_path, 0)
    first, _, third = made.CLOSE.modes
    poles = [(1.004 * f, 1.2 * z) for f, z, _ in (first, third)]
    found = chatter.modes(tmp_path, direction="x", poles=poles).fit.identified
    assert [mode.frequency for mode in found] == pytest.approx([first[0], third[0]], rel=0.01)


@pytest.mark.parametrize("pole", [(0.0, 0.1), (700.0, 1.5)])
def test_poles_out_of_range(tmp_path, pole):
    write_set(tmp_path, 0)
    with pytest.raises(InputError, match="damping ratio between"):
        chatter.modes(tmp_path, poles=[pole])
