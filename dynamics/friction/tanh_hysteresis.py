"""Presliding hysteresis of guides and screws with memory, and sliding that depends on speed.

After "Time domain coupled simulation of machine tool dynamics and cutting forces considering the
influences of nonlinear friction characteristics and process damping", eqs. 1 (rotation) and 2
(translation): f = (fc + (C + Cv exp(-av |v|)) |v|) (2 tanh(ah x') - 1) sgn(v), x' the way since
the last reversal of motion.

The factor r = (2 tanh(ah x') - 1) sgn(v) is a branch that rises from -1 to 1 of the new direction:
right after sliding, when a reversal finds r = -1 of the new direction, it is continuous, at about
300 um over with ah = 11500 1/m (2 tanh(3.45) - 1 = 0.996). After a shorter motion it would jump.
Here the same branch starts where the reversal finds it, r = r0 + 2 tanh(ah x') sgn(v), and
Masing's rules settle the rest: the curve from rest is half a branch, r = tanh(2 ah x); a branch
that comes back to where the one before began has closed its loop, which is forgotten, and the
older branch goes on (Masing 1926; Jayakumar 1987, EERL 87-01). So r stays within -1 and 1, and
full loops are those of the paper. Such a law is that of springs and sliders in parallel (Iwan
1966, J. Appl. Mech. 33:893), whose stored and dissipated energies are known along any path.

The speed-dependent part multiplies r only where r opposes the motion; it would otherwise give
back, as the presliding spring relaxes fast, energy that was never put in.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.friction.harmonic import describing_function
from dynamics.friction.implicit import implicit_force
from dynamics.friction.law import FrictionLawEntry, parameter_columns, port_column
from dynamics.friction.reversals import (
    branch_lost,
    branch_mean,
    branch_value,
    move_along,
    reversal_columns,
)
from dynamics.keys import Key, check_ranges
from dynamics.leaves import leaf

KEYS = (
    Key("coulomb", "force", "Coulomb friction", needed=True, above=0.0),
    Key("viscous", "damping", "force per velocity", 0.0, at_least=0.0),
    Key("low_speed_viscous", "damping", "further viscous friction at rest", 0.0, at_least=0.0),
    Key("low_speed_decay", "inverse_velocity", "of it over speed", 0.0, at_least=0.0),
    Key("hysteresis_slope", "inverse_length", "of the presliding branch over motion", above=0.0),
    Key("presliding_stiffness", "stiffness", "in place of hysteresis_slope", above=0.0),
)


@dataclass(frozen=True)
class TanhHysteresis:
    """Parameters of one friction; along a rotation read N m, rad for N, m.

    ValueError if a parameter is out of its range; the message names it.
    """

    coulomb: float  # fc, N; above 0
    viscous: float  # C, N s/m; not below 0
    low_speed_viscous: float  # Cv, N s/m; not below 0
    low_speed_decay: float  # av, s/m; not below 0
    hysteresis_slope: float  # ah, 1/m; above 0

    def __post_init__(self) -> None:
        check_ranges(self, KEYS, "tanh hysteresis")

    def steady_state_force(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """Sliding force at constant velocities in m/s, N; 0 at 0."""
        velocity = np.asarray(velocity, dtype=np.float64)
        slow = self.low_speed_viscous * np.exp(-self.low_speed_decay * np.abs(velocity))
        return np.sign(velocity) * self.coulomb + (self.viscous + slow) * velocity

    def stiffness_at_rest(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Dynamic stiffness 2 ah fc, N/m, of small motion about rest; Hz.

        Its damping vanishes with the amplitude; see `describing_function`.
        """
        shape = np.shape(np.asarray(frequency))
        return np.full(shape, 2.0 * self.hysteresis_slope * self.coulomb, dtype=np.complex128)

    def stiffness_in_motion(self, frequency: ArrayLike, velocity: float) -> NDArray[np.complex128]:
        """Dynamic stiffness j w dF/dv, N/m, about a velocity in m/s (not 0); Hz."""
        if velocity == 0.0:
            raise ValueError("tanh hysteresis: velocity must not be 0; see stiffness_at_rest")
        decay = self.low_speed_decay * abs(velocity)
        slope = self.viscous + self.low_speed_viscous * (1.0 - decay) * math.exp(-decay)
        return 2j * np.pi * np.asarray(frequency, dtype=np.float64) * slope

    def describing_function(self, amplitude: float, frequency: float) -> tuple[float, float]:
        """Equivalent stiffness, N/m, and damping, N s/m, of x = A sin(w t); m, Hz."""
        law = tanh_table([self], [0])
        return describing_function(tanh_force, tanh_advance, law, amplitude, frequency)


class TanhTable(NamedTuple):
    """Frictions as the kernels see them; columns (n,), reversals (n, depth)."""

    coulomb: NDArray[np.float64]  # fc, N
    viscous: NDArray[np.float64]  # C, N s/m
    low_speed_viscous: NDArray[np.float64]  # Cv, N s/m
    low_speed_decay: NDArray[np.float64]  # av, s/m
    hysteresis_slope: NDArray[np.float64]  # ah, 1/m
    port: NDArray[np.int64]
    count: NDArray[np.int64]  # reversals remembered: state
    value: NDArray[np.float64]  # r at each of them: state
    length: NDArray[np.float64]  # of the branch that ended there, ah x': state
    side: NDArray[np.float64]  # direction of the present branch, 1 or -1: state
    travel: NDArray[np.float64]  # along it, ah x': state
    rate: NDArray[np.float64]  # mean velocity of the last step, m/s: state


def tanh_table(laws: Sequence[TanhHysteresis], ports: Sequence[int]) -> TanhTable:
    """Return frictions on ports that have not moved yet."""
    columns = parameter_columns(laws, TanhTable._fields[:5])
    count, value, length, side, travel = reversal_columns(len(laws))
    return TanhTable(
        **columns, port=port_column(ports), count=count, value=value, length=length, side=side,
        travel=travel, rate=np.zeros(len(laws)),
    )  # fmt: skip


@leaf
def _resist(law, i, sign, travel, h):
    mean = branch_mean(law, i, sign, travel)
    speed = travel / h
    slow = law.low_speed_viscous[i] * math.exp(-law.low_speed_decay[i] * speed)
    return law.coulomb[i] * mean + (law.viscous[i] + slow) * speed * max(mean, 0.0)


@leaf
def _rest(law, i):
    return law.coulomb[i] * branch_value(law, i)


@leaf
def _stored(law, i, motion, h):  # noqa: ARG001
    sign = 1.0 if motion >= 0.0 else -1.0
    travel = abs(motion)
    if travel == 0.0:
        return 0.0
    lost = branch_lost(law, i, sign, travel)
    return law.coulomb[i] * (branch_mean(law, i, sign, travel) * travel - lost)


@leaf
def tanh_force(law, i, motion, h):
    """Mean force, N, over a motion (m) at constant velocity in a time h (s)."""
    sign = 1.0 if motion >= 0.0 else -1.0
    return sign * _resist(law, i, sign, abs(motion), h)


@leaf
def tanh_step(law, i, dx_free, gx, v_free, g, h):
    """Held force, N, and motion of the law, m; see `implicit.implicit_force`."""
    stiffness = 2.0 * law.hysteresis_slope[i] * law.coulomb[i]
    stiffness += (law.viscous[i] + law.low_speed_viscous[i]) / h
    return implicit_force(_rest, _resist, _stored, law, i, stiffness, dx_free, gx, v_free, g, h)


@leaf
def tanh_advance(law, i, motion, h):
    """Move along the branches by a motion, m, in a time h, s."""
    move_along(law, i, motion)
    law.rate[i] = motion / h


@leaf
def tanh_stored(law, i, motion):
    """Change of the stored energy, J, over a motion, m."""
    return _stored(law, i, motion, 1.0)


def tanh_of_keys(
    coulomb: float,
    hysteresis_slope: float | None = None,
    presliding_stiffness: float | None = None,
    **further: float,
) -> TanhHysteresis:
    """Hysteresis whose slope is given, or the stiffness at a reversal: twice slope times force.

    ValueError if neither is given, or both are, or a parameter is out of its range.
    """
    if (hysteresis_slope is None) == (presliding_stiffness is None):
        raise ValueError("tanh hysteresis: give hysteresis_slope or presliding_stiffness")
    if hysteresis_slope is None:
        if not coulomb > 0.0:
            raise ValueError(f"tanh hysteresis: coulomb must be above 0, not {coulomb}")
        hysteresis_slope = presliding_stiffness / (2.0 * coulomb)
    return TanhHysteresis(coulomb=coulomb, hysteresis_slope=hysteresis_slope, **further)


TANH_HYSTERESIS = FrictionLawEntry(
    name="tanh-hysteresis",
    label="tanh hysteresis",
    help="presliding hysteresis with memory of its reversals, sliding that depends on speed",
    keys=KEYS,
    spec=TanhHysteresis,
    table=TanhTable,
    columns=tanh_table,
    step=tanh_step,
    force=tanh_force,
    advance=tanh_advance,
    make=tanh_of_keys,
)
