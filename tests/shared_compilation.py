"""Several processes of tests that need the same kernel compile it once.

Each would compile what is not in the cache yet. Here whoever comes second waits until the kernel is
in the cache, and takes it from there: that costs less than a second, where to compile costs ten.
"""

import hashlib
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from numba.core.caching import FunctionCache
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

from chatter.engine.presets import CACHE_FOLDER
from chatter.stability.methods.collocation import first_use

try:
    import fcntl
except ImportError:  # on Windows each process compiles for itself
    fcntl = None

FOLDER = CACHE_FOLDER / "locks"
#: what this process has passed and not left
_PASSED: set[str] = set()


@contextmanager
def one_process(name: str) -> Iterator[None]:
    """Let one process at a time pass; a process that ends lets go, and one may pass within."""
    if name in _PASSED:
        yield
        return
    FOLDER.mkdir(parents=True, exist_ok=True)
    with (FOLDER / name).open("w", encoding="ascii") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        _PASSED.add(name)
        try:
            yield
        finally:
            _PASSED.remove(name)


class LockOfAllProcesses:
    """In place of the lock of a module that keeps its threads apart."""

    def __init__(self, name: str) -> None:
        self._name, self._threads = name, threading.Lock()

    def __enter__(self) -> None:
        self._threads.acquire()
        self._passing = one_process(self._name)
        self._passing.__enter__()

    def __exit__(self, *error: object) -> None:
        try:
            self._passing.__exit__(*error)
        finally:
            self._threads.release()


def compile_once() -> None:
    """From now on a kernel that another process compiles is waited for."""
    if fcntl is None:
        return
    compile_as_numba_does = Dispatcher.compile

    def compile_or_wait(dispatcher: Dispatcher, signature: object) -> object:
        cached = isinstance(dispatcher._cache, FunctionCache)
        if not cached or signature in dispatcher.overloads:
            return compile_as_numba_does(dispatcher, signature)
        function = dispatcher.py_func
        asked = f"{function.__module__} {function.__qualname__} {signature}"
        name = hashlib.sha256(asked.encode()).hexdigest()[:24]
        # the lock of the compiler first, as everywhere: a thread that has it may ask for this one
        with global_compiler_lock, one_process(name):
            return compile_as_numba_does(dispatcher, signature)

    Dispatcher.compile = compile_or_wait
    first_use._compiling = LockOfAllProcesses("collocation")
