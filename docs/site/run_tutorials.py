"""Run tutorials and refresh their pictures: ``python docs/site/run_tutorials.py [NAME ...]``."""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(DOCS / "site"), str(DOCS.parent)]

import code_blocks  # noqa: E402
import picture_size  # noqa: E402


def refresh(path: Path) -> None:
    """Run one tutorial in a folder of its own and keep the pictures that it shows."""
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        code_blocks.run_page(path)
        for picture in code_blocks.pictures(path.read_text(encoding="utf-8")):
            source = Path(folder) / picture.split("/", 1)[1]
            picture_size.keep(source, DOCS / "pictures" / "tutorials" / picture)
        os.chdir(DOCS)
    sys.stdout.write(f"{path.stem}: {time.monotonic() - begun:.0f} s\n")


def main() -> None:
    """Run the tutorials that are named, or all."""
    names = sys.argv[1:] or sorted(path.stem for path in (DOCS / "tutorials").glob("*.md"))
    for name in names:
        refresh(DOCS / "tutorials" / f"{name}.md")


if __name__ == "__main__":
    main()
