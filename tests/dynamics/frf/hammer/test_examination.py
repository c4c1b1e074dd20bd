"""Faulty hammer records are found and named, good ones are kept.

The long study over hundreds of sets is benchmarks/hammer_examination.py.
"""

from dataclasses import replace

import numpy as np
import pytest

from dynamics.frf.hammer.examine import examine_records
from tests.dynamics.frf.hammer import hammer_records as made

CLOSE = made.CLOSE
RATE = made.SAMPLING_RATE


def good_set(count=6, seed=0, noise=None):
    rng = np.random.default_rng(seed)
    noise = made.Noise() if noise is None else noise
    return [
        made.record_of(rng, CLOSE, [made.random_hit(rng)], noise, f"tap{i + 1}")
        for i in range(count)
    ]


def onset(record):
    return int(np.argmax(record.force > 0.05 * record.force.max()))


def with_fault(change, place=2, count=6, seed=0):
    """A good set with one record changed; the findings about it, none about the others."""
    records = good_set(count, seed)
    records[place] = change(records[place])
    findings = examine_records(records)
    assert {finding.record for finding in findings} == {records[place].name}
    return findings


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("fault", sorted(made.FAULTS))
def test_every_kind_of_fault_is_found_and_no_good_record_lost(fault, seed):
    rng = np.random.default_rng([seed, sorted(made.FAULTS).index(fault)])
    _, taps = made.random_set(rng, faults=[fault, fault], count=7)
    found = {f.record for f in examine_records([tap.record for tap in taps]) if f.is_decisive}
    assert found == {tap.record.name for tap in taps if tap.fault}


@pytest.mark.parametrize("seed", range(6))
def test_real_sensors_and_an_unsteady_hand(seed):
    rng = np.random.default_rng([77, seed])
    _, taps = made.random_set(rng, sensors="real", scatter=0.01)
    found = {f.record for f in examine_records([tap.record for tap in taps])}
    assert found == {tap.record.name for tap in taps if tap.fault}


def test_three_of_six_faulty_do_not_outvote_the_good():
    rng = np.random.default_rng(3)
    _, taps = made.random_set(rng, faults=["wrong_gain", "skew", "late_bump"], count=6)
    found = {f.record for f in examine_records([tap.record for tap in taps])}
    assert found == {tap.record.name for tap in taps if tap.fault}


# ------------------------------------------------------------------ one fault each, with evidence


def test_double_hit():
    def bounce(record):
        blow = np.roll(record.force, 512)
        return replace(record, force=record.force + 0.3 * np.where(blow > 5.0, blow, 0.0))

    (finding,) = with_fault(bounce)
    assert finding.fault == "double_hit"
    share = float(finding.reason.split("(")[1].split("%")[0])
    assert share == pytest.approx(30.0, abs=1.0)
    assert "20.0 ms after" in finding.reason


def test_two_humps_within_one_blow():
    def hump(record):
        blow = np.roll(record.force, 14)
        return replace(record, force=record.force + 0.6 * np.where(blow > 5.0, blow, 0.0))

    (finding,) = with_fault(hump)
    assert finding.fault == "double_hit"
    assert "two humps" in finding.reason


@pytest.mark.parametrize("share", [0.5, 0.9])
@pytest.mark.parametrize("channel", ["force", "response"])
def test_clipping(channel, share):
    def clip(record):
        signal = getattr(record, channel)
        limit = share * np.max(np.abs(signal))
        return replace(record, **{channel: np.clip(signal, -limit, limit)})

    (finding,) = with_fault(clip)
    assert finding.fault == "clipped"
    assert channel in finding.reason


@pytest.mark.parametrize("channel", ["force", "response"])
@pytest.mark.parametrize("length", [1, 2, 5])
def test_dropout(channel, length):
    def spike(record):
        signal = getattr(record, channel).copy()
        signal[5000 : 5000 + length] = -0.15 * np.max(signal)
        return replace(record, **{channel: signal})

    (finding,) = with_fault(spike)
    assert finding.fault == "dropout"
    assert "195." in finding.reason  # 5000 samples at 25.6 kHz, ms


def test_a_small_spike_within_the_ringing():
    def spike(record):
        signal = record.response.copy()
        signal[onset(record) + 60] += 0.08 * np.max(np.abs(signal))
        return replace(record, response=signal)

    (finding,) = with_fault(spike)
    assert finding.fault == "dropout"


@pytest.mark.parametrize("channel", ["force", "response"])
@pytest.mark.parametrize("shape", ["ramp", "step"])
def test_drift(channel, shape):
    def drift(record):
        signal = getattr(record, channel)
        x = np.linspace(0.0, 1.0, signal.size)
        moved = {"ramp": x, "step": np.clip((x - 0.5) * 40, 0, 1)}[shape]
        return replace(record, **{channel: signal + 0.02 * np.max(signal) * moved})

    (finding,) = with_fault(drift)
    assert finding.fault == "drift"
    assert channel in finding.reason


@pytest.mark.parametrize("channel", ["force", "response"])
def test_stuck_samples(channel):
    def stick(record):
        signal = getattr(record, channel).copy()
        start = onset(record) + 40
        signal[start : start + 30] = signal[start]
        return replace(record, **{channel: signal})

    (finding,) = with_fault(stick)
    assert finding.fault == "stuck_samples"
    assert "30 samples" in finding.reason


@pytest.mark.parametrize(
    ("factor", "said"), [(2.0, "2 times"), (0.9, "0.9"), (9.80665, "g taken"), (1e-3, "thousand")]
)
def test_wrong_gain(factor, said):
    (finding,) = with_fault(lambda r: replace(r, response=factor * r.response))
    assert finding.fault == "wrong_gain"
    assert said in finding.reason


@pytest.mark.parametrize("channel", ["force", "response"])
def test_wrong_polarity(channel):
    (finding,) = with_fault(lambda r: replace(r, **{channel: -getattr(r, channel)}))
    assert finding.fault == "wrong_polarity"


@pytest.mark.parametrize("shift", [-1, 1, 3, 40])
def test_trigger_skew(shift):
    (finding,) = with_fault(lambda r: replace(r, response=np.roll(r.response, shift)))
    assert finding.fault == "trigger_skew"
    assert f"{abs(shift)}." in finding.reason
    assert ("late" if shift > 0 else "early") in finding.reason


def test_a_skew_of_half_a_sample():
    def delay(record):
        spectrum = np.fft.rfft(record.response)
        lines = np.fft.rfftfreq(record.response.size)
        return replace(record, response=np.fft.irfft(spectrum * np.exp(-1j * np.pi * lines)))

    (finding,) = with_fault(delay)
    assert finding.fault == "trigger_skew"
    assert "(0.5" in finding.reason


def test_late_bump():
    def bump(record):
        time = record.time - 0.2
        burst = np.exp(-300 * time) * np.sin(2 * np.pi * 660 * time) * (time > 0)
        return replace(record, response=record.response + 0.06 * record.response.max() * burst)

    (finding,) = with_fault(bump)
    assert finding.fault == "late_bump"
    assert "no force explains" in finding.reason


def test_no_coherence():
    rng = np.random.default_rng(9)
    noise = rng.standard_normal(12800)
    (unrelated,) = with_fault(lambda r: replace(r, response=np.std(r.response) * noise))
    (noisy,) = with_fault(
        lambda r: replace(r, response=r.response + 0.1 * r.response.max() * noise)
    )
    assert unrelated.fault == noisy.fault == "no_coherence"


def test_another_place_struck():
    other = made.Structure(tuple((f, z, 1.6 * m if f > 1000 else m) for f, z, m in CLOSE.modes))

    def elsewhere(record):
        rng = np.random.default_rng(5)
        return made.record_of(rng, other, [made.random_hit(rng)], made.Noise(), record.name)

    with_fault(elsewhere)


def test_no_hit_a_cut_hit_and_a_late_one():
    rng = np.random.default_rng(4)
    (finding,) = with_fault(lambda r: replace(r, force=rng.standard_normal(12800)))
    assert finding.fault == "no_hit"
    (finding,) = with_fault(lambda r: replace(r, force=np.roll(r.force, -onset(r) - 3)))
    assert finding.fault == "cut_hit"

    def late(record):
        shift = 12800 - onset(record) - 300
        quiet = made.Noise().response * record.response.max() * rng.standard_normal(shift)
        response = np.concatenate((quiet, record.response[:-shift]))
        force = np.concatenate((0.3 * rng.standard_normal(shift), record.force[:-shift]))
        return replace(record, force=force, response=response)

    (finding,) = with_fault(late)
    assert finding.fault == "late_hit"


def test_a_dead_channel():
    (finding,) = with_fault(lambda r: replace(r, response=np.zeros(12800)))
    assert finding.fault == "stuck_samples"
    assert "constant" in finding.reason


# ------------------------------------------------------------------------- what is no fault


def test_a_force_window_of_the_acquisition_is_no_fault():
    def windowed(record):
        force = record.force.copy()
        force[onset(record) + 40 :] = 0.0
        return replace(record, force=force)

    assert examine_records([windowed(record) for record in good_set()]) == []


def test_perfect_signals_are_no_fault():
    assert examine_records(good_set(noise=made.Noise(0.0, 0.0))) == []


def test_offsets_and_forces_may_differ():
    records = good_set()
    records[1] = replace(records[1], response=records[1].response + 50.0)
    records[2] = replace(
        records[2], force=0.2 * records[2].force + 1.0, response=0.2 * records[2].response
    )
    assert examine_records(records) == []


# ------------------------------------------------------------------------- few records


def test_one_record_is_examined_by_itself_and_says_so():
    (finding,) = examine_records(good_set(1))
    assert not finding.is_decisive
    assert "no other good record" in finding.reason


def test_two_records_that_agree():
    assert examine_records(good_set(2)) == []


def test_two_records_that_differ_blame_neither():
    first, second = good_set(2)
    findings = examine_records([first, replace(second, response=2 * second.response)])
    assert [finding.is_decisive for finding in findings] == [False, False]
    assert all("too few agree" in finding.reason for finding in findings)


def test_two_records_against_one_say_how_few_they_are():
    records = good_set(3)
    records[0] = replace(records[0], response=2 * records[0].response)
    (finding,) = examine_records(records)
    assert finding.is_decisive
    assert "two records only" in finding.reason
