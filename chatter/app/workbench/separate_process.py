"""Long computations in a process of their own: a crash or a cancelled one leaves the page alone."""

from __future__ import annotations

import multiprocessing
import signal
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from chatter.app.workbench.compiling_note import reported_while_compiling
from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress

#: s, from one look at the process to the next
_INTERVAL = 0.05
#: called with what is being done and the share of it that is done
Report = Callable[[str, float], None]


def in_own_process(
    function: Callable[..., Any], arguments: tuple[Any, ...], go_on: Progress, report: Report
) -> Any:
    """Call a function of a module in a process of its own, and return what it returns.

    Parameters
    ----------
    function : callable
        Called with the arguments and a `Report`; what it returns is sent back.
    arguments : tuple
    go_on : callable
        Raises to give up; the process is ended then.
    report : callable

    Raises
    ------
    InputError, RunError
        As the function raises them; RunError if the process crashes.
    """
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_call, args=(there, function, arguments), daemon=True)
    process.start()
    there.close()
    try:
        while True:
            go_on(0, 0)
            if not here.poll(_INTERVAL):
                continue
            try:
                kind, content = here.recv()
            except EOFError:
                break
            if kind == "progress":
                report(*content)
            elif kind == "done":
                return content
            else:
                raise (InputError if kind == "input" else RunError)(content)
        process.join(1.0)
        raise RunError(f"the computation has crashed (exit code {process.exitcode})")
    finally:
        process.kill()
        process.join()
        here.close()


def _call(there: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    """Call the function in its process and send what comes of it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the page ends it

    one_at_a_time = threading.Lock()
    done = 0.0

    def report(stage: str, share: float) -> None:
        nonlocal done
        with one_at_a_time:
            done = share
            there.send(("progress", (stage, share)))

    try:
        with reported_while_compiling(lambda text: report(text, done)):
            found = function(*arguments, report)
        there.send(("done", found))
    except InputError as error:
        there.send(("input", error.messages))
    except RunError as error:
        there.send(("run", str(error)))
    except Exception as error:
        there.send(("run", f"a fault in chatter itself ({type(error).__name__}: {error})"))
