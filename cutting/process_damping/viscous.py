"""Process damping in its viscous form.

The flank ploughs into the wave that it cuts; for small waves the mean force is that of a dashpot
in the radial direction, F_r = C (b/V) r_dot, with friction mu in the tangential one
(Tlusty 1978; Schmitz and Smith 2019, Machining Dynamics, section 4.5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED
from cutting.process_damping.leaves import FlankLeaves
from cutting.process_damping.linear_flank import LinearFlank, bare_flank


@dataclass(frozen=True)
class ViscousProcessDamping:
    """Radial dashpot of the engaged flank."""

    coefficient: float  # C, N/m
    friction: float = 0.0  # mu, tangential over radial ploughing force

    @property
    def small_vibration(self) -> ViscousProcessDamping:
        """The dashpot itself."""
        return self

    def linear(self, radius: float) -> LinearFlank:  # noqa: ARG002
        """The dashpot for compiled linear analysis."""
        tangential, radial, _ = self.force_per_radial_velocity
        return bare_flank()._replace(tangential=tangential, radial=radial)

    def table(
        self,
        radius: NDArray[np.float64],  # noqa: ARG002
        teeth: int,  # noqa: ARG002
        step_angle: float,  # noqa: ARG002
    ) -> ViscousFlank:
        """Table for the kernels; all edges are alike."""
        return ViscousFlank(self.coefficient, self.friction)

    @property
    def force_per_radial_velocity(self) -> tuple[float, float, float]:
        """C mu, C, 0: tangential, radial, axial force per b r_dot / V, N/m."""
        return (self.coefficient * self.friction, self.coefficient, 0.0)


class ViscousFlank(NamedTuple):
    """The viscous form as the time-domain kernels see it."""

    coefficient: float  # C, N/m
    friction: float  # mu


@register_jitable(**INLINED)
def viscous_force(flank, tooth, segment, position, turning, rate, speed):  # noqa: ARG001
    """Tangential and radial force per length of edge, N/m.

    By the velocity of the edge along its outward normal, and the cutting speed, m/s; all edges are
    alike wherever they are, so that nothing else is used.
    """
    radial = flank.coefficient * rate / speed
    return flank.friction * radial, radial


@register_jitable(**INLINED)
def no_clear(flank, tooth, segment):
    """Clear nothing: the viscous form has no memory."""


@register_jitable(**INLINED)
def no_store(flank, tooth, segment, surface):
    """Store nothing: the viscous form has no memory."""


VISCOUS = FlankLeaves(ViscousFlank, viscous_force, no_store, no_clear)
