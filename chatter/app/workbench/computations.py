"""Computations of a session, in a thread of their own: the newest one waits, a failure is shown."""

import threading
from collections.abc import Callable
from typing import NamedTuple

from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress
from chatter.engine.parallel import kept_threads


class SupersededError(Exception):
    """A newer computation waits, or the user has given this one up."""


class Computation(NamedTuple):
    """What to compute, and whether a newer computation may end it."""

    run: Callable[[Progress], None]  # of a callable that may raise to give up
    may_be_superseded: bool
    #: s for which nothing newer may come before it is begun: a slider that moves has come to rest
    rest: float = 0.0
    #: what is said once the user has given it up
    when_cancelled: str = "cancelled"


class Computations:
    """Runs one computation at a time; of those that wait, only the newest is kept.

    Parameters
    ----------
    report : callable
        Called with a sentence for the user, empty when all is well.
    """

    def __init__(self, report: Callable[[str], None]) -> None:
        self._report = report
        self._changed = threading.Condition()
        self._waiting: tuple[Computation, ...] = ()
        self._running = False
        self._cancelled = False
        self._ended = False
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def start(self, *steps: Computation) -> None:
        """Compute the steps one after the other, in place of those that still wait."""
        with self._changed:
            self._waiting = steps
            self._changed.notify_all()

    def cancel(self) -> None:
        """Give up what is computed and what waits."""
        with self._changed:
            self._waiting = ()
            self._cancelled = self._running
            self._changed.notify_all()

    def end(self) -> None:
        """Give up everything, and the thread with it."""
        self.cancel()
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    def wait(self, longest: float) -> bool:
        """Wait until nothing is left to compute; False after the time `longest`, s."""
        with self._changed:
            return self._changed.wait_for(lambda: not (self._waiting or self._running), longest)

    def _work(self) -> None:
        # starting threads for each diagram would cost it a millisecond or two
        with kept_threads():
            self._take_turns()

    def _take_turns(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: bool(self._waiting) or self._ended)
                if self._ended:
                    return
                steps = self._waiting
                step, *others = steps
                if step.rest > 0.0 and self._changed.wait_for(self._unlike(steps), step.rest):
                    continue
                self._waiting, later = (), tuple(others)
                self._running, self._cancelled = True, False
            self._run(step)
            with self._changed:
                self._running = False
                if not self._waiting and not self._cancelled:
                    self._waiting = later
                self._changed.notify_all()

    def _unlike(self, steps: tuple[Computation, ...]) -> Callable[[], bool]:
        """Whether other steps wait by now, or none."""
        return lambda: self._ended or self._waiting is not steps

    def _run(self, step: Computation) -> None:
        def go_on(*_: object) -> None:
            if self._cancelled or (step.may_be_superseded and self._waiting):
                raise SupersededError

        try:
            step.run(go_on)
        except SupersededError:
            if self._cancelled:
                self._report(step.when_cancelled)
        except (InputError, RunError) as error:
            self._report(str(error))
        except Exception as error:  # whatever fails, the page lives on
            self._report(f"a fault in chatter itself ({type(error).__name__}: {error})")
