"""Files that results write: texts, summaries as strict JSON, pictures."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from chatter.description.given_path import path_given
from chatter.description.whole_files import write_whole
from chatter.io.presentation import presentation
from chatter.io.result_tables import Columns, require_kind, write_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def finite_or_none(value: float) -> float | None:
    """Return a number as JSON knows it: None in place of nan and inf."""
    return float(value) if math.isfinite(value) else None


def as_json(summary: Mapping) -> str:
    """Text of a summary; refuses nan and inf, which JSON does not know."""
    return json.dumps(summary, indent=2, allow_nan=False) + "\n"


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

    def tables(self) -> Mapping[str, Columns]:
        """Columns of each table that is written, by the name of its file without extension."""
        raise NotImplementedError

    def plot(self) -> Figure:
        """Return the picture of the result as a matplotlib figure."""
        module, _, function = self.drawn_by.rpartition(".")
        return getattr(presentation(module), function)(self)

    def save(self, folder: str | Path, tables: str = "csv") -> list[Path]:
        """Write tables, summary.json and the picture into a folder.

        Parameters
        ----------
        folder : path
        tables : str, optional
            Files of the tables: "csv", "parquet" or "none".

        Returns
        -------
        list of Path
            What was written.

        Raises
        ------
        InputError
            If `tables` is none of these, or pyarrow is needed and not installed.
        """
        require_kind(tables)
        summary = {"summary.json": as_json(self.summary())}
        written = write_results(folder, summary, {self.picture: self.plot()})
        return [
            *(
                path
                for name, columns in self.tables().items()
                for path in write_table(Path(folder), name, tables, columns)
            ),
            *written,
        ]
