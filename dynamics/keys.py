"""Quantities that a file gives for a law, as the law declares them.

Sections, their schema and their messages are made from these declarations. `cutting` and
`dynamics` know nothing of each other: both have this module, and a test keeps the two alike.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple


class Key(NamedTuple):
    """A quantity by its key in a file."""

    name: str
    dimension: str  # by its name: "force", "length", "pressure", "number", ...
    help: str = ""
    default: float | None = None  # SI; None where it is needed, or follows from another key
    needed: bool = False
    above: float | None = None  # bounds, SI
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None

    def problem(self, value: float) -> str:
        """Say how an SI value is out of range; empty where it is within."""
        bounds = (
            ("above", self.above, self.above is None or value > self.above),
            ("at least", self.at_least, self.at_least is None or value >= self.at_least),
            ("below", self.below, self.below is None or value < self.below),
            ("at most", self.at_most, self.at_most is None or value <= self.at_most),
        )
        for words, bound, holds in bounds:
            if not holds:
                return f"must be {words} {bound:g}, not {value}"
        return "" if math.isfinite(value) else f"must be finite, not {value}"


def check_ranges(law: Any, keys: Sequence[Key], what: str) -> None:
    """Raise ValueError where an attribute of a law is out of the range of its key."""
    for key in keys:
        value = getattr(law, key.name, None)
        problem = "" if value is None else key.problem(value)
        if problem:
            raise ValueError(f"{what}: {key.name} {problem}")


def with_defaults(keys: Sequence[Key], values: Mapping[str, float]) -> dict[str, float]:
    """Values by key, with the defaults of those that are not given."""
    defaults = {key.name: key.default for key in keys if key.default is not None}
    return {**defaults, **values}
