"""Columns of the tables that the kernels of frictions read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray


def parameter_columns(laws: Sequence[Any], names: Sequence[str]) -> dict[str, NDArray[np.float64]]:
    """Columns (n,) of the parameters of n laws, by their names; not writeable."""
    return {
        name: _fixed(np.array([getattr(law, name) for law in laws], dtype=np.float64))
        for name in names
    }


def port_column(ports: Sequence[int]) -> NDArray[np.int64]:
    """Column (n,) of the ports that n laws act on; not writeable."""
    return _fixed(np.array(ports, dtype=np.int64))


def _fixed(column: NDArray) -> NDArray:
    column.flags.writeable = False
    return column
