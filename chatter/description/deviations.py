"""Standard deviations of the values of a file that are given as "1650 +- 80 MPa"."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from chatter.description.path import field_at, join_path, leaves
from chatter.description.quantities import QuantityField
from chatter.description.units import QuantityError, parse


def deviations_of(kind: type[BaseModel], data: Any) -> dict[str, float]:
    """Return the standard deviations, SI, of the values of nested tables, by path."""
    found: dict[str, float] = {}
    for steps, text in leaves(data):
        field = field_at(kind, steps) if isinstance(text, str) else None
        if field is not None and (deviation := _deviation(text, field)) > 0.0:
            found[join_path(steps)] = deviation
    return found


def _deviation(item: str, field: QuantityField) -> float:
    """Standard deviation (SI) of a quantity; 0 of a share of another value, such as "8 %"."""
    try:
        return parse(item, field.matching(item).dimension).deviation
    except QuantityError:
        return 0.0
