"""What a variable of a MAT file holds, whatever its version."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TypeAlias

import numpy as np

from dynamics.frf.container import MeasurementError

#: numbers, text, fields of a structure, or elements of a structure or cell array
Node: TypeAlias = "np.ndarray | str | dict[str, Node] | list[Node]"
Variables: TypeAlias = "Mapping[str, Node]"

#: how deep structures of structures are followed, and most elements of one array of them
DEPTH, MOST_ELEMENTS = 4, 4096


def require_count(path: Path, name: str, count: int) -> None:
    """Raise MeasurementError where an array of structures has more elements than are read."""
    if count > MOST_ELEMENTS:
        raise MeasurementError(
            f"{path}: {name} has {count} elements; at most {MOST_ELEMENTS} are read"
        )
