"""A word while the program is loaded, where that takes longer than people wait in silence."""

from __future__ import annotations

import sys
import threading
import time

#: s from the start of the program to the word
_SAID_AFTER = 1.5
_LOOKED_EVERY = 0.1
_PRINTED_WITHIN = 2.0
_IMPORT = "<frozen importlib._bootstrap>"


class StartUp:
    """Start of the program, up to the first work that shows its own progress.

    The word is said only while the main thread imports: a question that waits for its answer, or
    a result that is printed, is not silence.
    """

    def __init__(self) -> None:
        #: time of the last word, on the clock of `time.monotonic`; None after the first work began
        self._last_word: float | None = None
        self._over = threading.Event()
        self._watching: threading.Thread | None = None

    def begin(self) -> None:
        """Begin to watch, once in a process."""
        self._last_word = time.monotonic()
        self._watching = threading.Thread(target=self._watch, daemon=True)
        self._watching.start()

    def end(self) -> float:
        """End with the first work; returns how long nothing has been said before it, s."""
        silent = 0.0 if self._last_word is None else time.monotonic() - self._last_word
        self._last_word = None
        self._over.set()
        return silent

    def close(self) -> None:
        """End before the process does: Python aborts where a thread is printing at its end."""
        self._over.set()
        if self._watching is not None:
            self._watching.join(_PRINTED_WITHIN)

    def _watch(self) -> None:
        if self._over.wait(_SAID_AFTER):
            return
        while not is_importing(threading.main_thread()):
            if self._over.wait(_LOOKED_EVERY):
                return
        from chatter.report.console import print_message

        print_message("loading the program ...")
        if self._last_word is not None:
            self._last_word = time.monotonic()


def is_importing(thread: threading.Thread) -> bool:
    """Whether a thread is within an import."""
    frame = sys._current_frames().get(thread.ident or 0)
    while frame is not None:
        if frame.f_code.co_filename == _IMPORT:
            return True
        frame = frame.f_back
    return False


START_UP = StartUp()
