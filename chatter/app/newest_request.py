"""The newest request wins: a computation asks now and then whether a newer one has come."""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

from chatter.description.errors import RunError

#: pages that are remembered
_MOST_PAGES = 32


class SupersededError(Exception):
    """A newer request of the same page and kind has come, or the server ends."""


class NewestRequest:
    """Runs one computation at a time; those that a newer request supersedes are given up.

    So is a computation after the time `longest`, s.
    """

    def __init__(self, longest: float) -> None:
        self._longest = longest
        self._newest: OrderedDict[str, int] = OrderedDict()
        self._count = 0
        self._guard = threading.Lock()
        self._computing = threading.Lock()
        self._ended = threading.Event()

    def run(self, page: str, compute: Callable[[Callable[..., None]], Any]) -> Any:
        """Return what a function computes, of a callable to be called now and then.

        SupersededError is raised if a newer request of the page has come, RunError if it takes
        too long.
        """
        with self._guard:
            self._count += 1
            ticket = self._newest[page] = self._count
            self._newest.move_to_end(page)
            while len(self._newest) > _MOST_PAGES:
                self._newest.popitem(last=False)

        def go_on(*_: Any) -> None:
            if self._ended.is_set() or self._newest.get(page) != ticket:
                raise SupersededError
            if time.monotonic() > deadline:
                raise RunError(
                    f"given up after {self._longest:g} s; the command line has no such limit"
                )

        deadline = float("inf")
        with self._computing:
            deadline = time.monotonic() + self._longest
            go_on()
            found = compute(go_on)
            go_on()
            return found

    def end(self) -> None:
        """Give up whatever is computed."""
        self._ended.set()
