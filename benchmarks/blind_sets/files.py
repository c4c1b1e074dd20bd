"""Folders, case files and truth files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

TRUTH = "truth"


def folders(out: Path, number: int) -> tuple[Path, Path]:
    """Folder of a set and, apart from it, of its truth; both made."""
    name = f"set-{number:04d}"
    place, truth = out / name, out / TRUTH / name
    place.mkdir(parents=True, exist_ok=False)
    truth.mkdir(parents=True, exist_ok=False)
    return place, truth


def write_toml(path: Path, content: Mapping[str, Any]) -> None:
    """Write a file as TOML."""
    path.write_text(tomlkit.dumps(plain(content)), encoding="utf-8")


def plain(value: Any) -> Any:
    """Numbers and lists in place of numpy's."""
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, np.ndarray | list | tuple):
        return [plain(one) for one in value]
    if isinstance(value, np.generic):
        return value.item()
    return value


def write_signals(
    path: Path, heading: Sequence[str], columns: Sequence[np.ndarray], formats: Sequence[str]
) -> None:
    """Write columns as CSV with name and unit in the heading."""
    rows = np.column_stack(columns)
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(heading) + "\n")
        np.savetxt(file, rows, fmt=list(formats), delimiter=",")


def quantity(value: float, unit: str) -> str:
    """A number with its unit, at six digits."""
    return f"{value:.6g} {unit}"


def declared(rng: np.random.Generator, value: float, spread: float) -> float:
    """A true value as somebody declares it: off by a share, at most two and a half spreads."""
    return float(value * (1.0 + spread * np.clip(rng.standard_normal(), -2.5, 2.5)))


def mode_tables(
    rng: np.random.Generator,
    frequency: np.ndarray,
    damping: np.ndarray,
    mass: np.ndarray,
    direction: np.ndarray,
) -> list[dict[str, Any]]:
    """[[structure.mode]] of a declared case."""
    return [
        {
            "frequency": quantity(declared(rng, frequency[m], 0.003), "Hz"),
            "damping": round(declared(rng, damping[m], 0.06), 6),
            "mass": quantity(declared(rng, mass[m], 0.022), "kg"),
            "direction": [round(float(direction[m, 0])), round(float(direction[m, 1])), 0],
        }
        for m in range(len(frequency))
    ]


def material_table(
    rng: np.random.Generator, Ktc: float, Krc: float, Kte: float, Kre: float
) -> dict[str, Any]:
    """[material] of a declared case."""
    return {
        "law": "linear",
        "Ktc": quantity(declared(rng, Ktc, 0.03) * 1e-6, "MPa"),
        "Krc": quantity(declared(rng, Krc, 0.04) * 1e-6, "MPa"),
        "Kte": quantity(declared(rng, Kte, 0.04) * 1e-3, "N/mm"),
        "Kre": quantity(declared(rng, Kre, 0.04) * 1e-3, "N/mm"),
    }
