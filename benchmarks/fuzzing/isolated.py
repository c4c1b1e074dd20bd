"""Inputs answered in forked processes, when everything is compiled, each within limits."""

from __future__ import annotations

import os
import resource
import signal
import time
import traceback
from collections.abc import Callable
from multiprocessing import Pipe
from pathlib import Path

from chatter.description.errors import InputError, RunError
from dynamics.frf.container import MeasurementError
from dynamics.structure.linear_structure import StructureError

#: processor time of an answer, s, and memory beyond that of the program, bytes
SECONDS, MEMORY = 10, 2 << 30
_GRACE = 120  # s of the clock, where other programs share the processor
_MOST_ANSWERS = 200  # of one process, so that what it keeps does not add up

ANSWERED, REFUSED, FAILED = "answered", "refused", "run failed in words"
AS_IT_SHOULD = (ANSWERED, REFUSED, FAILED)


def in_words(answer: Callable[[], str | None], names: tuple[str, ...]) -> str:
    """How an answer ends: one of `AS_IT_SHOULD`, or what is wrong.

    `names`: words of which a refusal has to hold one, such as the file.
    """
    try:
        return answer() or ANSWERED
    except (InputError, MeasurementError, StructureError) as error:
        texts = error.messages if isinstance(error, InputError) else [str(error)]
        return refusal(texts, names)
    except RunError:
        return FAILED
    except MemoryError:
        return "memory"
    except Exception as error:  # what is looked for
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"{type(error).__name__} at {Path(place.filename).name}:{place.lineno}: {error}"


def refusal(texts: list[str] | tuple[str, ...], names: tuple[str, ...]) -> str:
    """`REFUSED` where every text holds one of the names."""
    for text in texts:
        if not any(name in text for name in names):
            return f"refusal without a file: {text}"
    return REFUSED


def late(words: str) -> bool:
    """Whether a process was ended for the time that it took."""
    return words.startswith("no answer")


class Worker:
    """A forked process that answers one input after the other; one that ends is forked anew.

    Parameters
    ----------
    answer : callable
        Numbers that tell what is asked -> how it ends, in words.
    """

    def __init__(self, answer: Callable[..., str]) -> None:
        self._answer = answer
        self._child = 0
        self._asked = 0

    def ask(self, *numbers: int, seconds: int = SECONDS) -> str:
        """Words of the answer; what ends the process is put in words, too."""
        if not self._child or self._asked >= _MOST_ANSWERS:
            self.end()
            self._fork()
        self._asked += 1
        self._near.send_bytes(" ".join(map(str, (seconds, *numbers))).encode())
        try:
            if self._near.poll(_GRACE + seconds):
                return self._near.recv_bytes().decode() or "ended without a word"
        except (EOFError, ConnectionResetError):
            pass
        return self._ended(seconds)

    def end(self) -> None:
        """End the process."""
        if self._child:
            os.kill(self._child, signal.SIGKILL)
            os.waitpid(self._child, 0)
            self._near.close()
        self._child = 0

    def _ended(self, seconds: int) -> str:
        """How the process ended; it is killed where it goes on."""
        child, status = os.waitpid(self._child, os.WNOHANG)
        if not child:
            os.kill(self._child, signal.SIGKILL)
            _, status = os.waitpid(self._child, 0)
        self._child = 0
        self._near.close()
        if os.WIFSIGNALED(status):
            too_long = os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL)
            return f"no answer within {seconds} s" if too_long else f"signal {os.WTERMSIG(status)}"
        return "ended without a word"

    def _fork(self) -> None:
        self._near, far = Pipe()
        self._asked = 0
        self._child = os.fork()
        if self._child:
            far.close()
            return
        self._near.close()
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 1)
        os.dup2(nothing, 2)
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
        try:
            while True:
                seconds, *numbers = map(int, far.recv_bytes().split())
                spent = int(time.process_time()) + 1
                resource.setrlimit(resource.RLIMIT_CPU, (spent + seconds, resource.RLIM_INFINITY))
                far.send_bytes(self._answer(*numbers)[:2000].encode(errors="replace"))
        finally:
            os._exit(0)
