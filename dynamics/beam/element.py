"""Timoshenko beam element of round section.

Two-node elements whose shape functions solve the static equations exactly, with shear
(Przemieniecki, Theory of Matrix Structural Analysis, 1968, section 5.6; Friedman and Kosmatka,
Computers & Structures 47, 1993); consistent mass with rotary inertia. No gyroscopic terms.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.structure.linear_structure import StructureError

# Four points integrate polynomials up to degree seven; the mass needs six.
_ROOTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
GAUSS_POSITIONS, GAUSS_WEIGHTS = 0.5 * (_ROOTS + 1.0), 0.5 * _WEIGHTS

ShearFormula = Callable[[float, float], float]


def cowper(poisson: float, bore_ratio: float) -> float:
    """Shear coefficient of a round section, 6(1+nu)/(7+6nu) if solid (Cowper 1966).

    The bore ratio is inner over outer diameter, 0 for a solid section.
    """
    square = (1.0 + bore_ratio**2) ** 2
    return (
        6.0
        * (1.0 + poisson)
        * square
        / ((7.0 + 6.0 * poisson) * square + (20.0 + 12.0 * poisson) * bore_ratio**2)
    )


def hutchinson(poisson: float, bore_ratio: float) -> float:
    """Shear coefficient of a round section, 6(1+nu)^2/(7+12nu+4nu^2) if solid.

    Hutchinson, Journal of Applied Mechanics 68, 2001.

    The bore ratio is inner over outer diameter, 0 for a solid section.
    """
    two, four = bore_ratio**2, bore_ratio**4
    denominator = (
        7.0 * four
        + 34.0 * two
        + 7.0
        + poisson * (12.0 * four + 48.0 * two + 12.0)
        + poisson**2 * (4.0 * four + 16.0 * two + 4.0)
    )
    return 6.0 * (1.0 + two) ** 2 * (1.0 + poisson) ** 2 / denominator


@dataclass(frozen=True)
class Material:
    """Elastic isotropic material.

    Parameters
    ----------
    young : float
        Young's modulus, N/m^2.
    density : float
        kg/m^3.
    poisson : float
    """

    young: float
    density: float
    poisson: float = 0.3

    def __post_init__(self) -> None:
        for what in ("young", "density"):
            positive("material", what, getattr(self, what))
        if not -1.0 < self.poisson <= 0.5:
            raise StructureError(f"material: poisson is {self.poisson}; from above -1 to 0.5")

    @property
    def shear_modulus(self) -> float:
        """N/m^2."""
        return self.young / (2.0 * (1.0 + self.poisson))


@dataclass(frozen=True)
class Segment:
    """Stretch of a line with one round section."""

    length: float  # m
    outer_diameter: float  # m
    material: Material
    inner_diameter: float = 0.0  # bore, m; 0 for a solid section
    elements: int = 4  # number of elements, at least; positions where something is joined add some
    #: kappa, or its formula of Poisson's ratio and inner over outer diameter
    shear_coefficient: float | ShearFormula = cowper

    def __post_init__(self) -> None:
        positive("segment", "length", self.length)
        positive("segment", "outer_diameter", self.outer_diameter)
        if not 0.0 <= self.inner_diameter < self.outer_diameter:
            raise StructureError(
                f"segment: inner_diameter is {self.inner_diameter} m; "
                f"from 0 to below outer_diameter, {self.outer_diameter} m"
            )
        if self.elements < 1:
            raise StructureError(f"segment: elements is {self.elements}; at least 1")
        positive("segment", "shear_coefficient", self.kappa)

    @property
    def kappa(self) -> float:
        """Shear coefficient."""
        if callable(self.shear_coefficient):
            ratio = self.inner_diameter / self.outer_diameter
            return float(self.shear_coefficient(self.material.poisson, ratio))
        return float(self.shear_coefficient)

    @property
    def area(self) -> float:
        """m^2."""
        return 0.25 * np.pi * (self.outer_diameter**2 - self.inner_diameter**2)

    @property
    def second_moment(self) -> float:
        """Second moment of area about a diameter, m^4; twice that about the axis."""
        return np.pi / 64.0 * (self.outer_diameter**4 - self.inner_diameter**4)

    @property
    def shear_parameter(self) -> float:
        """12 E I/(kappa G A), m^2: Phi times the square of the element's length."""
        material = self.material
        return (
            12.0
            * material.young
            * self.second_moment
            / (self.kappa * material.shear_modulus * self.area)
        )


def shape_functions(segment: Segment, length: float, position: float) -> NDArray[np.float64]:
    """Motion (6, 12) of the section at a position between the nodes of an element.

    Axis along x; per node u, v, w and rotations about x, y, z. Friedman and Kosmatka
    1993; in the x-z plane the slope is minus the rotation about y.

    Position 0 at the first node, 1 at the second; length of the element, m.
    """
    s, phi = position, segment.shear_parameter / length**2
    deflection = np.array(
        [
            2 * s**3 - 3 * s**2 - phi * s + 1 + phi,
            length * (s**3 - (2 + phi / 2) * s**2 + (1 + phi / 2) * s),
            -(2 * s**3 - 3 * s**2 - phi * s),
            length * (s**3 - (1 - phi / 2) * s**2 - phi / 2 * s),
        ]
    ) / (1 + phi)
    rotation = np.array(
        [
            6 / length * (s**2 - s),
            3 * s**2 - (4 + phi) * s + 1 + phi,
            -6 / length * (s**2 - s),
            3 * s**2 - (2 - phi) * s,
        ]
    ) / (1 + phi)
    motion = np.zeros((6, 12))
    motion[0, [0, 6]] = motion[3, [3, 9]] = 1 - s, s
    motion[1, [1, 5, 7, 11]], motion[5, [1, 5, 7, 11]] = deflection, rotation
    mirrored = np.array([1, -1, 1, -1])
    motion[2, [2, 4, 8, 10]], motion[4, [2, 4, 8, 10]] = deflection * mirrored, -rotation * mirrored
    return motion


def element_mass(segment: Segment, length: float) -> NDArray[np.float64]:
    """Consistent mass (12, 12) of an element with rotary inertia; kg, kg m, kg m^2."""
    area, second = segment.area, segment.second_moment
    inertia = segment.material.density * np.array([area] * 3 + [2.0 * second, second, second])
    return _integrated(
        inertia,
        length,
        [shape_functions(segment, length, position) for position in GAUSS_POSITIONS],
    )


def element_stiffness(segment: Segment, length: float) -> NDArray[np.float64]:
    """Stiffness (12, 12) of an element; N/m, N, N m."""
    material, area, second = segment.material, segment.area, segment.second_moment
    shear = segment.kappa * material.shear_modulus * area
    rigidity = np.array(
        [
            material.young * area,
            shear,
            shear,
            material.shear_modulus * 2.0 * second,
            material.young * second,
            material.young * second,
        ]
    )
    return _integrated(
        rigidity, length, [_strains(segment, length, position) for position in GAUSS_POSITIONS]
    )


def positive(where: str, what: str, value: float) -> None:
    """Refuse a value that is not finite and above zero.

    Raises
    ------
    StructureError
        The message begins with `where` and `what`.
    """
    if not (np.isfinite(value) and value > 0.0):
        raise StructureError(f"{where}: {what} is {value}; it must be above 0")


def _strains(segment: Segment, length: float, position: float) -> NDArray[np.float64]:
    """Stretch, two shears, twist and two curvatures (6, 12) at a position of an element."""
    s, phi = position, segment.shear_parameter / length**2
    shear = np.array([-phi / length, -phi / 2, phi / length, -phi / 2]) / (1 + phi)
    curvature = np.array(
        [6 / length * (2 * s - 1), 6 * s - 4 - phi, -6 / length * (2 * s - 1), 6 * s - 2 + phi]
    ) / (length * (1 + phi))
    strains = np.zeros((6, 12))
    strains[0, [0, 6]] = strains[3, [3, 9]] = -1 / length, 1 / length
    strains[1, [1, 5, 7, 11]], strains[5, [1, 5, 7, 11]] = shear, curvature
    mirrored = np.array([1, -1, 1, -1])
    strains[2, [2, 4, 8, 10]], strains[4, [2, 4, 8, 10]] = shear * mirrored, curvature * -mirrored
    return strains


def _integrated(
    weight: NDArray[np.float64], length: float, rows: list[NDArray[np.float64]]
) -> NDArray[np.float64]:
    return sum(
        part * length * (row.T @ (weight[:, None] * row))
        for part, row in zip(GAUSS_WEIGHTS, rows, strict=True)
    )
