"""Progress: what is being done, how far, how long; nothing is silent for more than two seconds."""

import ast
import threading
import time

import pytest

from chatter.cli import COMMANDS, progress
from chatter.cli.imported_commands import python_name
from chatter.cli.progress import RunningWork, elapsed_in_words, in_words, progress_bar, running
from chatter.description.progress import begin
from tests.places import ROOT

#: commands that compute nothing
AT_ONCE = {"materials", "new", "schema"}


class Clock:
    """A clock that is set by hand."""

    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def test_the_time_left_is_that_of_the_pace_so_far(clock):
    work = RunningWork("limits", clock)
    assert work.remaining() is None
    assert work.line() == "limits ..."
    work(0, 200)
    clock.now += 10.0
    assert work.line() == "limits: 0 of 200, 10 s so far"
    work(50, 200)
    # 50 parts in 10 s: 150 more take 30 s
    assert work.remaining() == pytest.approx(30.0)
    assert work.line() == "limits: 50 of 200 (25%), about 30 s left"
    # between two reports it goes down with time, never below zero
    clock.now += 4.0
    assert work.remaining() == pytest.approx(26.0)
    clock.now += 40.0
    assert work.remaining() == 0.0
    # "about 0 s left", for minutes
    assert work.line() == "limits: 50 of 200 (25%), the next takes longer than those before"


def test_one_part_alone_is_no_measure_of_how_far_it_is(clock):
    """ "critical depth at this speed: 0 of 1 (0%)", again and again."""
    work = RunningWork("critical depth", clock)
    work(0, 1)
    clock.now += 17.0
    assert work.line() == "critical depth: 17 s so far"
    clock.now += 15.0
    assert work.line() == "critical depth: 32 s so far"


def test_what_an_earlier_run_has_finished_is_not_pace(clock):
    work = RunningWork("points", clock)
    clock.now += 0.1
    work(900, 1000)
    clock.now += 10.0
    work(910, 1000)
    assert work.remaining() == pytest.approx(90.0)


def test_the_pace_is_that_of_late(clock):
    work = RunningWork("search", clock)
    work(0, 1000)
    for done in range(100, 600, 100):  # a hundred a second
        clock.now += 1.0
        work(done, 1000)
    for done in range(505, 605, 5):  # then five in two seconds
        clock.now += 2.0
        work(done, 1000)
    # 600 of 1000 done: 400 more at 2.5 a second
    assert work.remaining() == pytest.approx(160.0, rel=0.1)


def test_one_part_that_took_long_is_not_the_pace(clock):
    """ "100 of 400 (25%), about 7.3 h left": the last one had taken a minute, all of them 160 s."""
    work = RunningWork("limits", clock)
    for done in range(100):  # one a second
        work(done, 400)
        clock.now += 1.0
    clock.now += 60.0
    work(100, 400)
    # 300 more at 10 in 70 s, at the worst
    assert 300.0 < work.remaining() <= 2100.0


def test_a_first_part_that_took_long_is_pace(clock):
    work = RunningWork("points", clock)
    clock.now += 20.0
    work(1, 10)
    assert work.remaining() == pytest.approx(180.0)


def test_the_time_of_preparing_is_no_pace(clock):
    """A move of ten minutes was announced with two hours: planning it was counted as its steps."""
    work = RunningWork("move", clock)
    clock.now += 12.0
    work(0, 600_000)
    for done in range(1000, 6000, 1000):  # a thousand a second
        clock.now += 1.0
        work(done, 600_000)
        assert work.remaining() == pytest.approx((600_000 - done) / 1000.0)
    assert work.announcement() is None
    clock.now += 2.0
    work(7000, 600_000)
    # 593 s are left, and 19 s are over
    assert work.announcement() == "move: about 10 min in all; Ctrl-C ends it"


def test_minutes_are_announced_once(clock):
    work = RunningWork("samples", clock)
    work(0, 100)
    clock.now += 5.0
    work(10, 100)
    assert work.announcement() is None  # 50 s in all
    work.stage("more samples")
    clock.now += 5.0
    work(11, 100)
    # 11 parts in 10 s: 89 more take 81 s, 91 s in all
    assert work.announcement() == "more samples: about 2 min in all; Ctrl-C ends it"
    assert work.announcement() is None


def test_parts_that_were_slow_to_begin_are_no_pace(clock):
    """A search of two minutes was announced with seven: its first cuts read compiled code."""
    work = RunningWork("search", clock)
    work(0, 1000)
    clock.now += 4.0
    work(14, 1000)
    # at this pace 286 s; it waits for another estimate like it
    assert work.announcement() is None
    for done in range(24, 64, 10):  # ten a second from now on
        clock.now += 1.0
        work(done, 1000)
    assert work.remaining() == pytest.approx((1000 - 54) / 10.0)
    assert work.announcement() is None
    clock.now += 2.0
    work(74, 1000)
    assert work.announcement() == "search: about 2 min in all; Ctrl-C ends it"


def test_the_first_line_counts_from_the_last_word(monkeypatch, capsys):
    monkeypatch.setattr(progress, "FIRST_LINE", 5.0)
    monkeypatch.setattr(progress.START_UP, "end", lambda: 4.9)
    with running("critical depth"):
        time.sleep(0.4)
    assert "critical depth ..." in capsys.readouterr().err


def test_another_part_counts_and_is_timed_anew(clock):
    """ "all 34 done, evaluating the result for 2 min" said neither of what nor how far."""
    work = RunningWork("limits at all speeds", clock)
    clock.now += 100.0
    work(34, 34)
    begin(work, "lowest limit between the speeds")
    clock.now += 3.0
    assert work.line() == "lowest limit between the speeds: 3 s so far"
    work(10, 40)
    clock.now += 3.0
    work(20, 40)
    assert work.line() == "lowest limit between the speeds: 20 of 40 (50%), about 6 s left"
    begin(lambda done, total: None, "what takes no name is not asked")


def test_compiling_is_named(clock):
    """A method used for the first time ran 90 s as "critical depth: 90 s so far"."""
    work = RunningWork("critical depth", clock, is_compiling=lambda: True)
    clock.now += 5.0
    assert work.line() == "critical depth: compiling what is used for the first time, 5 s so far"
    work(1, 2)
    assert "compiling" not in work.line()


def test_the_time_of_compiling_is_no_pace(clock):
    """A bifurcation of half a minute was announced with 22: code was compiled for the first cut."""
    compiling = True
    work = RunningWork("cuts", clock, is_compiling=lambda: compiling)
    clock.now += 50.0
    assert work.announcement() is None  # looked at while code is compiled
    clock.now += 50.0
    compiling = False
    work(1, 25)
    assert work.remaining() is None
    assert work.announcement() is None
    clock.now += 2.0
    work(2, 25)
    assert work.remaining() == pytest.approx(46.0)


def test_compilation_is_seen_while_it_goes_on():
    import numba

    from chatter.first_steps.compiling import is_compiling

    seen = []

    @numba.extending.overload(_asked)
    def _(value):
        seen.append(is_compiling())
        return lambda value: value

    assert not is_compiling()
    assert numba.njit(lambda value: _asked(value))(1.0) == 1.0
    assert seen[0]
    assert not is_compiling()


def _asked(value):
    """Of what compiled code asks while it is compiled."""
    return value


def test_what_comes_after_the_last_part_is_told(clock):
    work = RunningWork("time steps", clock)
    work(0, 10)
    clock.now += 65.0
    work(10, 10)
    clock.now += 30.0
    assert work.line() == "time steps: all 10 done, evaluating the result for 30 s"
    assert work.announcement() is None


def test_durations_in_words():
    assert in_words(42.4) == "42 s"
    assert in_words(125.0) == "2 min"
    assert in_words(2.5 * 3600.0) == "2.5 h"


def test_lines_where_there_is_no_terminal(monkeypatch, capsys):
    monkeypatch.setattr(progress, "FIRST_LINE", 0.05)
    monkeypatch.setattr(progress, "NEXT_LINE", 0.05)
    with progress_bar("critical depth") as work:
        time.sleep(0.2)
        work.stage("another part")
        work(3, 4)
        time.sleep(0.2)
    printed = capsys.readouterr().err
    assert "critical depth ..." in printed
    assert "another part: 3 of 4 (75%)" in printed


def test_no_two_lines_are_alike_and_none_is_later_than_two_seconds(monkeypatch, capsys):
    assert progress.FIRST_LINE <= 2.0
    assert progress.NEXT_LINE <= 2.0
    monkeypatch.setattr(progress, "FIRST_LINE", 0.5)
    monkeypatch.setattr(progress, "NEXT_LINE", 0.5)
    with running("candidates") as work:
        time.sleep(0.6)
        work(3, 4)
        time.sleep(2.2)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) >= 4
    assert all("candidates" in line for line in lines)
    assert any(line.startswith("candidates: 3 of 4 (75%), ") and "so far" in line for line in lines)


def test_short_work_prints_nothing(capsys):
    with running("critical depth") as work:
        work(1, 2)
    assert capsys.readouterr().err == ""


def test_the_bar_counts_the_time_of_each_part_anew(monkeypatch):
    """A part that had just begun stood there with the 99 s of the one before it."""
    seen = []

    class Bar(progress.Progress):
        def reset(self, task, **kwargs):
            super().reset(task, **kwargs)
            seen.append(self.tasks[0].elapsed)

    monkeypatch.setattr(progress, "Progress", Bar)
    ended, work = threading.Event(), RunningWork("limits")
    thread = threading.Thread(target=progress._on_terminal, args=(work, ended))
    thread.start()
    time.sleep(0.4)
    begin(work, "lowest limit")
    time.sleep(0.4)
    ended.set()
    thread.join()
    (elapsed,) = seen
    assert elapsed < 0.1


def test_an_error_ends_the_lines():
    with pytest.raises(ValueError, match="no"), progress_bar("critical depth"):
        raise ValueError("no")


@pytest.mark.parametrize("command", sorted(set(COMMANDS) - AT_ONCE))
def test_every_command_that_computes_shows_its_progress(command):
    path = ROOT / "chatter" / "cli" / f"{python_name(command)}.py"
    tree = ast.parse(path.read_text(encoding="utf-8"))
    used = [node for node in ast.walk(tree) if isinstance(node, ast.With)]
    shown = [ast.unparse(node.items[0]) for node in used]
    # `running` where nothing is compiled; `shown` is one of the two
    assert any(name in one for one in shown for name in ("progress_bar(", "running(", "shown("))


def test_elapsed_time_goes_on_from_line_to_line():
    assert elapsed_in_words(47.2) == "47 s"
    assert elapsed_in_words(107.0) == "1 min 47 s"
    assert elapsed_in_words(122.0) == "2 min 2 s"


def test_a_part_that_has_just_begun_has_no_time():
    """Lines ended with "0 s so far"."""
    now = [0.0]
    work = RunningWork("machine", clock=lambda: now[0])
    now[0] = 3.0
    work.begin("critical depth")
    now[0] = 3.2
    assert work.line() == "critical depth ..."
    now[0] = 6.0
    assert work.line() == "critical depth: 3 s so far"


def test_compiling_after_the_last_part_is_named(clock):
    """Beside a ball's limits a minute of compiling was "evaluating the result"."""
    work = RunningWork("limits at all speeds", clock, is_compiling=lambda: True)
    work(34, 34)
    clock.now += 30.0
    words = "compiling what is used for the first time for 30 s"
    assert work.line() == f"limits at all speeds: all 34 done, {words}"
