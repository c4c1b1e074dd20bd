"""Say what is wrong with a case: which file, which key, what was given, what is allowed."""

from __future__ import annotations

import difflib
from typing import Any

from pydantic import BaseModel, ValidationError

from chatter.case.base import SectionError
from chatter.case.path import field_at, join_path, keys_of, model_at
from chatter.case.quantities import shown
from chatter.units import DIMENSIONS


def sentences(error: ValidationError, model: type[BaseModel], name: str) -> list[str]:
    """Turn the errors of a validation into one sentence each.

    Parameters
    ----------
    error : ValidationError
    model : type
        Class that was validated.
    name : str
        File, for the beginning of each sentence.
    """
    texts = []
    for item in error.errors(include_url=False):
        steps = tuple(item["loc"])
        for key, text in _problems(item, model, steps):
            path = join_path((*steps, key) if key else steps)
            texts.append(f"{name}: {path}: {text}" if path else f"{name}: {text}")
    return texts


def _problems(item: Any, model: type[BaseModel], steps: tuple) -> list[tuple[str, str]]:
    kind = item["type"]
    original = item.get("ctx", {}).get("error")
    if isinstance(original, SectionError):
        return list(original.problems)
    if kind == "value_error":
        return [("", str(original))]
    if kind == "extra_forbidden":
        return [("", _unknown_key(model, steps))]
    if kind == "missing":
        return [("", _missing(model, steps))]
    if kind == "literal_error":
        return [("", _not_allowed(item))]
    wanted = next((text for part, text in _KINDS.items() if kind.startswith(part)), None)
    given = shown(item["input"])
    return [("", f"{given} is wrong; {wanted}" if wanted else f"{given}: {item['msg']}")]


_KINDS = {
    "model": "a table is wanted",
    "dict": "a table is wanted",
    "tuple": "a list is wanted",
    "list": "a list is wanted",
    "string": "text in quotes is wanted",
    "path": "a file name is wanted",
}


def nearest(word: str, known: list[str]) -> str:
    """Return a hint at the nearest known word, or the list of all."""
    folded = {key.lower(): key for key in known}
    near = difflib.get_close_matches(word.lower(), folded, n=1, cutoff=0.6)
    if near:
        return f'did you mean "{folded[near[0]]}"?'
    return "known are " + ", ".join(known)


def _unknown_key(model: type[BaseModel], steps: tuple) -> str:
    section = model_at(model, steps[:-1])
    hint = nearest(str(steps[-1]), keys_of(section)) if section else ""
    return f"unknown key; {hint}" if hint else "unknown key"


def _missing(model: type[BaseModel], steps: tuple) -> str:
    field = field_at(model, steps)
    if field is None:
        return "is missing"
    entry = DIMENSIONS[field.dimension]
    example = f'"{entry.example}"' if entry.unit else entry.example
    return f"is missing; {entry.name} is wanted, such as {example}"


def _not_allowed(item: Any) -> str:
    allowed = item["ctx"]["expected"].replace("'", '"')
    return f"{shown(item['input'])} is not allowed; allowed are {allowed}"
