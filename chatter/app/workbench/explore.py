"""The stability view in a notebook."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from chatter.description.case import Case
from chatter.description.case_or_path import takes_case_or_path
from chatter.description.errors import InputError


def _short_name(name: str) -> str:
    """Name of a case file as seen from the folder of the notebook; elsewhere without its folder."""
    path = Path(name)
    try:
        return path.resolve().relative_to(Path.cwd()).as_posix() if path.is_absolute() else name
    except ValueError:
        return path.name


@takes_case_or_path
def explore(case: Case, method: str | None = None) -> Any:
    """Show a stability diagram with sliders in a notebook; a click simulates a point of it.

    Parameters
    ----------
    case : Case, or path of a case file
    method : str, optional
        Stability method, as of `chatter.lobes`.

    Returns
    -------
    panel.viewable.Viewable
        Which a notebook shows; ``.servable()`` puts it on a page of its own.

    Raises
    ------
    InputError
        If Panel is not installed, the case lacks a section, or the method is too slow.
    """
    if find_spec("panel") is None:
        raise InputError("explore requires Panel: pip install 'chatter[app]'")
    import panel as pn

    from chatter.app.workbench.stability_view import StabilityView
    from chatter.plots.notebook_scripts import load_notebook_scripts

    load_notebook_scripts()
    shown: list[Any] = []

    def show(change: Callable[[], None]) -> None:
        change()
        if shown and shown[0]._models:  # a notebook has no document that is told of changes
            pn.io.notebook.push_notebook(*shown)

    view = StabilityView(case, _short_name(case.name), show, method)
    shown.append(view.__panel__())
    return shown[0]
