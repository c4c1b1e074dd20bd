"""What is said on the page while code is compiled that is used for the first time."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

NOTE = "compiling what is used for the first time: up to some minutes, once"
#: s of compiling from which on it is reported
_PATIENCE = 1.0


@contextmanager
def reported_while_compiling(
    report: Callable[[str], None], patience: float = _PATIENCE
) -> Iterator[None]:
    """Report, from a thread of its own, when what is done inside waits for the compiler.

    Parameters
    ----------
    report : callable
        Called with a sentence, once for each time that it begins to wait.
    patience : float
        s between looks.
    """
    from chatter.first_steps.compiling import is_compiling

    ended = threading.Event()

    def watch() -> None:
        reported = False
        while not ended.wait(patience):
            waits = is_compiling()
            if waits and not reported:
                report(NOTE)
            reported = waits

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()
