"""A user's own table of materials: a TOML file with a table a row, checked like a case."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.law_section import FORCE_LAWS
from chatter.description.ranges import stated_ends
from chatter.description.toml_document import parse_document, read_text
from chatter.description.units import QuantityError, parse
from cutting.keys import Key, with_defaults
from cutting.material.families import family_of
from cutting.material.row import MaterialRow
from cutting.material.table import MATERIALS

#: texts that a row may have beside the keys of its law
_TEXTS = ("source", "iso_group", "condition", "validity", "assumption")
_RANGE = "chip_thickness"
_GRADES = "examples"
_WORD = re.compile(r"[\w.%+-]+")
_ISO_GROUPS = ("P", "M", "K", "N", "S", "H")


def read_material_table(path: str | Path) -> dict[str, MaterialRow]:
    """Read a table of materials: a table a row, named as a case names it.

    Parameters
    ----------
    path : str or Path
        TOML; a row has the keys of its `law` ("linear" without one) and a `source`, and may have
        `iso_group`, `condition`, `examples`, `validity`, `chip_thickness` (from, to), `assumption`.

    Returns
    -------
    dict of str to MaterialRow

    Raises
    ------
    InputError
        If the file cannot be read or a row is wrong; all problems found are in it.
    """
    path = Path(path)
    data = parse_document(read_text(path, "table of materials"), str(path)).unwrap()
    problems: list[str] = []
    rows = {}
    for name, given in data.items():
        if not isinstance(given, Mapping):
            problems.append(f"{name}: {formatted(given)} is given, a table of a row is required")
            continue
        row = _Row(name, given)
        rows[name] = row.read()
        problems += row.problems
    if not data:
        problems.append("has no rows")
    if problems:
        raise InputError([f"{path}: {problem}" for problem in problems])
    return rows


#: likeness of a name from which on it is taken for a misspelt one, before a grade without a row
_MISSPELT = 0.8


def row_named(
    name: str, rows: Mapping[str, MaterialRow] = MATERIALS, condition: str | None = None
) -> MaterialRow:
    """Row of a table, by its name or by a grade that it holds; see `name_of_row`."""
    return rows[name_of_row(name, rows, condition)]


def is_in_table(name: str, rows: Mapping[str, MaterialRow]) -> bool:
    """Whether a name is that of a row, or a grade that rows hold."""
    return name in rows or bool(_rows_of_grade(name, rows))


def name_of_row(
    name: str, rows: Mapping[str, MaterialRow] = MATERIALS, condition: str | None = None
) -> str:
    """Name of a row that is given by it, or by a grade and, where several hold it, a condition.

    ValueError where no row or several are meant, with the nearest or with what chooses.
    """
    graded = _rows_of_grade(name, rows) if name not in rows else []
    if condition is not None:
        return _row_in_condition(name, rows, [name] if name in rows else graded, condition)
    if name in rows:
        return name
    if len(graded) == 1 and rows[graded[0]].is_grade(name):
        return graded[0]
    if len(graded) > 1:
        raise ValueError(
            f"{formatted(name)} is a grade of {len(graded)} rows; the name of a row chooses, or "
            f"material.condition with some words of it: {_choices(graded, rows)}"
        )
    raise ValueError(
        f"{formatted(name)} is not in the table of materials; {_hint(name, rows, graded)}"
        f"`chatter materials` lists all {len(rows)}, `chatter materials WORD` searches"
    )


def _row_in_condition(
    name: str, rows: Mapping[str, MaterialRow], among: list[str], condition: str
) -> str:
    """The one of some rows whose condition or name has all words of a condition.

    Where several have them, the one that has them as words: "VDI 2" is not in "VDI 3, 0.25 % C".
    """
    words = condition.lower().replace(",", " ").split()
    found = [one for one in among if words and all(word in rows[one].state(one) for word in words)]
    whole = [one for one in found if set(words) <= set(_WORD.findall(rows[one].state(one)))]
    for chosen in (found, whole):
        if len(chosen) == 1:
            return chosen[0]
    if not among:
        return name_of_row(name, rows)
    several = "chooses none" if not found else f"leaves {len(found)}"
    raise ValueError(
        f"condition = {formatted(condition)} {several} of the rows of {formatted(name)}: "
        f"{_choices(found or among, rows)}"
    )


def _choices(names: Iterable[str], rows: Mapping[str, MaterialRow]) -> str:
    """Names of rows, each with what tells it from the others, to choose one."""
    return ", ".join(f'"{name}" ({_difference(rows[name])})' for name in names)


def _difference(row: MaterialRow) -> str:
    """Condition and tangential coefficient of a row: sources differ where conditions do not."""
    tangential = f"Ktc {1e-6 * row.cutting[0]:.4g} MPa" if row.cutting[0] else ""
    return "; ".join(one for one in (row.condition, tangential) if one)


def _hint(name: str, rows: Mapping[str, MaterialRow], graded: list[str]) -> str:
    """Rows that may be meant."""
    misspelt = difflib.get_close_matches(name[:60], rows, n=1, cutoff=_MISSPELT)
    family = "" if graded or misspelt else words_of_family(name, rows)
    if family:
        return f"{family}; "
    near = misspelt or difflib.get_close_matches(name[:60], rows, n=1, cutoff=0.4)
    meant = [f'"{one}"' for one in graded or near]
    return f"did you mean {meant[0]}? " if meant else ""


def words_of_family(grade: str, rows: Mapping[str, MaterialRow]) -> str:
    """What a grade without a row is by its designation, and the nearest rows; else empty."""
    family = family_of(grade)
    if family is None:
        return ""
    near = [
        f'"{name}"'
        for name, row in rows.items()
        if any(f"group {group}" in row.examples for group in family.groups)
    ]
    if not near:
        return (
            f"by its name it is {family.name}, of which there is no row: `chatter coefficients` "
            "finds coefficients by a few cuts"
        )
    return f"by its name it is {family.name}; the nearest rows are {', '.join(near)}"


def _rows_of_grade(grade: str, rows: Mapping[str, MaterialRow]) -> list[str]:
    """Names of the rows that hold a grade."""
    return [name for name, row in rows.items() if row.has_grade(grade)]


class _Row:
    """A row as it is read, with what is wrong with it."""

    def __init__(self, name: str, given: Mapping[str, Any]) -> None:
        self.name = name
        self.given = given
        self.problems: list[str] = []

    def read(self) -> MaterialRow:
        """Return the row; where there are problems it is not to be used."""
        law = self.given.get("law", "linear")
        if law not in FORCE_LAWS.names():
            self._problem("law", f"{formatted(law)} is no force law; there are {self._laws()}")
            law = "linear"
        keys = FORCE_LAWS[law].keys
        self._refuse_unknown(law, [key.name for key in keys])
        values = {key.name: self._value(key) for key in keys}
        found = {name: value for name, value in values.items() if value is not None}
        texts = {key: self._text(key) for key in _TEXTS}
        if not texts["source"]:
            self._problem("source", "is missing; a row says where its coefficients come from")
        if texts["iso_group"] not in ("", *_ISO_GROUPS):
            self._problem("iso_group", f"must be one of {', '.join(_ISO_GROUPS)}")
        return MaterialRow(
            law,
            with_defaults(keys, found),
            chip_thickness=self._chip_thickness(),
            examples=self._examples(),
            **texts,
        )

    def _problem(self, key: str, text: str) -> None:
        self.problems.append(f"{self.name}.{key}: {text}")

    @staticmethod
    def _laws() -> str:
        return ", ".join(f'"{law}"' for law in FORCE_LAWS.names())

    def _refuse_unknown(self, law: str, keys: Iterable[str]) -> None:
        known = ("law", *keys, *_TEXTS, _RANGE, _GRADES)
        for key in self.given:
            if key not in known:
                listed = ", ".join(known)
                self._problem(key, f'unknown key of a row with law = "{law}"; there are {listed}')

    def _value(self, key: Key) -> float | None:
        given = self.given.get(key.name)
        if given is None:
            if key.needed:
                self._problem(key.name, "is missing")
            return None
        return self._quantity(key.name, given, key.dimension, key)

    def _quantity(
        self, name: str, given: Any, dimension: str, key: Key | None = None
    ) -> float | None:
        try:
            value = parse(given, dimension).value
        except QuantityError as error:
            self._problem(name, str(error))
            return None
        problem = "" if key is None else key.problem(value)
        if problem:
            self._problem(name, problem)
        return value

    def _text(self, key: str) -> str:
        given = self.given.get(key, "")
        if not isinstance(given, str):
            self._problem(key, f"{formatted(given)} is given, a text is required")
            return ""
        return given

    def _examples(self) -> tuple[str, ...]:
        given = self.given.get(_GRADES, [])
        if not isinstance(given, list) or not all(isinstance(one, str) for one in given):
            self._problem(_GRADES, f"{formatted(given)} is given, a list of texts is required")
            return ()
        return tuple(given)

    def _chip_thickness(self) -> tuple[float, float] | None:
        given = self.given.get(_RANGE)
        if given is None:
            return None
        given = (stated_ends(given) or given) if isinstance(given, str) else given
        if not isinstance(given, list) or len(given) != 2:
            self._problem(_RANGE, f'{formatted(given)} is given, "0.02..0.2 mm" is required')
            return None
        low, high = (self._quantity(_RANGE, one, "length") for one in given)
        if low is None or high is None:
            return None
        if not 0.0 <= low < high:
            self._problem(_RANGE, f"{formatted(given)} does not go from a smaller to a larger one")
        return low, high
