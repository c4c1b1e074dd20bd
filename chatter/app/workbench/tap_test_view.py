"""Tap test: hammer records or FRFs to modes, with records and poles chosen by hand."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import panel as pn
import tomlkit

import chatter
from chatter.app.workbench.computations import Computation, Computations
from chatter.app.workbench.modal_test_figures import ModalTestFigures
from chatter.app.workbench.picture_files import picture
from chatter.app.workbench.result_panel import CODE, downloads, table_buttons
from chatter.app.workbench.session import Session, readable_extensions
from chatter.app.workbench.table_files import PageTable, as_html
from chatter.app.workbench.upload import LATE, dropper
from chatter.app.workbench.wrapped_text import wrapped_text
from chatter.description.errors import InputError
from chatter.description.progress import Progress
from chatter.io.hammer_records import is_hammer_record
from chatter.studies.modal_test import ModalTest

_FIRST_STEP = (
    "Drop hammer records (force and response of each blow) or FRF files of one direction, then "
    "those of the next. Without any, begin in Case."
)
_HEADINGS = ("frequency [Hz]", "damping ratio", "mass [kg]", "fit error", "remark")


class TapTestView:
    """Records judged one by one, FRF, stabilisation diagram, modes.

    Parameters
    ----------
    session : Session
    show : callable
        Called with a function that changes the page, from another thread.
    taken : callable
        Called when modes have gone into the case.
    """

    def __init__(
        self,
        session: Session,
        show: Callable[[Callable[[], None]], None],
        taken: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._show, self._taken = session, show, taken
        #: what goes into the case, by side and direction
        self._fitted: dict[tuple[str, str], ModalTest] = {}
        self._fitting: Mapping[str, Any] = {}
        self.test: ModalTest | None = None
        self.files: list[Path] = []
        self.poles: list[tuple[float, float]] = []
        self.upload = dropper(self.take, "Hammer records or FRF files")
        self.upload.begun = self._drop_begins
        self.upload.removed = self.remove
        #: folder that the files of a drop go to, whatever is chosen while they come
        self._dropped_into: str | None = None
        #: names of the files that lay there before
        self._before: frozenset[str] = frozenset()
        self.direction = pn.widgets.Select(label="Direction", options=["x", "y", "z"], width=100)
        self.side = pn.widgets.Select(label="Side", options=["tool", "workpiece"], width=140)
        self.columns = pn.widgets.TextInput(
            label="Columns, where the files have no heading", width=330,
            placeholder="time [s],force [N],acceleration [m/s^2]",
        )  # fmt: skip
        self.records: dict[str, pn.widgets.Checkbox] = {}
        #: records that a person has ticked or unticked
        self._by_hand: dict[str, bool] = {}
        self._record_list = pn.Column()
        self._heading = pn.pane.Markdown("")
        self.joined = wrapped_text("", 560)
        self.remove_all = pn.widgets.Button(label="Remove all records")
        self.into_case = pn.widgets.Button(label="Modes into the case", color="primary",
                                           disabled=True)  # fmt: skip
        self.automatic = pn.widgets.Button(label="Poles found automatically")
        self.picked = pn.widgets.Button(label="Fit the picked poles")
        self.message = wrapped_text(_FIRST_STEP)
        self.same_call = pn.pane.Str("", width=900, styles=CODE)
        self.modes = pn.pane.HTML("", width=700)
        self.tables = table_buttons(self.mode_table, "modes")
        for button in self.tables:
            button.disabled = True
        self._files = pn.FlexBox(min_width=860)
        self.figures = ModalTestFigures()
        self._results = self._make_results()
        self.computations = Computations(lambda text: self._later(text))
        self.into_case.on_click(lambda _: self.put_into_case())
        self.automatic.on_click(lambda _: self.fit())
        self.picked.on_click(lambda _: self.fit_picked())
        self.remove_all.on_click(lambda _: self.remove_files())
        for widget in (self.direction, self.side, self.columns):
            widget.param.watch(lambda _: self._options_changed(), "value")

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        return pn.Column(
            pn.Row(self.upload, pn.Column(pn.Row(self.direction, self.side), self.columns)),
            self.message,
            self._results,
        )

    def _make_results(self) -> pn.Column:
        """Pictures, modes and records; nothing is shown before the first fit."""
        drawn = self.figures
        return pn.Column(
            pn.Row(
                pn.Column(
                    picture(drawn.magnitude, "frf"), picture(drawn.phase, "phase"),
                    picture(drawn.coherence, "coherence"),
                ),
                pn.Column(
                    picture(drawn.stabilisation, "stabilisation"),
                    pn.Row(self.picked, self.automatic),
                    self.modes,
                    pn.Row(*self.tables),
                    self.into_case,
                    self._heading,
                    self.joined,
                    self._record_list,
                    self.remove_all,
                ),
            ),
            self.same_call,
            self._files,
            visible=False,
        )  # fmt: skip

    def take(self, files: Mapping[str, bytes]) -> None:
        """Write uploaded files beside the case and fit modes to them."""
        name = self._dropped_into or self._folder_name()
        try:
            changed = self._changed(name, files)
            self._session.store(name, files, readable_extensions())
        except InputError as error:
            self.message.object = self._session.short(error)
            return
        if name != self._folder_name():
            self.upload.forget()
            names = ", ".join(sorted(files))
            self.message.object = f"{names}: in {name}, the direction as they were dropped"
            return
        self._by_hand = {key: tick for key, tick in self._by_hand.items() if key not in changed}
        self.files = self._files_in(name)
        self.joined.object = _told_of_joining(set(files) - self._before, self._before)
        self.fit()

    def remove_files(self) -> None:
        """Take all files out of those of the direction: what is dropped next stands alone."""
        names = [one.name for one in self.files]
        self.upload.forget()
        self.remove(*names)

    def remove(self, *names: str) -> None:
        """Take files out of those of the direction; they are kept in a folder beside."""
        folder = self._folder_name()
        gone = [one for one in self._files_in(folder) if one.name in names]
        if not gone:
            return
        kept_in = self._session.put_aside(gone)
        self._before -= {one.name for one in gone}
        self._begin_anew()
        self.open_folder()
        if not self.files:
            self.computations.cancel()
            self._fitted.pop((self.side.value, self.direction.value), None)
            self._results.visible = False
            self.message.object = f"{_counted(len(gone))} moved to {kept_in}; {_FIRST_STEP}"

    def _drop_begins(self, _: str) -> None:
        """Note what lies in the folder; a busy page pauses between two files of one drop."""
        late = self._dropped_into == self._folder_name() and self.upload.pause() < LATE
        self._dropped_into = self._folder_name()
        if not late:
            self._before = frozenset(one.name for one in self._files_in(self._dropped_into))

    def _changed(self, folder: str, files: Mapping[str, bytes]) -> set[str]:
        """Names of files that are new in a folder, or others than those of the name there."""
        there = {one.name: one for one in self._files_in(folder)}
        return {name for name, content in files.items()
                if name not in there or there[name].read_bytes() != content}  # fmt: skip

    def _files_in(self, folder: str) -> list[Path]:
        """Files of a folder that may be records or FRFs."""
        return [one for one in sorted(self._session.path(folder).glob("*"))
                if one.suffix.lower() in readable_extensions() and one.is_file()]  # fmt: skip

    def open_folder(self) -> None:
        """Take up the records that lie in the folder of the direction, as of a session before."""
        self.files = self._files_in(self._folder_name())
        if self.files:
            self.fit()

    def _begin_anew(self) -> None:
        """Forget what was found and ticked of the files before."""
        self.files, self.records, self.test, self._by_hand = [], {}, None, {}
        self._record_list.objects, self.joined.object = [], ""
        self._fitting = {}  # what is fitted still is of the files before

    def fit(self, poles: list[tuple[float, float]] | None = None) -> None:
        """Fit modes to the records that are used, at all poles or at those given."""
        if not self.files:
            self.message.object = "no file yet: drop hammer records or FRFs"
            return
        self.poles = poles or []
        self.into_case.disabled = True
        self.message.object = "fitting modes ..."
        arguments = self._arguments()
        self._fitting = arguments
        self._hold_direction(True)
        self.computations.start(Computation(lambda go_on: self._fit(arguments, go_on), True))

    def _hold_direction(self, held: bool) -> None:
        """Keep direction and side as they are while a fit for them runs."""
        for chosen in (self.direction, self.side):
            chosen.disabled = held

    def mode_table(self) -> PageTable:
        """Return the modes that were fitted."""
        found = () if self.test is None else self.test.fit.identified
        return PageTable(_HEADINGS, [
            (mode.frequency, mode.damping, mode.mass, f"{mode.fit_error:.1%}", mode.warning)
            for mode in found
        ])  # fmt: skip

    def fit_picked(self) -> None:
        """Fit modes at the poles that are picked."""
        poles = self.figures.picked_poles()
        if not poles:
            self.message.object = (
                "no pole is picked: click poles of the diagram, with shift several"
            )
            return
        self.fit(poles)

    def overrule(self, record: str, used: bool) -> None:
        """Use a record, or leave it out, whatever was found."""
        self.records[record].value = used

    def put_into_case(self) -> None:
        """Put the modes of every direction that was fitted into the open case.

        They take the place of those along the same direction and side.
        """
        tables: list[dict[str, Any]] = []
        written = []
        for (side, direction), test in self._fitted.items():
            text = test.to_toml()
            modes = tomlkit.parse(text).unwrap().get("structure", {}).get("mode", [])
            if modes:
                written.append(f"modes-{direction}.toml" if side == "tool"
                               else f"modes-{side}-{direction}.toml")  # fmt: skip
                self._session.path(written[-1]).write_text(text, encoding="utf-8")
            tables += modes
        if not tables:
            self.message.object = "no mode with a mass: nothing goes into the case"
            return
        if not self._session.name:
            self.message.object = (
                f"written: {', '.join(written)}; the new case of the view Case takes them up"
            )
            self._taken()
            return
        try:
            self._session.set_modes(tables)
        except InputError as error:
            self.message.object = self._session.short(error)
            return
        self.message.object = (
            f"{len(tables)} modes are in {self._session.name}; it is not saved yet"
        )
        self._taken()

    def _folder_name(self) -> str:
        return f"taps-{self.side.value}-{self.direction.value}"

    def _options_changed(self) -> None:
        if self.files and self.files[0].parent == self._session.path(self._folder_name()):
            self.fit()  # with other columns
            return
        self.upload.forget()  # those are of the direction before
        self._begin_anew()
        self._hold_direction(False)
        self._results.visible = False
        self.message.object = f"no file of {self.side.value}, {self.direction.value} yet"
        self.open_folder()

    def _arguments(self) -> dict[str, Any]:
        """Arguments of `chatter.modes` for what is chosen."""
        columns = self.columns.value.strip() or None
        hammered = any(is_hammer_record(one, columns) for one in self.files)
        found: dict[str, Any] = {"direction": self.direction.value, "side": self.side.value}
        left_out = {name for name, used in self._by_hand.items() if not used}
        kept = set(self._by_hand) - left_out
        if hammered:
            bad = {name for name, why in self._reasons().items() if why.startswith("unreadable")}
            found["paths"] = (
                [one for one in self.files if one.name not in left_out | bad]
                if left_out - bad
                else self.files[0].parent
            )
            found["keep"] = sorted(kept)
            found["columns"] = columns
        else:
            found["paths"] = [one for one in self.files if one.name not in left_out]
        if self.poles:
            found["poles"] = self.poles
        return {key: value for key, value in found.items() if value not in (None, [])}

    def _reasons(self) -> dict[str, str]:
        """Record -> why the examination leaves it out, or would."""
        if self.test is None or self.test.hammer is None:
            return {}
        found: dict[str, str] = {}
        for one in (*self.test.hammer.excluded, *self.test.hammer.kept):
            told = f"{one.fault.replace('_', ' ')}: {one.reason}"
            found[one.record] = f"{found[one.record]}; {told}" if one.record in found else told
        return found

    def _fit(self, arguments: Mapping[str, Any], go_on: Progress) -> None:
        try:
            self._fit_and_draw(arguments, go_on)
        finally:
            if self._fitting is arguments:  # no later one has begun
                self._show(lambda: self._hold_direction(False))

    def _fit_and_draw(self, arguments: Mapping[str, Any], go_on: Progress) -> None:
        try:
            test = chatter.modes(**arguments)
        except InputError as error:
            told = self._session.short(str(error))
            self._show(lambda: setattr(self.message, "object", told))
            return
        go_on(0, 0)
        folder = self._session.results(f"modes-{arguments['direction']}")
        test.save(folder)
        go_on(0, 0)
        self._show(lambda: self._draw(test, arguments, folder))

    def _draw(self, test: ModalTest, arguments: Mapping[str, Any], folder: Path) -> None:
        self._fitted[arguments["side"], arguments["direction"]] = test
        if self._fitting is not arguments:
            return
        self.test = test
        self._results.visible = True
        self.figures.draw(test)
        self._list_records(test)
        self.modes.object = as_html(self.mode_table())
        for button in self.tables:
            button.disabled = False
        self.into_case.disabled = not test.fit.modes
        self._files.objects = downloads(folder)
        self.same_call.object = self._same_call(arguments)
        self.message.object = self._session.short("\n".join(test.notes))

    def _list_records(self, test: ModalTest) -> None:
        """One line a file: used or not, and why."""
        reasons = self._reasons()
        used = (
            {one.name for one in self.files if self._by_hand.get(one.name, True)}
            if test.hammer is None
            else set(test.hammer.used)
        )
        self._heading.object = (
            f"**Records of {self.side.value}, {self.direction.value}** (a tick: it is used)"
        )
        rows = []
        for name in (one.name for one in self.files):
            box = pn.widgets.Checkbox(label=name, value=name in used, width=150)
            box.param.watch(lambda event, name=name: self._ticked(name, event.new), "value")
            left_out = "" if box.value else "left out by hand"
            self.records[name] = box
            rows.append(pn.Row(box, wrapped_text(reasons.get(name, left_out), 440)))
        self._record_list.objects = rows

    def _ticked(self, name: str, used: bool) -> None:
        """Use a file, or leave it out, as a person wants it."""
        self._by_hand[name] = used
        if used and name not in self._reasons():
            del self._by_hand[name]  # as it is without a person
        self.fit(self.poles)

    def _same_call(self, arguments: Mapping[str, Any]) -> str:
        given = dict(arguments)
        paths = given.pop("paths")
        listed_paths = paths if isinstance(paths, list) else [paths]
        names = [self._session.short(one) for one in listed_paths]
        words = ["chatter", "modes", *names]
        for key in ("direction", "side", "columns"):
            words += [f"--{key}", given[key]] if key in given else []
        words += [part for one in given.get("keep", ()) for part in ("--keep", one)]
        words += [
            part for f, d in given.get("poles", ()) for part in ("--pole", f"{f:g}", f"{d:g}")
        ]
        called = names[0] if len(names) == 1 else names
        listed = "".join(f", {key}={value!r}" for key, value in given.items())
        return f"{shlex.join(words)}\nchatter.modes({called!r}{listed})"

    def _later(self, text: str) -> None:
        told = self._session.short(text)
        self._show(lambda: setattr(self.message, "object", told))


def _counted(files: int) -> str:
    return "1 file" if files == 1 else f"{files} files"


def _told_of_joining(dropped: set[str], before: frozenset[str]) -> str:
    """Say which files came to which; empty where there were none before."""
    if not dropped or not before:
        return ""
    return (
        f"{', '.join(sorted(dropped))}: judged together with the {_counted(len(before))} that lay "
        "here before. Untick what does not belong to this test, or remove all and drop anew."
    )
