"""Linear law with edge terms: F = (K_c h + K_e) b (Altintas 2012, eq. 2.80)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutting.force.law import (
    CUTTING_KEYS,
    EDGE_KEYS,
    Coefficients,
    ForceLaw,
    ForceLawEntry,
    SlopePower,
)
from cutting.leaves import leaf


class LinearTable(NamedTuple):
    """The law for each tooth; columns tangential, radial, axial."""

    cutting: NDArray[np.float64]  # N/m^2, (N, 3)
    edge: NDArray[np.float64]  # N/m, (N, 3)


@leaf
def linear_force(law, tooth, chip):
    """Tangential, radial and axial force per length of edge, N/m, at a chip thickness > 0, m."""
    return (
        law.cutting[tooth, 0] * chip + law.edge[tooth, 0],
        law.cutting[tooth, 1] * chip + law.edge[tooth, 1],
        law.cutting[tooth, 2] * chip + law.edge[tooth, 2],
    )


@dataclass(frozen=True)
class LinearLaw(ForceLaw):
    """Coefficients of the linear law."""

    cutting: Coefficients  # K_tc, K_rc, K_ac, N/m^2
    edge: Coefficients = (0.0, 0.0, 0.0)  # K_te, K_re, K_ae, N/m

    leaf = linear_force

    @classmethod
    def table(cls, laws: Sequence[LinearLaw]) -> LinearTable:
        """Table of the law for the kernels, of one law for each tooth."""
        return LinearTable(
            np.array([law.cutting for law in laws], dtype=np.float64),
            np.array([law.edge for law in laws], dtype=np.float64),
        )

    @property
    def slope_power(self) -> SlopePower:
        """Slope of the force: the cutting coefficients."""
        return SlopePower(np.asarray(self.cutting))


def _of_keys(
    inclination: float,  # noqa: ARG001
    Ktc: float,
    Krc: float,
    Kac: float,
    Kte: float,
    Kre: float,
    Kae: float,
) -> LinearLaw:
    return LinearLaw((Ktc, Krc, Kac), (Kte, Kre, Kae))


LINEAR = ForceLawEntry(
    name="linear",
    label="linear law",
    help="F = (Kc h + Ke) b",
    keys=(*CUTTING_KEYS, *EDGE_KEYS),
    spec=LinearLaw,
    table=LinearTable,
    make=_of_keys,
)
