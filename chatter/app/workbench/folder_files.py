"""Which files of a folder are cases of cuts and machines, those with faults included."""

from __future__ import annotations

from pathlib import Path

import tomlkit

from chatter.description.case import load
from chatter.description.errors import InputError

#: what a cut needs
_OF_CUT = frozenset(("tool", "material", "cut", "structure"))
#: so many of them in a file that cannot be read: it is meant as a case
_MEANT_AS_CUT = 3
#: what only a machine file has
_OF_MACHINE = frozenset(("body", "beam", "connector"))


def is_cut(path: Path) -> bool:
    """Whether a file describes a cut, or has faults and is meant to: it is mended on the page."""
    try:
        case = load(path)
    except InputError:
        return len(_OF_CUT & _keys(path)) >= _MEANT_AS_CUT
    return all((case.tool, case.material, case.cut, case.structure))


def is_machine(path: Path) -> bool:
    """Whether a file describes a machine, or has faults and is meant to."""
    from chatter.description.machine.machine_file import load_machine

    try:
        machine = load_machine(path)
    except InputError:
        return bool(_OF_MACHINE & _keys(path))
    return any(machine.model_dump(exclude_defaults=True, exclude={"title"}).values())


def _keys(path: Path) -> frozenset[str]:
    """Keys of a TOML file; those that a case has where it is no TOML, which is mended there."""
    try:
        return frozenset(tomlkit.parse(path.read_text(encoding="utf-8-sig")))
    except tomlkit.exceptions.ParseError:
        return _OF_CUT
    except (OSError, ValueError):
        return frozenset()
