"""Studies of the open case: started, watched, cancelled, gone on with, shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn

from chatter.app.sliders import case_sliders
from chatter.app.workbench.long_work import LongWork
from chatter.app.workbench.result_panel import result_panel, same_call
from chatter.app.workbench.session import Session, read_started
from chatter.app.workbench.studies import OPTION_NAMES, STUDIES, run_study
from chatter.app.workbench.studies import same_call as call_of
from chatter.description.case import Case
from chatter.description.errors import InputError

_RESULTS_OF_WHATIF = ("", "lobes", "critical depth", "forces", "surface", "frf")

#: what is said of a study that was cancelled and keeps what it has finished
_GOES_ON = "cancelled; Start goes on where it stopped, if the case and the options stay the same"
#: what is said of a study that began and left no results, and where it keeps what it has finished
_HALF_ENDED = (
    "This study was started at {} and has not come to its end: it was cancelled, the page was "
    "closed, or it is still computing{}. Results below are of an earlier run."
)
_WOULD_GO_ON = "; Start goes on where it stopped, if the case and the options are the same"
#: option of a study that names the values that vary, and how far each does at first
_VARY, _SHARE = "vary", "+-20%"


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
        #: values of the open case by their words, which a choice adds to those that vary
        self.varied = pn.widgets.Select(label="add a value that varies", options=[""], width=260)
        self.varied.param.watch(lambda event: self._vary(event.new), "value")
        self._option_row, self._result = pn.FlexBox(min_width=860), pn.Column()
        self.start_button.on_click(lambda _: self.start())
        self.choice.param.watch(lambda _: self._chosen(), "value")
        session.watch(self._show_results)
        session.watch(self._offer_values)
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
        told = _GOES_ON if STUDIES[name].goes_on else "cancelled"
        arguments = (name, case, given, folder)
        self.work.start(run_study, arguments, self._show_results, note, told)

    def _chosen(self) -> None:
        study = STUDIES[self.choice.value]
        self.options = {name: _widget(name, value) for name, value in study.options.items()}
        for widget in self.options.values():
            widget.param.watch(lambda _: self._show_call(), "value")
        self._option_row.objects = [pn.pane.Str(study.description, width=880),
                                    *self._pickers(), *self.options.values()]  # fmt: skip
        self._offer_values()
        self._show_results()

    def _pickers(self) -> list[Any]:
        return [self.varied] if _VARY in self.options else []

    def _offer_values(self) -> None:
        """Offer the values of the open case that can be larger and smaller."""
        case = self._session.case
        found = values_that_vary(case) if case is not None and _VARY in self.options else {}
        self.varied.options = {"": "", **found}

    def _vary(self, path: str) -> None:
        """Add a line for a value; it stands there to be changed."""
        if not path or _VARY not in self.options:
            return
        widget = self.options[_VARY]
        lines = [one for one in widget.value.splitlines() if one.strip()]
        if not any(one.startswith(f"{path}=") for one in lines):
            widget.value = "\n".join([*lines, f"{path}={_SHARE}"])
        self.varied.value = ""

    def _show_call(self) -> None:
        file = self._session.name or "case.toml"
        self.call.objects = [same_call(call_of(self.choice.value, file, self.given()))]

    def _show_results(self) -> None:
        self._show_call()
        folder = self._session.results(self.choice.value)
        begun = read_started(folder)
        goes_on = _WOULD_GO_ON if STUDIES[self.choice.value].goes_on else ""
        told = [pn.pane.Str(_HALF_ENDED.format(begun, goes_on), width=880)] if begun else []
        self._result.objects = [*told, *result_panel(folder)]


def values_that_vary(case: Case) -> dict[str, str]:
    """Paths of the values of a case that a slider moves and that are no counts, by their words.

    None where the case lacks a tool, a material, a cut or a structure.
    """
    if None in (case.tool, case.material, case.cut, case.structure):
        return {}
    return {
        f"{one.group}: {one.label}": one.path
        for one in case_sliders(case)
        if one.value and not one.whole
    }


def _widget(name: str, value: Any) -> Any:
    label = OPTION_NAMES.get(name, name).replace("_", " ")
    if name == "result":
        return pn.widgets.Select(label=label, options=list(_RESULTS_OF_WHATIF), width=160)
    if isinstance(value, bool):
        return pn.widgets.Checkbox(label=label, value=value)
    if isinstance(value, int):
        return pn.widgets.IntInput(label=label, value=value, start=1, end=100_000, width=120)
    return pn.widgets.TextAreaInput(label=label, value=value, width=420, height=80)
