"""Files that results write: texts, summaries as strict JSON, pictures."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def finite_or_none(value: float) -> float | None:
    """Return a number as JSON knows it: None in place of nan and inf."""
    return float(value) if math.isfinite(value) else None


def as_json(summary: Mapping) -> str:
    """Text of a summary; refuses nan and inf, which JSON does not know."""
    return json.dumps(summary, indent=2, allow_nan=False) + "\n"


def write_results(
    folder: str | Path, texts: Mapping[str, str], pictures: Mapping[str, Figure]
) -> list[Path]:
    """Write texts and pictures into a folder, which is made where it is missing.

    Parameters
    ----------
    folder : path
    texts, pictures : mapping
        File name -> content.

    Returns
    -------
    list of Path
        What was written.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    for name, figure in pictures.items():
        figure.savefig(folder / name)
    return [folder / name for name in (*texts, *pictures)]
