"""A long computation of a view: start, progress, cancel, message, results."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn

from chatter.app.workbench.computations import Computation, Computations
from chatter.app.workbench.separate_process import Report, in_own_process
from chatter.app.workbench.session import without_folder
from chatter.app.workbench.wrapped_text import wrapped_text
from chatter.description.file_access import open_folder
from chatter.description.progress import Progress


class LongWork:
    """Runs functions in a process of their own, one at a time, and shows how far they are.

    Parameters
    ----------
    root : Path
        Folder of the session, which messages leave out.
    show : callable
        Called with a function that changes the page, from another thread.
    """

    def __init__(self, root: Path, show: Callable[[Callable[[], None]], None]) -> None:
        self._root, self._show = root, show
        self.cancel_button = pn.widgets.Button(label="Cancel", width=100)
        self.progress = pn.indicators.Progress(value=0, max=100, width=360, active=False)
        self.message = wrapped_text()
        self.computations = Computations(self.show_message)
        self.cancel_button.on_click(lambda _: self.computations.cancel())

    def start(
        self,
        function: Callable[..., Any],
        arguments: tuple[Any, ...],
        done: Callable[[], None],
        note: str = "",
        when_cancelled: str = "cancelled",
    ) -> None:
        """Start a function; `done` changes the page after it, `note` is what is said then."""

        def compute(go_on: Progress) -> None:
            try:
                given = (self._root, function, arguments)
                in_own_process(_in_folder, given, go_on, self.report)
                self.show_message(note)
            finally:
                self._show(lambda: self.progress.param.update(value=0, active=False))
            self._show(done)

        self.show_message("starting ...")
        self.computations.start(Computation(compute, False, when_cancelled=when_cancelled))

    def report(self, stage: str, share: float) -> None:
        """Show what is done, and the share of it."""
        value = min(100, round(100.0 * share))
        self._show(lambda: self.progress.param.update(value=value, active=True))
        self.show_message(f"{stage} ({value} %)")

    def show_message(self, text: str) -> None:
        """Show a sentence, with names relative to the folder."""
        told = without_folder(text, self._root)
        self._show(lambda: setattr(self.message, "object", told))


def _in_folder(
    root: Path, function: Callable[..., Any], arguments: tuple[Any, ...], report: Report
) -> Any:
    """Call a function in its process, where what lies in the folder of the session is allowed."""
    open_folder(root)
    return function(*arguments, report)
