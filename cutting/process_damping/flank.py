"""Forces on the flank behind the edge: none, viscous process damping, or ploughing.

A law is added by a table and leaves in its own module, and its entries here. Every table answers
three calls: the force at a place of the edge, the surface left by a step, and the end of contact.
"""

from __future__ import annotations

from typing import NamedTuple

from numba import types
from numba.extending import overload, register_jitable

from cutting.force.edge_force import INLINED
from cutting.process_damping.ploughing import (
    PloughingFlank,
    forget_wave,
    note_wave,
    ploughing_force,
)
from cutting.process_damping.viscous import ViscousFlank, no_note, no_wave, viscous_force


class BareFlank(NamedTuple):
    """A flank that touches nothing."""

    unused: float = 0.0


@register_jitable(**INLINED)
def bare_force(flank, tooth, piece, place, rate, speed):  # noqa: ARG001
    """No force."""
    return 0.0, 0.0


#: table -> leaf
FLANK_FORCES = {
    BareFlank: bare_force,
    ViscousFlank: viscous_force,
    PloughingFlank: ploughing_force,
}
FLANK_NOTES = {BareFlank: no_note, ViscousFlank: no_note, PloughingFlank: note_wave}
FLANK_ENDS = {BareFlank: no_wave, ViscousFlank: no_wave, PloughingFlank: forget_wave}


def _leaf(leaves, flank):
    return leaves.get(flank.instance_class) if isinstance(flank, types.BaseNamedTuple) else None


def flank_force(flank, tooth, piece, place, rate, speed):
    """Tangential and radial force per length of edge, N/m; see the leaves."""
    return FLANK_FORCES[type(flank)](flank, tooth, piece, place, rate, speed)


@overload(flank_force, jit_options=INLINED)
def _flank_force(flank, tooth, piece, place, rate, speed):  # noqa: ARG001
    return _leaf(FLANK_FORCES, flank)


def note_surface(flank, tooth, piece, surface):
    """Take in the surface that the edge has left in this step, m along its outward normal."""
    FLANK_NOTES[type(flank)](flank, tooth, piece, surface)


@overload(note_surface, jit_options=INLINED)
def _note_surface(flank, tooth, piece, surface):  # noqa: ARG001
    return _leaf(FLANK_NOTES, flank)


def end_contact(flank, tooth, piece):
    """Forget what lies behind an edge that has left the cut."""
    FLANK_ENDS[type(flank)](flank, tooth, piece)


@overload(end_contact, jit_options=INLINED)
def _end_contact(flank, tooth, piece):  # noqa: ARG001
    return _leaf(FLANK_ENDS, flank)
