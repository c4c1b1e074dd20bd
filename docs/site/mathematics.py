"""TeX in pages as MathML: no script, no font and no network to read a formula."""

from __future__ import annotations

import html
import re

from latex2mathml.converter import convert

_INLINE = re.compile(r'<span class="arithmatex">\\\((.+?)\\\)</span>', re.DOTALL)
_DISPLAY = re.compile(r'<div class="arithmatex">\s*\\\[(.+?)\\\]\s*</div>', re.DOTALL)


def _mathml(display: str, found: re.Match[str]) -> str:
    tex = html.unescape(found[1]).strip()
    shown = convert(tex, display=display)
    unknown = re.search(r"<mi>(\\\w+)</mi>", shown)
    if unknown:
        raise ValueError(f"{tex}: {unknown[1]} is not known to the formula converter")
    return shown


def with_mathml(page: str) -> str:
    """Page with its TeX as MathML; ValueError where a command is not known."""
    page = _DISPLAY.sub(lambda found: f"<p>{_mathml('block', found)}</p>", page)
    return _INLINE.sub(lambda found: _mathml("inline", found), page)
