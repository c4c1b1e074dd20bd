"""Files that results write: texts, summaries as strict JSON, pictures."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from chatter.description.given_path import path_given
from chatter.description.whole_files import write_whole
from chatter.io.presentation import presentation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: what a formula of a spreadsheet begins with, as wide as other keyboards write it too
_BEGIN_FORMULAS = tuple("=+-@|＝＋－＠")
#: a number with or without unit, which is none, and a dash for nothing
_QUANTITY = re.compile(r"[+-]?[0-9.]+([eE][+-]?[0-9]+)?( [\w/%*^°²³·]+)?|[+-](inf|nan)|-")


def finite_or_none(value: float) -> float | None:
    """Return a number as JSON knows it: None in place of nan and inf."""
    return float(value) if math.isfinite(value) else None


def as_json(summary: Mapping) -> str:
    """Text of a summary; refuses nan and inf, which JSON does not know."""
    return json.dumps(summary, indent=2, allow_nan=False) + "\n"


def csv_of_rows(rows: Iterable[Sequence[str]]) -> str:
    """CSV of rows of texts, which are quoted where they hold a comma and `inert`."""
    text = StringIO()
    csv.writer(text, lineterminator="\n").writerows(map(inert, row) for row in rows)
    return text.getvalue()


def inert(cell: str) -> str:
    """Text of a cell that no spreadsheet takes for a formula: "=1+1" gets an apostrophe."""
    begins = cell.strip().startswith(_BEGIN_FORMULAS)
    return f"'{cell}" if begins and not _QUANTITY.fullmatch(cell) else cell


def csv_text(columns: Mapping[str, tuple[Iterable[Any], str]]) -> str:
    """CSV of columns: heading -> values and their format; empty where a value is none or no number.

    Texts and truth values stand as they are, texts `inert`.
    """
    cells = [[_cell(value, form) for value in values] for values, form in columns.values()]
    return csv_of_rows([list(columns), *zip(*cells, strict=True)])


def _cell(value: Any, form: str) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return str(value).lower()
    return format(value, form) if value is not None and math.isfinite(value) else ""


def write_results(
    folder: str | Path, texts: Mapping[str, str], pictures: Mapping[str, Figure]
) -> list[Path]:
    """Write texts and pictures, file name -> content, into a folder, which is made where missing.

    Paths of what was written are returned.
    """
    folder = path_given(folder, "a folder for what is written")
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        write_whole(folder / name, text)
    for name, figure in pictures.items():
        write_whole(folder / name, presentation("plots.style").png_of(figure))
    return [folder / name for name in (*texts, *pictures)]


def short_repr(result: Any) -> str:
    """Return a repr that names the case of a result, and its method where it has one."""
    case, method = getattr(result, "case", None), getattr(result, "method", "")
    title = getattr(case, "title", "") or getattr(case, "name", "")
    words = ", ".join(word for word in (f"'{title}'" if title else "", method) if word)
    return f"<{type(result).__name__} {words}>".replace(" >", ">")


class NotebookResult:
    """A result with `.plot()`, which a notebook shows with its sentences."""

    def _repr_html_(self) -> str:
        """Return the sentences and the picture; notebooks ask for them by this name."""
        return presentation("report.notebook").notebook_page(self)


class SavedResult(NotebookResult):
    """A result that draws itself and writes its files: base of results, which give their tables."""

    #: module of pictures and function in it, such as "plots.whatif.plot_whatif"
    drawn_by: ClassVar[str]
    #: file name of the picture
    picture: ClassVar[str]

    def __repr__(self) -> str:
        """What the result is of: its arrays would fill the screen."""
        return short_repr(self)

    def summary(self) -> dict:
        """Content of summary.json."""
        raise NotImplementedError

    def tables(self) -> Mapping[str, str]:
        """Content of each further file of text, by its name."""
        raise NotImplementedError

    def plot(self) -> Figure:
        """Return the picture of the result as a matplotlib figure."""
        module, _, function = self.drawn_by.rpartition(".")
        return getattr(presentation(module), function)(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write tables, summary.json and the picture into a folder.

        Returns
        -------
        list of Path
            What was written.
        """
        texts = {**self.tables(), "summary.json": as_json(self.summary())}
        return write_results(folder, texts, {self.picture: self.plot()})
