"""Stability of the open case: its diagram, another case beside it, optimum and uncertainty."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import panel as pn

from chatter.app.stated_units import in_stated_unit
from chatter.app.workbench.long_work import LongWork
from chatter.app.workbench.other_machine import with_other_machine
from chatter.app.workbench.session import Session, readable_extensions
from chatter.app.workbench.stability_view import StabilityView
from chatter.app.workbench.studies import STUDIES, run_study
from chatter.app.workbench.table_files import table_of
from chatter.app.workbench.upload import dropper
from chatter.description.case import load
from chatter.description.errors import InputError

_NONE = "(none)"


class StabilityTab:
    """Diagrams of the open case.

    Parameters
    ----------
    session : Session
    show : callable
        Called with a function that changes the page, from another thread.
    """

    def __init__(
        self,
        session: Session,
        show: Callable[[Callable[[], None]], None],
        method: str | None = None,
    ) -> None:
        self._session, self._show, self._method = session, show, method
        self._shown_text: tuple[str, str] | None = None
        self.diagram: StabilityView | None = None
        self.beside: StabilityView | None = None
        self.other = pn.widgets.Select(label="Case beside it", options=[_NONE], width=220)
        self.keep = pn.widgets.Button(label="Sliders into the case")
        self.optimum = pn.widgets.Button(label="Optimum")
        self.uncertainty = pn.widgets.Button(label="Uncertainty band")
        self.upload = dropper(self.take_frfs, "FRF files in place of the modes")
        self.frf_files = pn.Card(title="FRF files", collapsed=True, width=460)
        self.work = LongWork(session.root, show)
        self.message = self.work.message
        self._diagram, self._beside = pn.Column(), pn.Column()
        self.keep.on_click(lambda _: self.keep_sliders())
        self.optimum.on_click(lambda _: self.study("optimum"))
        self.uncertainty.on_click(lambda _: self.study("uncertainty"))
        self.other.param.watch(lambda _: self._compare(), "value")
        self.frf_files.param.watch(lambda _: self._show_upload(), "collapsed")

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        return pn.Column(
            pn.Row(self.keep, self.optimum, self.uncertainty, self.work.cancel_button, self.other),
            self.message,
            pn.Row(self._diagram, self._beside),
            self.frf_files,
        )

    def refresh(self) -> None:
        """Show the open case as it stands; nothing is done where that is shown already."""
        session = self._session
        self.other.options = [_NONE, *session.case_names()]
        stands = session.name, session.text
        if stands == self._shown_text or not session.name:
            return
        self._shown_text = stands
        self._end_diagrams()
        try:
            case = session.sound_case()
            self.diagram = StabilityView(case, session.name, self._show, self._method)
        except InputError as error:
            self.work.show_message(str(error))
            self._diagram.objects = []
            return
        self.message.object = ""
        self._diagram.objects = [self.diagram.__panel__()]
        self._compare()

    def keep_sliders(self) -> None:
        """Put the values of the sliders that were moved into the case."""
        if self.diagram is None:
            return
        changes = self.diagram.patch()
        if not changes:
            self.message.object = "no slider was moved"
            return
        session = self._session
        try:
            case = session.sound_case()
            changed = {path: in_stated_unit(case, path, value) for path, value in changes.items()}
            patched, machine = with_other_machine(session, case, changed)
            session.set_text(patched.to_toml())
        except InputError as error:
            self.work.show_message(str(error))
            return
        beside = f"; its machine is {machine}, a new file" if machine else ""
        told = f"{', '.join(changes)}: in the case, which is not saved yet{beside}"
        self.message.object = told

    def take_frfs(self, files: Mapping[str, bytes]) -> None:
        """Let uploaded FRFs take the place of the modes of the case."""
        session = self._session
        try:
            session.sound_case()
            folder = session.store("frfs", files, readable_extensions())
            names = [Path(os.path.relpath(folder / name, session.folder)).as_posix()
                     for name in sorted(files)]  # fmt: skip
            gone = [(f"structure.{key}", None) for key in ("mode", "machine")]
            session.set_values([*gone, ("structure.frf", names)])
        except InputError as error:
            self.work.show_message(str(error))
        else:
            self.work.show_message(f"{', '.join(sorted(files))}: in place of the modes of the "
                                   "case, which is not saved yet")  # fmt: skip

    def study(self, name: str) -> None:
        """Compute the optimum or the uncertainty of the case and draw it into the diagram."""
        try:
            case = self._session.case_text
        except InputError as error:
            self.work.show_message(str(error))
            return
        folder, drawn = self._session.results(name), self.diagram
        label = STUDIES[name].label

        def draw() -> None:
            if drawn is not None:
                _DRAWN[name](drawn, folder)

        arguments = (name, case, STUDIES[name].options, folder)
        told = f"{label}: its tables are in the view Studies"
        if drawn is not None and drawn.moved():
            told += "; it is of the case as it is, without the sliders that were moved"
        self.work.start(run_study, arguments, draw, told)

    def end(self) -> None:
        """Give up what is computed."""
        self.work.computations.end()
        self._end_diagrams()

    def _show_upload(self) -> None:
        """Put the dropper on the page only while it is open: it measures itself in every frame."""
        self.frf_files.objects = [] if self.frf_files.collapsed else [self.upload]

    def _end_diagrams(self) -> None:
        for view in (self.diagram, self.beside):
            if view is not None:
                view.computations.end()
        self.diagram = self.beside = None

    def _compare(self) -> None:
        if self.beside is not None:
            self.beside.computations.end()
        self.beside, self._beside.objects = None, []
        name = self.other.value
        if self.diagram is not None:
            self.diagram.make_room(name not in (None, _NONE))
        if self.diagram is None or name in (None, _NONE):
            return
        try:
            case = load(self._session.path(name))
            self.beside = StabilityView(case, name, self._show, self._method, self.diagram)
        except InputError as error:
            self.work.show_message(str(error))
            return
        self._beside.objects = [self.beside.diagram_alone()]


def _draw_band(view: StabilityView, folder: Path) -> None:
    table = table_of(folder / "uncertainty.csv")
    by_heading = dict(zip(table.headings, zip(*table.rows, strict=True), strict=True))
    depths = [key for key in by_heading if key.startswith("limit_")]
    deepest = view.sliders["lobes.depths.to"].value
    low, high = (
        [value if isinstance(value, float) else deepest for value in by_heading[key]]
        for key in (depths[0], depths[-1])
    )
    view.show_band(list(by_heading["spindle_speed [rpm]"]), low, high)


def _draw_optimum(view: StabilityView, folder: Path) -> None:
    summary: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    best = summary["best"]
    if best is not None:
        view.mark_optimum(best["spindle_speed_rpm"], best["axial_depth_mm"])


_DRAWN = {"uncertainty": _draw_band, "optimum": _draw_optimum}
