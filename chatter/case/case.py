"""The Case: an immutable description of a cut; everything else is a function of it."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit
from pydantic import Field, PrivateAttr, ValidationError, model_validator

from chatter.case.base import Section, raise_if_any
from chatter.case.checks import engagement_problems, engagement_problems_of_draft
from chatter.case.cut import Cut
from chatter.case.document import move_references, parse_document, plain, read_text, value_at
from chatter.case.editing import set_value
from chatter.case.material import Material
from chatter.case.path import Step, field_at, join_path, key_of, model_at, parse_path
from chatter.case.sections import Axis, Contact, Friction, Lobes, ProcessDamping, Simulation, Stock
from chatter.case.structure import StructureSection
from chatter.case.tool import Tool
from chatter.case.wording import sentences, unknown_key
from chatter.errors import InputError
from chatter.shown import shown
from chatter.units import parse, write


class Case(Section):
    """A tool, a material, a cut and a structure, in SI.

    Sections are None (or empty) where the file has none; a command asks for those that it needs
    with `require`.
    """

    title: str = ""
    tool: Tool | None = None
    material: Material | None = None
    cut: Cut | None = None
    structure: StructureSection | None = None
    process_damping: ProcessDamping | None = None
    contact: Contact | None = None
    friction: dict[str, Friction] = Field(default_factory=dict)
    axis: Axis | None = None
    simulation: Simulation | None = None
    stock: Stock | None = None
    lobes: Lobes | None = None

    _document: Any = PrivateAttr(default=None)
    _folder: Path = PrivateAttr(default=Path())
    _name: str = PrivateAttr(default="case")

    @model_validator(mode="after")
    def _check_engagement(self) -> Case:
        if self.tool is not None and self.cut is not None:
            cut = self.cut
            raise_if_any(engagement_problems(cut.mode, cut.radial_depth, self.tool.diameter))
        return self

    def __eq__(self, other: object) -> bool:
        """Compare by content, whatever the files looked like and wherever they lie."""
        return isinstance(other, Case) and self._content() == other._content()

    def __hash__(self) -> int:
        """Hash of the content."""
        return hash(self._content())

    def _content(self) -> str:
        content = self.model_dump(mode="json")
        if self.structure is not None:
            # the same file, whatever folder its name starts from
            for entry in content["structure"]["frf"]:
                entry["file"] = str(Path(entry["file"]).resolve())
            if self.structure.machine is not None:
                content["structure"]["machine"] = str(self.structure.machine.resolve())
        return json.dumps(content, sort_keys=True)

    @property
    def name(self) -> str:
        """Name of the file, for messages."""
        return self._name

    @property
    def width_of_cut(self) -> float:
        """Radial depth of cut, m: the diameter where a slot does not give it."""
        given = self.cut.radial_depth
        return self.tool.diameter if given is None else given

    @property
    def folder(self) -> Path:
        """Folder that relative file names start from."""
        return self._folder

    @classmethod
    def from_dict(
        cls, data: Mapping[str, Any], name: str = "case", folder: Path | str = "."
    ) -> Case:
        """Make a case from nested dicts, with the keys and values of a case file.

        Keys whose value is None are taken as not given.

        Raises
        ------
        InputError
            If it describes no case; all problems found are in it.
        """
        if not isinstance(data, Mapping):
            raise InputError(f"{name}: {shown(data)} is given, a table of sections is wanted")
        try:
            document = tomlkit.item(plain(data))
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
        except RecursionError:
            raise InputError(f"{name}: is too deeply nested") from None
        return _validated(document, name, Path(folder))

    def require(self, *sections: str) -> None:
        """Raise InputError naming every one of the sections that the case lacks."""
        missing = [section for section in sections if not getattr(self, section)]
        if missing:
            raise InputError(
                [
                    f"{self.name}: [{section}] is missing; this command needs it"
                    for section in missing
                ]
            )

    def get(self, path: str) -> Any:
        """Return the value at a dotted path, in SI; a tuple of all where a step is ``[*]``.

        Raises
        ------
        InputError
            If the path leads nowhere.
        """
        return self._value_of(self, parse_path(path), 0)

    def _value_of(self, item: Any, steps: tuple[Step, ...], place: int) -> Any:
        if place == len(steps):
            return item
        step, here = steps[place], steps[: place + 1]
        if isinstance(item, Section):
            key = key_of(type(item), str(step))
            if key is None:
                raise InputError(f"{self.name}: {join_path(steps)}: {unknown_key(Case, here)}")
            return self._value_of(getattr(item, key), steps, place + 1)
        if isinstance(item, tuple) and step == "*":
            return tuple(self._value_of(entry, steps, place + 1) for entry in item)
        in_table = isinstance(item, dict) and step in item
        in_list = isinstance(item, tuple) and isinstance(step, int) and step < len(item)
        if not (in_table or in_list):
            raise InputError(f"{self.name}: {join_path(steps)}: there is no {join_path(here)}")
        return self._value_of(item[step], steps, place + 1)

    def patch(self, values: Mapping[str, Any]) -> Case:
        """Return the case with some values changed; this one stays as it is.

        Parameters
        ----------
        values : mapping
            Dotted path -> quantity text, number, text, list, table, or None to remove the key.
            A bare number is SI and is written in the unit that stood there. Sections that are
            not there are made; a table one place past the end of a list is appended.

        Raises
        ------
        InputError
            If a path is unknown or the patched case is wrong; all problems found are in it.
        """
        document = copy.deepcopy(self._source())
        problems: list[str] = []
        for path, value in values.items():
            try:
                steps = parse_path(path)
                _check_known(steps)
                set_value(document, steps, _in_given_unit(document, steps, plain(value, steps)))
            except InputError as error:
                problems += [f"{self._name}: {message}" for message in error.messages]
        if problems:
            raise InputError(problems)
        return _validated(document, self._name, self._folder)

    def deviations(self) -> dict[str, float]:
        """Standard deviations (SI) of the values given as "1650 +- 80 MPa", by path."""
        found: dict[str, float] = {}
        _collect_deviations(self._source(), (), found)
        return found

    def to_toml(self) -> str:
        """Return the case file, with the comments, the order and the units of its source."""
        return tomlkit.dumps(self._source())

    def save(self, path: str | Path) -> None:
        """Write the case file; relative file names are rewritten to hold in its folder.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        path = Path(path)
        document = copy.deepcopy(self._source())
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            if path.parent.resolve() != self._folder.resolve():
                move_references(document, self._folder, path.parent)
            path.write_text(tomlkit.dumps(document), encoding="utf-8", newline="")
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror})") from None

    def _source(self) -> Any:
        """Document that the case came from; made from the content where there was none."""
        if self._document is None:
            content = self.model_dump(mode="json", by_alias=True, exclude_unset=True)
            self._document = tomlkit.item(plain(content))
        return self._document


def load(path: str | Path) -> Case:
    """Read a case file.

    Raises
    ------
    InputError
        If the file cannot be read or describes no case; all problems found are in it.
    """
    path = Path(path)
    return _validated(parse_document(read_text(path), str(path)), str(path), path.parent)


def loads(text: str, name: str = "case", folder: str | Path = ".") -> Case:
    """Read a case from TOML text.

    Raises
    ------
    InputError
        If the text describes no case; all problems found are in it.
    """
    return _validated(parse_document(text, name), name, Path(folder))


def _validated(document: Any, name: str, folder: Path) -> Case:
    data = document.unwrap()
    try:
        case = Case.model_validate(data, context={"folder": folder})
    except ValidationError as error:
        problems = sentences(error, Case, name)
        told = [f"{name}: {path}: {text}" for path, text in engagement_problems_of_draft(data)]
        raise InputError([*problems, *(text for text in told if text not in problems)]) from None
    case._document, case._folder, case._name = document, folder, name
    return case


def _check_known(steps: tuple[Step, ...]) -> None:
    """Refuse a path with an unknown key before anything is changed."""
    for place, step in enumerate(steps):
        section = model_at(Case, steps[:place])
        named = section is not None and isinstance(step, str) and step != "*"
        if named and key_of(section, step) is None:
            here = steps[: place + 1]
            raise InputError(f"{join_path(steps)}: {unknown_key(Case, here)}")


def _in_given_unit(document: Any, steps: tuple[Step, ...], value: Any) -> Any:
    """Write bare numbers in the unit of the text that they replace."""
    field = field_at(Case, steps)
    stands = value_at(document, tuple(0 if step == "*" else step for step in steps))
    if field is None:
        return value
    if isinstance(value, list) and isinstance(stands, list) and len(value) == len(stands):
        pairs = zip(value, stands, strict=True)
        return [_like(entry, stood, field, steps) for entry, stood in pairs]
    return _like(value, stands, field, steps)


def _like(value: Any, stands: Any, field: Any, steps: tuple[Step, ...]) -> Any:
    bare = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not bare or not isinstance(stands, str):
        return value
    try:
        unit = parse(stands, field.dimension).unit
        return write(field.read(value), unit, field.dimension)
    except ValueError as error:
        raise InputError(f"{join_path(steps)}: {error}") from None


def _collect_deviations(item: Any, steps: tuple[Step, ...], found: dict[str, float]) -> None:
    if isinstance(item, dict):
        for key, value in item.items():
            _collect_deviations(value, (*steps, key), found)
    elif isinstance(item, list):
        for place, value in enumerate(item):
            _collect_deviations(value, (*steps, place), found)
    elif isinstance(item, str):
        field = field_at(Case, steps)
        if field is not None:
            deviation = parse(item, field.dimension).deviation
            if deviation > 0.0:
                found[join_path(steps)] = deviation
