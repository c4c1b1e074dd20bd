"""Registries: force laws, friction laws, methods, effects and formats, ours and those of packages.

Each registry is a list in this project (one line an entry) and an entry point group. A package that
declares an entry of the group, in its ``pyproject.toml``::

    [project.entry-points."chatter.force_laws"]
    my-law = "my_package.my_law:MY_LAW"

is found: the object it names is of the same kind as an entry of the list here.
"""

import difflib
from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from chatter.description.errors import InputError
from chatter.description.formatting import formatted

#: every entry point group that is read
GROUPS = (
    "chatter.force_laws",
    "chatter.friction_laws",
    "chatter.stability_methods",
    "chatter.effects",
    "chatter.formats",
)


class Named(Protocol):
    """What every entry of a registry has."""

    @property
    def name(self) -> str:
        """As in files and on the command line."""

    @property
    def label(self) -> str:
        """As in pictures and reports."""

    @property
    def help(self) -> str:
        """One line for help texts, the schema and the tables of the docs."""


Entry = TypeVar("Entry", bound=Named)


class Registry(Generic[Entry]):
    """Entries of one kind by name: those of this project, then those of installed packages.

    Parameters
    ----------
    group : str
        Entry point group, one of `GROUPS`.
    what : str
        What an entry is, as in messages: "stability method".
    built_in : iterable of Entry
        In the order in which they are listed.

    Notes
    -----
    Installed packages are looked at once, at the first use.
    """

    def __init__(self, *, group: str, what: str, built_in: Iterable[Entry]) -> None:
        if group not in GROUPS:
            raise ValueError(f"{group} is none of the entry point groups {', '.join(GROUPS)}")
        self.group, self.what = group, what
        self._built_in = tuple(built_in)
        self._entries: dict[str, Entry] | None = None

    @property
    def entries(self) -> dict[str, Entry]:
        """Name -> entry.

        Raises InputError if an entry of an installed package cannot be imported, or has a name that
        is taken.
        """
        if self._entries is None:
            entries = {entry.name: entry for entry in self._built_in}
            for point in _points():
                if point.group != self.group:
                    continue
                entry = _loaded(point, self.what)
                if entry.name in entries:
                    raise InputError(
                        f"{self.what} {formatted(entry.name)} of {_origin(point)} has the name of "
                        "another one; rename it or remove that package"
                    )
                entries[entry.name] = entry
            self._entries = entries
        return self._entries

    def names(self) -> tuple[str, ...]:
        """Names in the order of the list."""
        return tuple(self.entries)

    def __iter__(self) -> Iterator[Entry]:
        return iter(self.entries.values())

    def __len__(self) -> int:
        return len(self.entries)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self.entries

    def __getitem__(self, name: str) -> Entry:
        """Return the entry of a name; raise InputError that lists what there is."""
        if name not in self:
            raise InputError(self.unknown(name))
        return self.entries[name]

    def unknown(self, name: str) -> str:
        """Say that there is no entry of this name, and which there are."""
        known = ", ".join(formatted(entry) for entry in self.entries)
        near = difflib.get_close_matches(str(name)[:60].lower(), self.entries, n=1, cutoff=0.6)
        hint = (
            f"did you mean {formatted(near[0])}? There are {known}"
            if near
            else f"there are {known}"
        )
        return f"{self.what} {formatted(name)} is not known; {hint}"


@lru_cache(maxsize=1)
def _points() -> tuple[EntryPoint, ...]:
    """Entry points of all groups, in an order that does not depend on the installation."""
    installed = entry_points()
    points = (point for group in GROUPS for point in installed.select(group=group))
    return tuple(sorted(points, key=lambda point: (point.group, point.name, point.value)))


def _origin(point: EntryPoint) -> str:
    return f"package {point.dist.name}" if point.dist is not None else point.value


def _loaded(point: EntryPoint, what: str) -> Entry:  # type: ignore[type-var]
    try:
        entry = point.load()
    except Exception as error:
        raise InputError(
            f"{what} {formatted(point.name)} of {_origin(point)} ({point.value}) cannot be "
            f"imported: {type(error).__name__}: {error}"
        ) from error
    missing = [key for key in ("name", "label", "help") if not hasattr(entry, key)]
    if missing:
        raise InputError(
            f"{what} {formatted(point.name)} of {_origin(point)} ({point.value}) has no "
            + ", ".join(missing)
        )
    return entry


def extension_sources() -> list[Path]:
    """Python sources of the packages that declare entries of any registry; none is imported."""
    modules = {point.module.partition(".")[0] for point in _points()}
    sources: list[Path] = []
    for module in sorted(modules):
        found = find_spec(module)
        if found is None:
            continue
        folders = [Path(folder) for folder in found.submodule_search_locations or ()]
        for folder in folders:
            sources += sorted(folder.rglob("*.py"))
        if not folders and found.origin is not None:
            sources.append(Path(found.origin))
    return sources
