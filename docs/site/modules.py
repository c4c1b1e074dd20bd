"""Pages of every public module of the packages, for those who extend them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_WHAT = {
    "cutting": "Tool, force, engagement, chip, workpiece, process damping.",
    "dynamics": "Structure, beams, drives, friction, control, FRFs, identification.",
}


def _modules(package: str) -> Iterator[str]:
    for path in sorted((ROOT / package).rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        if any(part.startswith("_") for part in parts if part != "__init__"):
            continue
        if parts[1:2] == ("examples",):
            continue
        yield ".".join(part for part in parts if part != "__init__")


def page(package: str) -> str:
    """Return the page of a top package."""
    lines = [f"# Modules of `{package}`", "", _WHAT[package], ""]
    for name in _modules(package):
        lines += [f"## `{name}`", "", "```{eval-rst}", f".. automodule:: {name}"]
        lines += ["   :members:", "   :no-index:", "```", ""]
    return "\n".join(lines)
