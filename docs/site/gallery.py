"""Gallery: every shipped example with what it shows, its picture and its run time."""

from __future__ import annotations

import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
#: seconds of each example, written by ``python docs/site/run_examples.py``
_RUN_TIMES = ROOT / "docs" / "site" / "run-times.json"

_HEAD = """# Gallery

Every example is in the package. `chatter examples NAME` copies it, and with `--run` runs it.
The run times were measured on {machine}, with compiled kernels in the cache.
"""


def page() -> str:
    """Return the page."""
    from chatter.io.shipped_examples import examples

    measured = json.loads(_RUN_TIMES.read_text(encoding="utf-8"))
    parts = [_HEAD.format(machine=measured["machine"])]
    for one in examples().values():
        parts.append(f"## {one.name}\n\n{one.summary}\n")
        seconds = measured["seconds"].get(one.name)
        if seconds is not None:
            parts.append(f"Run time: {seconds:.0f} s.\n" if seconds >= 1 else "Run time: 1 s.\n")
        # an example that takes long has the picture of the page that tells of it
        for place in ("pictures/gallery", "pictures"):
            if (DOCS / place / f"{one.name}.png").exists():
                parts.append(f"![{one.name}](/{place}/{one.name}.png)\n")
                break
    return "\n".join(parts)
