"""Measurement: files in, channels assigned, compared, explained, the repaired case accepted."""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import panel as pn
import tomlkit

from chatter.app.workbench.long_work import LongWork
from chatter.app.workbench.residual_file import RESIDUALS
from chatter.app.workbench.residual_view import ResidualView
from chatter.app.workbench.result_panel import result_panel, same_call
from chatter.app.workbench.session import Session, checked_name, readable_extensions
from chatter.app.workbench.studies import run_measurement
from chatter.app.workbench.upload import dropper
from chatter.description.assignments import parse_assignments
from chatter.description.case import load
from chatter.description.errors import InputError
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement_file import read_measurement
from chatter.explain.records.description import QUANTITIES, SIDES
from chatter.io.signals import read_signals

_FOLDER, _FILE, _UPDATED = "measurements", "measurement.toml", "case-updated.toml"
_BEGINS = ("rest", "air", "cut")
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
        self.folder = pn.widgets.Select(label="Measurement", options=[], width=300)
        self.case = pn.widgets.Select(label="Case", options=[_DECLARED, _OPEN_CASE], width=200)
        self.compare_button = pn.widgets.Button(label="Compare", color="primary")
        self.explain_button = pn.widgets.Button(label="Explain", color="primary")
        self.accept_button = pn.widgets.Button(label="Accept the repaired case", disabled=True)
        self.accepted_name = pn.widgets.TextInput(label="as", value="repaired.toml", width=200)
        self.text = pn.widgets.TextAreaInput(
            label=_FILE, width=560, height=330, max_length=200_000,
            stylesheets=["textarea {font-family: monospace; font-size: 12.5px; white-space: pre}"],
        )  # fmt: skip
        self.write_button = pn.widgets.Button(label="Write measurement.toml")
        self.assignment = ChannelAssignment(self._assigned)
        self._channels = pn.Card(
            pn.Row(self.assignment, pn.Column(self.text, self.write_button)),
            title="Runs and channels", collapsed=True, min_width=1200,
        )  # fmt: skip
        #: folders whose measurement.toml is a draft of the page: further records go into it
        self._drafts: set[str] = set()
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
            name = checked_name(f"{self.name.value.strip()}.toml", (".toml",))[:-5]
            folder = f"{_FOLDER}/{name}"
            session.store(folder, files, (*readable_extensions(), ".toml"))
            path = session.path(folder)
            if _FILE in files:
                self._drafts.discard(folder)
                self._channels.collapsed = True
            elif folder in self._drafts or not (path / _FILE).exists():
                self._draft(folder, [path / one for one in sorted(files)])
        except InputError as error:
            self.work.show_message(str(error))
            return
        self.refresh()
        self.folder.value = folder
        self._show()
        self._say_what_is_wrong(folder, f"{len(files)} files are in {folder}")

    def _draft(self, folder: str, files: list[Path]) -> None:
        """Write a first measurement.toml: files come one by one, and each is a run."""
        self._drafts.add(folder)
        records = [path for path in files if path.suffix != ".toml"]
        self.assignment.offer(records)
        self._assigned()
        path = self._session.path(f"{folder}/{_FILE}")
        path.write_text(self.text.value, encoding="utf-8")
        self._channels.collapsed = False

    def write(self) -> None:
        """Write measurement.toml as it stands in the text, and say what is wrong with it."""
        name = self.folder.value
        if name is None:
            return
        self._drafts.discard(name)
        self._session.path(f"{name}/{_FILE}").write_text(self.text.value, encoding="utf-8")
        self._say_what_is_wrong(name, f"{name}/{_FILE} is written")

    def _say_what_is_wrong(self, folder: str, else_say: str) -> None:
        """Say what is wrong with the description of a measurement."""
        try:
            read_measurement(self._session.path(folder))
        except InputError as error:
            self.work.show_message(str(error))
        else:
            self.work.show_message(else_say)

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
        self._name_the_next()
        call = self._call(name, own)
        self.call.objects = [same_call(call)]
        path = self._session.path(self.folder.value)
        arguments = (name, path, case, call, self._results(name))
        self.work.start(run_measurement, arguments, self._show)

    def _name_the_next(self) -> None:
        """Propose a new folder for what is dropped once work on this one has begun."""
        if self.folder.value == f"{_FOLDER}/{self.name.value.strip()}":
            taken = set(self._session.measurement_names())
            self.name.value = next(
                name for name in (f"set-{k}" for k in range(1, len(taken) + 2))
                if f"{_FOLDER}/{name}" not in taken
            )  # fmt: skip

    def accept(self) -> None:
        """Take the repaired case into the folder as a case of its own, and open it."""
        session = self._session
        try:
            target = session.new_path(self.accepted_name.value.strip())
            load(self._results("explain") / _UPDATED).save(target)
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
        parts: list[Any] = []
        for name in ("explain", "compare"):
            parts += result_panel(self._results(name))
        self._result.objects = parts
        self._show_calls()
        done = [self._results(name) for name in ("explain", "compare")]
        self.residuals.show(max(done, key=_last_written))
        self.accept_button.disabled = not (self._results("explain") / _UPDATED).is_file()

    def _show_calls(self) -> None:
        """Show what gives the same as each button."""
        own = self.case.value == _OPEN_CASE
        if self.folder.value is not None:
            both = (self._call(name, own) for name in ("compare", "explain"))
            self.call.objects = [same_call(one) for one in both]

    def _assigned(self) -> None:
        """Write the assignment of the channels into the text."""
        session = self._session
        folder = session.path(f"{_FOLDER}/{self.name.value.strip()}")
        case = os.path.relpath(session.path(session.name), folder) if session.name else "case.toml"
        try:
            self.text.value = self.assignment.toml(Path(case).as_posix())
        except InputError as error:
            self.work.show_message(str(error))


class ChannelAssignment:
    """What each channel of the records is, by hand, and what each run differs in from the case.

    Parameters
    ----------
    changed : callable
        Called when an assignment has changed.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self.kind = pn.widgets.Select(label="Kind", options=list(KINDS), width=130)
        self.begins = pn.widgets.Select(label="Record begins", options=list(_BEGINS), width=130)
        self.angle = pn.widgets.Checkbox(label="spindle angle unknown", value=True)
        self.channels: dict[str, tuple[Any, ...]] = {}
        self.runs: dict[str, Any] = {}
        self._rows = pn.Column(pn.pane.Str("Drop records without a measurement.toml to assign "
                                           "their channels here."))  # fmt: skip
        for widget in (self.kind, self.begins, self.angle):
            widget.param.watch(lambda _: self._changed(), "value")

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the form for the page."""
        return pn.Column(pn.Row(self.kind, self.begins), self.angle, self._rows, width=600)

    def offer(self, records: list[Path]) -> None:
        """Make a row for every channel of the records and for every run."""
        names: dict[str, None] = {}
        for path in records:
            names |= dict.fromkeys(read_signals(path))
        # what was assigned stays: records come one by one
        self.channels = {name: self.channels.get(name) or self._watched(_assignment())
                         for name in names if not _is_time(name)}  # fmt: skip
        self.runs = {path.name: self.runs.get(path.name) or self._run_of(path)
                     for path in records}  # fmt: skip
        rows = [
            pn.Row(pn.pane.Str(name, width=110), *widgets)
            for name, widgets in self.channels.items()
        ]
        self._rows.objects = [
            pn.pane.Markdown("What each channel measures, on which side, along which direction:"),
            *rows,
            pn.pane.Markdown("What each run differs in from the case:"),
            *self.runs.values(),
        ]

    def _watched(self, widgets: tuple[Any, ...]) -> tuple[Any, ...]:
        for widget in widgets:
            widget.param.watch(lambda _: self._changed(), "value")
        return widgets

    def _run_of(self, path: Path) -> Any:
        """Field for what a run differs in from the case."""
        field = pn.widgets.TextInput(
            label=path.name, placeholder="spindle_speed=8000 rpm; axial_depth=1 mm", width=480
        )
        return self._watched((field,))[0]

    def toml(self, case: str) -> str:
        """Text of measurement.toml; InputError if a run is no list of assignments."""
        document = tomlkit.document()
        document["kind"], document["case"] = self.kind.value, case
        assigned = {
            name: (quantity.value, side.value, direction.value.strip())
            for name, (quantity, side, direction) in self.channels.items()
            if quantity.value
        }
        if assigned:
            record = {"begins": self.begins.value}
            if self.angle.value:
                record["spindle_angle"] = "unknown"
            document["record"] = record
            channels = tomlkit.table()
            for name, (quantity, side, direction) in assigned.items():
                channels[name] = _entry(name, quantity, side, direction)
            document["channels"] = channels
        runs = tomlkit.aot()
        for name, widget in self.runs.items():
            given = [one.strip() for one in widget.value.split(";") if one.strip()]
            runs.append(tomlkit.item({"file": name, **parse_assignments(given)}))
        document["run"] = runs
        return tomlkit.dumps(document)


def _last_written(folder: Path) -> float:
    """Time at which the residuals of a folder were written, s; 0 where there are none."""
    path = folder / RESIDUALS
    return path.stat().st_mtime if path.is_file() else 0.0


def _assignment() -> tuple[Any, Any, Any]:
    """Quantity, side and direction of a channel, to be chosen."""
    return (
        pn.widgets.Select(options=["", *QUANTITIES], width=140),
        pn.widgets.Select(options=list(SIDES), width=90),
        pn.widgets.TextInput(placeholder="x, [0.7, 0.7, 0], unknown", width=150),
    )


_AXES = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}


def _entry(name: str, quantity: str, side: str, direction: str) -> Any:
    entry: dict[str, Any] = {"quantity": quantity}
    if quantity in ("force", "displacement", "velocity", "acceleration"):
        entry["on"] = side
        given = parse_assignments([f"{name}={direction or 'unknown'}"])[name]
        entry["direction"] = _AXES.get(direction, given)
    found = tomlkit.inline_table()
    found.update(entry)
    return found


def _is_time(name: str) -> bool:
    return name.strip().lower() in ("time", "t")
