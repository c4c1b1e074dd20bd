"""What a process damping law is: a specification, its dashpot, a table and leaves for kernels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from cutting.process_damping.viscous import ViscousProcessDamping


class ProcessDampingLaw(Protocol):
    """Parameters of the force on the flank, SI."""

    @property
    def small_vibration(self) -> ViscousProcessDamping:
        """Dashpot that the flank is for small vibration, for the linear analysis."""

    def table(self, radius: NDArray[np.float64], teeth: int, step_angle: float) -> NamedTuple:
        """Table for the kernels.

        Parameters
        ----------
        radius : (L,) array of float
            Of the edge slices, m.
        teeth : int
        step_angle : float
            Rotation in a time step, rad.
        """


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
