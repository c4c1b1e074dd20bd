"""Shaft of a ball screw: its axial and torsional stiffness where the nut is."""

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import numpy as np

from dynamics.beam.element import Material, positive
from dynamics.drive.gear_train import series_stiffness
from dynamics.structure.linear_structure import StructureError

Support = Literal["fixed-free", "fixed-supported", "fixed-fixed"]
STEEL = Material(young=206e9, density=7850.0, poisson=0.3)


class AxialSupport(NamedTuple):
    """A bearing and the shaft from it to the nut, in a row."""

    station: float  # of the bearing along the axis from the nut, m
    stiffness: float  # N/m


@dataclass(frozen=True)
class ScrewShaft:
    """Shaft between the bearings of a ball screw.

    Raises
    ------
    StructureError
        If a size is not above 0, or the support unknown.
    """

    diameter: float  # that carries load: core or equivalent diameter, m
    #: from the fixed bearing at the drive's end to the other bearing or the free end, m
    length: float
    #: place of the nut at position 0 of the axis, from the fixed bearing along the direction of the
    #: axis, m; negative if that bearing lies ahead of the nut
    nut_at: float
    #: the first bearing carries axial load; the second one if "fixed", not if "supported"
    support: Support = "fixed-free"
    material: Material = STEEL

    def __post_init__(self) -> None:
        positive("screw shaft", "diameter", self.diameter)
        positive("screw shaft", "length", self.length)
        if not np.isfinite(self.nut_at):
            raise StructureError(f"screw shaft: nut_at is {self.nut_at}; a finite length, in m")
        if self.support not in get_args(Support):
            known = ", ".join(f'"{one}"' for one in get_args(Support))
            raise StructureError(f'screw shaft: support is "{self.support}"; there are {known}')

    @property
    def inertia(self) -> float:
        """Moment of inertia of the shaft about its axis, kg m^2."""
        return self.material.density * self.length * np.pi * self.diameter**4 / 32.0

    def torsional_stiffness(self, where: str, position: float) -> float:
        """G I_p / L from the drive's end to the nut, N m/rad.

        At a position of the axis, m. Raises StructureError, beginning with `where`, if the nut
        would lie off the shaft.
        """
        polar = np.pi * self.diameter**4 / 32.0
        free = abs(self._nut(where, position))
        return self.material.shear_modulus * polar / free if free > 0.0 else np.inf

    def supports(
        self, where: str, position: float, bearings: tuple[float, float]
    ) -> tuple[AxialSupport, ...]:
        """Bearings that carry axial load, each in a row with its length of shaft: E A / L.

        At a position of the axis, m; the axial stiffness of the first and the second bearing is in
        N/m. Raises StructureError, beginning with `where`, if the nut would lie off the shaft.
        """
        nut = self._nut(where, position)
        far = np.copysign(self.length, self.nut_at) - nut
        first, second = (
            AxialSupport(station, series_stiffness([bearing, self._axial(abs(station))]))
            for station, bearing in zip((-nut, far), bearings, strict=True)
        )
        return (first, second) if self.support == "fixed-fixed" else (first,)

    def axial_stiffness(self, where: str, position: float, bearings: tuple[float, float]) -> float:
        """Stiffness of bearings and shaft at the nut, without the nut's own, N/m."""
        return sum(one.stiffness for one in self.supports(where, position, bearings))

    def _axial(self, length: float) -> float:
        area = 0.25 * np.pi * self.diameter**2
        return self.material.young * area / length if length > 0.0 else np.inf

    def _nut(self, where: str, position: float) -> float:
        nut = self.nut_at + position
        end = np.copysign(self.length, self.nut_at)
        if not -1e-9 <= nut / end <= 1.0 + 1e-9:
            raise StructureError(
                f"{where}: at position {position:g} m the nut would be {nut:g} m from the fixed "
                f"bearing; the shaft reaches from 0 to {end:g} m"
            )
        return nut
