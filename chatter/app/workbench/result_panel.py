"""What a computation has left in its folder: sentences, pictures, tables, files to take away."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Any

import panel as pn

from chatter.app.workbench.session import CALL, read_call
from chatter.app.workbench.table_files import PageTable, as_csv, as_html, as_xlsx, table_of
from chatter.app.workbench.wrapped_text import wrapped_text

_TABLES = 6


def result_panel(folder: Path) -> list[Any]:
    """Parts of the page that show the results of a folder; none where there are none."""
    call = read_call(folder)
    if not call:
        return []
    words = [f"<h3>{escape(str(call.get('title', '')))}</h3>"]
    words += [f"<p>{escape(str(one))}</p>" for one in call.get("sentences", ())]
    words += [f"<p><i>{escape(str(one))}</i></p>" for one in call.get("notes", ())]
    parts: list[Any] = [pn.pane.HTML("".join(words), width=900)]
    parts += [pn.pane.PNG(path.read_bytes(), width=860) for path in sorted(folder.glob("*.png"))]
    for path in sorted(folder.glob("*.csv"))[:_TABLES]:
        parts.append(pn.Card(pn.pane.HTML(as_html(table_of(path))), title=path.name,
                             collapsed=True, width=900))  # fmt: skip
    parts.append(pn.FlexBox(*downloads(folder), min_width=860))
    return parts


def same_call(call: dict[str, Any]) -> pn.pane.Str:
    """Command and Python call that give the same."""
    text = "\n".join(str(call[key]) for key in ("command", "python") if call.get(key))
    return wrapped_text(text, styles=CODE)


#: look of commands and calls
CODE = {"font-family": "monospace", "background": "#f4f4f4",
        "padding": "6px"}  # fmt: skip


def downloads(folder: Path) -> list[pn.widgets.FileDownload]:
    """Button for each file of a folder, and for its tables as XLSX."""
    files = [path for path in sorted(folder.iterdir()) if path.is_file() and path.name != CALL]
    visible = [path for path in files if not path.name.startswith(".")]
    found = [pn.widgets.FileDownload(file=str(path), filename=path.name, label=path.name)
             for path in visible]  # fmt: skip
    found += [
        pn.widgets.FileDownload(
            callback=_workbook(path), filename=f"{path.stem}.xlsx", label=f"{path.stem}.xlsx"
        )
        for path in visible
        if path.suffix == ".csv" and not (folder / f"{path.stem}.xlsx").exists()
    ]
    return found


def table_buttons(
    table: Callable[[], PageTable], name: str
) -> tuple[pn.widgets.FileDownload, pn.widgets.FileDownload]:
    """Buttons that save a table of the page, as CSV and as XLSX."""
    return (
        pn.widgets.FileDownload(
            callback=lambda: as_csv(table()), filename=f"{name}.csv", label="Table (CSV)"
        ),
        pn.widgets.FileDownload(
            callback=lambda: as_xlsx(table()), filename=f"{name}.xlsx", label="Table (XLSX)"
        ),
    )


def _workbook(path: Path) -> Callable[[], Any]:
    return lambda: as_xlsx(table_of(path))
