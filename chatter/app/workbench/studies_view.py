"""Studies of the open case: started, watched, cancelled, gone on with, shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn

from chatter.app.workbench.long_work import LongWork
from chatter.app.workbench.result_panel import result_panel, same_call
from chatter.app.workbench.session import Session
from chatter.app.workbench.studies import OPTION_NAMES, STUDIES, run_study
from chatter.app.workbench.studies import same_call as call_of
from chatter.description.errors import InputError

_RESULTS_OF_WHATIF = ("", "lobes", "critical depth", "forces", "surface", "frf")


class StudiesView:
    """Studies by name, of those that the view is given.

    Parameters
    ----------
    session : Session
    show : callable
        Called with a function that changes the page, from another thread.
    names : tuple of str
        Keys of `STUDIES`.
    """

    def __init__(
        self, session: Session, show: Callable[[Callable[[], None]], None], names: tuple[str, ...]
    ) -> None:
        self._session = session
        labels = {STUDIES[name].label: name for name in names}
        self.choice = pn.widgets.Select(label="Study", options=labels, width=220)
        self.start_button = pn.widgets.Button(label="Start", color="primary", width=100)
        self.work = LongWork(session.root, show)
        self.call = pn.Column()
        self.options: dict[str, Any] = {}
        self._option_row, self._result = pn.FlexBox(min_width=860), pn.Column()
        self.start_button.on_click(lambda _: self.start())
        self.choice.param.watch(lambda _: self._chosen(), "value")
        session.watch(self._show_results)
        self._chosen()

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        buttons = pn.Row(self.start_button, self.work.cancel_button, self.work.progress)
        choice = [self.choice] if len(self.choice.options) > 1 else []
        return pn.Column(
            *choice, self._option_row, buttons, self.work.message, self.call, self._result
        )

    def given(self) -> dict[str, Any]:
        """Options as they are chosen."""
        return {name: widget.value for name, widget in self.options.items()}

    def start(self) -> None:
        """Start the study; one that was cancelled goes on from what it has finished."""
        name, given = self.choice.value, self.given()
        try:
            case = self._session.case_text
        except InputError as error:
            self.work.show_message(str(error))
            return
        folder = self._session.results(name)
        changed = self._session.changed
        note = "of the case as it stands here, which is not saved" if changed else ""
        self.work.start(run_study, (name, case, given, folder), self._show_results, note)

    def _chosen(self) -> None:
        study = STUDIES[self.choice.value]
        self.options = {name: _widget(name, value) for name, value in study.options.items()}
        for widget in self.options.values():
            widget.param.watch(lambda _: self._show_call(), "value")
        self._option_row.objects = [pn.pane.Str(study.description, width=880),
                                    *self.options.values()]  # fmt: skip
        self._show_results()

    def _show_call(self) -> None:
        file = self._session.name or "case.toml"
        self.call.objects = [same_call(call_of(self.choice.value, file, self.given()))]

    def _show_results(self) -> None:
        self._show_call()
        self._result.objects = result_panel(self._session.results(self.choice.value))


def _widget(name: str, value: Any) -> Any:
    label = OPTION_NAMES.get(name, name).replace("_", " ")
    if name == "result":
        return pn.widgets.Select(label=label, options=list(_RESULTS_OF_WHATIF), width=160)
    if isinstance(value, bool):
        return pn.widgets.Checkbox(label=label, value=value)
    if isinstance(value, int):
        return pn.widgets.IntInput(label=label, value=value, start=1, end=100_000, width=120)
    return pn.widgets.TextAreaInput(label=label, value=value, width=420, height=80)
