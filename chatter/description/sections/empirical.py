"""Terms learnt from measurements, where no law is known: what they say, and over what."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, field_validator, model_validator

from chatter.description.quantities import QuantityField
from chatter.description.section import Section, raise_if_any

#: entries of a table, at the fewest and at the most
_FEWEST, _MOST = 2, 2000


class Empirical(Section):
    """A term over a physical variable: a factor of the cutting force, or a force on an axis.

    Linear between its entries. The spindle angle, and what is `periodic`, repeat with the last
    entry; elsewhere the first and the last hold beyond the table.
    """

    #: variable -> dimension of its values
    DIMENSION: ClassVar[dict[str, str]] = {
        "spindle angle": "angle",
        "feed distance": "length",
        "cutting speed": "velocity",
        "position": "length",
        "velocity": "velocity",
    }
    #: those of a cut; the others are those of an axis
    OF_A_CUT: ClassVar[tuple[str, ...]] = ("spindle angle", "feed distance", "cutting speed")

    over: Literal["spindle angle", "feed distance", "cutting speed", "position", "velocity"] = (
        Field(description="spindle angle, feed distance and cutting speed of a cut; position and "
              "velocity of an axis")
    )  # fmt: skip
    at: tuple[float, ...] = Field(description="rising values of the variable, with their units")
    factor: tuple[float, ...] = Field((), description="of the cutting force, at each of them")
    force: tuple[float, ...] = Field((), description="on the axis, against its motion forwards")
    periodic: bool = Field(False, description="the table repeats from its last entry on")

    @field_validator("at", mode="before")
    @classmethod
    def _read_at(cls, given: Any, info: ValidationInfo) -> tuple[float, ...]:
        return _read(given, cls.DIMENSION.get(info.data.get("over", ""), "number"))

    @field_validator("factor", mode="before")
    @classmethod
    def _read_factor(cls, given: Any) -> tuple[float, ...]:
        return _read(given, "number")

    @field_validator("force", mode="before")
    @classmethod
    def _read_force(cls, given: Any) -> tuple[float, ...]:
        return _read(given, "force")

    @model_validator(mode="after")
    def _check_table(self) -> Empirical:
        wanted, other = ("factor", "force") if self.is_of_a_cut else ("force", "factor")
        problems = []
        if getattr(self, other):
            problems.append((other, f"is given; a term over the {self.over} has a {wanted}"))
        if len(getattr(self, wanted)) != len(self.at):
            problems.append(
                (wanted, f"has {len(getattr(self, wanted))} entries; at has {len(self.at)}")
            )
        if not np.all(np.diff(self.at) > 0.0):
            problems.append(("at", "does not rise from entry to entry"))
        if any(one < 0.0 for one in self.factor):
            problems.append(("factor", "is negative"))
        raise_if_any(problems)
        return self

    @property
    def is_of_a_cut(self) -> bool:
        """Whether it is a factor of the cutting force."""
        return self.over in self.OF_A_CUT

    @property
    def repeats(self) -> bool:
        """Whether the table repeats beyond its last entry."""
        return self.periodic or self.over == "spindle angle"

    def value_at(self, variable: NDArray[np.float64]) -> NDArray[np.float64]:
        """Factor, or force in N, at values of the variable, SI."""
        variable = np.asarray(variable, dtype=np.float64)
        if self.repeats:
            variable = self.at[0] + np.mod(variable - self.at[0], self.at[-1] - self.at[0])
        return np.interp(variable, self.at, self.factor or self.force)


def _read(given: Any, dimension: str) -> tuple[float, ...]:
    if not isinstance(given, (list, tuple)) or not _FEWEST <= len(given) <= _MOST:
        raise ValueError(f"a list of {_FEWEST} to {_MOST} quantities is required")
    field = QuantityField(dimension)
    return tuple(field.read(one) for one in given)


def problems_of_terms(terms: tuple[Empirical, ...]) -> list[tuple[str, str]]:
    """Terms over one variable that are given twice, by path and text."""
    found, problems = set(), []
    for index, term in enumerate(terms):
        if term.over in found:
            problems.append(
                (f"empirical[{index}].over", f"a term over the {term.over} is given twice")
            )
        found.add(term.over)
    return problems
