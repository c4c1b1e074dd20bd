"""Leaves of a force on the flank: what the kernels call, by the type of its table."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class FlankLeaves:
    """Leaves of the force on the flank, by the type of their table."""

    table: type  # NamedTuple
    #: table, tooth, segment, position, what the position changes by as the edge turns, m/rad, rate
    #: and cutting speed -> tangential and radial force per length of edge, N/m
    force: Callable
    #: takes in the surface that the edge has left in this step, m along its outward normal
    store: Callable
    clear: Callable  # clears what lies behind an edge that has left the cut
    has_memory: bool = False  # the force depends on the surface behind the edge
