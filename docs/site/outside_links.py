"""Links from pages to files outside docs: to their place in the manual, or as plain names."""

from __future__ import annotations

import re
from typing import Any

_PLACES = {
    "CONTRIBUTING.md": "/generated/contributing.md",
    "CHANGELOG.md": "/generated/changelog.md",
    "README.md": "/index.md",
}
_LINK = re.compile(r"\[([^\]]+)\]\((?:\.\./)+([^)#]+)(#[^)]*)?\)")


def inside(page: str) -> str:
    """Page whose links stay in the manual."""

    def changed(found: re.Match[str]) -> str:
        words, target = found[1], found[2]
        if target in _PLACES:
            return f"[{words}]({_PLACES[target]})"
        if re.match(r"(examples|tests|benchmarks|chatter|cutting|dynamics)/", target):
            return f"{words} (`{target}`)"
        return found[0]

    return _LINK.sub(changed, page)


def _read(app: Any, name: str, content: list[str]) -> None:
    content[0] = inside(content[0])


def setup(app: Any) -> dict[str, bool]:
    """Register the rewriting of links."""
    app.connect("source-read", _read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
