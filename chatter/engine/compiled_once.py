"""Functions that compiled code alone calls are optimised once, as parts of their driver.

numba optimises and translates every function for itself before it links it to what calls it, which
is then optimised and translated again with all that it holds. Through the levels of a time loop
that is up to half of the time of its compilation. A function without an entry for Python is only
linked here. What numba itself puts in place of functions of Python and numpy needs no entry either.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from numba import jit
from numba.core import environment
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.typing.templates import _OverloadFunctionTemplate

#: beginnings of the names of entries, for Python and for C
_ENTRIES = ("_ZN7cpython", "_ZN5cfunc")
_ENVIRONMENT = "_ZN08NumbaEnv"

_NO_ENTRIES = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

_set_environment_as_numba_does = JITCPUCodegen.set_env
_decorator_as_numba_has_it = _OverloadFunctionTemplate._get_jit_decorator


def compile_once() -> None:
    """Let numba leave functions without an entry to what calls them."""
    JITCPUCodegen._library_class = CompiledOnce
    JITCPUCodegen.set_env = _set_environment
    _OverloadFunctionTemplate._get_jit_decorator = _decorator_of_replacement


def _set_environment(codegen: Any, name: str, of_function: Any) -> None:
    """Set the environment of a function where there is machine code that refers to it."""
    if codegen._engine.get_global_value_address(name):
        _set_environment_as_numba_does(codegen, name, of_function)


def _decorator_of_replacement(template: Any) -> Callable:
    """Decorator of what stands in place of a function, which compiled code alone calls."""
    decorator = _decorator_as_numba_has_it(template)
    # what is compiled for other processors has other options
    return partial(jit, **_NO_ENTRIES) if decorator is jit else decorator


class CompiledOnce(JITCodeLibrary):
    """Code of a function, which becomes machine code only if it has an entry."""

    _is_part: bool | None = None  # not yet known
    _is_linked = False

    def get_pointer_to_function(self, name: str) -> int:
        """Address of a function; 0 where there is none of the name."""
        if self._is_left_to_callers():
            if not _defines(self._final_module, (name,)):
                return 0
            # its address is wanted, so that it needs machine code of its own
            self._is_part = False
        return super().get_pointer_to_function(name)

    def _is_left_to_callers(self) -> bool:
        if self._is_part is None:
            self._is_part = not self._finalized and not _defines(self._final_module, _ENTRIES)
        return self._is_part

    def _ensure_finalized(self) -> None:
        if not self._is_left_to_callers():
            super()._ensure_finalized()
        elif not self._is_linked:
            self._is_linked = True
            self.finalize()

    def _optimize_final_module(self) -> None:
        if not self._is_part:
            super()._optimize_final_module()

    def _finalize_final_module(self) -> None:
        if self._is_part:
            return
        super()._finalize_final_module()
        for variable in self._final_module.global_variables:
            if variable.name.startswith(_ENVIRONMENT):
                of_part = environment.lookup_environment(variable.name)
                if of_part is not None:
                    self._codegen.set_env(variable.name, of_part)


def _defines(module: Any, beginnings: tuple[str, ...]) -> bool:
    """Whether a module holds a function whose name begins so."""
    return any(
        function.name.startswith(beginnings) and not function.is_declaration
        for function in module.functions
    )
