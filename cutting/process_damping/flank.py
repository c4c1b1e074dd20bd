"""Forces on the flank behind the edge: none, viscous process damping, or ploughing.

A law is added by its module, which ends in `FlankLeaves`, and by its line here. Every table answers
three calls: the force on a segment of the edge, the surface left by a step, the end of contact.
"""

from typing import NamedTuple, Protocol

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED, by_table
from cutting.process_damping.leaves import FlankLeaves
from cutting.process_damping.linear_flank import LinearFlank
from cutting.process_damping.ploughing import PLOUGHING
from cutting.process_damping.viscous import VISCOUS, ViscousProcessDamping, no_clear, no_store


class ProcessDampingLaw(Protocol):
    """Parameters of the force on the flank, SI."""

    @property
    def small_vibration(self) -> ViscousProcessDamping:
        """Dashpot that the flank is for small vibration about a still tool."""

    def linear(self, radius: float) -> LinearFlank:
        """The same for compiled linear analysis, of a tool of this radius, m."""

    def table(self, radius: NDArray[np.float64], teeth: int, step_angle: float) -> NamedTuple:
        """Table for the kernels.

        From the radius of the edge slices (L,), m, and the rotation in a time step, rad.
        """


class BareFlank(NamedTuple):
    """A flank that touches nothing."""

    unused: float = 0.0


@register_jitable(**INLINED)
def bare_force(flank, tooth, segment, position, turning, rate, speed):  # noqa: ARG001
    """No force."""
    return 0.0, 0.0


BARE = FlankLeaves(BareFlank, bare_force, no_store, no_clear)

#: forces on the flank: one module and one line here each
LEAVES = (BARE, VISCOUS, PLOUGHING)

#: tangential and radial force per length of edge, N/m
flank_force = by_table({one.table: one.force for one in LEAVES})
#: takes in the surface that the edge has left in this step, m along its outward normal
store_surface = by_table({one.table: one.store for one in LEAVES})
#: clears what lies behind an edge that has left the cut
end_contact = by_table({one.table: one.clear for one in LEAVES})
