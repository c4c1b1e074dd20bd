"""Reprs that fit a screen: arrays by their shape, many entries by their number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

#: entries of an array or a list that are shown, and letters of any other field
_FEW, _LETTERS = 4, 120


class BriefRepr:
    """A dataclass whose repr, which `@dataclass(repr=False)` leaves to it, is short."""

    def __repr__(self) -> str:
        """Fields of the dataclass, none of them longer than a line."""
        told = ", ".join(
            f"{field.name}={_brief(getattr(self, field.name))}"
            for field in fields(self)  # type: ignore[arg-type]
            if field.repr
        )
        return f"{type(self).__name__}({told})"


def _brief(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size > _FEW:
        return f"<array {' x '.join(map(str, value.shape))}>"
    if isinstance(value, (tuple, list, Mapping)) and len(value) > _FEW:
        return f"<{len(value)} entries>"
    text = repr(value)
    if len(text) <= _LETTERS:
        return text
    if isinstance(value, (tuple, list, Mapping)):
        return f"<{len(value)} entries>"
    return f"<{type(value).__name__}>"
