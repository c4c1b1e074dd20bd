"""What a study changes: a case, with the machine that it is on, or a machine alone.

Paths that begin with "machine." lead into the machine.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from chatter.description.case import MACHINE_PATH, Case
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.patchable import Description
from chatter.description.path import field_at, parse_path
from chatter.description.quantities import QuantityField
from chatter.description.toml_document import parse_document, read_text, value_at
from chatter.description.units import QuantityError, parse
from chatter.description.usual_units import usual_unit
from chatter.studies.program import program

if TYPE_CHECKING:
    from chatter.description.machine.machine_file import MachineFile

    Model: TypeAlias = Case | MachineFile
    AnyModel = TypeVar("AnyModel", bound=Model)

#: beginning of paths into the machine of a case
PREFIX = MACHINE_PATH
#: tables that only a machine file has
_OF_MACHINES = ("body", "beam", "imported", "connector")


def load_model(path: str | Path) -> Model:
    """Read a case or a machine file, whichever it is; InputError if the file describes neither."""
    path = Path(path)
    document = parse_document(read_text(path), str(path))
    if any(key in document for key in _OF_MACHINES):
        from chatter.description.machine.machine_file import load_machine

        return load_machine(path)
    return Case.from_file(path)


def model_or_read(given: Model | str | Path) -> Model:
    """Return the case or machine that is given, or that of its file; InputError for all else."""
    if isinstance(given, (str, Path)):
        return load_model(given)
    if isinstance(given, Description) and given.NOUN in ("case", "machine"):
        return given
    raise InputError(
        f"a case, a machine or the path of its file is required; {formatted(given)} is given"
    )


def machine_of(model: Model) -> MachineFile | None:
    """Machine of a case, or the machine that the model is; None where there is none."""
    if not isinstance(model, Case):
        return model
    return model.machine_file() if model.on_machine else None


def patched(model: AnyModel, values: Mapping[str, Any]) -> AnyModel:
    """Return a model with some values changed: path -> value as for `Case.patch`.

    InputError if a path is unknown, there is no machine for it, or what comes of it is wrong.
    """
    if not values:
        return model
    if isinstance(model, Case):
        return model.patch(values)
    return model.patch({path.removeprefix(PREFIX): value for path, value in values.items()})


def value_of(model: Model, path: str) -> Any:
    """Value at a path, in SI; None where the model has none, InputError if there is no machine."""
    where, inside = _into(model, path)
    try:
        return where.get(inside)
    except InputError:
        return None


def unit_at(model: Model, path: str) -> str:
    """Unit in which the file states the quantity at a path, else that in which people read it."""
    where, inside = _into(model, path)
    steps = parse_path(inside, f"a {where.NOUN}")
    stands = value_at(parse_document(where.to_toml(), where.name), steps)
    kind = field_at(type(where), steps)
    if kind is not None and isinstance(stands, str):
        try:
            return parse(stands, kind.matching(stands).dimension).unit
        except QuantityError:
            # a share of another value, such as "30 %" of the diameter
            pass
    return usual_unit(type(where), inside).name


def field_of(model: Model, path: str) -> QuantityField | None:
    """Kind of quantity at a path; None where it takes none, or there is no such path."""
    where, inside = _into(model, path)
    return field_at(type(where), parse_path(inside, f"a {where.NOUN}"))


def standard_deviations(model: Model) -> dict[str, float]:
    """Standard deviations (SI) of all values given with one, by path, the machine's too."""
    return model.deviations()


def fingerprint(model: Model) -> str:
    """Text that changes where the model, a file that it names or the program changes."""
    digest = hashlib.sha256()
    parts = [model] if machine_of(model) in (None, model) else [model, machine_of(model)]
    for part in parts:
        digest.update(f"{program()} {type(part).__name__} {part.content}".encode())
        for path in sorted(_files(part.model_dump(mode="python"))):
            digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()


def _files(content: Any) -> Iterator[Path]:
    """Names of files anywhere in a description."""
    if isinstance(content, Path):
        yield content
    elif isinstance(content, Mapping):
        for entry in content.values():
            yield from _files(entry)
    elif isinstance(content, (list, tuple)):
        for entry in content:
            yield from _files(entry)


def _into(model: Model, path: str) -> tuple[Model, str]:
    """Description that a path leads into, and the path there."""
    if not path.startswith(PREFIX):
        return model, path
    inside = path.removeprefix(PREFIX)
    return _machine(model, inside), inside


def _machine(model: Model, path: str) -> MachineFile:
    if isinstance(model, Case):
        model.require_machine(path)
    return machine_of(model)
