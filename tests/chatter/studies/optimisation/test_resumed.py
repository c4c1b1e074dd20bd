"""A search that is interrupted loses nothing: the same command goes on, a changed case does not."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

import chatter
from chatter import RunError
from chatter.studies.result_cache import ResultCache
from tests.chatter.studies.optimisation.cuts import end_mill

NET = {"speeds": {"from": "8800 rpm", "to": "9600 rpm"}, "depths": {"to": "3 mm", "count": 10}}
WIDTHS = {"from": "2 mm", "to": "6 mm", "count": 3}
CASES = {
    "optimum": {"optimum": {**NET, "radial_depths": WIDTHS, "max_power": "2 kW"}},
    "pitch": {"pitch_design": {**NET, "count": 4}},
}
#: what each command writes that must not depend on an interruption
WRITTEN = {
    "optimum": ("optimum.csv", "summary.json", "case-optimum.toml"),
    "pitch": ("pitch.csv", "lobes.csv", "summary.json", "case-pitch.toml"),
}


def started(command, case, out):
    """The command in a process of its own."""
    line = [sys.executable, "-c", "from chatter.cli import main; main()", command, str(case)]
    return subprocess.Popen(
        [*line, "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "COLUMNS": "200"},
    )


def records_in(folder):
    """Pairs of key and finished record, in the order in which they were added."""
    with ResultCache(folder) as cache:
        return [(key, cache[key]) for key in cache]


def interrupted_after(count, command, case, out):
    """Exit code and messages of a command that gets Ctrl-C once so many parts are on disk."""
    process = started(command, case, out)
    try:
        until = time.monotonic() + 240.0
        while len(records_in(out)) < count and process.poll() is None and time.monotonic() < until:
            time.sleep(0.002)
        process.send_signal(signal.SIGINT)
        _, report = process.communicate(timeout=60.0)
    finally:
        process.kill()
    return process.returncode, report


def parts_before_the_time_domain(records):
    found = [record for _, record in records]
    return next(
        i for i, one in enumerate(found) if isinstance(one, dict) and one.get("verification")
    )


@pytest.mark.parametrize("command", [pytest.param("optimum", marks=pytest.mark.nightly), "pitch"])
def test_an_interrupted_search_goes_on_where_it_stopped(command, tmp_path):
    path, out, whole = tmp_path / "case.toml", tmp_path / "out", tmp_path / "whole"
    case = end_mill(CASES[command])
    case.save(path)
    # without an interruption
    getattr(chatter, command)(case, folder=whole).save(whole)
    stops = [2]
    if command == "optimum":
        # while candidates are simulated side by side
        stops.append(parts_before_the_time_domain(records_in(whole)))
    before = []
    for stop in stops:
        code, report = interrupted_after(stop, command, path, out)
        assert code == 1, report
        assert "the same command goes on from there" in report
        assert "Traceback" not in report
        assert not (out / "summary.json").exists()
        # what was known is there once, and was not computed again
        known, before = before, records_in(out)
        assert before[: len(known)] == known
        assert stop <= len(before) < len(records_in(whole))
        assert "parts of the search are finished" in report
    process = started(command, path, out)
    _, report = process.communicate(timeout=240.0)
    assert process.returncode == 0, report
    after = records_in(out)
    assert after[: len(before)] == before
    assert sorted(after) == sorted(records_in(whole))
    for name in WRITTEN[command]:
        assert (out / name).read_bytes() == (whole / name).read_bytes()


def test_a_changed_case_starts_anew_and_the_same_one_computes_nothing(tmp_path, monkeypatch):
    case = end_mill(CASES["pitch"])
    first = chatter.pitch(case, folder=tmp_path)
    known = records_in(tmp_path)
    monkeypatch.setattr("chatter.studies.pitch_design.pitch_search.first_limits", None)
    again = chatter.pitch(case, folder=tmp_path)
    assert records_in(tmp_path) == known
    assert again.best.pitch == first.best.pitch
    assert json.dumps(again.summary()) == json.dumps(first.summary())
    monkeypatch.undo()
    softer = case.patch({"structure.mode[0].stiffness": "12 N/um"})
    chatter.pitch(softer, folder=tmp_path)
    assert len(records_in(tmp_path)) >= len(known) + 10


def test_an_interrupted_run_in_time_is_no_verdict(tmp_path, monkeypatch):
    # Ctrl-C ends a simulation with what it has: that must not be read as chatter
    def cut_short(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("chatter.simulation.cut_run.run", cut_short)
    section = {**NET, "depths": {"to": "1 mm", "count": 5}}
    with pytest.raises(RunError, match="parts of the search are finished"):
        chatter.optimum(end_mill({"optimum": section}), folder=tmp_path)
    kept = [record for _, record in records_in(tmp_path)]
    assert not any(isinstance(one, dict) and one.get("verification") for one in kept)
