"""A package as pip leaves it behind an editable installation, and commands with it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomlkit as tomllib


def lay_out(folder: Path) -> bool:
    """Write the metadata that pip writes: name, version and entry points of pyproject.toml."""
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    name, version = project["name"], project["version"]
    info = folder / f"{name.replace('-', '_')}-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    lines = []
    for group, entries in project.get("entry-points", {}).items():
        lines += [f"[{group}]", *(f"{entry} = {place}" for entry, place in entries.items())]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    return True


def command(folder: Path, words: list[str]) -> str:
    """What ``chatter WORDS`` prints with the package installed; RuntimeError where it fails."""
    paths = [str(folder), *sys.path]
    done = subprocess.run(
        [sys.executable, "-m", "chatter", *words],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in paths if path)},
    )
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return done.stdout + done.stderr
