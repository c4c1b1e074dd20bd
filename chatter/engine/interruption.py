"""Ctrl-C and compiled code: an exception while results are handed to Python can end the process.

numba calls short functions of Python while it hands the results of compiled code over, and while
it loads code. Python runs the handler of Ctrl-C in the first of them; numba does not look whether
it raised, which is a segmentation fault. Other libraries in C call Python and drop the exception.
"""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

#: modules whose functions are called where an exception ends the process, or is lost
_CALLED_WITHIN = ("numba.core.serialize", "llvmlite.binding.executionengine")
#: in the name of the module of the constructor of a named tuple
_NAMED_TUPLE = "namedtuple_"
#: s: until Ctrl-C is tried again
_LATER = 0.002


def defer_interruptions() -> None:
    """Hold Ctrl-C back, from here on, while compiled code hands results over.

    Only the main thread receives Ctrl-C; what ignores it, or has no handler of Python, stays.
    """
    is_new = _deferred() is not None
    # a notebook sets its own handler before every cell
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if shell is not None and is_new:
        shell.events.register("pre_run_cell", _deferred)


@contextmanager
def interruptions_deferred() -> Iterator[None]:
    """Hold Ctrl-C back while compiled code hands results over, whoever set its handler since."""
    before = _deferred()
    try:
        yield
    finally:
        if before is not None:
            signal.signal(signal.SIGINT, before)


def repeat_swallowed_interruptions() -> None:
    """Send Ctrl-C again, from here on, where what called Python from C dropped it.

    It takes the place of the traceback that Python prints of a lost exception; other exceptions
    are told as before.
    """
    sys.unraisablehook = _Repeating(sys.unraisablehook)
    # an exception within the hook would be lost as well
    _deferred()


class _Repeating:
    """Hook for exceptions that nobody passes on, before another."""

    def __init__(self, hook: Callable[["sys.UnraisableHookArgs"], Any]) -> None:
        self._hook = hook

    def __call__(self, lost: "sys.UnraisableHookArgs") -> None:
        """Send Ctrl-C again; tell everything else as before."""
        if issubclass(lost.exc_type, KeyboardInterrupt):
            _send_later(signal.SIGINT)
        else:
            self._hook(lost)


def _deferred(*_: object) -> Callable[..., Any] | None:
    """Set the handler, and return the one before; None where that is to stay."""
    before = signal.getsignal(signal.SIGINT)
    main = threading.current_thread() is threading.main_thread()
    if not main or not callable(before) or isinstance(before, _Deferring):
        return None
    signal.signal(signal.SIGINT, _Deferring(before))
    return before


class _Deferring:
    """Handler that passes Ctrl-C on to another once Python, not compiled code, is interrupted."""

    def __init__(self, handler: Callable[..., Any]) -> None:
        self._handler = handler

    def __call__(self, number: int, frame: FrameType | None) -> Any:
        """Handle the signal in a frame."""
        if not _drops_exceptions(frame):
            return self._handler(number, frame)
        _send_later(number)
        return None


def _send_later(number: int) -> None:
    again = threading.Timer(_LATER, _interrupt_main_thread, [number])
    again.daemon = True
    again.start()


def _interrupt_main_thread(number: int) -> None:
    """Send a signal so that the main thread handles it at once, also while it waits."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident, number)
    else:
        signal.raise_signal(number)


def _drops_exceptions(frame: FrameType | None) -> bool:
    """Whether the frame, or one that called it, is called from C that does not look for errors."""
    while frame is not None:
        module = str(frame.f_globals.get("__name__", ""))
        if module in _CALLED_WITHIN or module.startswith(_NAMED_TUPLE):
            return True
        if frame.f_code is _Repeating.__call__.__code__:
            return True
        frame = frame.f_back
    return False
