"""Tables of the docs, made from the registries: ``python docs/tables.py`` rewrites them.

A table stands between ``<!-- table: NAME -->`` and ``<!-- end -->``; `tests/test_docs.py` holds the
pages to what this script would write.
"""

from __future__ import annotations

import re
import sys
import typing
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import typer.main
from pydantic import BaseModel

DOCS = Path(__file__).resolve().parent
if __name__ == "__main__":
    # the tables are of the packages beside this folder, whatever is installed
    sys.path.insert(0, str(DOCS.parent))
_BLOCK = re.compile(r"(<!-- table: (.+) -->\n)(?:(?!<!--).*\n)*(<!-- end -->)")


def _table(headers: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    heads = list(headers)
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines)


def _code(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _laws(laws: Iterable) -> str:
    rows = ([f"`{law.name}`", law.help, _code(key.name for key in law.keys)] for law in laws)
    return _table(["law", "what it is", "keys"], rows)


def friction_laws() -> str:
    """Friction laws of `[friction.NAME]`."""
    from chatter.description.law_section import FRICTION_LAWS

    return _laws(FRICTION_LAWS)


def force_laws() -> str:
    """Force laws of `[material]`."""
    from chatter.description.law_section import FORCE_LAWS

    return _laws(FORCE_LAWS)


def methods() -> str:
    """Stability methods."""
    from chatter.stability.registry import documentation

    return documentation().rstrip("\n") + "\n"


def formats() -> str:
    """File formats."""
    from chatter.io.formats.format_list import documentation

    return documentation().rstrip("\n") + "\n"


def effects() -> str:
    """Effects that `chatter explain` may name."""
    from chatter.explain.effects.effect_list import EFFECTS

    rows = ([f"`{one.name}`", ", ".join(one.kinds), one.help] for one in EFFECTS)
    return _table(["effect", "measurements", "what it is"], rows)


def commands() -> str:
    """Commands with their first line of help."""
    from chatter.cli import COMMANDS, program

    group = typer.main.get_command(program)
    rows = []
    for name in COMMANDS:
        one = group.commands[name]
        words = [p.metavar for p in one.params if p.param_type_name == "argument"]
        line = " ".join(["chatter", name, *words])
        rows.append([f"`{line}`", one.help.splitlines()[0]])
    return _table(["command", "what it does"], rows)


def _models(kind: object) -> Iterator[type[BaseModel]]:
    """Sections within the type of a field."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        yield kind
    for part in typing.get_args(kind):
        yield from _models(part)


def _section_rows(name: str, model: type[BaseModel]) -> Iterator[list[str]]:
    nested = []
    keys = []
    for key, field in model.model_fields.items():
        inner = list(_models(field.annotation))
        repeated = "tuple" in str(field.annotation)
        named = "dict" in str(field.annotation)
        shown = field.alias or key
        if not inner:
            keys.append(shown)
            continue
        for each in inner:
            path = f"{name}.{shown}" if name else shown
            path += ".NAME" if named else ""
            nested.append((f"[[{path}]]" if repeated else f"[{path}]", path, each))
    if keys and name:
        yield [_code(keys)]
    for title, path, each in nested:
        for row in _section_rows(path, each):
            yield [f"`{title}`", *row] if len(row) == 1 else row


def sections() -> str:
    """Sections of a case file and their keys."""
    from chatter.description.case import Case

    return _table(["section", "keys"], _section_rows("", Case))


TABLES: dict[str, Callable[[], str]] = {
    "commands": commands,
    "sections": sections,
    "force laws": force_laws,
    "friction laws": friction_laws,
    "methods": methods,
    "effects": effects,
    "formats": formats,
}


def current(page: str) -> str:
    """Text of a page with its tables as the registries have them."""
    return _BLOCK.sub(lambda found: found[1] + TABLES[found[2]]() + found[3], page)


def main() -> None:
    """Rewrite the tables of all pages."""
    for path in sorted(DOCS.glob("*.md")):
        before = path.read_text(encoding="utf-8")
        after = current(before)
        if after != before:
            path.write_text(after, encoding="utf-8")
            sys.stdout.write(f"{path.name}\n")


if __name__ == "__main__":
    main()
