"""Run examples for the gallery: ``python docs/site/run_examples.py [NAME ...]``.

Keeps a picture of each, those that other pages show, and the processor time it took with kernels in
the cache; each runs in a process of its own, with a limit on its time.
"""

from __future__ import annotations

import json
import platform
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(DOCS / "site"), str(DOCS.parent)]

import picture_size  # noqa: E402

RUN_TIMES = DOCS / "site" / "run-times.json"
GALLERY = DOCS / "pictures" / "gallery"
PICTURES = GALLERY.parent
#: of an example, files of its results and what the pages call them
ON_PAGES = {
    "chattering-cut": {
        "3-mm/simulate.png": "chattering-cut.png",
        "bifurcation/bifurcation.png": "bifurcation.png",
    },
    "face-mill-chatter": {
        "face-mill-entry.png": "face-mill-entry.png",
        "face-mill-onsets.png": "face-mill-onsets.png",
    },
    "flexible-workpiece": {"lobes.png": "flexible-workpiece.png"},
    "machine-coupled-milling": {"responses.png": "machine-responses.png"},
}
#: s after which an example is ended, and stands in the gallery without a picture
_LONGEST = 1500.0


def _processor_time() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def refresh(name: str) -> float:
    """Run one example and keep its picture; the processor time it took, s."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        begun = _processor_time()
        words = [sys.executable, "-m", "chatter", "examples", name, "--run", "--out", str(out)]
        subprocess.run(words, cwd=DOCS.parent, check=True, timeout=_LONGEST, capture_output=True)
        taken = _processor_time() - begun
        drawn = sorted(out.rglob("*.png"), key=lambda path: path.stat().st_mtime)
        if drawn:
            picture_size.keep(drawn[0], GALLERY / f"{name}.png")
        for found, shown in ON_PAGES.get(name, {}).items():
            picture_size.keep(out / found, PICTURES / shown)
    return taken


def main() -> None:
    """Run the examples that are named, or all."""
    from chatter.io.shipped_examples import examples

    measured = json.loads(RUN_TIMES.read_text(encoding="utf-8"))
    measured["machine"] = f"one core of {platform.machine()}, Python {platform.python_version()}"
    for name in sys.argv[1:] or list(examples()):
        try:
            measured["seconds"][name] = round(refresh(name), 1)
        except (subprocess.SubprocessError, OSError) as error:
            sys.stdout.write(f"{name}: {error}\n")
            continue
        RUN_TIMES.write_text(json.dumps(measured, indent=1) + "\n", encoding="utf-8")
        sys.stdout.write(f"{name}: {measured['seconds'][name]} s\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
