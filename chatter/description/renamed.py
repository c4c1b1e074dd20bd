"""Keys and values of files that have a new name: the old one is read for one release, with a note.

Each kind of file lists its own, `CASE` and `MACHINE`; they are applied when a file is read and when
a description is patched, so that everything else knows the new names alone.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from chatter.description.formatting import formatted
from chatter.description.path import Step, join_path


class Renamed(NamedTuple):
    """A key that has a new name, or a value of a key that has."""

    where: tuple[str, ...]  # path of the section ("*": any name), with the key for a value
    old: str
    new: str
    is_value: bool = False


_LAW = ("friction", "*", "law")

CASE = (
    Renamed(("contact",), "full_at", "full_engagement_share"),
    Renamed(("pitch_design",), "largest_chip", "max_pitch_ratio"),
    Renamed(("optimum",), "widths", "radial_depths"),
    Renamed(("friction", "*"), "sigma0", "bristle_stiffness"),
    Renamed(("friction", "*"), "sigma1", "bristle_damping"),
    Renamed(("friction", "*"), "sigma2", "viscous"),
    Renamed(_LAW, "tanh", "tanh-hysteresis", is_value=True),
    Renamed(_LAW, "coulomb", "coulomb-stribeck", is_value=True),
    Renamed(("lobes", "method"), "time", "time-domain", is_value=True),
)

MACHINE = (
    Renamed(("connector", "*"), "places", "positions"),
    Renamed(("move", "*"), "turns", "revolutions"),
    Renamed(("friction", "*"), "stiffness", "bristle_stiffness"),
    Renamed(("friction", "*"), "slow_viscous", "low_speed_viscous"),
    Renamed(("friction", "*"), "slow_decay", "low_speed_decay"),
    Renamed(("friction", "*"), "inclination", "hysteresis_slope"),
    Renamed(_LAW, "LuGre", "lugre", is_value=True),
    Renamed(_LAW, "tanh hysteresis", "tanh-hysteresis", is_value=True),
    Renamed(_LAW, "Coulomb-Stribeck", "coulomb-stribeck", is_value=True),
    Renamed(_LAW, "smooth Coulomb", "smooth-coulomb", is_value=True),
)


def rename(document: Any, renamed: Sequence[Renamed]) -> list[str]:
    """Give keys and values of a document their new names, in place.

    A note for each is returned: where it stands, the old name and the new one.
    """
    notes = []
    for one in renamed:
        *above, last = one.where
        for steps, table in _tables(document, tuple(above), ()):
            if one.is_value:
                if last in table and table[last] == one.old:
                    table[last] = one.new
                    notes.append(_note((*steps, last), one))
                continue
            for path, section in _tables(table, (last,), steps):
                if one.old in section and one.new not in section:
                    section[one.new] = section.pop(one.old)
                    notes.append(_note((*path, one.old), one))
    return notes


def rename_patch(
    steps: tuple[Step, ...], value: Any, renamed: Sequence[Renamed]
) -> tuple[tuple[Step, ...], Any, list[str]]:
    """Path and value of a patch with new names, and the notes of `rename`."""
    if all(one.where[0] != steps[0] for one in renamed):
        return steps, value, []
    nested = value
    for step in reversed(steps):
        nested = {step: nested}
    notes = rename(nested, renamed)
    new_steps = []
    for _ in steps:
        ((step, nested),) = nested.items()
        new_steps.append(step)
    return tuple(new_steps), nested, notes


def _tables(
    table: Any, pattern: tuple[str, ...], steps: tuple[Step, ...]
) -> Iterator[tuple[tuple[Step, ...], Any]]:
    """Tables that a pattern leads to from one, with their paths."""
    if not isinstance(table, dict):
        return
    if not pattern:
        yield steps, table
        return
    for name in list(table) if pattern[0] == "*" else [pattern[0]]:
        if name in table:
            yield from _tables(table[name], pattern[1:], (*steps, str(name)))


def _note(steps: tuple[Step, ...], one: Renamed) -> str:
    kind = "value" if one.is_value else "key"
    return (
        f"{join_path(steps)}: {formatted(one.old)} is now called {formatted(one.new)}; "
        f"the old {kind} is read in this release, not in the next"
    )
