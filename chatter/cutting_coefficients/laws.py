"""Force laws that are tried, and the mean forces of a rigid tool that each of them gives.

A straight edge of a linear law gives mean forces that are linear in the feed (Altintas 2012,
Manufacturing Automation, eqs 2.38 to 2.40); the mean of the rigid cut is taken by quadrature, so
that tools with corners, unequal teeth and arcs of any kind are as good.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from chatter.compile.cutter import cutter_of
from chatter.description.arrays import Array
from chatter.description.case import Case
from cutting.force.exponential import ExponentialLaw
from cutting.force.force_spectrum import RigidCut
from cutting.force.law import ForceLaw
from cutting.force.linear import LinearLaw

#: chip thickness to which the coefficients of an exponential law belong, m
REFERENCE_CHIP = 1e-4
_DIRECTIONS = "tra"
DIRECTION_NAMES = ("tangential", "radial", "axial")
#: component of a direction that counts
_SEEN = 1e-6
#: mean forces kept
_KEPT = 4096
_CUTTING, _EDGE = ("Ktc", "Krc", "Kac"), ("Kte", "Kre", "Kae")


@dataclass(frozen=True)
class TriedLaw:
    """A law with the keys of [material] that are fitted.

    Parameters
    ----------
    name : str
        As the report calls it.
    law : str
        As [material] calls it.
    keys : tuple of str
        Coefficients, in which forces are linear.
    exponents : tuple of int
        Of the tangential, radial and axial direction the number of its exponent; -1: a line.
    """

    name: str
    law: str
    keys: tuple[str, ...]
    exponents: tuple[int, int, int] = (-1, -1, -1)

    @property
    def cutting(self) -> list[int]:
        """Places of the cutting coefficients among the keys, tangential first."""
        return [place for place, key in enumerate(self.keys) if key[2] == "c"]

    @property
    def exponent_count(self) -> int:
        """Exponents that are fitted."""
        return max(self.exponents) + 1

    @property
    def parameters(self) -> int:
        """Numbers that are fitted."""
        return len(self.keys) + self.exponent_count

    def section(self, values: Sequence[float], exponents: Sequence[float]) -> dict[str, object]:
        """Section [material] in SI."""
        given: dict[str, object] = {"law": self.law}
        given |= {key: float(v) for key, v in zip(self.keys, values, strict=True)}
        if len(exponents):
            given |= {**self.exponent_keys(exponents), "h0": REFERENCE_CHIP}
        return given

    def exponent_keys(self, exponents: Sequence[float]) -> dict[str, float]:
        """Keys of the exponents in [material]; a line is a power of one."""
        powers = [1.0 if number < 0 else float(exponents[number]) for number in self.exponents]
        found = {"exponent": powers[0]}
        for key, power in zip(("radial_exponent", "axial_exponent"), powers[1:], strict=True):
            if power != powers[0] and f"K{key[0]}c" in self.keys:
                found[key] = power
        return found

    def directions_of(self, exponent: int) -> list[str]:
        """Names of the directions that an exponent belongs to."""
        named = zip(DIRECTION_NAMES, self.exponents, strict=True)
        return [name for name, number in named if number == exponent]


#: laws of case files, from the simplest to the richest
LAWS = (
    TriedLaw("linear without edge forces", "linear", _CUTTING),
    TriedLaw("linear", "linear", _CUTTING + _EDGE),
    TriedLaw("exponential without edge forces", "exponential", _CUTTING, (0, 0, 0)),
    TriedLaw("exponential", "exponential", _CUTTING + _EDGE, (0, 0, 0)),
)
#: laws of which every direction has its own form: a line with its edge force, or a power
BY_DIRECTION = (
    TriedLaw("linear in each direction", "linear", _CUTTING + _EDGE),
    TriedLaw(
        "linear (tangential, axial), power (radial)",
        "exponential",
        (*_CUTTING, "Kte", "Kae"),
        (-1, 0, -1),
    ),
    TriedLaw(
        "linear (tangential, radial), power (axial)",
        "exponential",
        (*_CUTTING, "Kte", "Kre"),
        (-1, -1, 0),
    ),
    TriedLaw(
        "linear (tangential), power (radial, axial)", "exponential", (*_CUTTING, "Kte"), (-1, 0, 1)
    ),
    TriedLaw(
        "power (tangential), linear (radial, axial)",
        "exponential",
        (*_CUTTING, "Kre", "Kae"),
        (0, -1, -1),
    ),
    TriedLaw(
        "power (tangential, radial), linear (axial)", "exponential", (*_CUTTING, "Kae"), (0, 1, -1)
    ),
    TriedLaw(
        "power (tangential, axial), linear (radial)", "exponential", (*_CUTTING, "Kre"), (0, -1, 1)
    ),
    TriedLaw("power in each direction", "exponential", _CUTTING, (0, 1, 2)),
)


def of_directions(laws: Sequence[TriedLaw], directions: ArrayLike) -> list[TriedLaw]:
    """Laws for channels of some directions (n, 3): without axial forces where none is seen."""
    if np.any(np.abs(np.asarray(directions)[:, 2]) > _SEEN):
        return list(laws)
    # an exponent of the axial force alone has nothing to show itself by
    kept = [law for law in laws if law.exponents[2] in (-1, law.exponents[0])]
    return [replace(law, keys=tuple(key for key in law.keys if key[1] != "a")) for law in kept]


def unit_forces(law: TriedLaw, case: Case, exponents: Sequence[float]) -> Array:
    """Mean force (3, n) on the rigid tool of each of n coefficients of 1 (SI), along x, y, z."""
    return np.array([_unit_force(case, key, _power(law, key, exponents)) for key in law.keys]).T


def unit_law(key: str, exponent: float | None) -> ForceLaw:
    """Force law of one coefficient of 1 (SI); with an exponent a power of the chip."""
    values = [float(direction == key[1]) for direction in _DIRECTIONS]
    if key[2] == "e":
        return LinearLaw([0.0, 0.0, 0.0], values)
    if exponent is None:
        return LinearLaw(values)
    return ExponentialLaw(values, REFERENCE_CHIP, exponent)


def unit_laws(law: TriedLaw, exponents: Sequence[float]) -> list[ForceLaw]:
    """Force laws, each of one coefficient of 1 (SI), in the order of the keys of a law."""
    return [unit_law(key, _power(law, key, exponents)) for key in law.keys]


def _power(law: TriedLaw, key: str, exponents: Sequence[float]) -> float | None:
    number = law.exponents[_DIRECTIONS.index(key[1])]
    return float(exponents[number]) if key[2] == "c" and number >= 0 else None


@lru_cache(_KEPT)
def _unit_force(case: Case, key: str, exponent: float | None) -> Array:
    """Mean force (3,) of one coefficient of 1 (SI)."""
    cutter, law, cut = cutter_of(case), unit_law(key, exponent), case.cut
    rigid = RigidCut(
        cutter, [law] * cutter.teeth, case.uncut_band, cut.feed_per_tooth, cut.axial_depth,
        cutter.teeth,
    )  # fmt: skip
    return rigid.force(np.array([0])).force[0].real
