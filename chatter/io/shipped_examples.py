"""The shipped examples: one folder a case, with case file, short script and what to see."""

import importlib.util
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from chatter.description.errors import InputError

#: in an installed package, and beside the packages in a source tree
_PLACES = (
    Path(__file__).resolve().parents[1] / "examples",
    Path(__file__).resolve().parents[2] / "examples",
)
_SCRIPT = "run.py"


@dataclass(frozen=True)
class Example:
    """One shipped example."""

    name: str
    folder: Path

    @property
    def summary(self) -> str:
        """First sentence of what to see."""
        script = (self.folder / _SCRIPT).read_text(encoding="utf-8")
        return script.split('"""')[1].strip().splitlines()[0]

    def copy(self, folder: str | Path) -> Path:
        """Copy the example into a new folder; InputError if the folder is there already."""
        folder = Path(folder)
        if folder.exists():
            raise InputError(f"{folder}: is there already; name another folder with --out")
        ignored = shutil.ignore_patterns("__pycache__", "out")
        shutil.copytree(self.folder, folder, ignore=ignored)
        return folder

    def run(self, out: str | Path) -> list[Path]:
        """Run the example's script; return the pictures and files it wrote."""
        return _main_of(self.folder / _SCRIPT)(Path(out))


def _main_of(script: Path) -> Callable[[Path], list[Path]]:
    specification = importlib.util.spec_from_file_location(f"example_{script.parent.name}", script)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module.main


def examples() -> dict[str, Example]:
    """Return the shipped examples by name."""
    for root in _PLACES:
        folders = sorted(path.parent for path in root.glob(f"*/{_SCRIPT}"))
        if folders:
            return {folder.name: Example(folder.name, folder) for folder in folders}
    return {}


def example(name: str) -> Example:
    """Return one example; InputError if there is none of that name."""
    known = examples()
    if name not in known:
        from chatter.description.wording import nearest

        raise InputError(f'"{name}" is no example; {nearest(name, list(known))}')
    return known[name]
