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
from chatter.case.cut import Cut
from chatter.case.document import (
    move_references,
    parse_document,
    read_text,
    set_value,
    value_at,
)
from chatter.case.material import Material
from chatter.case.path import (
    Step,
    field_at,
    join_path,
    key_of,
    keys_of,
    model_at,
    parse_path,
)
from chatter.case.sections import Axis, Contact, Friction, Lobes, ProcessDamping, Simulation
from chatter.case.structure import StructureSection
from chatter.case.tool import Tool
from chatter.case.wording import nearest, sentences
from chatter.errors import InputError
from chatter.units import QuantityError, parse, write


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
    lobes: Lobes | None = None

    _document: Any = PrivateAttr(default=None)
    _folder: Path = PrivateAttr(default=Path())
    _name: str = PrivateAttr(default="case")

    @model_validator(mode="after")
    def _check_engagement(self) -> Case:
        if self.tool is None or self.cut is None or self.cut.radial_depth is None:
            return self
        width, diameter = self.cut.radial_depth, self.tool.diameter
        problems = []
        shown = f"{width * 1e3:g} mm"
        if width > diameter * (1.0 + 1e-9):
            problems.append(
                ("cut.radial_depth", f"{shown} is more than the diameter, {diameter * 1e3:g} mm")
            )
        elif self.cut.mode == "slot" and abs(width - diameter) > 1e-6 * diameter:
            problems.append(
                (
                    "cut.radial_depth",
                    f'{shown} is not the diameter, {diameter * 1e3:g} mm, that mode = "slot" '
                    'cuts; leave it out, or choose "up" or "down"',
                )
            )
        raise_if_any(problems)
        return self

    def __eq__(self, other: object) -> bool:
        """Compare by content, whatever the files looked like."""
        return isinstance(other, Case) and self._content() == other._content()

    def __hash__(self) -> int:
        """Hash of the content."""
        return hash(self._content())

    def _content(self) -> str:
        return json.dumps(self.model_dump(mode="json"), sort_keys=True)

    @property
    def name(self) -> str:
        """Name of the file, for messages."""
        return self._name

    @property
    def folder(self) -> Path:
        """Folder that relative file names start from."""
        return self._folder

    @classmethod
    def from_dict(
        cls, data: Mapping[str, Any], name: str = "case", folder: Path | str = "."
    ) -> Case:
        """Make a case from nested dicts, with the keys and values of a case file."""
        return _validated(tomlkit.item(_without_none(data)), name, Path(folder))

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
        """Return the value at a dotted path, in SI.

        Raises
        ------
        InputError
            If the path leads nowhere.
        """
        item: Any = self
        steps = parse_path(path)
        for place, step in enumerate(steps):
            if isinstance(item, Section):
                name = key_of(type(item), str(step))
                item = getattr(item, name) if name else _unknown(path, steps[: place + 1])
            elif (isinstance(item, dict) and step in item) or (
                isinstance(item, tuple) and isinstance(step, int) and step < len(item)
            ):
                item = item[step]
            else:
                raise InputError(f"{path}: the case has no {join_path(steps[: place + 1])}")
        return item

    def patch(self, values: Mapping[str, Any]) -> Case:
        """Return the case with some values changed; this one stays as it is.

        Parameters
        ----------
        values : mapping
            Dotted path -> quantity text, number, text, list, table, or None to remove the key.
            A bare number is SI and is written in the unit that stood there.

        Raises
        ------
        InputError
            If a path is unknown or the patched case is wrong.
        """
        document = copy.deepcopy(self._document)
        for path, value in values.items():
            steps = parse_path(path)
            _check_known(path, steps)
            set_value(document, steps, self._in_given_unit(steps, value))
        return _validated(document, self._name, self._folder)

    def _in_given_unit(self, steps: tuple[Step, ...], value: Any) -> Any:
        """Write a bare number in the unit of the text that it replaces."""
        field = field_at(Case, steps)
        stands = value_at(self._document, tuple(0 if step == "*" else step for step in steps))
        bare = isinstance(value, (int, float)) and not isinstance(value, bool)
        if field is None or not bare or not isinstance(stands, str):
            return value
        try:
            return write(float(value), parse(stands, field.dimension).unit, field.dimension)
        except QuantityError:
            return value

    def deviations(self) -> dict[str, float]:
        """Standard deviations (SI) of the values given as "1650 +- 80 MPa", by path."""
        found: dict[str, float] = {}
        _collect_deviations(self._document, (), found)
        return found

    def to_toml(self) -> str:
        """Return the case file, with the comments, the order and the units of its source."""
        return tomlkit.dumps(self._document)

    def save(self, path: str | Path) -> None:
        """Write the case file; relative file names are rewritten to hold in its folder."""
        path = Path(path)
        document = copy.deepcopy(self._document)
        path.parent.mkdir(parents=True, exist_ok=True)
        move_references(document, self._folder, path.parent)
        path.write_text(tomlkit.dumps(document), encoding="utf-8")


def _without_none(item: Any) -> Any:
    """Drop the keys whose value is None: they are not given."""
    if isinstance(item, Mapping):
        return {key: _without_none(value) for key, value in item.items() if value is not None}
    return [_without_none(value) for value in item] if isinstance(item, (list, tuple)) else item


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
    """Read a case from TOML text."""
    return _validated(parse_document(text, name), name, Path(folder))


def _validated(document: Any, name: str, folder: Path) -> Case:
    try:
        case = Case.model_validate(document.unwrap(), context={"folder": folder})
    except ValidationError as error:
        raise InputError(sentences(error, Case, name)) from None
    case._document, case._folder, case._name = document, folder, name
    return case


def _check_known(path: str, steps: tuple[Step, ...]) -> None:
    """Refuse a path with an unknown key before anything is changed."""
    for place, step in enumerate(steps):
        section = model_at(Case, steps[:place])
        named = section is not None and isinstance(step, str) and step != "*"
        if named and key_of(section, step) is None:
            _unknown(path, steps[: place + 1])


def _unknown(path: str, steps: tuple[Step, ...]) -> None:
    section = model_at(Case, steps[:-1])
    hint = nearest(str(steps[-1]), keys_of(section)) if section else ""
    raise InputError(f'{path}: unknown key "{steps[-1]}"; {hint}')


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


def parse_assignments(assignments: list[str]) -> dict[str, Any]:
    """Read ``PATH=VALUE`` texts of the command line.

    A value is what TOML makes of it (number, true, list, table, quoted text); anything else is
    text, so that quantities need no quotes of their own.

    Raises
    ------
    InputError
        If an assignment has no "=" or no path.
    """
    values: dict[str, Any] = {}
    for assignment in assignments:
        path, equals, text = assignment.partition("=")
        if not equals or not path.strip():
            raise InputError(
                f'--set "{assignment}": PATH=VALUE is wanted, such as cut.axial_depth="2 mm"'
            )
        values[path.strip()] = _toml_value(text.strip())
    return values


def _toml_value(text: str) -> Any:
    try:
        return tomlkit.parse(f"value = {text}").unwrap()["value"]
    except Exception:
        # not TOML: plain text such as 2 mm
        return text
