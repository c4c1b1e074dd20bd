"""A session: a folder of case files, uploads and results, and the case that is open in it."""

from __future__ import annotations

import itertools
import json
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any, NamedTuple

import tomlkit

from chatter.app.workbench.folder_files import is_cut, is_machine
from chatter.app.workbench.page_words import in_words_of_the_page
from chatter.description.case import Case, loads
from chatter.description.errors import InputError
from chatter.description.file_access import open_folder
from chatter.description.path import parse_path
from chatter.description.stated_range import open_stated_ranges
from chatter.description.toml_editing import set_value
from chatter.io.formats.format_list import FORMATS

#: folder of results below that of the session, and the file that says how they were made
RESULTS, CALL = "results", "call.json"
#: folder of files that were taken out of use
_REMOVED = "removed"
#: file beside results while they are computed, and after that where the computation was ended
_STARTED = "started.txt"
#: bytes of a file that is uploaded, and of all files of one upload
LARGEST_FILE, LARGEST_UPLOAD = 64 * 1024**2, 256 * 1024**2
#: files of one upload
MOST_FILES = 200
_NAME = re.compile(r"[^\W_][\w .+()-]{0,119}")
_MODES = "structure.mode"


class CaseText(NamedTuple):
    """The open case, as another process reads it."""

    text: str
    name: str
    folder: Path

    def case(self) -> Case:
        """Return the case; InputError as of `chatter.description.case.loads`."""
        return loads(self.text, self.name, self.folder)


class Session:
    """The folder, and the open case with what was changed but not saved.

    Parameters
    ----------
    folder : Path
        Nothing outside of it is read by name or written.
    """

    def __init__(self, folder: Path) -> None:
        self.root = folder.resolve()
        open_folder(self.root)
        self.name = ""
        self.text = ""
        self.case: Case | None = None
        self.problems: tuple[str, ...] = ()
        self._on_disk: bytes | None = None
        self._watchers: list[Callable[[], None]] = []

    def path(self, name: str) -> Path:
        """Path of a name inside the folder; InputError if it leads out of it."""
        found = (self.root / name).resolve()
        if "\0" in name or not found.is_relative_to(self.root):
            raise InputError(f"{name}: lies outside of the folder {self.root.name}")
        return found

    def short(self, text: object) -> str:
        """Sentence with the names of files relative to the folder."""
        return without_folder(text, self.root)

    def new_path(self, name: str) -> Path:
        """Path of a case file that is not there yet; InputError where it is, or for other names."""
        path = self.path(checked_name(name, (".toml",)))
        if path.exists():
            raise InputError(f"{name}: is there already; give another name")
        return path

    def watch(self, changed: Callable[[], None]) -> None:
        """Call a function whenever the open case has changed."""
        self._watchers.append(changed)

    def case_names(self) -> list[str]:
        """Names of the case files of cuts in the folder, and one level below."""
        found = sorted([*self.root.glob("*.toml"), *self.root.glob("*/*.toml")])
        inside = [path for path in found if path.resolve().is_relative_to(self.root)]
        return [path.relative_to(self.root).as_posix() for path in inside if is_cut(path)]

    def machine_names(self) -> list[str]:
        """Names of the machine files in the folder, and one level below."""
        found = sorted([*self.root.glob("*.toml"), *self.root.glob("*/*.toml")])
        inside = [path for path in found if path.resolve().is_relative_to(self.root)]
        return [path.relative_to(self.root).as_posix() for path in inside if is_machine(path)]

    def measurement_names(self) -> list[str]:
        """Names of the folders with a measurement.toml, down to two levels."""
        found = [*self.root.glob("measurement.toml"), *self.root.glob("*/measurement.toml"),
                 *self.root.glob("*/*/measurement.toml")]  # fmt: skip
        inside = [path.parent for path in sorted(found)
                  if path.resolve().is_relative_to(self.root)]  # fmt: skip
        return [path.relative_to(self.root).as_posix() for path in inside]

    def open(self, name: str) -> None:
        """Open a case file, with its faults in `problems`; InputError if it is no text."""
        path = self.path(name)
        try:
            content = path.read_bytes()
            text = content.decode("utf-8-sig")
        except (OSError, UnicodeDecodeError):
            raise InputError(f"{name}: cannot be read as text; a TOML file is required") from None
        self.name, self._on_disk = name, content
        self.set_text(text)

    def start(self, name: str, text: str) -> None:
        """Open a new case that is not saved yet; InputError if there is a file of the name."""
        self.new_path(name)
        self.name, self._on_disk = name, None
        self.set_text(text)

    @property
    def folder(self) -> Path:
        """Folder that the file names in the open case start from."""
        return self.path(self.name).parent if self.name else self.root

    @property
    def changed(self) -> bool:
        """Whether the open case differs from its file."""
        return bool(self.name) and self._on_disk != self.text.encode()

    @property
    def case_text(self) -> CaseText:
        """The open case for another process; InputError if it has faults or none is open."""
        self.sound_case()
        return CaseText(self.text, self.name, self.folder)

    def sound_case(self) -> Case:
        """Return the open case; InputError if it has faults or none is open."""
        if not self.name:
            raise InputError("no case is open; choose one, or make one in the view Case")
        if self.case is None:
            raise InputError(self.problems)
        return self.case

    def set_text(self, text: str) -> None:
        """Take the text as that of the open case; its faults are in `problems`."""
        self.text, self.case, self.problems = text, None, ()
        try:
            self.case = loads(text, self.name, self.folder)
        except InputError as error:
            self.problems = error.messages
        for changed in self._watchers:
            changed()

    def set_values(self, values: Iterable[tuple[str, Any]]) -> None:
        """Set values by path in the text, one after the other, faulty ones too.

        Comments and order are kept; None takes a key away.

        InputError if the text is no TOML or a path leads nowhere.
        """
        try:
            document = tomlkit.parse(self.text)
        except tomlkit.exceptions.ParseError as error:
            raise InputError(f"{self.name}: {error}; mend the text first") from None
        for path, value in values:
            steps = parse_path(path)
            open_stated_ranges(Case, document, steps)
            set_value(document, steps, value, Case.LAYOUT)
        self.set_text(tomlkit.dumps(document))

    def set_modes(self, modes: Sequence[Mapping[str, Any]]) -> None:
        """Put modes into the case in place of those along the same directions and side."""
        stands = tomlkit.parse(self.text).unwrap().get("structure", {}).get("mode", [])
        replaced = [k for k, one in enumerate(stands) if any(_alike(one, new) for new in modes)]
        left = len(stands) - len(replaced)
        changes: list[tuple[str, Any]] = [
            (f"{_MODES}[{place}]", None) for place in reversed(replaced)
        ]
        changes += [(f"{_MODES}[{left + place}]", dict(one)) for place, one in enumerate(modes)]
        self.set_values(changes)

    def save(self, name: str = "") -> None:
        """Write the open case to its file, or to another; InputError if that is not possible.

        A file that another session has changed meanwhile is not overwritten.
        """
        case = self.sound_case()
        target = self.path(checked_name(name, (".toml",)) if name else self.name)
        stands = target.read_bytes() if target.exists() else None
        mine = self._on_disk if target == self.path(self.name) else None
        if stands is not None and stands != mine:
            raise InputError(
                f"{target.name}: has changed since it was opened here, or is another case; "
                "give another name"
            )
        if target.parent == self.folder:
            target.write_text(self.text, encoding="utf-8", newline="")
        else:
            case.save(target)
        self.name = target.relative_to(self.root).as_posix()
        self._on_disk = target.read_bytes()
        self.set_text(self._on_disk.decode())

    def results(self, kind: str) -> Path:
        """Folder of the results of a kind for the open case."""
        stem = self.name.removesuffix(".toml").replace("/", "-") or "session"
        return self.path(f"{RESULTS}/{stem}/{kind}")

    def store(self, folder: str, files: Mapping[str, bytes], extensions: Sequence[str]) -> Path:
        """Write uploaded files into a folder of the session; InputError if one is refused."""
        if len(files) > MOST_FILES or sum(map(len, files.values())) > LARGEST_UPLOAD:
            raise InputError(f"at most {MOST_FILES} files of {LARGEST_UPLOAD >> 20} MiB together")
        for name, content in files.items():
            checked_name(name, extensions)
            if len(content) > LARGEST_FILE:
                raise InputError(f"{name}: is larger than {LARGEST_FILE >> 20} MiB")
        target = self.path(folder)
        target.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            self.path(f"{folder}/{name}").write_bytes(content)
        return target

    def put_aside(self, files: Sequence[Path]) -> str:
        """Move files of one folder out of use, into a new folder; returns its name."""
        kept_in = next(
            name for name in (f"{_REMOVED}/{files[0].parent.name}-{k}" for k in itertools.count(1))
            if not self.path(name).exists()
        )  # fmt: skip
        target = self.path(kept_in)
        target.mkdir(parents=True)
        for one in files:
            one.rename(target / one.name)
        return kept_in


def without_folder(text: object, folder: Path) -> str:
    """Sentence in the words of the page, with the names of files relative to a folder."""
    return in_words_of_the_page(str(text).replace(f"{folder}{os.sep}", ""))


def root_of_results(folder: Path) -> Path:
    """Folder of the session that a folder of `Session.results` belongs to."""
    return folder.parents[2]


def checked_name(name: str, extensions: Sequence[str]) -> str:
    """Return a plain file name with one of the extensions; InputError for any other."""
    plain = isinstance(name, str) and _NAME.fullmatch(name) is not None and ".." not in name
    if not plain:
        raise InputError(f"{str(name)[:80]!r}: letters, digits, blanks and . _ - + ( ) are allowed")
    if not name.lower().endswith(tuple(extensions)):
        raise InputError(f"{name}: a file of {', '.join(extensions)} is required")
    return name


def readable_extensions() -> tuple[str, ...]:
    """Extensions of the files of measurements that are read."""
    return tuple(dict.fromkeys(end for one in FORMATS for end in one.extensions))


def write_call(folder: Path, call: Mapping[str, Any]) -> None:
    """Say beside results how they were made."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / CALL).write_text(json.dumps(call, indent=2) + "\n", encoding="utf-8")


def read_call(folder: Path) -> dict[str, Any]:
    """What `write_call` wrote; empty where there is nothing that can be read."""
    return read_object(folder / CALL)


def write_started(folder: Path) -> None:
    """Say beside results when a computation of new ones began."""
    folder.mkdir(parents=True, exist_ok=True)
    now = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M")
    (folder / _STARTED).write_text(f"{now}\n", encoding="utf-8")


def read_started(folder: Path) -> str:
    """When a computation that has not come to its end began; empty where there is none."""
    try:
        return (folder / _STARTED).read_text(encoding="utf-8").strip()[:40]
    except (OSError, ValueError):
        return ""


def forget_started(folder: Path) -> None:
    """Take away what `write_started` wrote."""
    (folder / _STARTED).unlink(missing_ok=True)


def read_object(path: Path) -> dict[str, Any]:
    """Object of a JSON file; empty where there is nothing that can be read."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _alike(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether two modes as a file states them move along one direction on one side."""
    first, second = one.get("direction", [1, 0, 0]), other.get("direction", [1, 0, 0])
    along = abs(sum(a * b for a, b in zip(first, second, strict=False)))
    return one.get("side", "tool") == other.get("side", "tool") and along > 0.7  # below 45 degrees
