"""Ctrl-C that libraries in C swallow comes again: they call Python, and pass no exception on."""

import signal
import sys
import threading

#: s: until Ctrl-C is tried again, when the library has gone on
_LATER = 0.002


def repeat_lost_interruptions() -> None:
    """Send Ctrl-C again where it was swallowed, in place of a traceback of Python."""
    told_before = sys.unraisablehook

    def hook(lost: "sys.UnraisableHookArgs") -> None:
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            told_before(lost)
            return
        again = threading.Timer(_LATER, _interrupt_main_thread)
        again.daemon = True
        again.start()

    sys.unraisablehook = hook


def _interrupt_main_thread() -> None:
    """Interrupt the main thread, also while it waits."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
    else:
        signal.raise_signal(signal.SIGINT)
