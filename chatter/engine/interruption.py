"""Ctrl-C and compiled code: an exception while results are handed to Python can end the process."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interruptions_deferred() -> Iterator[None]:
    """Hold Ctrl-C back until compiled code has returned; a second one is passed on at once.

    Tuples of tuples are built by Python code while they are handed over, and an exception there is
    a segmentation fault. Only the main thread receives Ctrl-C.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    held: list[tuple] = []

    def hold(*arguments) -> None:
        held.append(arguments)
        if len(held) > 1:
            before(*arguments)

    signal.signal(signal.SIGINT, hold)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if len(held) == 1:
            before(*held[0])
