"""Forces on the flank behind the edge: none, viscous process damping, or ploughing.

A law is added by a table and leaves in its own module, and its entries here. Every table answers
three calls: the force at a place of the edge, the surface left by a step, and the end of contact.
"""

from __future__ import annotations

from typing import NamedTuple

from numba.extending import register_jitable

from cutting.compiled import INLINED, by_table
from cutting.process_damping.ploughing import (
    PloughingFlank,
    clear_surface_history,
    ploughing_force,
    store_surface_history,
)
from cutting.process_damping.viscous import ViscousFlank, no_clear, no_store, viscous_force


class BareFlank(NamedTuple):
    """A flank that touches nothing."""

    unused: float = 0.0


@register_jitable(**INLINED)
def bare_force(flank, tooth, piece, place, rate, speed):  # noqa: ARG001
    """No force."""
    return 0.0, 0.0


#: tangential and radial force per length of edge, N/m
flank_force = by_table(
    {BareFlank: bare_force, ViscousFlank: viscous_force, PloughingFlank: ploughing_force}
)
#: takes in the surface that the edge has left in this step, m along its outward normal
store_surface = by_table(
    {BareFlank: no_store, ViscousFlank: no_store, PloughingFlank: store_surface_history}
)
#: clears what lies behind an edge that has left the cut
end_contact = by_table(
    {BareFlank: no_clear, ViscousFlank: no_clear, PloughingFlank: clear_surface_history}
)
