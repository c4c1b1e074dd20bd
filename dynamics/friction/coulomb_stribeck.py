"""Dry friction with true rest: any force up to the static one at rest, a curve in motion.

F = (FC + (FS - FC) exp(-(|v|/vS)^beta)) sgn(v) + c v, |F| <= FS at v = 0 (Armstrong-Helouvry,
Dupont and Canudas de Wit 1994, Automatica 30:1083, section 2.1).
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
    Key("static", "force", "largest at rest; as coulomb by default", at_least=0.0),
    Key("stribeck_velocity", "velocity", "over which the static force falls", above=0.0),
    Key("viscous", "damping", "force per velocity", 0.0, at_least=0.0),
    Key("stribeck_shape", "number", "exponent of the Stribeck curve", 2.0, above=0.0),
)
#: dynamic stiffness at rest, N/m (N m/rad): it holds, and nothing in a machine is stiffer
STIFFNESS_AT_REST = 1e14
#: Stribeck velocity where the static force is the Coulomb friction, m/s: it changes nothing
_ANY_VELOCITY = 1.0


@dataclass(frozen=True)
class CoulombStribeck:
    """Parameters of one dry friction; along a rotation read N m, rad for N, m.

    ValueError if a parameter is out of its range; the message names it.
    """

    coulomb: float  # FC, N; not below 0
    static: float  # FS, N; not below 0
    stribeck_velocity: float  # vS, m/s; above 0
    viscous: float = 0.0  # c, N s/m; not below 0
    stribeck_shape: float = 2.0  # beta; above 0

    def __post_init__(self) -> None:
        check_ranges(self, KEYS, "dry friction")

    def steady_state_force(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """Force at constant velocities in m/s, N; 0 at 0, where any up to the static is held."""
        velocity = np.asarray(velocity, dtype=np.float64)
        ratio = np.abs(velocity) / self.stribeck_velocity
        dry = (self.static - self.coulomb) * np.exp(-(ratio**self.stribeck_shape))
        return np.sign(velocity) * (self.coulomb + dry) + self.viscous * velocity

    def stiffness_at_rest(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Dynamic stiffness of small motion about rest, N/m: the port is held."""
        return np.full(np.shape(np.asarray(frequency)), STIFFNESS_AT_REST, dtype=np.complex128)

    def stiffness_in_motion(self, frequency: ArrayLike, velocity: float) -> NDArray[np.complex128]:
        """Dynamic stiffness j w dF/dv, N/m, about a velocity in m/s (not 0); Hz."""
        speed = abs(velocity)
        if not speed > 0.0:
            raise ValueError("dry friction: velocity must not be 0, at rest the port is held")
        ratio = speed / self.stribeck_velocity
        falling = (self.static - self.coulomb) * math.exp(-(ratio**self.stribeck_shape))
        falling *= self.stribeck_shape * ratio ** (self.stribeck_shape - 1.0)
        slope = self.viscous - falling / self.stribeck_velocity
        return 2j * np.pi * np.asarray(frequency, dtype=np.float64) * slope

    def describing_function(self, amplitude: float, frequency: float) -> tuple[float, float]:
        """Equivalent stiffness, N/m, and damping, N s/m, of x = A sin(w t); m, Hz.

        The stiffness is 0. Without a Stribeck curve the damping is 4 FC / (pi A w) + c (Den Hartog
        1931); with it the mean over the cycle is taken.
        """
        return memoryless_describing_function(self.steady_state_force, amplitude, frequency)


class CoulombStribeckTable(NamedTuple):
    """Dry frictions as the kernels see them; columns (n,)."""

    coulomb: NDArray[np.float64]  # FC, N
    static: NDArray[np.float64]  # FS, N
    stribeck_velocity: NDArray[np.float64]  # vS, m/s
    viscous: NDArray[np.float64]  # c, N s/m
    stribeck_shape: NDArray[np.float64]  # beta
    port: NDArray[np.int64]
    rate: NDArray[np.float64]  # mean velocity of the last step, m/s: state


def coulomb_stribeck_table(
    laws: Sequence[CoulombStribeck], ports: Sequence[int]
) -> CoulombStribeckTable:
    """Return frictions at rest on ports."""
    columns = parameter_columns(laws, CoulombStribeckTable._fields[:5])
    return CoulombStribeckTable(**columns, port=port_column(ports), rate=np.zeros(len(laws)))


@leaf
def _resist(law, i, sign, travel, h):  # noqa: ARG001
    speed = travel / h
    ratio = speed / law.stribeck_velocity[i]
    power = ratio * ratio if law.stribeck_shape[i] == 2.0 else ratio ** law.stribeck_shape[i]
    dry = law.coulomb[i] + (law.static[i] - law.coulomb[i]) * math.exp(-power)
    return dry + law.viscous[i] * speed


@leaf
def coulomb_stribeck_force(law, i, motion, h):
    """Force, N, of a motion (m) at constant velocity in a time h (s); 0 without motion."""
    if motion == 0.0:
        return 0.0
    sign = 1.0 if motion > 0.0 else -1.0
    return sign * _resist(law, i, sign, abs(motion), h)


@leaf
def coulomb_stribeck_step(law, i, dx_free, gx, v_free, g, h):
    """Held force, N, and motion of the law, m; see `implicit.implicit_force`."""
    return implicit_force(no_force, _resist, no_energy, law, i, math.inf, dx_free, gx, v_free, g, h)


@leaf
def coulomb_stribeck_advance(law, i, motion, h):
    """Note a motion, m, in a time h, s."""
    law.rate[i] = motion / h


def coulomb_stribeck_of_keys(
    coulomb: float,
    static: float | None = None,
    stribeck_velocity: float | None = None,
    **further: float,
) -> CoulombStribeck:
    """Dry friction; without a static force it is plain Coulomb friction.

    ValueError if the Stribeck velocity is missing, or a parameter is out of its range.
    """
    if static is None:
        static = coulomb
    if stribeck_velocity is None:
        if static != coulomb:
            raise ValueError("dry friction: stribeck_velocity is missing; static needs it")
        stribeck_velocity = _ANY_VELOCITY
    return CoulombStribeck(coulomb, static, stribeck_velocity, **further)


COULOMB_STRIBECK = FrictionLawEntry(
    name="coulomb-stribeck",
    label="Coulomb-Stribeck",
    help="dry friction with true rest, a Stribeck curve and a viscous part",
    keys=KEYS,
    spec=CoulombStribeck,
    table=CoulombStribeckTable,
    columns=coulomb_stribeck_table,
    step=coulomb_stribeck_step,
    force=coulomb_stribeck_force,
    advance=coulomb_stribeck_advance,
    make=coulomb_stribeck_of_keys,
)
