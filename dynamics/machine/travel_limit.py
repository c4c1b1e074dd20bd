"""Limit of the travel of every port: beyond it a machine has run away."""

from typing import NamedTuple

from numba.extending import register_jitable

from dynamics.compiled import INLINED


class TravelLimit(NamedTuple):
    """Displacement of any port at which a run halts."""

    furthest: float  # m (rad)


@register_jitable(**INLINED)
def travel_limit_commit(group, bus, clock):  # noqa: ARG001
    """Halt where a port is too far away."""
    for p in range(bus.u.shape[0]):
        # not below: also true of what is not a number
        if not abs(bus.u[p]) <= group.furthest:
            bus.halted[0] = 1
