"""Compiled code is taken from the disk without what only a compiler needs.

numba is ready to compile before it takes a function from its cache: it loads all it knows of the
functions of Python and numpy, the modules of all that the function calls, and the function in the
form that others are linked to. That is most of the time from the start of a short command to its
result. The function itself calls the runtime of numba and the C library alone. What is to be
compiled or linked after all loads the rest by itself.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
from numba.core import environment
from numba.core.caching import FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.environment import Environment
from numba.core.runtime import rtsys

_load_as_numba_does = FunctionCache.load_overload
_rebuild_as_numba_does = environment._rebuild_env


def load_without_compiler(folder: Path) -> None:
    """Take functions that are kept below a folder from the disk without what a compiler needs."""
    kept_below = str(folder)

    def load_overload(cache: Any, signature: Any, target: Any) -> Any:
        if not cache.cache_path.startswith(kept_below):
            return _load_as_numba_does(cache, signature, target)
        rtsys.initialize(target)
        with cache._guard_against_spurious_io_errors(), _as_kept(target.codegen()):
            return cache._load_overload(signature, target)
        return None

    FunctionCache.load_overload = load_overload


@contextmanager
def _as_kept(codegen: Any) -> Iterator[None]:
    """Let libraries and environments be rebuilt as they are here, not as numba does."""
    environment._rebuild_env = _without_module
    codegen._library_class = _KeptLibrary
    try:
        yield
    finally:
        del codegen._library_class
        environment._rebuild_env = _rebuild_as_numba_does


class _KeptLibrary(JITCodeLibrary):
    """Machine code from the disk; its bitcode is read where other code is linked to it."""

    _shared_module: Any

    @classmethod
    def _unserialize(cls, codegen: Any, state: Any) -> Any:
        name, kind, data = state
        if kind != "object":
            return JITCodeLibrary._unserialize(codegen, state)
        self = codegen.create_library(name)
        self._machine_code, self._bitcode = data
        self.enable_object_caching()
        self._set_compiled_object(self._machine_code)
        self._finalize_final_module()
        return self

    def get_pointer_to_function(self, name: str) -> int:
        """Address of a function; 0 where the machine code does not have its name."""
        if name.encode() in self._machine_code:
            self._codegen._engine._defined_symbols.add(name)
        return super().get_pointer_to_function(name)

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None:
            self._shared_module = llvm.parse_bitcode(self._bitcode)
            self._codegen._engine._load_defined_symbols(self._shared_module)
        return self._shared_module


def _without_module(module: str, constants: list[Any], name: str) -> Environment:
    """Environment of a function; those of numba itself use no Python objects and no module."""
    if not module.startswith("numba.") or module in sys.modules:
        return _rebuild_as_numba_does(module, constants, name)
    found = environment.lookup_environment(name)
    if found is not None:
        return found
    made = Environment({"__name__": module})
    made.consts[:] = constants
    made.env_name = name
    Environment._memo[name] = made
    return made
