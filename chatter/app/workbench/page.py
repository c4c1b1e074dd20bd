"""The page of a session: the case that is open, and the views of the folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn
from bokeh.document import Document

from chatter.app.workbench.case_view import CaseView
from chatter.app.workbench.cut_view import CutView
from chatter.app.workbench.machine_view import MachineView
from chatter.app.workbench.measurement_view import MeasurementView
from chatter.app.workbench.session import Session
from chatter.app.workbench.stability_tab import StabilityTab
from chatter.app.workbench.studies_view import StudiesView
from chatter.app.workbench.tap_test_view import TapTestView
from chatter.description.errors import InputError

_STUDIES = ("optimum", "pitch", "whatif", "uncertainty")


class Workbench:
    """Page of one session; a browser's page is changed by way of its `document`."""

    def __init__(
        self,
        folder: Path,
        first: str | None = None,
        method: str | None = None,
        text: str | None = None,
        document: Document | None = None,
    ) -> None:
        self._document = document
        self.session = Session(folder)
        files = self.session.case_names()
        self.choice = pn.widgets.Select(label="Case", options=files, width=300)
        self.message = pn.pane.Str(f"no case yet in {self.session.root.name}: drop hammer records "
                                   "in Tap test, or make one in Case", width=800)  # fmt: skip
        show = self._in_the_page
        self.case = CaseView(self.session, self._opened)
        self.tap_test = TapTestView(self.session, show, self._modes_taken)
        self.sheet = StudiesView(self.session, show, ("sheet", "check"))
        self.studies = StudiesView(self.session, show, _STUDIES)
        self.stability = StabilityTab(self.session, show, method)
        self.cut = CutView(self.session, show)
        self.machine = MachineView(self.session, show)
        self.measurement = MeasurementView(self.session, show, self._opened)
        self.views: dict[str, Any] = {
            "Tap test": self.tap_test,
            "Case": self.case,
            "Stability": self.stability,
            "Cut": self.cut,
            "Machine": self.machine,
            "Measurement": self.measurement,
            "Studies": self.studies,
            "Operator's sheet": self.sheet,
        }
        self.tabs = pn.Tabs(
            *((name, view.__panel__()) for name, view in self.views.items()), dynamic=True
        )
        self.tabs.param.watch(lambda _: self._refresh(), "active")
        self.session.watch(self._describe)
        self.choice.param.watch(lambda event: self.open(event.new), "value")
        first = first if first in files else next(iter(files), None)
        if first is not None:
            self.choice.value = first
            self.open(first)
            if text is not None:
                self.session.set_text(text)
            sound = self.session.case is not None
            self.tabs.active = list(self.views).index("Stability" if sound else "Case")
        self.tap_test.open_folder()

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the page."""
        return pn.Column(pn.Row(self.choice, self.message), self.tabs)

    def end(self) -> None:
        """Give up what is computed for this session."""
        self.stability.end()
        for quick in (self.tap_test, self.cut):
            quick.computations.end()
        for long in (self.machine, self.measurement, self.sheet, self.studies):
            long.work.computations.end()

    def open(self, name: str | None) -> None:
        """Open a case file of the folder."""
        if name is None or name == self.session.name:
            return
        try:
            self.session.open(name)
        except InputError as error:
            self.message.object = self.session.short(error)

    def _opened(self, name: str) -> None:
        self.choice.options = self.session.case_names()
        self.choice.value = name

    def _modes_taken(self) -> None:
        self.tabs.active = list(self.views).index("Case")

    def _refresh(self) -> None:
        """Bring up to date what follows the case only while it is looked at."""
        view = list(self.views.values())[self.tabs.active]
        if hasattr(view, "refresh"):
            view.refresh()

    def _describe(self) -> None:
        case = self.session.case
        title = case.title if case is not None else "the case has faults: see the view Case"
        self.message.object = f"{title}{' (not saved)' if self.session.changed else ''}"
        self._refresh()

    def _in_the_page(self, change: Callable[[], None]) -> None:
        """Change the page from another thread; without a browser, at once."""
        if self._document is None:
            change()
        else:
            self._document.add_next_tick_callback(change)
