"""`chatter detect`: files of every kind, advice, what is written, what is refused."""

import json
import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
import scipy.io
import scipy.io.wavfile

import chatter
from benchmarks.stated_speeds import Cut
from chatter.description.errors import InputError
from chatter.detection.spectral.recording import Recording
from chatter.monitoring.advice import proposed_by_frequency
from tests.chatter.detection.made_recordings import (
    RATE,
    chatter_line,
    clock,
    during,
    forced_cut,
    noise,
)
from tests.command_line import chatter_command
from tests.places import EXAMPLES

REVOLUTION, TEETH, FREQUENCY = 50.0, 4, 1230.0
#: tooth passing frequency = fc / k: 60 * 1230 / (4 k)
LOBES = {6: 3075.0, 7: 2635.714, 5: 3690.0}


def made(seconds=3.0):
    random = np.random.default_rng(1)
    time = clock(seconds)
    values = forced_cut(random, time, REVOLUTION, TEETH) * during(time, 0.5, seconds)
    chatter_part = chatter_line(random, time, FREQUENCY, TEETH * REVOLUTION)
    return time, values + 2.0 * during(time, 1.2, seconds) * chatter_part + noise(random, time)


def write_csv(path, heading, time, values):
    np.savetxt(path, np.c_[time, values], delimiter=",", header=heading, comments="", fmt="%.7g")
    return path


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recording")
    return write_csv(folder / "cut.csv", "time [s],ax [m/s^2]", *made())


def test_the_command_writes_what_the_contract_names(table, tmp_path):
    done = chatter_command(
        "detect", table, "--spindle-speed", "3000 rpm", "--teeth", TEETH, "--out", tmp_path,
        "--json",
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    summary = json.loads((tmp_path / "detection.json").read_text(encoding="utf-8"))
    assert json.loads(done.stdout) == summary
    assert (tmp_path / "detection.png").stat().st_size > 10_000
    assert summary["verdict"] == "chatter"
    for one in summary["segments"]:
        assert {"from_s", "to_s", "verdict", "chatter_frequency_Hz", "confidence"} <= one.keys()
        assert one["verdict"] in ("chatter", "stable", "idle", "not judged")
        assert 0.0 <= one["confidence"] <= 1.0
    found = [one for one in summary["segments"] if one["verdict"] == "chatter"]
    assert found[0]["chatter_frequency_Hz"] == pytest.approx(FREQUENCY, rel=1e-3)
    proposed = {one["lobe"]: one["spindle_speed_rpm"] for one in summary["proposed_speeds"]}
    for lobe, speed in LOBES.items():
        assert proposed[lobe] == pytest.approx(speed, rel=1e-3)
    assert "3075 rpm (k = 6)" in summary["advice"][0]


def test_speeds_are_proposed_nearest_first():
    # 60 * 900 / (6 k): 1800, 1500, 1286 and 2250 rpm are 144, 156, 370 and 594 from 1656
    found = proposed_by_frequency(900.0, 1656.0 / 60.0, 6)
    assert [one.lobe for one in found] == [5, 6, 7, 4]
    assert [round(one.spindle_speed_rpm) for one in found] == [1800, 1500, 1286, 2250]


def test_the_same_in_wav_csv_npz_and_memory(table, tmp_path):
    time, values = made()
    scipy.io.wavfile.write(
        tmp_path / "cut.wav", int(RATE), (values / np.abs(values).max() * 30000).astype(np.int16)
    )
    np.savez(tmp_path / "cut.npz", **{"time [ms]": 1e3 * time, "ax [g]": values / 9.80665})
    direct = Recording("made", 1.0 / RATE, ("a",), ("acceleration",), values[:, None])
    for one in (table, tmp_path / "cut.wav", tmp_path / "cut.npz", direct):
        found = chatter.detect(one, "3000 rpm", TEETH)
        assert found.verdict == "chatter"
        assert found.chatter_frequency == pytest.approx(FREQUENCY, rel=1e-3)


def test_a_file_without_time_asks_for_the_sampling_rate(tmp_path):
    _, values = made()
    path = tmp_path / "cut.csv"
    np.savetxt(path, values, header="force [N]", comments="")
    with pytest.raises(InputError, match=r"cut\.csv: no column is a time; .*--sampling-rate"):
        chatter.detect(path, "3000 rpm", TEETH)
    assert chatter.detect(path, "3000 rpm", TEETH, sampling_rate="10 kHz").verdict == "chatter"


def test_a_channel_is_chosen_by_name(tmp_path):
    time, values = made()
    random = np.random.default_rng(2)
    calm = forced_cut(random, time, REVOLUTION, TEETH) + noise(random, time)
    heading = "time [s],ax [m/s^2],ay [m/s^2],temperature [degC],n [rpm]"
    columns = np.c_[values, calm, 20.0 + 0.1 * time, 3000.0 + random.standard_normal(time.size)]
    path = write_csv(tmp_path / "cut.csv", heading, time, columns)
    found = chatter.detect(path, "3000 rpm", TEETH)
    assert found.recording.channels == ("ax", "ay")
    assert found.verdict == "chatter"
    assert chatter.detect(path, "3000 rpm", TEETH, channels=["ay"]).verdict == "stable"
    with pytest.raises(InputError, match=r'--channel "az" is no signal of the file; .*ax, ay'):
        chatter.detect(path, "3000 rpm", TEETH, channels=["az"])


def test_a_speed_that_is_some_percent_off_is_read_off_the_lines(table):
    found = chatter.detect(table, "3240 rpm", TEETH)
    assert found.verdict == "chatter"
    summary = found.summary()
    assert summary["spindle_speed_rpm"] == pytest.approx(3000.0, rel=1e-3)
    assert "3240 rpm were stated" in summary["notes"][0]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"spindle_speed": "3000"}, "spindle speed"),
        ({"spindle_speed": "-5 rpm"}, "above zero"),
        ({"spindle_speed": "3 mm"}, "spindle speed"),
        ({"spindle_speed": "3000 rpm", "teeth": 0}, "--teeth 0: a number from 1 to 200"),
        ({"spindle_speed": "3000 rpm", "sampling_rate": "0 Hz"}, "sampling rate"),
    ],
)
def test_wrong_values_are_refused(table, given, message):
    with pytest.raises(InputError, match=message):
        chatter.detect(table, **given)


def test_a_wrong_file_is_one_sentence_and_exit_code_2(tmp_path):
    path = tmp_path / "nothing.wav"
    done = chatter_command("detect", path)
    assert done.exit_code == 2
    assert "nothing.wav: no such file" in done.output
    assert "Traceback" not in done.output


CASE = """
[tool]
kind = "end mill"
teeth = 4
diameter = "20 mm"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "300 MPa"
[cut]
mode = "down"
spindle_speed = "6600 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "{depth} mm"
radial_depth = "10 mm"
[[structure.mode]]
frequency = "600 Hz"
damping = 0.03
stiffness = "10 N/um"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "1150 Hz"
damping = 0.03
stiffness = "40 N/um"
direction = [0, 1, 0]
[lobes]
speeds = { from = "5000 rpm", to = "12000 rpm", count = 141 }
"""


def test_with_a_case_the_mode_and_stable_speeds_of_the_case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace("{depth}", "8"), encoding="utf-8")
    case = chatter.load(path)
    random = np.random.default_rng(3)
    time = clock(3.0)
    values = forced_cut(random, time, 110.0, 4) + 2.0 * chatter_line(random, time, 637.0, 440.0)
    values += noise(random, time)
    recording = Recording("cut", 1.0 / RATE, ("x",), ("sound",), values[:, None])
    found = chatter.detect(recording, case=path)
    assert found.verdict == "chatter"
    summary = found.summary()
    assert summary["mode"] == {"number": 1, "frequency_Hz": pytest.approx(600.0, rel=1e-3)}
    assert summary["teeth"] == 4
    diagram = chatter.lobes(case)
    speeds, limits = diagram.limits.spindle_speed_rpm, diagram.limits.critical_depth_mm
    deep = limits > 1.1 * 8.0
    expected = [speeds[deep & (speeds < 6534.0)].max(), speeds[deep & (speeds > 6666.0)].min()]
    proposed = summary["proposed_speeds"]
    assert sorted(one["spindle_speed_rpm"] for one in proposed) == pytest.approx(expected)
    # what is proposed is stable by another call, and the cut as it was is not
    assert all(
        chatter.check(case.patch({"cut.spindle_speed": f"{one['spindle_speed_rpm']} rpm"})).stable
        for one in proposed
    )
    assert not chatter.check(case).stable
    assert not any("has 8 mm as stable" in one for one in summary["advice"])
    shallow = case.patch({"cut.axial_depth": "1 mm"})
    assert any(
        "has 1 mm as stable" in one
        for one in chatter.detect(recording, case=shallow).advice.sentences
    )


@pytest.mark.parametrize(("depth", "verdict"), [("1 mm", "stable"), ("3 mm", "chatter")])
def test_simulated_cuts_have_the_verdict_of_their_poincare_sections(depth, verdict):
    case = chatter.load(EXAMPLES / "chattering-cut" / "case.toml")
    result = chatter.simulate(case.patch({"cut.axial_depth": depth}))
    assert result.detection.verdict == verdict
    duration = 60.0 / 100.0  # of 60 revolutions at 6000 rpm
    for quantity, columns in (("force", [0, 1]), ("displacement", [3, 4])):
        values = result.rows[:, columns]
        recording = Recording(
            "simulated", duration / len(values), ("x", "y"), (quantity,) * 2, values
        )
        found = chatter.detect(recording, "6000 rpm", 4)
        assert found.verdict == verdict
        if verdict == "chatter":
            expected = result.detection.chatter_frequency
            assert found.chatter_frequency == pytest.approx(expected, rel=2e-3)
            assert found.segments[-1].bifurcation == result.detection.bifurcation


@pytest.mark.parametrize(
    ("step", "words"),
    [
        (1.0, "1 samples a second, where 20 are needed; is its time in another unit"),
        (
            1e-9,
            "s at 1e+09 samples a second, where 0.001 s are needed; is its time in another unit",
        ),
        (0.004, "250 samples a second show nothing above 125 Hz; the spindle turns at 200 Hz"),
    ],
)
def test_clocks_that_show_nothing_of_the_cut_are_refused(tmp_path, step, words):
    time = step * np.arange(2000)
    path = write_csv(tmp_path / "cut.csv", "time [s],ax [m/s^2]", time, np.sin(np.arange(2000)))
    with pytest.raises(InputError, match=re.escape(words)):
        chatter.detect(path, spindle_speed="12000 rpm", teeth=2)


def test_a_gap_in_the_time_is_not_filled(tmp_path):
    """One pause of three hours, which an even clock would fill with 10^8 samples."""
    time = np.arange(2000) * 1e-4
    time[1000:] += 1e4
    rows = np.c_[time, np.sin(np.arange(2000))]
    path = tmp_path / "cut.csv"
    np.savetxt(path, rows, delimiter=",", header="time [s],ax [m/s^2]", comments="", fmt="%.9f")
    with pytest.raises(InputError, match=r"cut\.csv: the time jumps by 1e\+04 s at line 1002"):
        chatter.detect(path)


@pytest.mark.parametrize("rate", [210.0, 250.0])
def test_a_slow_recording_has_a_single_band(rate):
    """Fewer lines than a band has: the median over no band was not a number."""
    values = np.random.default_rng(1).normal(size=(300, 1))
    recording = Recording("cut", 1.0 / rate, ("a",), ("acceleration",), values)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        found = chatter.detect(recording, teeth=2, spindle_speed="6000 rpm")
    assert [one.verdict for one in found.segments] == ["idle"]


def pulses(per_revolution):
    return np.mod(REVOLUTION * per_revolution * clock(3.0), 1.0) < 0.25


TACHOS = [
    (6, lambda: pulses(6)),
    (60, lambda: pulses(60)),
    ("noise", lambda: np.random.default_rng(3).standard_normal(int(3 * RATE))),
    ("missing pulses", lambda: pulses(1) & (np.mod(REVOLUTION * clock(3.0), 7.0) > 1.0)),
]


@pytest.mark.parametrize(("kind", "signal"), TACHOS, ids=[str(one[0]) for one in TACHOS])
def test_a_tacho_of_another_kind_does_not_hide_chatter(kind, signal):
    _, values = made()
    tacho = np.asarray(signal(), dtype=float)
    recording = Recording(
        "made", 1.0 / RATE, ("a",), ("acceleration",), values[:, None], 0.0, tacho
    )
    found = chatter.detect(recording, 60.0 * REVOLUTION * np.pi / 30.0, TEETH)
    assert found.verdict == "chatter", kind
    assert found.evidence.revolution.mean == pytest.approx(REVOLUTION, rel=3e-3)


@pytest.mark.parametrize("heading", ["spindle speed [rpm]", "tacho [rpm]", "Drehzahl [1/min]"])
def test_a_measured_speed_beside_the_signal_is_taken(tmp_path, heading):
    time, values = made()
    columns = np.c_[values, np.full(time.size, 60.0 * REVOLUTION)]
    path = write_csv(tmp_path / "a.csv", f"Zeit/ms,ax [m/s^2],{heading}", 1e3 * time, columns)
    found = chatter.detect(path, teeth=TEETH)
    assert found.verdict == "chatter"
    assert found.evidence.revolution.mean == pytest.approx(REVOLUTION, rel=3e-3)


@pytest.mark.parametrize("digit", [1.5e-4, 1e-3])
def test_a_time_that_was_rounded_is_even(tmp_path, digit):
    time, values = made()
    path = write_csv(tmp_path / "a.csv", "time [s],ax [g]", np.round(time / digit) * digit, values)
    found = chatter.detect(path, f"{60.0 * REVOLUTION} rpm", TEETH)
    assert found.verdict == "chatter"
    assert found.recording.time_step == pytest.approx(1.0 / RATE, rel=1e-3)
    assert found.segments[-1].chatter_frequency == pytest.approx(FREQUENCY, rel=2e-3)


def test_an_overloaded_recorder_calls_nothing_stable():
    _, values = made()
    # all but the sign of the signal is lost, as by a telephone beside the machine
    for level, least in ((0.02, "not judged"), (50.0, "chatter")):
        clipped = np.clip(values, -level, level)[:, None]
        recording = Recording("made", 1.0 / RATE, ("a",), ("sound",), clipped)
        found = chatter.detect(recording, f"{60.0 * REVOLUTION} rpm", TEETH)
        quiet = [one for one in found.segments if one.verdict in ("stable", "idle")]
        assert found.verdict in (least, "chatter")
        assert bool(quiet) == (level > 1.0)
        assert any("overloaded" in one for one in found.notes) == (level < 1.0)


def test_fields_of_a_structure_have_their_time(tmp_path):
    time, values = made()
    scipy.io.savemat(tmp_path / "a.mat", {"rec": {"time_ms": 1e3 * time, "mic": values}})
    found = chatter.detect(tmp_path / "a.mat", f"{60.0 * REVOLUTION} rpm", TEETH)
    assert found.verdict == "chatter"


def test_a_cell_that_is_no_number_is_named_by_line_and_column(tmp_path):
    text = "time [s],ax [g],temperature [degC]\n0,1,20\n0.001,2,nan\n"
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(InputError, match="line 3, temperature: 'nan' is not a finite number"):
        chatter.detect(tmp_path / "a.csv")


@pytest.mark.parametrize("teeth", [4, None])
def test_a_tacho_of_three_pulses_without_a_speed_is_told(teeth):
    """Of a spindle at 50 Hz with four teeth: 150 Hz are not the revolution."""
    time = clock(3.0)
    angle = 2.0 * np.pi * 50.0 * time
    cut = sum(np.cos(4 * k * angle + k) / (1 + abs(k - 3)) for k in range(1, 20))
    runout = sum(0.15 * np.cos(k * angle + k) / (1 + k / 4) for k in range(1, 30))
    values = cut + runout + 0.05 * np.random.default_rng(4).standard_normal(time.size)
    tacho = (np.mod(150.0 * time, 1.0) < 0.3).astype(float)
    recording = Recording(
        "made", 1.0 / RATE, ("a",), ("acceleration",), values[:, None], 0.0, tacho
    )
    found = chatter.detect(recording, teeth=teeth)
    assert found.verdict in ("stable", "not judged")
    note = next(one for one in found.notes if "pulse" in one)
    assert "3000 rpm too, at 3:" in note
    assert "--spindle-speed" in note


@pytest.mark.parametrize(
    ("heading", "said"),
    [("tacho [V]", True), ("once per revolution [V]", False), ("Keyphasor [V]", False)],
)
def test_the_name_of_a_tacho_may_state_one_pulse_a_revolution(tmp_path, heading, said):
    time, values = made()
    tacho = (np.mod(REVOLUTION * time + 0.4, 1.0) < 0.3).astype(float)
    path = write_csv(tmp_path / "a.csv", f"time [s],ax [g],{heading}", time, np.c_[values, tacho])
    found = chatter.detect(path)
    assert found.verdict == "chatter"
    assert found.evidence.revolution.mean == pytest.approx(REVOLUTION, rel=1e-3)
    assert any("pulse" in one for one in found.notes) == said
    assert found.recording.once_per_revolution != said


def with_tacho(cut, seed, pulses):
    recording = cut.record(np.random.default_rng(seed))
    turned = pulses * cut.revolution * np.arange(len(recording.values)) * recording.time_step
    return replace(recording, tacho=(np.mod(turned + 0.4, 1.0) < 0.3).astype(float))


@pytest.mark.parametrize(
    ("pulses", "teeth", "revolution"), [(2, 3, 48.25), (4, 2, 31.1), (6, 1, 35.3), (8, 6, 31.8)]
)
def test_a_stable_cut_is_no_chatter_whatever_pulses_its_tacho_has(pulses, teeth, revolution):
    """Its lines between the harmonics of the pulses are of the runout."""
    recording = with_tacho(Cut(revolution, teeth, 0.3, 0.0), 3, pulses)
    for known in (None, teeth):
        found = chatter.detect(recording, teeth=known)
        assert found.verdict in ("stable", "not judged")
        if found.verdict == "not judged":
            assert any("--spindle-speed" in one.reason for one in found.segments)


@pytest.mark.parametrize(
    ("pulses", "teeth", "revolution"), [(6, 1, 82.7), (8, 2, 38.4), (8, 6, 122.8), (1, 4, 61.3)]
)
def test_chatter_is_not_stable_whatever_pulses_its_tacho_has(pulses, teeth, revolution):
    """It may lie below the harmonics of several pulses a revolution."""
    recording = with_tacho(Cut(revolution, teeth, 0.3, 3.0), 3, pulses)
    found = chatter.detect(recording, teeth=teeth)
    assert found.verdict in ("chatter", "not judged")
    if pulses == 1:
        assert found.verdict == "chatter"


def test_noise_at_two_levels_without_a_speed_is_idle_and_not_judged():
    """Nothing shows a speed, and the quiet part is told by its level alone."""
    time = clock(6.0)
    values = np.where(time < 3.0, 0.01, 1.0) * np.random.default_rng(6).standard_normal(time.size)
    found = chatter.detect(
        Recording("made", 1.0 / RATE, ("a",), ("acceleration",), values[:, None])
    )
    assert {one.verdict for one in found.segments} == {"idle", "not judged"}
