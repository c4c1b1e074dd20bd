"""Tests of a machine as the command line asks for them."""

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from chatter.description.errors import InputError
from chatter.description.machine.frequency_response import FrfSection
from chatter.description.machine.machine_file import MachineFile
from chatter.description.machine.move import MoveSection
from chatter.description.wording import sentences
from chatter.simulation.virtual_tests.from_file import default_frfs

#: band of a test that names none
_BAND = ("5 Hz", "500 Hz")


def frf_sections(
    file: MachineFile, only: Sequence[str] | None, changes: Mapping[str, Any]
) -> dict[str, FrfSection]:
    """Tests of a file, changed by the options; one of the command line's own if it excites.

    Raises InputError if a name is unknown or an option is wrong.
    """
    changed = _as_keys(changes)
    if "excite" in changed:
        chosen = {changed["excite"]: {"band": _BAND}}
    else:
        named = _chosen("frf", dict(file.frf), only)
        sections = named or default_frfs(file)
        chosen = {name: section.model_dump() for name, section in sections.items()}
    return {name: _section(FrfSection, {**keys, **changed}) for name, keys in chosen.items()}


def move_sections(file: MachineFile, only: Sequence[str] | None) -> dict[str, MoveSection]:
    """Moves of a file; InputError if there are none, or a name is unknown."""
    if not file.move:
        raise InputError(
            f"{file.name}: move: there is no [move.NAME]; such as [move.fast] kind = "
            '"jerk limited", axes = ["Y"], travel = ["100 mm"], velocity = "1 m/s", '
            'acceleration = "10 m/s^2", jerk = "500 m/s^3"'
        )
    return _chosen("move", dict(file.move), only)


def _chosen(kind: str, sections: dict, only: Sequence[str] | None) -> dict:
    for name in only or ():
        if name not in sections:
            known = ", ".join(sections) or "none"
            raise InputError(f"--only {name}: there is no [{kind}.{name}]; there are {known}")
    return {name: sections[name] for name in only} if only else sections


def _as_keys(changes: Mapping[str, Any]) -> dict[str, Any]:
    """Options as keys of a section."""
    keys = dict(changes)
    for key in ("moving", "position"):
        if key in keys:
            keys[key] = dict(_pair(f"--{key}", text) for text in keys[key])
    held = {axis: word for word in ("brake", "free") for axis in keys.pop(word, ())}
    if held:
        keys["condition"] = held
    return keys


def _pair(option: str, text: str) -> tuple[str, str]:
    axis, equals, value = text.partition("=")
    if not equals or not axis.strip():
        raise InputError(f'{option} {text!r}: expected AXIS=VALUE, such as {option} "Y=1 mm"')
    return axis.strip(), value.strip()


def _section(kind: type[FrfSection], keys: Mapping[str, Any]) -> FrfSection:
    try:
        return kind.model_validate(keys)
    except ValidationError as error:
        raise InputError(sentences(error, kind, "test of the command line")) from None
