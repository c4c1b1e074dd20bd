"""What a force law is: a specification, keys of files, a table and a leaf for the kernels.

The algebra of a law stands once, in its leaf, which takes a chip thickness or an array of them.
Forces are per length of edge, in the order tangential, radial, axial.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutting.keys import Key, with_defaults

Coefficients = tuple[float, float, float]

CUTTING_KEYS = (
    Key("Ktc", "pressure", "tangential cutting coefficient", needed=True, above=0.0),
    Key("Krc", "pressure", "radial cutting coefficient", 0.0),
    Key("Kac", "pressure", "axial cutting coefficient", 0.0),
)
EDGE_KEYS = (
    Key("Kte", "line_force", "tangential edge coefficient", 0.0),
    Key("Kre", "line_force", "radial edge coefficient", 0.0),
    Key("Kae", "line_force", "axial edge coefficient", 0.0),
)


class SlopePower(NamedTuple):
    """Slope of a law over the chip thickness: cutting (h / reference)^exponent."""

    cutting: NDArray[np.float64]  # N/m^2, (3,)
    exponent: float | Coefficients = 0.0  # of all, or of each of the three; 0 for a linear law
    reference: float = 1.0  # m

    @property
    def exponents(self) -> NDArray[np.float64]:
        """Exponent of each direction, (3,)."""
        return np.broadcast_to(np.asarray(self.exponent, dtype=np.float64), 3)

    @property
    def lowest_exponent(self) -> float:
        """Of the direction whose slope grows most as the chip goes to zero; 0 for a linear law."""
        acting = self.exponents[np.asarray(self.cutting) != 0.0]
        return float(acting.min()) if acting.size else 0.0

    @property
    def above_lowest(self) -> NDArray[np.float64]:
        """Exponent of each direction above the lowest, (3,); 0 where nothing acts."""
        above = self.exponents - self.lowest_exponent
        return np.where(np.asarray(self.cutting) != 0.0, above, 0.0)


@dataclass(frozen=True)
class ForceLaw(ABC):
    """Parameters of one force law, SI."""

    #: compiled force per length of edge: table, tooth and chip thickness > 0, m -> three of N/m
    leaf: ClassVar[Callable[..., tuple[Any, Any, Any]]]

    @classmethod
    @abstractmethod
    def table(cls, laws: Sequence[Any]) -> NamedTuple:
        """Table of the law for the kernels, of one law for each tooth."""

    @property
    @abstractmethod
    def slope_power(self) -> SlopePower:
        """Slope of the force, for the linear analysis."""

    def force(self, chip_thickness: ArrayLike) -> NDArray[np.float64]:
        """Return (3, ...) N/m for a chip thickness in m; zero where that is not positive."""
        h = np.asarray(chip_thickness, dtype=np.float64)
        cuts = h > 0.0
        parts = type(self).leaf(self.table([self]), 0, np.where(cuts, h, 1.0))
        return np.where(cuts, np.stack(parts), 0.0)

    def slope(self, chip_thickness: ArrayLike) -> NDArray[np.float64]:
        """Return (3, ...) N/m^2, the derivative of `force`."""
        power = self.slope_power
        h = np.asarray(chip_thickness, dtype=np.float64)
        sizes = [(h / power.reference) ** exponent for exponent in power.exponents]
        return np.stack([one * size for one, size in zip(power.cutting, sizes, strict=True)])

    def worn(self, cutting_wear: float | Sequence[float], edge_wear: Sequence[float]) -> ForceLaw:
        """Law of a worn edge.

        By the share by which the cutting coefficients have grown, all or each of the three, and
        what is added to each of the three edge coefficients, N/m.
        """
        cutting = np.asarray(self.cutting) * (1.0 + np.asarray(cutting_wear))  # type: ignore[attr-defined]
        edge = np.asarray(self.edge) + np.asarray(edge_wear)  # type: ignore[attr-defined]
        return replace(self, cutting=tuple(cutting), edge=tuple(edge))  # type: ignore[call-arg]

    def scaled(self, factor: float) -> ForceLaw:
        """Law whose force is a multiple of this one's."""
        if factor == 1.0:
            return self
        edge = np.asarray(self.edge) * (factor - 1.0)  # type: ignore[attr-defined]
        return self.worn(factor - 1.0, tuple(edge))


@dataclass(frozen=True)
class ForceLawEntry:
    """A force law in the list of laws.

    Parameters
    ----------
    name : str
        In files.
    label : str
        In messages and pictures.
    help : str
        One line for the schema and the tables of the docs.
    keys : sequence of Key
        That files give.
    spec : type
        Of the law: a `ForceLaw`.
    table : type
        NamedTuple that `spec.table` returns.
    make : callable
        Inclination of the edge, rad, and values by key -> law.
    """

    name: str
    label: str
    help: str
    keys: Sequence[Key]
    spec: type[ForceLaw]
    table: type
    make: Callable[..., ForceLaw]

    def of(self, values: Mapping[str, float], inclination: float) -> ForceLaw:
        """Law of values by key, SI, for an edge inclined by an angle (the helix), rad."""
        return self.make(inclination, **with_defaults(self.keys, values))
