"""Result of a residual diagnostic: a sentence in plain words, its numbers, and what to draw."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Bars:
    """Bars in groups: one group a category, one bar a series."""

    categories: tuple[str, ...]
    series: Mapping[str, Array]  # each (n,)
    label: str  # of the values
    floor: float | None = None  # level that is drawn as a line


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve, with the standard errors of its values where they are known."""

    x: Array
    y: Array
    label: str = ""
    spread: Array | None = None


@dataclass(frozen=True, eq=False)
class Curves:
    """Curves over one variable."""

    curves: tuple[Curve, ...]
    x_label: str
    y_label: str
    #: upright lines, by what they stand for
    marks: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    floor: float | None = None  # level that is drawn as a line
    logarithmic: str = ""  # of "x", "y", "xy" or "": axes with a logarithmic scale
    joined: bool = True  # whether the values are joined by lines


@dataclass(frozen=True, eq=False)
class Map:
    """Values over two variables, nan where there are none."""

    x_edges: Array
    y_edges: Array
    values: Array  # (y, x)
    x_label: str
    y_label: str
    label: str
    logarithmic: str = ""


@dataclass(frozen=True, eq=False)
class Points:
    """Points of several classes over two variables."""

    classes: Mapping[str, tuple[Array, Array]]
    x_label: str
    y_label: str
    logarithmic: str = ""
    curve: Curve | None = None  # among the points


Panel = Bars | Curves | Map | Points


@dataclass(frozen=True, eq=False)
class Finding:
    """Result of one diagnostic of a residual."""

    name: str  # of the diagnostic
    # one sentence with numbers; the variable alone where no dependence is significant
    description: str
    significant: bool  # whether it shows more than chance does
    numbers: Mapping[str, Any] = field(default_factory=dict)  # as JSON knows them
    panel: Panel | None = None

    def summary(self) -> dict[str, Any]:
        """Entry of explanation.json."""
        return {
            "name": self.name,
            "description": self.description,
            "significant": self.significant,
            "numbers": dict(self.numbers),
        }
