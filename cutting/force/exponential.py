"""Exponential law: F = (K h0 (h/h0)^p + K_e) b, the size effect of the specific force.

Each direction may have its own exponent: radial and axial forces level off sooner than tangential
ones (Altintas 2012, Manufacturing Automation, section 2.3; Kienzle and Victor 1957).

Kienzle, O., 1952, VDI-Z 94:299: the specific cutting force falls with a power of the chip.
"""

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
from cutting.keys import Key
from cutting.leaves import leaf


class ExponentialTable(NamedTuple):
    """The law for each tooth; columns tangential, radial, axial."""

    cutting: NDArray[np.float64]  # N/m^2, (N, 3)
    edge: NDArray[np.float64]  # N/m, (N, 3)
    reference: float  # h0, m
    exponents: NDArray[np.float64]  # p of each, (3,)
    shared: bool  # whether all three are the same


@leaf
def exponential_force(law, tooth, chip):
    """Tangential, radial and axial force per length of edge, N/m, at a chip thickness > 0, m."""
    # a power, by exponential and logarithm: a tenth of the whole time step less
    logarithm = np.log(chip / law.reference)
    tangential = law.reference * np.exp(law.exponents[0] * logarithm)
    radial, axial = tangential, tangential
    if not law.shared:
        radial = law.reference * np.exp(law.exponents[1] * logarithm)
        axial = law.reference * np.exp(law.exponents[2] * logarithm)
    return (
        law.cutting[tooth, 0] * tangential + law.edge[tooth, 0],
        law.cutting[tooth, 1] * radial + law.edge[tooth, 1],
        law.cutting[tooth, 2] * axial + law.edge[tooth, 2],
    )


@dataclass(frozen=True)
class ExponentialLaw(ForceLaw):
    """Coefficients of the exponential law."""

    cutting: Coefficients  # K_tc, K_rc, K_ac at the reference chip thickness, N/m^2
    reference_chip_thickness: float  # h0, m
    exponent: float | Coefficients  # p of all, or of each; 0 < p <= 1
    edge: Coefficients = (0.0, 0.0, 0.0)  # K_te, K_re, K_ae, N/m

    leaf = exponential_force

    @property
    def exponents(self) -> NDArray[np.float64]:
        """Exponent of each direction, (3,)."""
        return np.broadcast_to(np.asarray(self.exponent, dtype=np.float64), 3)

    @classmethod
    def table(cls, laws: Sequence[ExponentialLaw]) -> ExponentialTable:
        """Table of the law for the kernels, of one law for each tooth."""
        return ExponentialTable(
            np.array([law.cutting for law in laws], dtype=np.float64),
            np.array([law.edge for law in laws], dtype=np.float64),
            laws[0].reference_chip_thickness,
            np.array(laws[0].exponents),
            bool(np.ptp(laws[0].exponents) == 0.0),
        )

    @property
    def slope_power(self) -> SlopePower:
        """Slope of the force; it grows without bound as the chip thickness goes to zero."""
        slope = self.exponents * np.asarray(self.cutting)
        return SlopePower(slope, tuple(self.exponents - 1.0), self.reference_chip_thickness)


def _of_keys(
    inclination: float,  # noqa: ARG001
    h0: float,
    exponent: float,
    radial_exponent: float | None = None,
    axial_exponent: float | None = None,
    **coefficients: float,
) -> ExponentialLaw:
    cutting, edge = (
        tuple(coefficients[key.name] for key in keys) for keys in (CUTTING_KEYS, EDGE_KEYS)
    )
    radial = exponent if radial_exponent is None else radial_exponent
    axial = exponent if axial_exponent is None else axial_exponent
    return ExponentialLaw(cutting, h0, (exponent, radial, axial), edge)


EXPONENTIAL = ForceLawEntry(
    name="exponential",
    label="exponential law",
    help="F = (Kc h0 (h/h0)^p + Ke) b",
    keys=(
        *CUTTING_KEYS,
        *EDGE_KEYS,
        Key("h0", "length", "reference chip thickness", needed=True, above=0.0, at_most=2.0),
        Key("exponent", "number", "p of K h0 (h/h0)^p", needed=True, above=0.0, at_most=1.0),
        Key(
            "radial_exponent",
            "number",
            "p of the radial force; exponent where not given",
            above=0.0,
            at_most=1.0,
        ),
        Key(
            "axial_exponent",
            "number",
            "p of the axial force; exponent where not given",
            above=0.0,
            at_most=1.0,
        ),
    ),
    spec=ExponentialLaw,
    table=ExponentialTable,
    make=_of_keys,
)
