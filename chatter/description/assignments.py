"""Assignments of the command line, ``--set PATH=VALUE``, as values for a patch."""

from collections.abc import Sequence
from typing import Any

import tomlkit

from chatter.description.errors import InputError
from chatter.description.formatting import formatted

#: takes a key away
NONE = "none"


def parse_assignments(assignments: Sequence[str]) -> dict[str, Any]:
    """Read ``PATH=VALUE`` texts of the command line.

    A value is what TOML makes of it (number, true, list, table, quoted text); ``none`` takes the
    key away; anything else is text, so that quantities need no quotes of their own.

    Raises
    ------
    InputError
        If an assignment has no "=" or no path.
    """
    values: dict[str, Any] = {}
    problems = []
    for assignment in assignments:
        path, equals, text = assignment.partition("=")
        if not equals or not path.strip():
            problems.append(
                f"--set {formatted(assignment)}: PATH=VALUE is required, "
                'such as cut.axial_depth="2 mm"'
            )
        elif not text.strip():
            problems.append(f"--set {formatted(assignment)}: there is no value after the =")
        values[path.strip()] = _toml_value(text.strip())
    if problems:
        raise InputError(problems)
    return values


def _toml_value(text: str) -> Any:
    if text == NONE:
        return None
    try:
        read = tomlkit.parse(f"value = {text}").unwrap()
    except Exception:
        # not TOML: plain text such as 2 mm
        return text
    return read["value"] if len(read) == 1 else text
