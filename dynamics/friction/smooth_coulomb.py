"""Coulomb friction that passes smoothly through zero: F = FC tanh(v / vc) + c v.

A regularisation, not a law of contact: below the velocity vc the friction creeps where a real one
sticks. It is what many simulations take for Coulomb friction (Andersson, Soderberg and Bjorklund
2007, equation 5), so that their results can be met exactly.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.friction.harmonic import memoryless_describing_function
from dynamics.friction.implicit import implicit_force, no_energy, no_force
from dynamics.friction.law import FrictionLawEntry, parameter_columns, port_column
from dynamics.keys import Key, check_ranges
from dynamics.leaves import leaf

KEYS = (
    Key("coulomb", "force", "Coulomb friction", needed=True, at_least=0.0),
    Key(
        "smoothing_velocity",
        "velocity",
        "below which the friction falls to zero",
        needed=True,
        above=0.0,
    ),
    Key("viscous", "damping", "force per velocity", 0.0, at_least=0.0),
)


@dataclass(frozen=True)
class SmoothCoulomb:
    """Parameters of one smooth friction; about an axis read N m, rad for N, m.

    ValueError if a parameter is out of its range; the message names it.
    """

    coulomb: float  # FC, N; not below 0
    smoothing_velocity: float  # vc, m/s; above 0
    viscous: float = 0.0  # c, N s/m; not below 0

    def __post_init__(self) -> None:
        check_ranges(self, KEYS, "smooth friction")

    def steady_state_force(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """Force at constant velocities in m/s, N."""
        velocity = np.asarray(velocity, dtype=np.float64)
        return self.coulomb * np.tanh(velocity / self.smoothing_velocity) + self.viscous * velocity

    def stiffness_at_rest(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Dynamic stiffness of small motion about rest, N/m; Hz."""
        return self.stiffness_in_motion(frequency, 0.0)

    def stiffness_in_motion(self, frequency: ArrayLike, velocity: float) -> NDArray[np.complex128]:
        """Dynamic stiffness j w dF/dv, N/m, about a velocity in m/s, 0 included; Hz."""
        steep = 1.0 / math.cosh(min(abs(velocity) / self.smoothing_velocity, 300.0)) ** 2
        slope = self.viscous + self.coulomb / self.smoothing_velocity * steep
        return 2j * np.pi * np.asarray(frequency, dtype=np.float64) * slope

    def describing_function(self, amplitude: float, frequency: float) -> tuple[float, float]:
        """Equivalent stiffness, N/m, and damping, N s/m, of x = A sin(w t); m, Hz.

        The stiffness is 0; the damping is the mean over the cycle, and tends to 4 FC / (pi A w) + c
        as the smoothing vanishes (Den Hartog 1931).
        """
        return memoryless_describing_function(self.steady_state_force, amplitude, frequency)


class SmoothCoulombTable(NamedTuple):
    """Smooth frictions as the kernels see them; columns (n,)."""

    coulomb: NDArray[np.float64]  # FC, N
    smoothing_velocity: NDArray[np.float64]  # vc, m/s
    viscous: NDArray[np.float64]  # c, N s/m
    port: NDArray[np.int64]
    rate: NDArray[np.float64]  # mean velocity of the last step, m/s: state


def smooth_coulomb_table(laws: Sequence[SmoothCoulomb], ports: Sequence[int]) -> SmoothCoulombTable:
    """Return frictions at rest on ports."""
    columns = parameter_columns(laws, SmoothCoulombTable._fields[:3])
    return SmoothCoulombTable(**columns, port=port_column(ports), rate=np.zeros(len(laws)))


@leaf
def _resist(law, i, sign, travel, h):  # noqa: ARG001
    speed = travel / h
    return law.coulomb[i] * math.tanh(speed / law.smoothing_velocity[i]) + law.viscous[i] * speed


@leaf
def smooth_coulomb_force(law, i, motion, h):
    """Force, N, of a motion (m) at constant velocity in a time h (s)."""
    sign = 1.0 if motion >= 0.0 else -1.0
    return sign * _resist(law, i, sign, abs(motion), h)


@leaf
def smooth_coulomb_step(law, i, dx_free, gx, v_free, g, h):
    """Held force, N, and motion of the law, m; see `implicit.implicit_force`."""
    stiffness = (law.coulomb[i] / law.smoothing_velocity[i] + law.viscous[i]) / h
    return implicit_force(
        no_force, _resist, no_energy, law, i, stiffness, dx_free, gx, v_free, g, h
    )


@leaf
def smooth_coulomb_advance(law, i, motion, h):
    """Note a motion, m, in a time h, s."""
    law.rate[i] = motion / h


SMOOTH_COULOMB = FrictionLawEntry(
    name="smooth-coulomb",
    label="smooth Coulomb",
    help="Coulomb friction that passes smoothly through zero: FC tanh(v / vc) + c v",
    keys=KEYS,
    spec=SmoothCoulomb,
    table=SmoothCoulombTable,
    columns=smooth_coulomb_table,
    step=smooth_coulomb_step,
    force=smooth_coulomb_force,
    advance=smooth_coulomb_advance,
)
