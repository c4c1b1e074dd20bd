"""Machine: its FRFs at rest, moving and in the cut, contour errors, mode shapes that move."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

import chatter
from chatter.app.workbench.long_work import LongWork
from chatter.app.workbench.picture_files import legend_above, picture
from chatter.app.workbench.result_panel import result_panel, same_call
from chatter.app.workbench.session import Session
from chatter.app.workbench.studies import run_machine
from chatter.description.errors import InputError
from chatter.plots.mode_shapes import SHARE, isometric

_FRAMES, _INTERVAL = 24, 50  # of a period of the animation, and ms from one to the next


class MachineView:
    """A machine file of the folder.

    Parameters
    ----------
    session : Session
    show : callable
        Called with a function that changes the page, from another thread.
    """

    def __init__(self, session: Session, show: Callable[[Callable[[], None]], None]) -> None:
        self._session = session
        self._shapes: dict[str, Any] = {}
        self.file = pn.widgets.Select(label="Machine", options=[], width=260)
        self.tests = pn.widgets.MultiSelect(label="FRFs (none: all)", options=[], width=260, size=6)
        self.move = pn.widgets.Select(label="Move", options=[], width=260)
        self.frf_button = pn.widgets.Button(label="FRFs", color="primary")
        self.move_button = pn.widgets.Button(label="Move", color="primary")
        self.shapes_button = pn.widgets.Button(label="Mode shapes", color="primary")
        self.mode = pn.widgets.IntSlider(label="Mode", start=1, end=2, value=1, width=260)
        self.player = pn.widgets.Player(
            label="Phase", start=0, end=_FRAMES - 1, value=0, interval=_INTERVAL,
            loop_policy="loop", width=320, show_loop_controls=False,
        )  # fmt: skip
        self.frequency = pn.pane.Str("")
        self.rest = ColumnDataSource({"xs": [], "ys": []})
        self.moved = ColumnDataSource({"xs": [], "ys": []})
        self._figure = self._shape_figure()
        #: shown once there are shapes: above the results it would only take their room
        self._animation = pn.Column(
            pn.Row(self.mode, self.frequency),
            self.player,
            picture(self._figure, "mode-shape"),
            visible=False,
        )
        self.work = LongWork(session.root, show)
        self.call = pn.Column()
        #: what each button has left, the newest above
        self._left: dict[str, list[Any]] = {}
        self._results = pn.Column()
        self.frf_button.on_click(lambda _: self.start("frf"))
        self.move_button.on_click(lambda _: self.start("move"))
        self.shapes_button.on_click(lambda _: self.start("mode_shapes"))
        self.file.param.watch(lambda _: self._opened(), "value")
        for chosen in (self.tests, self.move):
            chosen.param.watch(lambda _: self._show_calls(), "value")
        for widget in (self.mode, self.player):
            widget.param.watch(lambda _: self.draw(), "value")
        self.refresh()

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        choice = pn.Column(
            self.file, self.tests, self.frf_button, self.move, self.move_button, self.shapes_button
        )
        return pn.Column(
            pn.Row(self.work.cancel_button, self.work.progress),
            self.work.message,
            pn.Row(choice, self._animation),
            self.call,
            self._results,
        )

    def refresh(self) -> None:
        """Offer the machine files that are there now."""
        found = self._session.machine_names()
        self.file.options = found
        if self.file.value not in found:
            self.file.value = next(iter(found), None)

    def start(self, name: str) -> None:
        """Compute "frf", "move" or "mode_shapes" of the machine as it is chosen."""
        if self.file.value is None:
            self.work.show_message(
                "no machine file in the folder; chatter examples machine-gantry has one"
            )
            return
        tests = {"frf": list(self.tests.value), "move": [self.move.value]}.get(name, [])
        if tests == [None]:
            self.work.show_message(f"{self.file.value}: has no [move.NAME]")
            return
        call = self._call(name, tests)
        folder = self._folder(name)
        self.call.objects = [same_call(call)]
        arguments = (name, self._session.path(self.file.value), call, tests, folder)
        self.work.start(run_machine, arguments, lambda: self._done(name))

    def draw(self) -> None:
        """Draw the mode at the phase that is chosen."""
        if not self._shapes:
            return
        points, lines, place = self._shapes["points"], self._shapes["lines"], self.mode.value - 1
        scale = SHARE * float(np.linalg.norm(np.ptp(points, axis=0)))
        swing = scale * np.sin(2.0 * np.pi * self.player.value / _FRAMES)
        flat = isometric(points + swing * self._shapes["shapes"][place]) * 1e3
        self.moved.data = _segments(flat, lines)
        self.frequency.object = f"{self._shapes['frequency'][place]:.4g} Hz"

    def _call(self, name: str, tests: list[str]) -> dict[str, str]:
        file = self.file.value
        loaded = f"chatter.load_machine({file!r})"
        if name == "mode_shapes":
            return {
                "command": shlex.join(["chatter", "mode-shapes", file]),
                "python": f"chatter.mode_shapes({loaded})",
            }
        words = ["chatter", name, file, *(part for one in tests for part in ("--only", one))]
        given = repr(tests[0]) if name == "move" else repr(tests) if tests else ""
        return {
            "command": shlex.join(words),
            "python": f"chatter.{name}({loaded}{', ' + given if given else ''})",
        }

    def _folder(self, name: str) -> Path:
        stem = str(self.file.value).removesuffix(".toml").replace("/", "-")
        return self._session.path(f"results/{stem}/{name}")

    def _opened(self) -> None:
        self.tests.options, self.move.options = [], []
        self._shapes, self.rest.data, self.moved.data = {}, _nothing(), _nothing()
        self._animation.visible = False
        self._left, self._results.objects = {}, []
        if self.file.value is None:
            return
        try:
            machine = chatter.load_machine(self._session.path(self.file.value), self.file.value)
        except InputError as error:
            self.work.show_message(str(error))
            return
        self.tests.options, self.move.options = list(machine.frf), list(machine.move)
        self.move.value = next(iter(machine.move), None)
        for name in ("mode_shapes", "move", "frf"):
            self._done(name)
        self._show_calls()

    def _show_calls(self) -> None:
        """Show what gives the same as each button."""
        if self.file.value is None:
            return
        offered = {"frf": list(self.tests.value), "mode_shapes": []}
        if self.move.value is not None:
            offered["move"] = [self.move.value]
        self.call.objects = [same_call(self._call(name, one)) for name, one in offered.items()]

    def _done(self, name: str) -> None:
        folder = self._folder(name)
        if name == "mode_shapes":
            self._take_shapes(folder / "mode-shapes.npz")
        found = result_panel(folder)
        if found:
            self._left.pop(name, None)
            self._left = {name: found, **self._left}
            self._results.objects = [part for parts in self._left.values() for part in parts]

    def _take_shapes(self, path: Path) -> None:
        if not path.is_file():
            return
        with np.load(path, allow_pickle=False) as arrays:
            self._shapes = dict(arrays)
        flat = isometric(self._shapes["points"]) * 1e3
        self.rest.data = _segments(flat, self._shapes["lines"])
        middle, reach = flat.mean(axis=0), 0.65 * float(np.ptp(flat, axis=0).max())
        self._figure.x_range.update(start=middle[0] - reach, end=middle[0] + reach)
        self._figure.y_range.update(start=middle[1] - reach, end=middle[1] + reach)
        self.mode.param.update(end=max(2, len(self._shapes["frequency"])), value=1)
        self.player.value = _FRAMES // 4
        self._animation.visible = True
        self.draw()

    def _shape_figure(self) -> Any:
        drawn = figure(width=560, height=520, x_range=(0, 1), y_range=(0, 1),
                       tools="pan,wheel_zoom,reset")  # fmt: skip
        drawn.multi_line("xs", "ys", source=self.rest, color="#BBBBBB", legend_label="at rest")
        drawn.multi_line("xs", "ys", source=self.moved, color="#0072B2", line_width=2,
                         legend_label="in the mode")  # fmt: skip
        drawn.xaxis.axis_label = drawn.yaxis.axis_label = "[mm], oblique view"
        legend_above(drawn)
        return drawn


def _nothing() -> dict[str, list[Any]]:
    return {"xs": [], "ys": []}


def _segments(flat: Any, lines: Any) -> dict[str, Any]:
    ends = flat[lines]  # (lines, 2, 2)
    return {"xs": list(ends[:, :, 0]), "ys": list(ends[:, :, 1])}
