"""Dotted paths into a case: "cut.axial_depth", "structure.mode[0].damping", "structure.mode[*]"."""

import re
from collections.abc import Iterator, Mapping
from functools import cache, lru_cache
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.quantities import QuantityField

#: a key, a place in a list, or ``"*"`` for every place
Step = str | int

_STEP = re.compile(r"\.?([A-Za-z_][\w-]*)|\[(\d+|\*)\]|\.(\d+|\*)(?=[.\[]|$)")


def parse_path(text: str, into: str = "a case, such as cut.axial_depth") -> tuple[Step, ...]:
    """Split a dotted path into its steps.

    What it leads into is for the message of an InputError if it is not a path.
    """
    found = _split(text) if isinstance(text, str) else None
    if found is None:
        raise InputError(f"{formatted(text)} is not a path into {into}")
    return found


@lru_cache(4096)
def _split(text: str) -> tuple[Step, ...] | None:
    """Steps of a path, which a search asks for again and again; None of what is none."""
    steps: list[Step] = []
    position = 0
    while position < len(text):
        match = _STEP.match(text, position)
        if match is None:
            break
        key, bracket, dotted = match.groups()
        at = bracket or dotted
        steps.append(key if key else "*" if at == "*" else int(at))
        position = match.end()
    if not steps or position < len(text) or not isinstance(steps[0], str):
        return None
    return tuple(steps)


def join_path(steps: tuple[Step, ...]) -> str:
    """Write steps as a dotted path."""
    text = ""
    for step in steps:
        position = isinstance(step, int) or step == "*"
        text += f"[{step}]" if position else f".{step}" if text else step
    return text


def leaves(item: Any, steps: tuple[Step, ...] = ()) -> Iterator[tuple[tuple[Step, ...], Any]]:
    """Path and value of everything in nested tables and lists that is neither."""
    if isinstance(item, Mapping):
        for key, value in item.items():
            yield from leaves(value, (*steps, key))
    elif isinstance(item, (list, tuple)):
        for index, value in enumerate(item):
            yield from leaves(value, (*steps, index))
    else:
        yield steps, item


@cache
def model_at(model: type[BaseModel], steps: tuple[Step, ...]) -> type[BaseModel] | None:
    """Section class that a path leads to; None where it leads to no section."""
    annotation: Any = model
    for step in steps:
        sections = _sections(annotation)
        if isinstance(step, int) or step == "*":
            continue
        if is_mapping(annotation):
            annotation = get_args(annotation)[1]
            continue
        if not sections or key_of(sections[0], step) is None:
            return None
        annotation = sections[0].model_fields[key_of(sections[0], step)].annotation
    sections = _sections(annotation)
    return sections[0] if sections and not is_mapping(annotation) else None


@cache
def info_at(model: type[BaseModel], steps: tuple[Step, ...]) -> FieldInfo | None:
    """Declaration of the field that a path leads to or into; None where there is none."""
    while steps and (isinstance(steps[-1], int) or steps[-1] == "*"):
        steps = steps[:-1]
    section = model_at(model, steps[:-1]) if steps else None
    name = key_of(section, steps[-1]) if section else None
    return section.model_fields[name] if name else None


@cache
def field_at(model: type[BaseModel], steps: tuple[Step, ...]) -> QuantityField | None:
    """Quantity field that a path leads to, or into where it is a list; None for other fields."""
    info = info_at(model, steps)
    if info is not None:
        return next(iter(_quantity_fields([*info.metadata, info.annotation])), None)
    # quantities by name, such as the positions of axes
    named = info_at(model, steps[:-1]) if steps and isinstance(steps[-1], str) else None
    entries = [] if named is None else _entries_by_name(named.annotation)
    return next(iter(_quantity_fields(entries)), None)


@cache
def key_of(section: type[BaseModel], key: str) -> str | None:
    """Attribute of a section for a key of the file (``from`` is ``from_``); None if unknown."""
    for name, info in section.model_fields.items():
        if key == (info.alias or name):
            return name
    return None


def keys_of(section: type[BaseModel]) -> list[str]:
    """Keys that a section may have in the file."""
    return [info.alias or name for name, info in section.model_fields.items()]


def _sections(annotation: Any) -> list[type[BaseModel]]:
    """Section classes in an annotation, unwrapping options, lists and mappings."""
    parts = get_args(annotation)
    # Python 3.10 takes list[float] for a type
    if not parts and isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [section for part in parts for section in _sections(part)]


def is_mapping(annotation: Any) -> bool:
    """Whether an annotation is that of tables by name."""
    return get_origin(annotation) is dict


def _entries_by_name(annotation: Any) -> list[Any]:
    """What the entries of a table by name are, where an annotation is that of one."""
    parts = get_args(annotation) if get_origin(annotation) in (Union, UnionType) else (annotation,)
    return [get_args(part)[1] for part in parts if is_mapping(part)]


def _quantity_fields(parts: list[Any]) -> list[QuantityField]:
    found = []
    for part in parts:
        if isinstance(part, QuantityField):
            found.append(part)
        elif get_origin(part) in (Annotated, Union, UnionType):
            found += _quantity_fields(list(get_args(part)))
    return found
