"""Force that grows with the root of the chip thickness: F_t = K sqrt(h0 h) b, F_r = r F_t."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.force.law import ForceLaw, ForceLawEntry, SlopePower
from cutting.keys import Key
from cutting.leaves import leaf


class RootTable(NamedTuple):
    """The law for each tooth; columns (N,)."""

    specific: NDArray[np.float64]  # K, N/m^2
    ratio: NDArray[np.float64]  # r
    reference: float  # h0, m


@leaf
def root_force(law, tooth, chip):
    tangential = law.specific[tooth] * np.sqrt(law.reference * chip)
    return tangential, law.ratio[tooth] * tangential, 0.0 * tangential


@dataclass(frozen=True)
class RootLaw(ForceLaw):
    specific: float
    ratio: float
    reference: float

    leaf = root_force

    @classmethod
    def table(cls, laws):
        return RootTable(
            np.array([law.specific for law in laws]),
            np.array([law.ratio for law in laws]),
            laws[0].reference,
        )

    @property
    def slope_power(self):
        slope = 0.5 * self.specific * np.array([1.0, self.ratio, 0.0])
        return SlopePower(slope, -0.5, self.reference)

    def worn(self, cutting_growth, edge_growth):
        return replace(self, specific=self.specific * (1.0 + cutting_growth))


def make(inclination, specific_force, force_ratio, h0):
    return RootLaw(specific_force, force_ratio, h0)


LAW = ForceLawEntry(
    name="root",
    label="root law",
    help="F = K sqrt(h0 h) b",
    keys=(
        Key("specific_force", "pressure", "K, at the chip thickness h0", needed=True, above=0.0),
        Key("force_ratio", "number", "radial over tangential force", 0.3),
        Key("h0", "length", "reference chip thickness", needed=True, above=0.0, at_most=2.0),
    ),
    spec=RootLaw,
    table=RootTable,
    make=make,
)
