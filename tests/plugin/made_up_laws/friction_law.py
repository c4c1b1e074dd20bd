"""Coulomb friction smoothed by an arc tangent: F = 2/pi FC atan(v / vc)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.friction.harmonic import memoryless_describing_function
from dynamics.friction.implicit import implicit_force, no_energy, no_force
from dynamics.friction.law import FrictionLawEntry, parameter_columns, port_column
from dynamics.keys import Key, check_ranges
from dynamics.leaves import leaf

KEYS = (
    Key("coulomb", "force", "Coulomb friction", needed=True, at_least=0.0),
    Key("smoothing_velocity", "velocity", "at which half of it acts", needed=True, above=0.0),
)


@dataclass(frozen=True)
class ArctanCoulomb:
    """Parameters, SI."""

    coulomb: float
    smoothing_velocity: float

    def __post_init__(self) -> None:
        check_ranges(self, KEYS, "arctan friction")

    def steady_state_force(self, velocity):
        return (
            2.0 / math.pi * self.coulomb * np.arctan(np.divide(velocity, self.smoothing_velocity))
        )

    def stiffness_at_rest(self, frequency):
        return self.stiffness_in_motion(frequency, 0.0)

    def stiffness_in_motion(self, frequency, velocity):
        share = velocity / self.smoothing_velocity
        slope = 2.0 / math.pi * self.coulomb / self.smoothing_velocity / (1.0 + share**2)
        return 2j * np.pi * np.asarray(frequency, dtype=np.float64) * slope

    def describing_function(self, amplitude, frequency):
        return memoryless_describing_function(self.steady_state_force, amplitude, frequency)


class ArctanCoulombTable(NamedTuple):
    """Frictions as the kernels see them; columns (n,)."""

    coulomb: NDArray[np.float64]  # N
    smoothing_velocity: NDArray[np.float64]  # m/s
    port: NDArray[np.int64]
    rate: NDArray[np.float64]  # mean velocity of the last step, m/s: state, where a search begins


def table(laws, ports):
    return ArctanCoulombTable(
        **parameter_columns(laws, ArctanCoulombTable._fields[:2]),
        port=port_column(ports),
        rate=np.zeros(len(laws)),
    )


@leaf
def _resist(law, i, sign, way, h):
    return 2.0 / math.pi * law.coulomb[i] * math.atan(way / h / law.smoothing_velocity[i])


@leaf
def force(law, i, motion, h):
    return _resist(law, i, 1.0, motion, h)


@leaf
def step(law, i, dx_free, gx, v_free, g, h):
    stiffness = law.coulomb[i] / law.smoothing_velocity[i] / h
    return implicit_force(
        no_force, _resist, no_energy, law, i, stiffness, dx_free, gx, v_free, g, h
    )


@leaf
def advance(law, i, motion, h):
    law.rate[i] = motion / h


LAW = FrictionLawEntry(
    name="arctan-coulomb",
    label="arctan Coulomb",
    help="Coulomb friction smoothed by an arc tangent",
    keys=KEYS,
    spec=ArctanCoulomb,
    table=ArctanCoulombTable,
    columns=table,
    step=step,
    force=force,
    advance=advance,
)
