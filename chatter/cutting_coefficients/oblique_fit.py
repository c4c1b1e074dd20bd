"""The oblique law from the linear one: shear stress and friction angle of the material.

A linear law has three cutting coefficients at one helix; the oblique transformation gives them from
a shear stress and a friction angle, with the rake known and the shear angle by Merchant's least
energy, phi = pi/4 - (beta - alpha)/2 (Merchant 1945; Budak, Altintas and Armarego 1996). One number
is left over: it tells whether the axial force is that of the helix.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
import tomlkit

from chatter.description.arrays import Array
from chatter.description.formatting import to_digits
from chatter.description.unit_system import METRIC, UnitSystem
from cutting.force.oblique import oblique_cutting_coefficients

#: first values: shear stress over the tangential coefficient, friction angle (rad)
_FIRST_SHARE, _FIRST_FRICTION = 0.3, 0.5
#: bounds of the friction angle, rad
_FRICTION = (1e-3, math.radians(80.0))
#: probability that a law that holds leaves more
_HOLDS = 0.01
_EDGE = ("Kte", "Kre", "Kae")


@dataclass(frozen=True, eq=False)
class ObliqueFit:
    """Numbers of the oblique law, and whether it holds.

    Parameters
    ----------
    values : (5,) array
        Shear stress (Pa), friction angle (rad), edge coefficients (N/m).
    covariance : (5, 5) array
    rake, inclination : float
        Normal rake and helix, rad.
    chi_square : float
        What it leaves of the linear coefficients, of one degree of freedom.
    units : UnitSystem
        In which the numbers are written.
    """

    values: Array
    covariance: Array
    rake: float
    inclination: float
    chi_square: float
    units: UnitSystem = METRIC

    @property
    def holds(self) -> bool:
        """Whether the linear coefficients are those of a shear stress and a friction angle."""
        return bool(scipy.stats.chi2.sf(self.chi_square, 1) > _HOLDS)

    @property
    def shear_angle(self) -> float:
        """Shear angle by Merchant, rad."""
        return merchant_shear_angle(float(self.values[1]), self.rake)

    def summary(self) -> dict[str, Any]:
        """Part of coefficients.json."""
        return {
            "values": self._rows(),
            "rake_angle_deg": math.degrees(self.rake),
            "shear_angle_deg": math.degrees(self.shear_angle),
            "chi_square": self.chi_square,
            "holds": self.holds,
        }

    def _rows(self) -> list[dict[str, Any]]:
        pressure, line_force = self.units.pressure, self.units.line_force
        units = [
            ("shear_stress", pressure.factor, pressure.name),
            ("friction_angle", math.degrees(1.0), "deg"),
        ]
        units += [(name, line_force.factor, line_force.name) for name in _EDGE]
        deviations = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return [
            {
                "name": name,
                "value": factor * float(value),
                "standard_deviation": factor * float(deviation),
                "unit": unit,
            }
            for (name, factor, unit), value, deviation in zip(
                units, self.values, deviations, strict=True
            )
        ]

    def material_toml(self) -> str:
        """[material] section of a case file."""
        section = tomlkit.table()
        section.add("law", "oblique")
        for one in self._rows():
            section.add(
                one["name"],
                f"{one['value']:.5g} +- {to_digits(one['standard_deviation'])} {one['unit']}",
            )
        section.add("shear_angle", f"{math.degrees(self.shear_angle):.5g} deg")
        section.add("rake_angle", f"{math.degrees(self.rake):.5g} deg")
        document = tomlkit.document()
        document.add(tomlkit.comment("oblique law, rake as given, shear angle by Merchant"))
        if not self.holds:
            document.add(tomlkit.comment("it does not hold: the axial force is not of this helix"))
        document.add("material", section)
        return tomlkit.dumps(document)


def merchant_shear_angle(friction: float, rake: float) -> float:
    """Shear angle of least energy, rad."""
    return 0.25 * math.pi - 0.5 * (friction - rake)


def oblique_fit(
    linear: Array, covariance: Array, rake: float, inclination: float, units: UnitSystem = METRIC
) -> ObliqueFit:
    """Fit the oblique law to the coefficients (6,) of a linear one, SI, by their covariance."""
    deviation = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(deviation, deviation)
    root = np.linalg.cholesky(correlation + 1e-12 * np.eye(deviation.size))
    size = np.array([linear[0], 1.0, *np.maximum(np.abs(linear[3:]), deviation[3:])])

    def left(scaled: Array) -> Array:
        shear_stress, friction, *edge = scaled * size
        cutting = oblique_cutting_coefficients(
            shear_stress, friction, merchant_shear_angle(friction, rake), rake, inclination
        )
        return scipy.linalg.solve_triangular(
            root, (np.array([*cutting, *edge]) - linear) / deviation, lower=True
        )

    first = np.array([_FIRST_SHARE, _FIRST_FRICTION, *(linear[3:] / size[2:])])
    low = np.array([1e-6, _FRICTION[0], -np.inf, -np.inf, -np.inf])
    high = np.array([np.inf, _FRICTION[1], np.inf, np.inf, np.inf])
    found = scipy.optimize.least_squares(left, first, bounds=(low, high), x_scale="jac")
    spread = np.linalg.pinv(found.jac.T @ found.jac) * np.outer(size, size)
    return ObliqueFit(found.x * size, spread, rake, inclination, 2.0 * float(found.cost), units)
