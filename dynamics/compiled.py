"""How compiled code is decorated, and calls what is chosen by the type of a table.

Compiled code that calls leaves has its `njit` from here, or its presets from
`chatter.engine.presets`: the leaves of laws wait for this module (see `leaves` beside it).

`cutting` and `dynamics` know nothing of each other: both have this module, and a test keeps the
two alike.
"""

from collections.abc import Callable

from numba import njit as njit
from numba.extending import overload

from dynamics.leaves import INLINED as INLINED
from dynamics.leaves import UNCOUNTED as UNCOUNTED
from dynamics.leaves import by_table as by_table
from dynamics.leaves import hand_over

hand_over()


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
