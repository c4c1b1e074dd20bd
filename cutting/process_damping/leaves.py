"""Leaves of a force on the flank: what the kernels call, by the type of its table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class FlankLeaves:
    """Leaves of the force on the flank, by the type of their table.

    Parameters
    ----------
    table : type
        NamedTuple.
    force : callable
        Table, tooth, segment, position, rate and cutting speed -> tangential and radial force per
        length of edge, N/m.
    store : callable
        Takes in the surface that the edge has left in this step, m along its outward normal.
    clear : callable
        Clears what lies behind an edge that has left the cut.
    has_memory : bool
        The force depends on the surface behind the edge.
    """

    table: type
    force: Callable
    store: Callable
    clear: Callable
    has_memory: bool = False
