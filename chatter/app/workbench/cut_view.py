"""Cut: a simulated cut with its signals, surface, workpiece as it is carved, and sound."""

from __future__ import annotations

import io
import math
import shlex
from collections.abc import Callable
from typing import Any

import numpy as np
import panel as pn
import scipy.io.wavfile
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

import chatter
from chatter.app.workbench.computations import Computation, Computations
from chatter.app.workbench.picture_files import legend_above, picture
from chatter.app.workbench.result_panel import downloads, result_panel, same_call, table_buttons
from chatter.app.workbench.session import Session
from chatter.app.workbench.studies import save_result
from chatter.app.workbench.surface_figure import SurfaceFigure
from chatter.app.workbench.table_files import PageTable, as_html
from chatter.app.workbench.wrapped_text import wrapped_text
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.progress import Progress
from chatter.plots.simulation import moving_plane, once_a_revolution, spectrum
from chatter.plots.workpiece import plan_view
from chatter.simulation.carving_history import removal_times
from chatter.simulation.result import SimulationResult
from cutting.chip.discrete_chip import DiscreteCut

_AXES = "xyz"
_COLOURS = ("#0072B2", "#E69F00", "#009E73")
#: points of a curve that a screen shows
_MOST_POINTS = 6000
_FRAMES = 100
_SOUND_RATE, _SHORTEST_SOUND, _LONGEST_SOUND = 44_100, 2.0, 20.0  # Hz, s, s
_CHANGED = "the case was changed after this cut was simulated"
_CARVE = {"simulation.chip": "dexel"}


class CutView:
    """The cut of the open case in the time domain.

    Parameters
    ----------
    session : Session
    show : callable
        Called with a function that changes the page, from another thread.
    """

    def __init__(self, session: Session, show: Callable[[Callable[[], None]], None]) -> None:
        self._session, self._show = session, show
        self.result: SimulationResult | None = None
        self._removed: Any = None
        self._shown: tuple[str, str] | None = None
        #: name and text of the case that the cut on the page is of
        self._simulated = ("", "")
        self.start_button = pn.widgets.Button(label="Simulate", color="primary")
        self.carve = pn.widgets.Checkbox(label="carve the workpiece (dexels)", value=False)
        self.cancel_button = pn.widgets.Button(label="Cancel")
        self.progress = pn.indicators.Progress(value=0, max=100, width=300, active=False)
        self.message = wrapped_text()
        self.player = pn.widgets.Player(
            label="Time", start=0, end=_FRAMES, value=_FRAMES, interval=80, loop_policy="once",
            width=400, show_loop_controls=False,
        )  # fmt: skip
        self.clock = pn.pane.Str("")
        self.surface = SurfaceFigure()
        self.summary = pn.pane.HTML("", width=520)
        self.tables = table_buttons(self.numbers, "cut")
        self.sound = pn.pane.Audio(None, name="tool velocity as sound")
        self.sound_file = pn.widgets.FileDownload(
            callback=self._sound_file, filename="cut.wav", label="Sound (WAV)", disabled=True
        )
        axes = [f"{kind}{axis}" for kind in ("F", "") for axis in _AXES]
        self.signals = ColumnDataSource({name: [] for name in ("time", *axes)})
        self.spectrum = ColumnDataSource({name: [] for name in ("f", *_AXES)})
        self.section = ColumnDataSource({"x": [], "y": []})
        self.orbit = ColumnDataSource({"x": [], "y": []})
        self.workpiece = ColumnDataSource({"image": [], "x": [], "y": [], "dw": [], "dh": []})
        self.tool = ColumnDataSource({"x": [], "y": []})
        self._figures = self._make_figures()
        # nothing is shown before a cut was simulated, and no workpiece where none is carved
        self._pictures, self._carved = pn.Column(visible=False), pn.Column(visible=False)
        self.call, self._files, self._before = pn.Column(), pn.FlexBox(min_width=860), pn.Column()
        self.computations = Computations(self._show_message)
        self.start_button.on_click(lambda _: self.start())
        self.cancel_button.on_click(lambda _: self.computations.cancel())
        self.carve.param.watch(lambda _: self._show_call(), "value")
        self.player.param.watch(lambda _: self.draw_time(), "value")

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        force, moved, lines, section, workpiece = (
            picture(drawn, name) for name, drawn in self._figures.items()
        )
        self._carved = workpiece
        self._pictures.objects = [
            pn.Row(self.player, self.clock),
            pn.Row(pn.Column(force, moved, lines), pn.Column(workpiece, section)),
            pn.Row(self.surface.__panel__(),
                   pn.Column(self.summary, pn.Row(*self.tables), self.sound, self.sound_file)),
        ]  # fmt: skip
        return pn.Column(
            pn.Row(self.start_button, self.carve, self.cancel_button, self.progress),
            self.message,
            self.call,
            self._pictures,
            self._files,
            self._before,
        )

    def refresh(self) -> None:
        """Show what was simulated of the open case before, where nothing newer is shown."""
        session = self._session
        stands = session.name, session.text
        if stands == self._shown or not session.name:
            return
        self._shown = stands
        self._show_call()
        if self.result is not None and session.name != self._simulated[0]:
            self._clear()
        if self.result is None:
            self._before.objects = result_panel(session.results("simulate"))
        elif session.text != self._simulated[1]:
            self.message.object = _CHANGED

    def _clear(self) -> None:
        """Show no cut: what is shown is of another case."""
        self.result, self._pictures.visible, self.message.object = None, False, ""
        self._files.objects, self.sound_file.disabled = [], True

    def start(self) -> None:
        """Simulate the cut."""
        try:
            case = self._session.sound_case()
            case.require("tool", "material", "cut", "structure")
        except InputError as error:
            self._show_message(str(error))
            return
        changes = self._changes(case)
        call, folder = self._call(changes), self._session.results("simulate")
        of_what = self._session.name, self._session.text
        self.call.objects = [same_call(call)]

        def compute(go_on: Progress) -> None:
            def progress(done: int, total: int) -> None:
                go_on(done, total)
                self._report(done, total)

            try:
                result = chatter.simulate(case, changes, progress)
                go_on(0, 0)
                removed = _removal(result)
                save_result(result, folder, {"title": "Cut", **call})
                self._show(lambda: self._draw(result, removed, folder, of_what))
            finally:
                self._show(lambda: self.progress.param.update(value=0, active=False))

        self.message.object = "simulating ..."
        self.computations.start(Computation(compute, False))

    def _changes(self, case: Case) -> dict[str, str]:
        """What carving the workpiece changes in a case."""
        given = case.simulation
        carved = given is not None and given.chip in ("dexel", "voxel")
        return _CARVE if self.carve.value and not carved else {}

    def _show_call(self) -> None:
        """Show what gives the same, before it is asked for."""
        try:
            changes = self._changes(self._session.sound_case())
        except InputError:
            self.call.objects = []
            return
        self.call.objects = [same_call(self._call(changes))]

    def draw_time(self) -> None:
        """Show the cut at the time that is chosen: the window of the signals, the workpiece."""
        if self.result is None:
            return
        time = self.result.time
        now = float(time[-1]) * self.player.value / _FRAMES
        a_window = min(float(time[-1]), 3.0 * float(time[-1]) / max(self.result.revolutions, 3.0))
        self.clock.object = f"{now:.4g} s"
        if self.player.value < _FRAMES:
            self._figures["force"].x_range.update(start=max(0.0, now - a_window), end=now)
        else:
            self._figures["force"].x_range.update(start=0.0, end=float(time[-1]))
        self._draw_workpiece(now)

    def numbers(self) -> PageTable:
        """Return the numbers of the cut that is shown."""
        return _numbers(None if self.result is None else self.result.summary())

    def _report(self, done: int, total: int) -> None:
        value = min(100, round(100.0 * done / total)) if total else 0
        self._show(lambda: self.progress.param.update(value=value, active=True))

    def _call(self, changes: dict[str, str]) -> dict[str, str]:
        file = self._session.name
        words = ["chatter", "simulate", file]
        words += [part for path, one in changes.items() for part in ("--set", f"{path}={one}")]
        given = f", {changes!r}" if changes else ""
        return {
            "command": shlex.join(words),
            "python": f"chatter.simulate(chatter.load({file!r}){given})",
        }

    def _draw(
        self, result: SimulationResult, removed: Any, folder: Any, of_what: tuple[str, str]
    ) -> None:
        if of_what[0] != self._session.name:
            return  # another case was opened meanwhile; its files are kept
        self._simulated = of_what
        self.result, self._removed = result, removed
        self._pictures.visible, self._carved.visible = True, removed is not None
        self._before.objects = []
        told = result.summary()
        self.message.object = self._session.short(
            "\n".join([f"{told['verdict']}: {told['reason']}", *result.notes])
        )
        self._draw_signals(result)
        self._draw_motion(result)
        feed = result.case.cut.feed_per_tooth * result.case.tool.teeth
        self.surface.show(result.finish.walls, feed)
        self.sound.object, self.sound.sample_rate = sound_of(result), _SOUND_RATE
        self.sound_file.disabled = False
        self.summary.object = as_html(self.numbers())
        self._files.objects = downloads(folder)
        self.player.value = _FRAMES
        self.draw_time()

    def _draw_signals(self, result: SimulationResult) -> None:
        kept = _kept(np.linalg.norm(result.force, axis=1))
        columns = {"time": result.time[kept]}
        for number, axis in enumerate(_AXES):
            columns[f"F{axis}"] = result.force[kept, number]
            columns[axis] = result.displacement[kept, number] * 1e6
        self.signals.data = columns
        for name, values in (("force", result.force), ("motion", result.displacement * 1e6)):
            reach = 1.1 * float(np.abs(values).max()) or 1.0
            self._figures[name].y_range.update(start=-reach, end=reach)

    def _draw_motion(self, result: SimulationResult) -> None:
        rows, motion = result.settled, result.displacement * 1e6
        lines: dict[str, Any] = {"f": [], **{axis: [] for axis in _AXES}}
        if rows.stop - rows.start >= 16:
            for number, axis in enumerate(_AXES):
                lines["f"], lines[axis] = spectrum(result.time[rows], motion[rows, number])
        top = 3.0 * max((mode.frequency for mode in result.setup.modes), default=2000.0)
        shown = np.asarray(lines["f"]) <= top
        self.spectrum.data = {name: np.asarray(values)[shown] for name, values in lines.items()}
        self._figures["spectrum"].x_range.update(start=0.0, end=top)
        highest = max(float(np.max(self.spectrum.data[axis], initial=0.0)) for axis in _AXES)
        self._figures["spectrum"].y_range.update(
            start=1e-4 * (highest or 1.0), end=2.0 * (highest or 1.0)
        )
        plane = moving_plane(result)
        points = once_a_revolution(result, plane)
        self.section.data = {"x": points[:, 0], "y": points[:, 1]}
        section = self._figures["section"]
        section.xaxis.axis_label, section.yaxis.axis_label = (f"{_AXES[k]} [µm]" for k in plane)
        settled = motion[rows][:: max(1, (rows.stop - rows.start) // _MOST_POINTS)]
        self.orbit.data = {"x": settled[:, plane[0]], "y": settled[:, plane[1]]}

    def _draw_workpiece(self, now: float) -> None:
        if self._removed is None:
            self.workpiece.data = {name: [] for name in ("image", "x", "y", "dw", "dh")}
            return
        (x0, y0), (x1, y1), times = self._removed
        self.workpiece.data = {
            "image": [(times > now).astype(np.uint8)],
            "x": [1e3 * x0], "y": [1e3 * y0], "dw": [1e3 * (x1 - x0)], "dh": [1e3 * (y1 - y0)],
        }  # fmt: skip
        result = self.result
        x, y = 1e3 * result.setup.path.position_at(np.array([now]))[:, 0]
        turn, radius = np.linspace(0.0, 2.0 * np.pi, 90), 1e3 * result.setup.cutter.radius
        self.tool.data = {"x": x + radius * np.sin(turn), "y": y + radius * np.cos(turn)}
        drawn = self._figures["workpiece"]
        drawn.x_range.update(start=1e3 * x0, end=1e3 * x1)
        drawn.y_range.update(start=1e3 * y0, end=1e3 * y1)

    def _sound_file(self) -> io.BytesIO:
        content = io.BytesIO()
        scipy.io.wavfile.write(content, _SOUND_RATE, sound_of(self.result))
        content.seek(0)
        return content

    def _show_message(self, text: str) -> None:
        told = self._session.short(text)
        self._show(lambda: setattr(self.message, "object", told))

    def _make_figures(self) -> dict[str, Any]:
        force = _figure(620, 230, "time [s]", "force on the tool [N]")
        motion = _figure(620, 210, "time [s]", "displacement [µm]", x_range=force.x_range)
        lines = _figure(620, 230, "frequency [Hz]", "amplitude [µm]", y_axis_type="log")
        section = _figure(430, 300, "x [µm]", "y [µm]", match_aspect=True, x_range=None,
                          y_range=None)  # fmt: skip
        workpiece = _figure(430, 330, "x [mm]", "y [mm]")
        for axis, colour in zip(_AXES, _COLOURS, strict=True):
            force.line("time", f"F{axis}", source=self.signals, color=colour,
                       legend_label=f"F{axis}")  # fmt: skip
            motion.line("time", axis, source=self.signals, color=colour, legend_label=axis)
            lines.line("f", axis, source=self.spectrum, color=colour, legend_label=axis)
        section.line("x", "y", source=self.orbit, color="#C9D6DF", line_width=0.5)
        section.scatter("x", "y", source=self.section, size=4, color="#D55E00",
                        legend_label="once a revolution")  # fmt: skip
        workpiece.image("image", "x", "y", "dw", "dh", source=self.workpiece,
                        palette=["#FFFFFF", "#9FB4C0"])  # fmt: skip
        workpiece.line("x", "y", source=self.tool, color="#D55E00", legend_label="tool")
        for drawn in (force, motion, lines, section, workpiece):
            legend_above(drawn)
        return {"force": force, "motion": motion, "spectrum": lines, "section": section,
                "workpiece": workpiece}  # fmt: skip


def sound_of(result: SimulationResult) -> Any:
    """Velocity of the tool as sound, (n,) of int16 at 44.1 kHz; a short run is repeated.

    The settled part of the run, along the direction that moves most.
    """
    rows = result.settled
    time = result.time[rows]
    axis = int(np.argmax(np.ptp(result.displacement[rows], axis=0)))
    if len(time) < 4:
        return np.zeros(_SOUND_RATE, dtype=np.int16)
    velocity = np.gradient(result.displacement[rows, axis], time)
    even = np.arange(time[0], time[-1], 1.0 / _SOUND_RATE)[: int(_LONGEST_SOUND * _SOUND_RATE)]
    heard = np.interp(even, time, velocity - velocity.mean())
    # settled rows are whole revolutions, so that their repetition has no gap
    heard = np.tile(heard, max(1, math.ceil(_SHORTEST_SOUND * _SOUND_RATE / max(len(heard), 1))))
    largest = float(np.abs(heard).max()) or 1.0
    return np.round(0.8 * 32767.0 * heard / largest).astype(np.int16)


def _removal(result: SimulationResult) -> Any:
    """Corners of the plan of the workpiece, and when its cells go; None where none is carved."""
    cut = result.setup.groups[0]
    if not isinstance(cut, DiscreteCut):
        return None
    low, high, material = plan_view(cut.stock, 0)
    return low, high, removal_times(result, material, (low, high), 0)


def _kept(size: Any) -> Any:
    """Places of the rows that are drawn: of each interval the lowest and the highest."""
    if len(size) <= _MOST_POINTS:
        return np.arange(len(size))
    intervals = np.array_split(np.arange(len(size)), _MOST_POINTS // 2)
    ends = [(part[np.argmin(size[part])], part[np.argmax(size[part])]) for part in intervals]
    return np.unique(np.array(ends).ravel())


def _numbers(told: dict[str, Any] | None) -> PageTable:
    if told is None:
        return PageTable(("cut", "value"), [])
    location = told.get("surface_location_error_um")
    rows = [
        ("verdict", told["verdict"]),
        ("chatter frequency [Hz]", told["chatter_frequency_Hz"]),
        ("largest force [N]", told["peak_resultant_N"]),
        *((f"mean {name} [N]", value) for name, value in told["mean_force_N"].items()),
        ("largest displacement [um]", told["peak_displacement_um"]),
        ("mean power [W]", told["power"]["mean_W"]),
        ("surface location error [um]", location),
    ]
    return PageTable(("cut", "value"), rows)


def _figure(width: int, height: int, x: str, y: str, **options: Any) -> Any:
    ends = {"x_range": (0, 1), "y_range": (0.1, 1), **options}
    ends = {key: value for key, value in ends.items() if value is not None}
    drawn = figure(width=width, height=height, tools="pan,box_zoom,wheel_zoom,reset", **ends)
    drawn.xaxis.axis_label, drawn.yaxis.axis_label = x, y
    return drawn
