"""How leaves of compiled code are decorated, and chosen by the type of their table.

`cutting` and `dynamics` know nothing of each other: both have this module, and a test keeps the
two alike. The drivers of `chatter` build on it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from numba import types
from numba.extending import overload

#: nothing is allocated in a time loop, so that references need no counting: it costs more there
#: than the physics
UNCOUNTED = {"error_model": "numpy", "_nrt": False}
#: leaves become part of the loop that calls them
INLINED = {**UNCOUNTED, "forceinline": True}


def by_table(kernels: Mapping[type, Callable]) -> Callable:
    """Return a function that calls the kernel of the type of its first argument, a table.

    In compiled code the kernel is chosen when the driver is compiled.
    """

    def call(table, *rest):
        return kernels[type(table)](table, *rest)

    @overload(call, jit_options=INLINED, strict=False)
    def _compiled(table, *rest):  # noqa: ARG001
        return kernels.get(getattr(table, "instance_class", types.NoneType))

    return call


def for_each(call: Callable) -> Callable:
    """Return a function that makes a call for every table of a tuple, in their order.

    It takes the tuple and the two further arguments of the call.
    """

    def calls(tables, first, second):
        for table in tables:
            call(table, first, second)

    @overload(calls, jit_options=INLINED)
    def _compiled(tables, first, second):  # noqa: ARG001
        if len(tables) == 0:
            return lambda tables, first, second: None  # noqa: ARG005

        def rest(tables, first, second):
            call(tables[0], first, second)
            calls(tables[1:], first, second)

        return rest

    return calls
