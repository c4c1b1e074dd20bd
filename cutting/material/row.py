"""A row of the table of materials: coefficients of one force law, their source and their range."""

from collections.abc import Mapping
from dataclasses import dataclass

from cutting.material.grades import bare, designations

CUTTING = ("Ktc", "Krc", "Kac")
EDGE = ("Kte", "Kre", "Kae")


@dataclass(frozen=True)
class MaterialRow:
    """Coefficients of a force law for one pair of tool and material."""

    law: str  # name of a force law
    values: Mapping[str, float]  # its keys, SI
    source: str  # author, year, table
    iso_group: str = ""  # letter of ISO 513: P, M, K, N, S, H
    condition: str = ""  # treatment, strength and hardness, as in the source
    examples: tuple[str, ...] = ()  # grades, as a search may name them
    validity: str = ""  # tool and cut that the source names
    chip_thickness: tuple[float, float] | None = None  # m; None where the source has no range
    assumption: str = ""  # what no source stands for

    @property
    def cutting(self) -> tuple[float, float, float]:
        """Tangential, radial and axial cutting coefficient, N/m^2."""
        tangential, radial, axial = (self.values.get(key, 0.0) for key in CUTTING)
        return tangential, radial, axial

    @property
    def edge(self) -> tuple[float, float, float]:
        """Tangential, radial and axial edge coefficient, N/m."""
        tangential, radial, axial = (self.values.get(key, 0.0) for key in EDGE)
        return tangential, radial, axial

    def keys(self) -> dict[str, float | str]:
        """Return the law and its coefficients under their names in a case file, SI."""
        return {"law": self.law, **self.values}

    def has_grade(self, grade: str) -> bool:
        """Whether a grade, such as "C45", "1.0503" or "316L", is one of the row by any standard."""
        wanted = designations(grade)
        return any(
            name in wanted
            for example in self.examples
            for name in (bare(example), *map(bare, example.split()))
        )

    def is_grade(self, grade: str) -> bool:
        """Whether a grade is named by the row in full: not by a word of it, such as "steel"."""
        wanted = designations(grade)
        return any(
            bare(name) in wanted
            for example in self.examples
            for name in (
                example,
                *(word for word in example.split() if any(map(str.isdigit, word))),
            )
        )

    def state(self, name: str) -> str:
        """Return what tells it from other rows of a grade, in lower case: condition and name."""
        return f"{self.condition} {name}".lower()

    def words(self, name: str) -> str:
        """Return all that a search goes through, in lower case."""
        group = f"iso {self.iso_group}" if self.iso_group else ""
        parts = (name, self.law, group, self.condition, *self.examples, self.validity, self.source)
        return " ".join(parts).lower()
