"""Progress of long work: what is being done, how far, and how long it will take."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from chatter.cli.garbage import collect_from_here
from chatter.cli.start_up import START_UP
from chatter.report.console import MESSAGES, print_message

#: s without a word after which a line is printed where there is no terminal to draw a bar on
FIRST_LINE = 2.0
#: s from line to line
NEXT_LINE = 2.0
#: s of work from which on its duration is announced
LONG = 60.0
#: s of work before it ends within which its duration is no news
_REST = 20.0
#: s from look to look whether there is something to print
_LOOKED_EVERY = 0.5
#: two estimates this far apart, s, and as near as this share are one to announce; so is any after
#: this long, s: the first parts of a search are hardly like the others
_APART, _NEAR, _LONG_ENOUGH = 2.0, 0.3, 10.0
#: s of a part from which on its time is told
_NEWS = 0.5
#: s of work from which its pace is known, and that it is taken over
_PACE = 1.0
_OF_LATE = 20.0
#: parts that it is taken over at the least: a single one may take a hundred times another
_PARTS = 10
_COMPILING = "compiling what is used for the first time"


class RunningWork:
    """Work under way: called with (done, total) as it goes on, in whatever thread.

    Parameters
    ----------
    description : str
        What is being done.
    clock : callable, optional
        s, that never goes back.
    is_compiling : callable, optional
        Whether the time goes into compiling what the work uses for the first time.
    """

    def __init__(
        self,
        description: str,
        clock: Callable[[], float] = time.monotonic,
        is_compiling: Callable[[], bool] = lambda: False,
    ) -> None:
        self.description = description
        self._clock = clock
        self._is_compiling = is_compiling
        self._begun = clock()
        #: times and parts that the pace is of: the newest report last, one a second before it
        self._reports: deque[tuple[float, int]] = deque()
        self._newest: tuple[float, int, int] | None = None
        self._announced = False
        #: whether code was compiled since the last report
        self._compiled = False
        #: elapsed time and total of an estimate that waits for another like it, s
        self._estimate: tuple[float, float] | None = None

    def __call__(self, done: int, total: int) -> None:
        """Report how many of all parts are done."""
        now = self._clock()
        if self._compiled or self._is_compiling():
            # what was compiled is compiled once: the time that it took is no pace
            self._reports.clear()
            self._reports.append((now, done))
            self._compiled = False
        elif not self._reports:
            # what is reported at once was finished before, by an earlier run; the time before a
            # report of nothing done went into preparing the parts
            prepared = not done or now - self._begun < _PACE
            self._reports.append((now, done) if prepared else (self._begun, 0))
        elif now - self._reports[-1][0] >= _PACE:
            self._reports.append((now, done))
        # the pace is that of late: parts of a search differ
        while len(self._reports) > 1 and self._is_enough(now, done, *self._reports[1]):
            self._reports.popleft()
        if self._began_slowly():
            self._reports.popleft()
        self._newest = (now, done, total)

    @staticmethod
    def _is_enough(now: float, done: int, since: float, before: int) -> bool:
        """Whether the pace can be taken from a report on."""
        return now - since > _OF_LATE and done - before >= _PARTS

    def _began_slowly(self) -> bool:
        """Whether the first parts took what later ones do not: compiled code is read, say."""
        if len(self._reports) < 3 or self._reports[0][1]:
            return False
        (begun, before), (first, some), (last, more) = (self._reports[k] for k in (0, 1, -1))
        return last - first >= _APART and 2 * (some - before) / (first - begun) < (more - some) / (
            last - first
        )

    def stage(self, description: str) -> None:
        """Report that another part of the work has begun, under its own description."""
        self.description = description

    def begin(self, description: str) -> None:
        """Report that another part of the work has begun, which counts and is timed anew."""
        self.description = description
        self._begun = self._clock()
        self._reports.clear()
        self._newest, self._announced, self._estimate = None, False, None

    @property
    def counts(self) -> tuple[int, int | None]:
        """Parts that are done, and all; None where that is not known yet."""
        return (0, None) if self._newest is None else self._newest[1:]

    @property
    def begun(self) -> float:
        """Time of the clock at which the part that is under way began, s."""
        return self._begun

    @property
    def elapsed(self) -> float:
        """Time since the work began, s."""
        return self._clock() - self._begun

    def remaining(self) -> float | None:
        """Time that the rest takes at the pace so far, s; None before there is one."""
        if not self._reports or self._newest is None:
            return None
        begun, before = self._reports[0]
        at, done, total = self._newest
        if done <= before or at - begun < _PACE:
            return None
        expected_end = begun + (at - begun) * (total - before) / (done - before)
        return max(expected_end - self._clock(), 0.0)

    def line(self) -> str:
        """Line on what is being done and how far it is."""
        done, total = self.counts
        if self.elapsed < _NEWS and not done:
            # a part that has just begun: "0 s so far" is no news
            return f"{self.description} ..."
        so_far = f"{elapsed_in_words(self.elapsed)} so far"
        if self._is_compiling() and not done:
            so_far = f"{_COMPILING}, {so_far}"
        if not total or (total == 1 and not done):
            return f"{self.description}: {so_far}"
        if not done:
            # two lines alike would look as if nothing went on
            return f"{self.description}: 0 of {total}, {so_far}"
        if done >= total and self._newest is not None:
            since = in_words(self._clock() - self._newest[0])
            what = _COMPILING if self._is_compiling() else "evaluating the result"
            return f"{self.description}: all {total} done, {what} for {since}"
        return f"{self.description}: {done} of {total} ({done / total:.0%}){self._rest()}"

    def _rest(self) -> str:
        """How long the rest takes, where that is known."""
        left = self.remaining()
        if left is None:
            return ""
        if left == 0.0:
            return ", the next takes longer than those before"
        return f", about {in_words(math.ceil(left))} left"

    def announcement(self) -> str | None:
        """Sentence, once, that the work takes minutes, as soon as its pace shows it."""
        self._compiled |= self._is_compiling()
        left = self.remaining()
        if self._announced or left is None or left < max(LONG - self.elapsed, _REST):
            return None
        if not self._is_settled(self.elapsed + left):
            return None
        self._announced = True
        return f"{self.description}: about {in_words(self.elapsed + left)} in all; Ctrl-C ends it"

    def _is_settled(self, total: float) -> bool:
        """Whether an estimate of the whole, s, is like one before it, or has had time to be."""
        now = self.elapsed
        if self._clock() - self._reports[0][0] >= _LONG_ENOUGH:
            return True
        before = self._estimate
        if before is not None and now - before[0] < _APART:
            return False
        self._estimate = (now, total)
        return before is not None and abs(total - before[1]) <= _NEAR * total


def report_stage(work: RunningWork, description: str, share: float) -> None:
    """Report a part of the work by its name and the share of the whole that is done."""
    work.stage(description)
    work(round(100.0 * share), 100)


def in_words(seconds: float) -> str:
    """Duration in the unit that people say it in."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    minutes = seconds / 60.0
    return f"{minutes:.0f} min" if minutes < 90.0 else f"{minutes / 60.0:.1f} h"


def elapsed_in_words(seconds: float) -> str:
    """Duration to the second, so that each of two lines some seconds apart is news."""
    if seconds < 90.0:
        return in_words(seconds)
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s"


@contextmanager
def progress_bar(description: str, driver: object | None = None) -> Iterator[RunningWork]:
    """Announce what the first use takes, and show on stderr what is being done and how far.

    A bar on a terminal, else a line every two seconds. Yields a function of (done, total); `driver`
    is as for `announce_compilation`.
    """
    announce_compilation(driver)
    from chatter.first_steps.compiling import is_compiling

    with _shown(RunningWork(description, is_compiling=is_compiling)) as work:
        yield work


@contextmanager
def running(description: str) -> Iterator[RunningWork]:
    """Show on stderr what is being done and how far, without compiled code."""
    with _shown(RunningWork(description)) as work:
        yield work


@contextmanager
def _shown(work: RunningWork) -> Iterator[RunningWork]:
    collect_from_here()
    ended = threading.Event()
    shown = _on_terminal if MESSAGES.is_terminal else partial(_in_lines, START_UP.end())
    thread = threading.Thread(target=shown, args=(work, ended), daemon=True)
    thread.start()
    try:
        yield work
    finally:
        ended.set()
        thread.join()


def _on_terminal(work: RunningWork, ended: threading.Event) -> None:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=MESSAGES, transient=True) as bar:
        task, begun = bar.add_task(work.description, total=None), work.begun
        while not ended.wait(0.1):
            if begun != work.begun:
                # the bar's own time is that of the part that it names
                begun = work.begun
                bar.reset(task, total=None)
            done, total = work.counts
            bar.update(task, description=work.description, completed=done, total=total)
            sentence = work.announcement()
            if sentence is not None:
                bar.console.print(sentence, markup=False)


def _in_lines(silent: float, work: RunningWork, ended: threading.Event) -> None:
    """Print lines on work before which nothing was said for so long, s."""
    due = time.monotonic() + max(FIRST_LINE - silent, 0.0)
    before = ""
    while not ended.wait(min(_LOOKED_EVERY, max(due - time.monotonic(), 0.0))):
        sentence = work.announcement()
        if sentence is None and time.monotonic() < due:
            continue
        line = sentence or work.line()
        # the same line twice would say that nothing goes on
        later = f"{line}, {elapsed_in_words(work.elapsed)} so far"
        print_message(later if line == before else line)
        before = line
        due = time.monotonic() + NEXT_LINE


def announce_compilation(driver: object | None = None) -> None:
    """Announce that the first use compiles, where the cache does not hold the kernels yet.

    Parameters
    ----------
    driver : compiled function, optional
        The only one asked for; by default any kernel will do.
    """
    from chatter.engine.presets import CACHE_FOLDER, is_compiled

    known = any(CACHE_FOLDER.rglob("*.nbi")) if driver is None else is_compiled(driver)
    if not known:
        print_message("first use: compiling the numerical kernels, once, about half a minute ...")


def announce_resumed(noun: str, before: int, total: int) -> None:
    """Announce how many parts of a study an earlier run has finished."""
    print_message(f"{before} of {total} {noun} were finished before")
