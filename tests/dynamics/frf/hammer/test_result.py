"""A set of hammer records examined and averaged: what is used, left out, kept."""

from dataclasses import replace

import numpy as np
import pytest

from chatter.io.hammer_records import read_hammer_folder
from dynamics.frf.container import MeasurementError
from dynamics.frf.hammer.averaging import hammer_test
from dynamics.frf.hammer.spectra import h2
from tests.dynamics.frf.hammer import hammer_records as made

CLOSE = made.CLOSE


def records(count=6, seed=0):
    rng = np.random.default_rng(seed)
    return [
        made.record_of(rng, CLOSE, [made.random_hit(rng)], made.Noise(), f"tap{i + 1}.csv")
        for i in range(count)
    ]


def with_doubled_gain(taps, place=1):
    return [replace(r, response=2 * r.response) if i == place else r for i, r in enumerate(taps)]


def level(frf):
    band = frf.band(500.0, 1700.0)
    exact = CLOSE.accelerance(band.frequency)
    return np.vdot(exact, band.values) / np.vdot(exact, exact)


def test_the_faulty_is_left_out_and_the_average_is_right():
    test = hammer_test(with_doubled_gain(records()))
    assert test.used == ("tap1.csv", "tap3.csv", "tap4.csv", "tap5.csv", "tap6.csv")
    assert [(f.record, f.fault) for f in test.excluded] == [("tap2.csv", "wrong_gain")]
    assert level(test.frf) == pytest.approx(1.0, abs=2e-3)
    assert test.kept == test.remarks == ()


def test_keep_overrides():
    taps = with_doubled_gain(records())
    test = hammer_test(taps, keep=["tap2.csv"])
    assert len(test.used) == 6
    assert [f.record for f in test.kept] == ["tap2.csv"]
    assert test.excluded == ()
    # H1 weighs each record, line by line, by the power of its blow
    lines = test.frf.band(500.0, 1700.0).frequency
    turns = np.exp(-2j * np.pi * np.outer(lines, taps[0].time))
    power = np.abs([turns @ np.where(r.force > 3.0, r.force, 0.0) for r in taps]) ** 2
    weight = np.abs(CLOSE.accelerance(lines)) ** 2
    expected = 1 + np.sum(weight * power[1] / power.sum(axis=0)) / weight.sum()
    assert level(test.frf).real == pytest.approx(expected, rel=2e-3)


def test_a_kept_double_hit_keeps_both_blows():
    rng = np.random.default_rng(1)
    first = made.random_hit(rng)
    second = replace(first, start=first.start + 0.03, peak=0.6 * first.peak)
    taps = records(3)
    twice = made.record_of(rng, CLOSE, [first, second], made.Noise(), "twice.csv")
    test = hammer_test([*taps, twice], keep=["twice.csv"])
    assert [f.fault for f in test.kept] == ["double_hit"]
    assert level(test.record_frfs[-1]) == pytest.approx(1.0, abs=5e-3)


def test_each_record_alone_has_the_lines_of_the_average():
    test = hammer_test(records(4))
    assert len(test.record_frfs) == 4
    for frf in test.record_frfs:
        np.testing.assert_array_equal(frf.frequency, test.frf.frequency)
        assert level(frf) == pytest.approx(1.0, abs=5e-3)


def test_what_a_fit_takes_is_the_average_in_band():
    test = hammer_test(records())
    (frf,) = test.frfs
    assert frf.frequency[0] >= test.usable_band[0]
    assert frf.frequency[-1] <= test.usable_band[1]
    assert frf.coherence.shape == frf.frequency.shape


def test_the_other_estimator_lies_above():
    taps = records()
    low, high = hammer_test(taps).frf, hammer_test(taps, estimator=h2).frf
    assert np.all(np.abs(high.values) >= np.abs(low.values) * (1 - 1e-12))


def test_wrong_keeps_are_refused():
    taps = records(3)
    with pytest.raises(MeasurementError, match=r"no record 'tap9.csv'.*tap1.csv, tap2.csv"):
        hammer_test(taps, keep=["tap9.csv"])
    rng = np.random.default_rng(0)
    taps[1] = replace(taps[1], force=rng.standard_normal(12800))
    with pytest.raises(MeasurementError, match=r"tap2.csv cannot be kept: no hit"):
        hammer_test(taps, keep=["tap2.csv"])


def test_no_good_record_left():
    rng = np.random.default_rng(0)
    taps = [replace(r, force=rng.standard_normal(12800)) for r in records(2)]
    with pytest.raises(MeasurementError, match=r"no good record among 2: tap1.csv: no hit.*tap2"):
        hammer_test(taps)


def test_a_folder_with_a_file_that_cannot_be_read(tmp_path):
    for record in records(4):
        columns = np.stack([record.time, record.force, record.response], axis=1)
        head = "time [s],force [N],acceleration [m/s^2]"
        np.savetxt(
            tmp_path / record.name,
            columns,
            fmt=["%.7f", "%.3f", "%.4f"],
            delimiter=",",
            header=head,
            comments="",
        )
    (tmp_path / "tap0.csv").write_text("time [s],force [N],acceleration [m/s^2]\n0,1,nan\n")
    (tmp_path / "notes.md").write_text("words\n")
    folder = read_hammer_folder(tmp_path)
    test = hammer_test(folder.records, unreadable=folder.unreadable)
    assert test.used == ("tap1.csv", "tap2.csv", "tap3.csv", "tap4.csv")
    assert [(f.record, f.fault) for f in test.excluded] == [("tap0.csv", "unreadable")]
    assert "line 2" in test.excluded[0].reason
    with pytest.raises(MeasurementError, match=r"tap0.csv cannot be kept"):
        hammer_test(folder.records, keep=["tap0.csv"], unreadable=folder.unreadable)
