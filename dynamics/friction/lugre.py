"""LuGre friction: one bristle that bends and slips, with a Stribeck curve.

F = s0 z + s1 z' + s2 v,  z' = v - |v| z / g(v) (Canudas de Wit, Olsson, Astrom and Lischinsky
1995, IEEE Trans. Autom. Control 40:419, eqs. 2-4), with the Stribeck curve of feed axes
g(v) = (FC + (FS - FC) exp(-(|v|/vS)^beta) + Flog ln(|v|/vlog + 1)) / s0.

In a step the speed is constant; the bristle then relaxes exponentially and the mean force is
closed. With bristle damping s1 > 0 the law as published can push along the motion, and so create
energy, when a far bent bristle meets a sudden high speed (Barahanov and Ortega 2000, IEEE Trans.
Autom. Control 45:1208); there the force is held at zero instead.
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
from dynamics.keys import Key, check_ranges
from dynamics.leaves import leaf

#: exponent of the Stribeck curve beyond which it is below rounding
_FAR_SLIDING = 60.0


KEYS = (
    Key("bristle_stiffness", "stiffness", "s0 of the bristles", needed=True, above=0.0),
    Key("bristle_damping", "damping", "s1 of the bristles", 0.0, at_least=0.0),
    Key("viscous", "damping", "force per velocity; s2 of the LuGre law", 0.0, at_least=0.0),
    Key("coulomb", "force", "Coulomb friction", needed=True, above=0.0),
    Key("static", "force", "force at the onset of sliding", needed=True, above=0.0),
    Key(
        "stribeck_velocity", "velocity", "over which the static force falls", needed=True, above=0.0
    ),
    Key("stribeck_shape", "number", "exponent of the Stribeck curve", 2.0, above=0.0),
    Key("logarithmic", "force", "that grows with the logarithm of speed", 0.0, at_least=0.0),
    Key("logarithmic_velocity", "velocity", "from which it grows", 1.0, above=0.0),
)


@dataclass(frozen=True)
class LuGre:
    """Parameters of one LuGre friction; along a rotation read N m, rad for N, m.

    ValueError if a parameter is out of its range; the message names it.
    """

    bristle_stiffness: float  # s0, N/m
    bristle_damping: float  # s1, N s/m
    viscous: float  # s2, N s/m
    coulomb: float  # FC, N
    static: float  # FS, N
    stribeck_velocity: float  # vS, m/s
    stribeck_shape: float = 2.0  # beta
    logarithmic: float = 0.0  # Flog, N
    logarithmic_velocity: float = 1.0  # vlog, m/s

    def __post_init__(self) -> None:
        check_ranges(self, KEYS, "LuGre friction")

    def sliding_force(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """s0 g(v), N, at velocities in m/s: steady force without its viscous part."""
        speed = np.abs(np.asarray(velocity, dtype=np.float64))
        stribeck = np.exp(-((speed / self.stribeck_velocity) ** self.stribeck_shape))
        slow = np.log1p(speed / self.logarithmic_velocity)
        return self.coulomb + (self.static - self.coulomb) * stribeck + self.logarithmic * slow

    def steady_state_force(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """Force at constant velocities in m/s, N; 0 at 0."""
        velocity = np.asarray(velocity, dtype=np.float64)
        return np.sign(velocity) * self.sliding_force(velocity) + self.viscous * velocity

    def stiffness_at_rest(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Dynamic stiffness s0 + j w (s1 + s2), N/m, of small motion about rest; Hz."""
        omega = 2.0 * np.pi * np.asarray(frequency, dtype=np.float64)
        return self.bristle_stiffness + 1j * omega * (self.bristle_damping + self.viscous)

    def stiffness_in_motion(self, frequency: ArrayLike, velocity: float) -> NDArray[np.complex128]:
        """Dynamic stiffness of small motion about a steady velocity (m/s, not 0), N/m.

        From the law linearised about z = g sgn(v): dz' = (g' |v| / g) dv - |v| / g dz, with g' the
        slope of g over speed. Tends to j w dF/dv at low frequency.
        """
        speed = abs(velocity)
        if not speed > 0.0:
            raise ValueError("LuGre friction: velocity must not be 0; see stiffness_at_rest")
        rate = 2j * np.pi * np.asarray(frequency, dtype=np.float64)
        ratio = speed / self.stribeck_velocity
        falling = (self.static - self.coulomb) * math.exp(-(ratio**self.stribeck_shape))
        falling *= self.stribeck_shape * ratio ** (self.stribeck_shape - 1.0)
        slope = self.logarithmic / (speed + self.logarithmic_velocity)
        slope -= falling / self.stribeck_velocity
        sliding = float(self.sliding_force(speed))
        relaxation = speed * self.bristle_stiffness / sliding
        bristle = slope * speed / sliding / (rate + relaxation)  # dz/dv
        bent = (self.bristle_stiffness + self.bristle_damping * rate) * bristle
        return rate * (bent + self.viscous)

    def describing_function(self, amplitude: float, frequency: float) -> tuple[float, float]:
        """Equivalent stiffness, N/m, and damping, N s/m, of x = A sin(w t); m, Hz."""
        law = lugre_table([self], [0])
        return describing_function(lugre_force, lugre_advance, law, amplitude, frequency)


class LuGreTable(NamedTuple):
    """LuGre frictions as the kernels see them; columns (n,)."""

    bristle_stiffness: NDArray[np.float64]  # s0, N/m
    bristle_damping: NDArray[np.float64]  # s1, N s/m
    viscous: NDArray[np.float64]  # s2, N s/m
    coulomb: NDArray[np.float64]  # FC, N
    static: NDArray[np.float64]  # FS, N
    stribeck_velocity: NDArray[np.float64]  # vS, m/s
    stribeck_shape: NDArray[np.float64]  # beta
    logarithmic: NDArray[np.float64]  # Flog, N
    logarithmic_velocity: NDArray[np.float64]  # vlog, m/s
    port: NDArray[np.int64]
    deflection: NDArray[np.float64]  # z, m: state
    rate: NDArray[np.float64]  # mean velocity of the last step, m/s: state


def lugre_table(laws: Sequence[LuGre], ports: Sequence[int]) -> LuGreTable:
    """Return frictions at rest on ports, with unbent bristles."""
    columns = parameter_columns(laws, LuGreTable._fields[:9])
    deflection, rate = np.zeros(len(laws)), np.zeros(len(laws))
    return LuGreTable(**columns, port=port_column(ports), deflection=deflection, rate=rate)


@leaf
def lugre_bent(law, i, speed):
    """g, m: deflection in steady sliding at a speed >= 0, m/s."""
    force = law.coulomb[i]
    ratio = speed / law.stribeck_velocity[i]
    power = ratio * ratio if law.stribeck_shape[i] == 2.0 else ratio ** law.stribeck_shape[i]
    if power < _FAR_SLIDING:
        force += (law.static[i] - law.coulomb[i]) * math.exp(-power)
    if law.logarithmic[i] > 0.0:
        force += law.logarithmic[i] * math.log1p(speed / law.logarithmic_velocity[i])
    return force / law.bristle_stiffness[i]


@leaf
def _bend(law, i, sign, travel, h):
    """Mean and final deflection along sign over a motion at constant speed, and g, m."""
    start = sign * law.deflection[i]
    slip = lugre_bent(law, i, travel / h)
    lengths = travel / slip
    kept = -math.expm1(-lengths)
    # (1 - exp(-x)) / x loses digits only below rounding
    mean = kept / lengths if lengths > 1e-12 else 1.0 - 0.5 * lengths
    away = start - slip
    return slip + away * mean, start - away * kept, slip


@leaf
def _resist(law, i, sign, travel, h):
    mean, end, slip = _bend(law, i, sign, travel, h)
    start = sign * law.deflection[i]
    change = (end - start) / h
    force = law.bristle_stiffness[i] * mean + law.bristle_damping[i] * change
    force += law.viscous[i] * travel / h
    return max(force, 0.0) if start > slip else force


@leaf
def _rest(law, i):
    return law.bristle_stiffness[i] * law.deflection[i]


@leaf
def _stored(law, i, motion, h):
    sign = 1.0 if motion >= 0.0 else -1.0
    _, end, _ = _bend(law, i, sign, abs(motion), h)
    start = sign * law.deflection[i]
    return 0.5 * law.bristle_stiffness[i] * (end - start) * (end + start)


@leaf
def lugre_force(law, i, motion, h):
    """Mean force, N, over a motion (m) at constant velocity in a time h (s)."""
    sign = 1.0 if motion >= 0.0 else -1.0
    return sign * _resist(law, i, sign, abs(motion), h)


@leaf
def lugre_step(law, i, dx_free, gx, v_free, g, h):
    """Held force, N, and motion of the law, m; see `implicit.implicit_force`."""
    stiffness = law.bristle_stiffness[i] + (law.bristle_damping[i] + law.viscous[i]) / h
    return implicit_force(_rest, _resist, _stored, law, i, stiffness, dx_free, gx, v_free, g, h)


@leaf
def lugre_advance(law, i, motion, h):
    """Bend the bristle by a motion, m, in a time h, s."""
    sign = 1.0 if motion >= 0.0 else -1.0
    _, end, _ = _bend(law, i, sign, abs(motion), h)
    law.deflection[i] = sign * end
    law.rate[i] = motion / h


@leaf
def lugre_energy(law, i):
    """Energy stored in the bristle, J."""
    return 0.5 * law.bristle_stiffness[i] * law.deflection[i] * law.deflection[i]


LUGRE = FrictionLawEntry(
    name="lugre",
    label="LuGre",
    help="one bristle that bends and slips, with a Stribeck curve",
    keys=KEYS,
    spec=LuGre,
    table=LuGreTable,
    columns=lugre_table,
    step=lugre_step,
    force=lugre_force,
    advance=lugre_advance,
)
