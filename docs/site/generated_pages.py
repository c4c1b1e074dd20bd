"""Pages of the manual that are made from the program: name of the page -> what writes it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import command_options
import gallery
import key_tables
import modules

ROOT = Path(__file__).resolve().parents[2]


def _copy(name: str) -> Callable[[], str]:
    def page() -> str:
        return (ROOT / name).read_text(encoding="utf-8").replace("](docs/", "](/")

    return page


PAGES: dict[str, Callable[[], str]] = {
    "changelog.md": _copy("CHANGELOG.md"),
    "contributing.md": _copy("CONTRIBUTING.md"),
    "gallery.md": gallery.page,
    "case-keys.md": key_tables.case_page,
    "machine-keys.md": key_tables.machine_page,
    "measurement-keys.md": key_tables.measurement_page,
    "command-options.md": command_options.page,
    "modules-cutting.md": lambda: modules.page("cutting"),
    "modules-dynamics.md": lambda: modules.page("dynamics"),
}


def write(folder: Path) -> None:
    """Write the pages that have changed; the others are not read again by Sphinx."""
    folder.mkdir(exist_ok=True)
    for name, make in PAGES.items():
        path, content = folder / name, make()
        if not path.exists() or path.read_text(encoding="utf-8") != content:
            path.write_text(content, encoding="utf-8")
