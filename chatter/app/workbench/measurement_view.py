"""Measurement: files in, channels assigned, compared, explained, the repaired case accepted."""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import panel as pn

from chatter.app.workbench.channel_assignment import ChannelAssignment
from chatter.app.workbench.long_work import LongWork
from chatter.app.workbench.page_words import in_words_of_the_page
from chatter.app.workbench.repaired_case import take_repaired_case, why_no_repaired_case
from chatter.app.workbench.residual_file import RESIDUALS
from chatter.app.workbench.residual_view import ResidualView
from chatter.app.workbench.result_panel import result_panel, same_call
from chatter.app.workbench.session import Session, checked_name, readable_extensions
from chatter.app.workbench.studies import run_measurement
from chatter.app.workbench.upload import LATE, dropper
from chatter.app.workbench.wrapped_text import wrapped_text
from chatter.description.case import Case, load
from chatter.description.errors import InputError
from chatter.explain.measurement_file import read_measurement

_FOLDER, _FILE = "measurements", "measurement.toml"
_CASE = "case.toml"
#: what is said of work that was cancelled: an explanation keeps the predictions that it has made
_CANCELLED = {
    "compare": "cancelled",
    "explain": "cancelled; Explain goes on from the predictions made so far, if the records and "
    "the case stay the same",
}
#: what is said of files that were dropped after others under one name
_JOINED = (
    "the files dropped last are with those that were there before: a set of its own needs a name "
    "of its own in the field above before it is dropped"
)
_OPEN_CASE = "the open case"
_DECLARED = "the one that it names"


class MeasurementView:
    """Measurement folders of the session.

    Parameters
    ----------
    session : Session
    show : callable
        Called with a function that changes the page, from another thread.
    opened : callable
        Called with the name of the case that was accepted.
    """

    def __init__(
        self,
        session: Session,
        show: Callable[[Callable[[], None]], None],
        opened: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._session, self._opened = session, opened
        self.name = pn.widgets.TextInput(label="Name of the new folder", value="set-1", width=220)
        self.upload = dropper(self.take, "Records, with measurement.toml where there is one")
        self.upload.begun = self._drop_begins
        self.upload.arriving = self._file_arrives
        #: whether the files of a drop go to those of an earlier one
        self._joins = False
        #: folder that the files of a drop go to, whatever is begun while they come
        self._dropped_into: str | None = None
        self._proposed = ""  # name of the new folder that nobody typed
        self.folder = pn.widgets.Select(label="Measurement", options=[], width=300)
        self.case = pn.widgets.Select(label="Case", options=[_DECLARED, _OPEN_CASE], width=200)
        self.compare_button = pn.widgets.Button(label="Compare", color="primary")
        self.explain_button = pn.widgets.Button(label="Explain", color="primary")
        self.accept_button = pn.widgets.Button(label="Accept the repaired case", disabled=True)
        self.accepted_name = pn.widgets.TextInput(label="as", value="repaired.toml", width=200)
        #: why there is nothing to accept
        self.none_to_accept = wrapped_text()
        self.text = pn.widgets.TextAreaInput(
            label=_FILE, width=500, height=330, max_length=200_000,
            stylesheets=["textarea {font-family: monospace; font-size: 12.5px; white-space: pre}"],
        )  # fmt: skip
        self.write_button = pn.widgets.Button(label="Write measurement.toml")
        #: what is wrong with the assignment, beside it
        self.fault = wrapped_text(width=500, styles={"color": "#c62828"})
        self.assignment = ChannelAssignment(self._assigned, self._declared)
        self._channels = pn.Card(
            pn.Row(self.assignment, pn.Column(self.fault, self.text, self.write_button)),
            title="Runs and channels", collapsed=True, min_width=1260,
        )  # fmt: skip
        #: folders whose measurement.toml is a draft of the page: further records go into it
        self._drafts: set[str] = set()
        #: folder that the assignment is of, and measurement.toml as it stood when it was shown
        self._assigned_to: str | None = None
        self._text_of_file = ""
        self.work = LongWork(session.root, show)
        self.call, self._result, self.residuals = pn.Column(), pn.Column(), ResidualView()
        self.compare_button.on_click(lambda _: self.start("compare"))
        self.explain_button.on_click(lambda _: self.start("explain"))
        self.accept_button.on_click(lambda _: self.accept())
        self.write_button.on_click(lambda _: self.write())
        # files dropped so far are of the folder before
        self.name.param.watch(lambda _: self.upload.forget(), "value")
        self.folder.param.watch(lambda _: self._show(), "value")
        self.case.param.watch(lambda _: self._show_calls(), "value")
        self.refresh()

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        return pn.Column(
            pn.Row(self.folder, self.case, pn.Column(self.name, self.upload)),
            self._channels,
            pn.Row(self.compare_button, self.explain_button, self.work.cancel_button,
                   self.work.progress),
            self.work.message,
            self.call,
            pn.Row(self.accept_button, self.accepted_name),
            self.none_to_accept,
            self.residuals,
            self._result,
        )  # fmt: skip

    def refresh(self) -> None:
        """Offer the measurement folders that are there now."""
        found = self._session.measurement_names()
        self.folder.options = found
        if self.folder.value not in found:
            self.folder.value = next(iter(found), None)

    def take(self, files: Mapping[str, bytes]) -> None:
        """Write uploaded files into a folder of their own; offer their channels for assignment."""
        session = self._session
        try:
            folder = self._dropped_into or self._new_folder()
            checked_name(f"{Path(folder).name}.toml", (".toml",))
            session.store(folder, files, (*readable_extensions(), ".toml"))
            path = session.path(folder)
            if _FILE in files:
                self._drafts.discard(folder)
                self._channels.collapsed = True
            elif folder in self._drafts or not (path / _FILE).exists():
                self._draft(folder)
        except InputError as error:
            self.work.show_message(str(error))
            return
        self.refresh()
        self.folder.value = folder
        self._show()
        told = self._what_is_wrong(folder) or f"{_counted(len(files))} in {folder}"
        self.work.show_message(f"{told}\n{_JOINED}" if self._joins else told)

    def _file_arrives(self, file: str, share: float) -> None:
        """Say that a file is on its way, and how much of it has come."""
        self.work.show_message(f"{file} is arriving ({100.0 * share:.0f} %) ...")

    def _new_folder(self) -> str:
        """Folder of what is dropped next."""
        return f"{_FOLDER}/{self.name.value.strip()}"

    def _drop_begins(self, file: str) -> None:
        """Files go into the new folder, late ones of a drop to the others of it.

        A busy page pauses between two files; whoever drops another set gives it a name, waits, or
        has a file of a name that is there already.
        """
        before, named = self._dropped_into, self.name.value != self._proposed
        late = before is not None and not named and self.upload.pause() < LATE
        if not (late and not self._session.path(f"{before}/{file}").exists()):
            self._dropped_into = self._new_folder()
        self._joins = (self._session.path(str(self._dropped_into)) / _FILE).is_file()

    def _draft(self, folder: str) -> None:
        """Write a first measurement.toml: files come one by one, and each is a run."""
        path = self._session.path(folder)
        if folder not in self._drafts:
            self.assignment.begin()
        self._drafts.add(folder)
        self._assigned_to = folder
        records = (one for one in path.iterdir() if one.suffix.lower() in readable_extensions())
        self.assignment.offer(sorted(records))
        self.text.value = self.assignment.toml(self._case_from(folder))
        (path / _FILE).write_text(self.text.value, encoding="utf-8")
        self._channels.collapsed = False

    def _case_from(self, folder: str) -> str:
        """Case that a measurement names: the one that was dropped with it, or the open one."""
        session, path = self._session, self._session.path(folder)
        if (path / _CASE).is_file() or not session.name:
            return _CASE
        return Path(os.path.relpath(session.path(session.name), path)).as_posix()

    def _declared(self) -> Case | None:
        """Case that the measurement on the page names; None where there is none without faults."""
        folder = self._assigned_to
        if folder is None:
            return None
        own = self._session.path(folder) / _CASE
        try:
            return load(own) if own.is_file() else self._session.case
        except InputError:
            return None

    def write(self) -> None:
        """Write measurement.toml as it stands in the text, and say what is wrong with it."""
        name = self.folder.value
        if name is None:
            return
        self._drafts.discard(name)
        self._write_text(name)
        self.work.show_message(self._what_is_wrong(name) or f"{name}/{_FILE} is written")

    def _what_is_wrong(self, folder: str) -> str:
        """Return what is wrong with the description of a measurement; empty where it is sound."""
        try:
            read_measurement(self._session.path(folder))
        except InputError as error:
            return str(error)
        return ""

    def start(self, name: str) -> None:
        """Compare or explain the measurement that is chosen."""
        if self.folder.value is None:
            self.work.show_message(
                "no measurement: drop records, or open a folder with measurement.toml"
            )
            return
        own = self.case.value == _OPEN_CASE
        try:
            case = self._session.case_text if own else None
        except InputError as error:
            self.work.show_message(str(error))
            return
        if self.text.value != self._text_of_file:  # what is shown is what is used
            self._write_text(self.folder.value)
        self._name_the_next()
        call = self._call(name, own)
        self.call.objects = [same_call(call)]
        path = self._session.path(self.folder.value)
        arguments = (name, path, case, call, self._results(name))
        self.work.start(run_measurement, arguments, self._show, when_cancelled=_CANCELLED[name])

    def _write_text(self, folder: str) -> None:
        path = self._session.path(f"{folder}/{_FILE}")
        path.write_text(self.text.value, encoding="utf-8")
        self._text_of_file = self.text.value

    def _name_the_next(self) -> None:
        """Propose a new folder for what is dropped once work on this one has begun."""
        if self.folder.value == f"{_FOLDER}/{self.name.value.strip()}":
            taken = set(self._session.measurement_names())
            self.name.value = next(
                name for name in (f"set-{k}" for k in range(1, len(taken) + 2))
                if f"{_FOLDER}/{name}" not in taken
            )  # fmt: skip
            self._proposed = self.name.value

    def accept(self) -> None:
        """Take the repaired case into the folder as a case of its own, and open it."""
        session, results = self._session, self._results("explain")
        if why_no_repaired_case(results):  # as it stands on the page
            return
        try:
            target = take_repaired_case(session, results, self.accepted_name.value.strip())
        except InputError as error:
            self.work.show_message(str(error))
            return
        self.work.show_message(f"{target.name} is in the folder, and open")
        self._opened(target.name)

    def _results(self, name: str) -> Path:
        stem = str(self.folder.value).replace("/", "-").replace(".", "-")
        return self._session.path(f"results/{stem}/{name}")

    def _call(self, name: str, own: bool) -> dict[str, str]:
        folder, file = self.folder.value, self._session.name
        words = ["chatter", name, folder, *(["--case", file] if own else [])]
        given = f", {file!r}" if own else ""
        return {"command": shlex.join(words), "python": f"chatter.{name}({folder!r}{given})"}

    def _show(self) -> None:
        if self.folder.value is None:
            return
        path = self._session.path(f"{self.folder.value}/{_FILE}")
        if path.is_file():
            self.text.value = path.read_text(encoding="utf-8", errors="replace")
            self._text_of_file = self.text.value
        parts: list[Any] = []
        for name in ("explain", "compare"):
            parts += result_panel(self._results(name))
        self._result.objects = parts
        self._show_calls()
        done = [self._results(name) for name in ("explain", "compare")]
        self.residuals.show(max(done, key=_last_written))
        self._offer_to_accept()

    def _offer_to_accept(self) -> None:
        """Offer the repaired case where there is one, or say why there is none."""
        why_not = why_no_repaired_case(self._results("explain"))
        self.none_to_accept.object = why_not
        self.none_to_accept.visible = bool(why_not)
        self.accept_button.disabled = self.accepted_name.disabled = bool(why_not)

    def _show_calls(self) -> None:
        """Show what gives the same as each button."""
        own = self.case.value == _OPEN_CASE
        if self.folder.value is not None:
            both = (self._call(name, own) for name in ("compare", "explain"))
            self.call.objects = [same_call(one) for one in both]

    def _assigned(self) -> None:
        """Write the assignment of the channels into the text."""
        if self._assigned_to is None or self.folder.value != self._assigned_to:
            return
        try:
            self.text.value = self.assignment.toml(self._case_from(self._assigned_to))
        except InputError as error:
            self.fault.object = in_words_of_the_page(str(error))
        else:
            self.fault.object = ""


def _counted(files: int) -> str:
    return "1 file is" if files == 1 else f"{files} files are"


def _last_written(folder: Path) -> float:
    """Time at which the residuals of a folder were written, s; 0 where there are none."""
    path = folder / RESIDUALS
    return path.stat().st_mtime if path.is_file() else 0.0
