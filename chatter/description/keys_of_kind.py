"""Keys of a section that belong to its kind alone, such as those of a law."""

from __future__ import annotations

from collections.abc import Mapping

from chatter.description.path import field_at
from chatter.description.section import Section
from chatter.description.wording import nearest


def key_problems(
    section: Section, choosing: str, keys: Mapping[str, bool], always: tuple[str, ...] = ()
) -> list[tuple[str, str]]:
    """Tell keys that do not belong to the kind that a section is of, and needed ones missing.

    Parameters
    ----------
    section : Section
    choosing : str
        Key that chooses the kind.
    keys : mapping of str to bool
        Keys of the kind, and whether each is needed.
    always : tuple of str
        Keys of every kind.
    """
    kind = f'{choosing} = "{getattr(section, choosing)}"'
    problems = []
    for name in type(section).model_fields:
        if name in (choosing, *always):
            continue
        given = name in section.model_fields_set and getattr(section, name) not in (None, ())
        if given and name not in keys:
            problems.append((name, f"does not belong to {kind}; {nearest(name, list(keys))}"))
        if not given and keys.get(name, False):
            field = field_at(type(section), (name,))
            wanted = "" if field is None else f"; {field.noun}, such as {field.example}"
            problems.append((name, f"is missing; {kind} needs it{wanted}"))
    return problems
