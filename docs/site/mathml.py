"""Formulas as MathML: a reader needs no script, no font and no network."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert


def _converted(tex: str, display: str) -> str:
    shown = convert(tex, display=display)
    unknown = re.search(r"<m[io]>(\\\w+)</m[io]>", shown)
    if unknown:
        raise ValueError(f"{tex}: {unknown[1]} is not known to the formula converter")
    return str(shown)


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(_converted(node.astext(), "inline"))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.math_block) -> None:
    number = f'<span class="eqno">({node["number"]})</span>' if node["number"] else ""
    identifier = f' id="{node["ids"][0]}"' if node["ids"] else ""
    formula = _converted(node.astext(), "block")
    writer.body.append(f'<div class="math"{identifier}>{number}{formula}</div>')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Register the renderer and choose it."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True, "parallel_write_safe": True}
