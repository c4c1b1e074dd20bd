"""Super-elements written in the formats that parts of a machine are read from."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from chatter.io.formats.node_table import NODE_COLUMNS, ROW_COLUMNS
from dynamics.structure.linear_structure import LinearStructure


def write_super_element(
    folder: str | Path, reduced: LinearStructure, positions: Mapping[str, ArrayLike]
) -> list[Path]:
    """Write mass.npz, stiffness.npz and nodes.csv of a super-element.

    Its points, at positions (3,) in m, are nodes with six freedoms, its first coordinates; the rest
    are modal coordinates, which no node has. As from `craig_bampton.super_element` with boundary
    points that have all six directions.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    written = [folder / name for name in ("mass.npz", "stiffness.npz", "nodes.csv")]
    np.savez_compressed(written[0], matrix=reduced.mass)
    np.savez_compressed(written[1], matrix=reduced.stiffness)
    with written[2].open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow([*NODE_COLUMNS, *ROW_COLUMNS, "point"])
        for number, (name, at) in enumerate(positions.items()):
            row = [f"{value:.9g}" for value in np.asarray(at)]
            table.writerow([number + 1, *row, *(6 * number + np.arange(1, 7)), name])
    return written
