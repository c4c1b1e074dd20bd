"""Force laws: tangential, radial and axial force per length of edge.

A force law is one frozen class with two methods, ``force(h)`` and ``slope(h)``, both of shape
``(3, ...)`` in the order tangential, radial, axial. The slope is what stability needs. A new law
is one class here, and its table and leaf in `edge_force`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Coefficients = tuple[float, float, float]


class ForceLaw(Protocol):
    """Force per length of edge as a function of the chip thickness."""

    def force(self, chip_thickness: ArrayLike) -> NDArray[np.float64]:
        """Return (3, ...) N/m for a chip thickness in m."""
        ...

    def slope(self, chip_thickness: ArrayLike) -> NDArray[np.float64]:
        """Return (3, ...) N/m^2, the derivative of `force`."""
        ...


@dataclass(frozen=True)
class LinearLaw:
    """F = (K_c h + K_e) b with edge terms (Altintas 2012, eq. 2.80).

    Parameters
    ----------
    cutting : (3,) tuple of float
        K_tc, K_rc, K_ac, N/m^2.
    edge : (3,) tuple of float
        K_te, K_re, K_ae, N/m.
    """

    cutting: Coefficients
    edge: Coefficients = (0.0, 0.0, 0.0)

    def force(self, chip_thickness: ArrayLike) -> NDArray[np.float64]:
        """Return (3, ...) N/m; zero where the chip thickness is not positive."""
        h = np.asarray(chip_thickness, dtype=np.float64)
        return np.where(
            h > 0.0,
            np.multiply.outer(self.cutting, h)
            + np.reshape(np.asarray(self.edge), (3,) + (1,) * h.ndim),
            0.0,
        )

    def slope(self, chip_thickness: ArrayLike) -> NDArray[np.float64]:
        """Return (3, ...) N/m^2."""
        h = np.asarray(chip_thickness, dtype=np.float64)
        return np.multiply.outer(np.asarray(self.cutting), np.ones_like(h))


@dataclass(frozen=True)
class ExponentialLaw:
    """F = (K h0 (h/h0)^p + K_e) b, the size effect of the specific force (Kienzle 1952).

    Parameters
    ----------
    cutting : (3,) tuple of float
        K_tc, K_rc, K_ac at the reference chip thickness, N/m^2.
    reference_chip_thickness : float
        h0, m.
    exponent : float
        p, 0 < p <= 1.
    edge : (3,) tuple of float
        K_te, K_re, K_ae, N/m.
    """

    cutting: Coefficients
    reference_chip_thickness: float
    exponent: float
    edge: Coefficients = (0.0, 0.0, 0.0)

    def force(self, chip_thickness: ArrayLike) -> NDArray[np.float64]:
        """Return (3, ...) N/m; zero where the chip thickness is not positive."""
        h = np.asarray(chip_thickness, dtype=np.float64)
        h0 = self.reference_chip_thickness
        size = h0 * (np.maximum(h, 0.0) / h0) ** self.exponent
        edge = np.reshape(np.asarray(self.edge), (3,) + (1,) * h.ndim)
        return np.where(h > 0.0, np.multiply.outer(self.cutting, size) + edge, 0.0)

    def slope(self, chip_thickness: ArrayLike) -> NDArray[np.float64]:
        """Return (3, ...) N/m^2; it grows without bound as the chip thickness goes to zero."""
        h = np.asarray(chip_thickness, dtype=np.float64)
        ratio = h / self.reference_chip_thickness
        return np.multiply.outer(self.cutting, self.exponent * ratio ** (self.exponent - 1.0))


def oblique_cutting_coefficients(
    shear_stress: float,
    friction_angle: float,
    shear_angle: float,
    normal_rake: float,
    inclination: float,
) -> Coefficients:
    """Cutting coefficients of an oblique edge from orthogonal cutting data.

    Parameters
    ----------
    shear_stress : float
        Shear yield stress, Pa.
    friction_angle, shear_angle : float
        Mean friction angle beta_a and (orthogonal) shear angle phi_c, rad.
    normal_rake, inclination : float
        Normal rake and inclination (helix) angle, rad.

    Returns
    -------
    (3,) tuple of float
        K_tc, K_rc, K_ac, N/m^2.

    Notes
    -----
    Budak, Altintas, Armarego 1996, eqs. 10 to 12, with Stabler's rule (chip flow angle equals
    the inclination) and the orthogonal shear angle taken as the normal shear angle.
    """
    i = inclination
    chip_flow = i
    normal_friction = math.atan(math.tan(friction_angle) * math.cos(chip_flow))
    lean = normal_friction - normal_rake
    denominator = math.sqrt(
        math.cos(shear_angle + lean) ** 2
        + math.tan(chip_flow) ** 2 * math.sin(normal_friction) ** 2
    )
    scale = shear_stress / math.sin(shear_angle) / denominator
    skew = math.tan(chip_flow) * math.sin(normal_friction)
    return (
        scale * (math.cos(lean) + math.tan(i) * skew),
        scale * math.sin(lean) / math.cos(i),
        scale * (math.cos(lean) * math.tan(i) - skew),
    )
