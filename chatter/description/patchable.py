"""What a case and a machine share: an immutable description, read from TOML, patched, written."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import tomlkit
from pydantic import PrivateAttr, ValidationError

from chatter.description.bare_numbers import give_bare_numbers_their_unit, refuse_bare_numbers
from chatter.description.deviations import deviations_of
from chatter.description.errors import InputError
from chatter.description.file_access import remember_written, was_written
from chatter.description.formatting import formatted
from chatter.description.given_path import path_given
from chatter.description.given_values import EXAMPLE_OF_PATCH, mapping_given, text_given
from chatter.description.kinds_of_files import refuse_other_kind, with_article
from chatter.description.magnitudes import long_lists
from chatter.description.path import (
    Step,
    info_at,
    is_mapping,
    join_path,
    key_of,
    model_at,
    parse_path,
)
from chatter.description.renamed import Renamed, rename, rename_patch
from chatter.description.section import Section
from chatter.description.stated_range import open_stated_ranges, ranges_spelt_out
from chatter.description.toml_document import parse_document, plain, read_text, value_at
from chatter.description.toml_editing import PLAIN, Layout, set_value
from chatter.description.unit_that_stands import in_unit_that_stands
from chatter.description.whole_files import write_whole
from chatter.description.wording import nearest, sentences, unknown_key

if TYPE_CHECKING:
    from typing_extensions import Self


class Description(Section):
    """Nested tables of a TOML file, in SI.

    A kind of file says by class variables how it is called and laid out, and by methods what is
    to be checked across its sections and which files it names.
    """

    #: what the file describes, and a path into it, for messages
    NOUN: ClassVar[str]
    EXAMPLE_PATH: ClassVar[str]
    LAYOUT: ClassVar[Layout]
    #: keys and values that have a new name
    RENAMED: ClassVar[tuple[Renamed, ...]] = ()

    #: the file that it came from, and what was set in it since: (path, value)
    _document: Any = PrivateAttr(default=None)
    _edits: tuple[tuple[tuple[Step, ...], Any], ...] = PrivateAttr(default=())
    #: bare content of the file, with what was set
    _data: Any = PrivateAttr(default=None)
    _folder: Path = PrivateAttr(default=Path())
    _name: str = PrivateAttr(default="")
    _notes: tuple[str, ...] = PrivateAttr(default=())

    def __eq__(self, other: object) -> bool:
        """Compare by content, whatever the files looked like and wherever they lie."""
        return type(other) is type(self) and self.content == other.content

    def __repr__(self) -> str:
        """Name and title: what it holds would fill the screen."""
        title = getattr(self, "title", "")
        return f"<{type(self).__name__} {self.name!r}{f': {title}' if title else ''}>"

    __str__ = __repr__

    def __hash__(self) -> int:
        """Hash of the content."""
        return hash(self.content)

    @property
    def content(self) -> str:
        """All that it holds, as text by which descriptions compare."""
        content = self.model_dump(mode="json")
        self._resolve_files(content)
        return json.dumps(content, sort_keys=True)

    def _resolve_files(self, content: dict[str, Any]) -> None:
        """Make file names in the content absolute, so that one file has one name."""

    @classmethod
    def _move_references(cls, document: Any, old: Path, new: Path) -> None:
        """Rewrite file names relative to one folder so that they hold in another."""

    @classmethod
    def _problems_of_draft(cls, data: Mapping[str, Any]) -> Sequence[tuple[str, str]]:
        """Tell, as path and sentence, what can be told of data that has other faults."""
        del data
        return ()

    @classmethod
    def _follow_from_others(cls, data: Mapping[str, Any]) -> Mapping[tuple[Step, ...], str]:
        """Keys that come from others as the data state them, and what is to be said in their place.

        That they are missing is said only where nothing else is wrong.
        """
        del data
        return {}

    @classmethod
    def _belongs_elsewhere(cls, steps: tuple[Step, ...]) -> str | None:
        """Say where a path belongs that leads nowhere here; None where nothing tells."""
        del steps
        return None

    def _further_problems(self, data: Mapping[str, Any]) -> Sequence[tuple[str, str]]:
        """Tell, as path and sentence, what is wrong across sections that are right in themselves.

        Data are what the file says, before units were read.
        """
        del data
        return ()

    @property
    def name(self) -> str:
        """Name of the file, for messages."""
        return self._name or self.NOUN

    @property
    def notes(self) -> tuple[str, ...]:
        """What the reader of the file should know, such as keys that have a new name."""
        return self._notes

    @property
    def folder(self) -> Path:
        """Folder that relative file names start from."""
        return self._folder

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], name: str = "", folder: Path | str = ".") -> Self:
        """Make a description from nested dicts, with the keys and values of its file.

        Keys whose value is None are taken as not given.

        Raises
        ------
        InputError
            If it describes nothing; all problems found are in it.
        """
        name = name or cls.NOUN
        if not isinstance(data, Mapping):
            raise InputError(f"{name}: {formatted(data)} is given, a table of sections is required")
        try:
            if long := long_lists(data):
                raise InputError([f"{name}: {text}" for text in long])
        except RecursionError:
            raise InputError(f"{name}: is too deeply nested") from None
        try:
            document = tomlkit.item(plain(data, noun=cls.NOUN))
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
        except RecursionError:
            raise InputError(f"{name}: is too deeply nested") from None
        return cls._of_document(document, name, path_given(folder, "the folder of its files"))

    @classmethod
    def from_file(cls, path: str | Path, name: str = "") -> Self:
        """Read a file, which messages call by its path, or by another name.

        Raises
        ------
        InputError
            If the file cannot be read or describes nothing; all problems found are in it.
        """
        path = path_given(path, f"{with_article(cls.NOUN)} file")
        text = read_text(path, cls.NOUN)
        name = name or str(path)
        document = parse_document(text, name, cls.NOUN)
        refuse_bare_numbers(cls, document.unwrap(), name)
        return cls._of_document(document, name, path.parent, is_foreign=not was_written(text))

    @classmethod
    def from_mended_file(cls, path: str | Path, values: Mapping[str, Any]) -> Self:
        """Read a file that is wrong by itself and right with some values set; see `patch`.

        Raises
        ------
        InputError
            If it describes nothing with the values either.
        """
        path = Path(path)
        document = parse_document(read_text(path, cls.NOUN), str(path), cls.NOUN)
        for key, value in values.items():
            try:
                steps = cls._steps(key)
                cls._check_known(steps)
                open_stated_ranges(cls, document, steps)
                set_value(document, steps, plain(value, steps, cls.NOUN), cls.LAYOUT)
            except InputError as error:
                raise InputError([f"{path}: {text}" for text in error.messages]) from None
        refuse_bare_numbers(cls, document.unwrap(), str(path))
        return cls._of_document(document, str(path), path.parent, is_foreign=True)

    @classmethod
    def from_text(cls, text: str, name: str = "", folder: str | Path = ".") -> Self:
        """Read TOML text.

        Raises
        ------
        InputError
            If the text describes nothing; all problems found are in it.
        """
        name = text_given(name, "a name for messages") or cls.NOUN
        document = parse_document(text_given(text, f"{name}: a description"), name)
        refuse_bare_numbers(cls, document.unwrap(), name)
        return cls._of_document(document, name, path_given(folder, "the folder of its files"))

    @classmethod
    def _of_document(
        cls, document: Any, name: str, folder: Path, *, is_foreign: bool = False
    ) -> Self:
        notes = rename(document, cls.RENAMED)
        plain_data = document.unwrap()
        if long := long_lists(plain_data):
            raise InputError([f"{name}: {text}" for text in long])
        plain_data = ranges_spelt_out(cls, (), plain_data)
        made = cls._validated(plain_data, name, folder, is_foreign=is_foreign)
        made._document = document
        made._notes = tuple(f"{name}: {note}" for note in notes)
        return made

    @classmethod
    def _validated(
        cls, data: dict[str, Any], name: str, folder: Path, *, is_foreign: bool = False
    ) -> Self:
        context = {"folder": folder, "is_foreign": is_foreign}
        try:
            made = cls.model_validate(data, context=context)
        except ValidationError as error:
            refuse_other_kind(data, name, cls.NOUN)
            problems = sentences(error, cls, name, cls._follow_from_others(data))
            told = [f"{name}: {path}: {text}" for path, text in cls._problems_of_draft(data)]
            raise InputError(
                [*problems, *(text for text in told if text not in problems)]
            ) from None
        made._data, made._folder, made._name = data, folder, name
        problems = [
            f"{name}: {path}: {text}" if path else f"{name}: {text}"
            for path, text in made._further_problems(data)
        ]
        if problems:
            raise InputError(problems)
        return made

    def get(self, path: str) -> Any:
        """Return the value at a dotted path, in SI; a tuple of all where a step is ``[*]``.

        Raises
        ------
        InputError
            If the path leads nowhere.
        """
        return self._value_of(self, self._steps(text_given(path, f"{self.name}: a path")), 0)

    def _value_of(self, item: Any, steps: tuple[Step, ...], index: int) -> Any:
        if index == len(steps):
            return item
        step, here = steps[index], steps[: index + 1]
        if isinstance(item, Section):
            key = key_of(type(item), str(step))
            if key is None:
                raise InputError(
                    f"{self.name}: {join_path(steps)}: {unknown_key(type(self), here)}"
                )
            return self._value_of(getattr(item, key), steps, index + 1)
        if isinstance(item, tuple) and step == "*":
            return tuple(self._value_of(entry, steps, index + 1) for entry in item)
        in_table = isinstance(item, dict) and step in item
        in_list = isinstance(item, tuple) and isinstance(step, int) and step < len(item)
        if not (in_table or in_list):
            raise InputError(f"{self.name}: {join_path(steps)}: there is no {join_path(here)}")
        return self._value_of(item[step], steps, index + 1)

    def patch(self, values: Mapping[str, Any]) -> Self:
        """Return the description with some values changed; this one stays as it is.

        Parameters
        ----------
        values : mapping
            Dotted path -> quantity text, number, text, list, table, or None to remove the key; of
            a table with from, to and count also "FROM..TO:COUNT".
            A bare number is SI and is written in the unit that stood there. Sections that are
            not there are made; a table one place past the end of a list is appended.

        Raises
        ------
        InputError
            If a path is unknown or what comes of it is wrong; all problems found are in it.
        """
        mapping_given(values, f"{self.name}: a dictionary", EXAMPLE_OF_PATCH)
        data = copied(self._plain())
        edits, said = [], []
        notes: list[str] = []
        problems: list[str] = []
        unknown: list[str] = []
        for path, value in values.items():
            try:
                given = plain(value, self._steps(path), self.NOUN)
                steps, given, renamed = rename_patch(self._steps(path), given, self.RENAMED)
                notes += renamed
                self._check_known(steps)
                unknown += self._newly_made(data, steps)
                given = ranges_spelt_out(type(self), steps, given)
                said.append((steps, given))
                given = in_unit_that_stands(type(self), data, steps, given)
                set_value(data, steps, copied(given), self.LAYOUT, PLAIN)
                edits.append((steps, given))
            except InputError as error:
                problems += [f"{self.name}: {message}" for message in error.messages]
        if problems:
            raise InputError(problems)
        try:
            made = self._validated(data, self.name, self._folder)
        except InputError as error:
            # a table that was made and is not whole: its name is hardly meant
            raise InputError(
                [f"{self.name}: {text}" for text in unknown] or self._words_on(said, error)
            ) from None
        made._document, made._edits = self._document, (*self._edits, *edits)
        made._notes = (*self._notes, *notes)
        return made

    def _words_on(
        self, said: Sequence[tuple[tuple[Step, ...], Any]], error: InputError
    ) -> list[str]:
        """Words of an error of what was set, said of bare numbers as they were given."""
        data = copied(self._plain())
        for steps, value in said:
            set_value(data, steps, copied(value), self.LAYOUT, PLAIN)
        try:
            self._validated(data, self.name, self._folder)
        except InputError as of_bare:
            return of_bare.messages
        return error.messages

    def deviations(self) -> dict[str, float]:
        """Standard deviations (SI) of the values given as "1650 +- 80 MPa", by path."""
        return deviations_of(type(self), self._plain())

    @property
    def stated(self) -> Mapping[str, Any]:
        """What the file states, in its units, with all that was set in it."""
        return self._plain()

    def to_toml(self) -> str:
        """Return the file, with the comments, the order and the units of its source."""
        return tomlkit.dumps(self._source())

    def save(self, path: str | Path) -> None:
        """Write the file; relative file names are rewritten to hold in its folder.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        path = path_given(path, f"the {self.NOUN} to be written")
        document = self._source()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            moved = path.parent.resolve() != self._folder.resolve()
            if moved:
                self._move_references(document, self._folder, path.parent)
            text = tomlkit.dumps(document)
            write_whole(path, text)
            if moved:
                remember_written(text)
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror})") from None

    def _plain(self) -> dict[str, Any]:
        """Content of the file; made from that of the description where there was none."""
        if self._data is None:
            content = self.model_dump(mode="json", by_alias=True, exclude_unset=True)
            self._data = plain(content)
        return self._data

    def _source(self) -> Any:
        """Document with all that was set in it."""
        if self._document is None:
            content = copied(self._plain())
            give_bare_numbers_their_unit(type(self), content)
            return tomlkit.item(content)
        # only what is written needs it, so that patches do not carry its comments about
        document = copy.deepcopy(self._document)
        for steps, value in self._edits:
            open_stated_ranges(type(self), document, steps)
            set_value(document, steps, copied(value), self.LAYOUT)
        give_bare_numbers_their_unit(type(self), document)
        return document

    @classmethod
    def _steps(cls, path: str) -> tuple[Step, ...]:
        return parse_path(path, f"{with_article(cls.NOUN)}, such as {cls.EXAMPLE_PATH}")

    @classmethod
    def _check_known(cls, steps: tuple[Step, ...]) -> None:
        """Refuse a path with an unknown key before anything is changed."""
        for index, step in enumerate(steps):
            section = model_at(cls, steps[:index])
            named = section is not None and isinstance(step, str) and step != "*"
            if named and key_of(section, step) is None:
                why = cls._belongs_elsewhere(steps) or unknown_key(cls, steps[: index + 1])
                raise InputError(f"{join_path(steps)}: {why}")

    @classmethod
    def knows(cls, steps: tuple[Step, ...]) -> bool:
        """Tell whether a path leads along keys that such a description may have."""
        try:
            cls._check_known(steps)
        except InputError:
            return False
        return True

    @classmethod
    def _newly_made(cls, document: Any, steps: tuple[Step, ...]) -> list[str]:
        """Say where a path leads into a table of a name that none of its kind has."""
        for index in range(1, len(steps) - 1):
            kind, name = steps[:index], steps[index]
            info = info_at(cls, kind)
            stands = value_at(document, kind)
            if info is None or not is_mapping(info.annotation) or not stands or name in stands:
                continue
            hint = nearest(str(name), [str(one) for one in stands])
            return [f"{join_path(steps)}: there is no {join_path((*kind, name))}; {hint}"]
        return []


def copied(value: Any) -> Any:
    """Copy of nested tables and lists; what they hold is immutable."""
    if isinstance(value, dict):
        return {key: copied(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [copied(entry) for entry in value]
    return value
