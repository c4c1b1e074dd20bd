"""Leaves of laws: plain functions to Python, and to numba as soon as there is compiled code.

A law owns its keys and its leaf, in one module. Reading a case needs the keys alone, and must not
wait for the compiler to load: what is decorated here waits until something is to be compiled
(`compiled` is imported), and is then handed to numba as `register_jitable` and `overload` do it.

`cutting` and `dynamics` know nothing of each other: both have this module, and a test keeps the
two alike.
"""

import sys
from collections.abc import Callable, Mapping
from typing import TypeVar

Leaf = TypeVar("Leaf", bound=Callable)

#: nothing is allocated in a time loop, so that references need no counting: it costs more there
#: than the physics
UNCOUNTED = {"error_model": "numpy", "_nrt": False}
#: leaves become part of the loop that calls them, and need no entry of their own
INLINED = {**UNCOUNTED, "forceinline": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}

_WAITING: list[Callable[[], None]] = []


def leaf(function: Leaf) -> Leaf:
    """Decorate a leaf of a law, which compiled code inlines."""

    def register() -> None:
        from numba.extending import register_jitable

        register_jitable(**INLINED)(function)

    _once_numba_is_there(register)
    return function


def by_table(kernels: Mapping[type, Callable]) -> Callable:
    """Return a function that calls the kernel of the type of its first argument, a table.

    In compiled code the kernel is chosen when the driver is compiled.
    """

    def call(table, *rest):
        return kernels[type(table)](table, *rest)

    def register() -> None:
        from numba import types
        from numba.extending import overload

        @overload(call, jit_options=INLINED, strict=False)
        def _compiled(table, *rest):  # noqa: ARG001
            return kernels.get(getattr(table, "instance_class", types.NoneType))

    _once_numba_is_there(register)
    return call


def hand_over() -> None:
    """Hand everything that waits to numba."""
    while _WAITING:
        _WAITING.pop(0)()


def _once_numba_is_there(register: Callable[[], None]) -> None:
    _WAITING.append(register)
    if "numba" in sys.modules:
        hand_over()
