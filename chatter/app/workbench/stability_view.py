"""Stability: a diagram that follows sliders, and points of it simulated by a click."""

import csv
import io
import shlex
from collections.abc import Callable
from typing import Any

import panel as pn
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, HoverTool
from bokeh.plotting import figure

from chatter.app.live_case import LiveCase
from chatter.app.sliders import Slider
from chatter.app.workbench.computations import Computation, Computations
from chatter.description.case import Case
from chatter.description.progress import Progress

_STEPS = 400
_HEADING = ("spindle_speed [rpm]", "critical_depth [mm]", "chatter_frequency [Hz]", "bifurcation")


class StabilityView:
    """Diagram of a case with its sliders.

    Parameters
    ----------
    case : Case
        Of a tool, a material, a cut and a structure; InputError if it lacks one.
    file : str
        Its name, for the command that gives the same.
    show : callable
        Called with a function that changes the page, from the thread of the computations.
    """

    def __init__(self, case: Case, file: str, show: Callable[[Callable[[], None]], None]) -> None:
        self._live, self._file, self._show = LiveCase(case, None), file, show
        self._diagram: dict[str, Any] = {}
        self.sliders = {one.path: _widget(one) for one in self._live.sliders}
        self.limit = ColumnDataSource(
            {name: [] for name in ("speed", "depth", "stable", "frequency", "kind")}
        )
        self.operating = ColumnDataSource({"speed": [], "depth": [], "colour": []})
        self.motion = ColumnDataSource({"revolution": [], "low": [], "high": []})
        self.message, self.verdict, self.same_call = (_text() for _ in range(3))
        self.cancel = pn.widgets.Button(label="Cancel")
        self.table = pn.widgets.FileDownload(
            callback=self._table, filename="lobes.csv", label="Table (CSV)"
        )
        self.computations = Computations(lambda text: self._later(self.message, text))
        self.cancel.on_click(lambda _: self.computations.cancel())
        self._lobes, self._motion = self._lobes_figure(), self._motion_figure()
        for widget in self.sliders.values():
            widget.param.watch(lambda _: self.draw(), "value")
        self.draw()

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        groups = list(dict.fromkeys(one.group for one in self._live.sliders))
        cards = [
            pn.Card(
                *(self.sliders[one.path] for one in self._live.sliders if one.group == group),
                title=group,
                collapsed=index > 1,
                width=330,
            )
            for index, group in enumerate(groups)
        ]
        pictures = pn.Column(
            pn.Row(self.table, self.cancel),
            self.message,
            pn.pane.Bokeh(self._lobes),
            self.same_call,
            self.verdict,
            pn.pane.Bokeh(self._motion),
        )
        return pn.Row(pn.Column(*cards), pictures)

    def moved(self) -> dict[str, float]:
        """Values of the sliders that have been moved, by path."""
        return {
            one.path: self.sliders[one.path].value
            for one in self._live.sliders
            if self.sliders[one.path].value != one.value
        }

    def draw(self) -> None:
        """Draw the diagram of the values, first a coarse one."""
        values = self.moved()
        self.same_call.object = self._same_call(values)
        self.computations.start(
            Computation(lambda go_on: self._compute(values, "coarse", go_on), False),
            Computation(lambda go_on: self._compute(values, "fine", go_on), True),
        )

    def simulate(self, speed: float, depth: float) -> None:
        """Simulate the cut at a point of the diagram: speed in rpm, depth in mm."""
        values = self.moved()
        self.verdict.object = f"{speed:.0f} rpm, {depth:.3g} mm: computing ..."
        self.computations.start(
            Computation(lambda go_on: self._simulate(values, speed, depth, go_on), True)
        )

    def _compute(self, values: dict[str, float], stage: str, go_on: Progress) -> None:
        diagram = self._live.diagram(values, stage, go_on)
        self._show(lambda: self._draw(diagram))

    def _draw(self, diagram: dict[str, Any]) -> None:
        self._diagram, cut = diagram, diagram["operating"]
        none = float("nan")
        deepest = diagram["max_axial_depth_mm"]
        self.limit.data = {
            "speed": diagram["spindle_speed_rpm"],
            "depth": [found[0] if found else none for found in diagram["crossings_mm"]],
            "stable": [found[0] if found else deepest for found in diagram["crossings_mm"]],
            "frequency": [none if f is None else f for f in diagram["chatter_frequency_Hz"]],
            "kind": diagram["bifurcation"],
        }
        self.operating.data = {
            "speed": [cut["spindle_speed_rpm"]],
            "depth": [cut["axial_depth_mm"]],
            "colour": ["#2e7d32" if cut["stable"] else "#c62828"],
        }
        self._lobes.x_range.update(
            start=diagram["spindle_speed_rpm"][0], end=diagram["spindle_speed_rpm"][-1]
        )
        self._lobes.y_range.update(start=0.0, end=deepest)
        self.message.object = "; ".join(diagram["notes"])

    def _simulate(
        self, values: dict[str, float], speed: float, depth: float, go_on: Progress
    ) -> None:
        run = self._live.simulation(values, speed, depth, go_on)
        self._show(lambda: self._draw_run(run))

    def _draw_run(self, run: dict[str, Any]) -> None:
        self.motion.data = {
            "revolution": run["revolutions"],
            "low": run["lowest_um"],
            "high": run["highest_um"],
        }
        self._motion.yaxis.axis_label = f"tool, {run['direction']} [um]"
        self.verdict.object = (
            f"{run['spindle_speed_rpm']:.0f} rpm, {run['axial_depth_mm']:.3g} mm: "
            f"{run['verdict']} ({run['reason']})\nlargest force {run['peak_resultant_N']:.0f} N, "
            f"mean power {run['mean_power_W'] / 1e3:.2g} kW"
        )

    def _later(self, pane: pn.pane.Str, text: str) -> None:
        self._show(lambda: setattr(pane, "object", text))

    def _same_call(self, values: dict[str, float]) -> str:
        by_path = self._live.by_path
        texts = {path: by_path[path].text(value) for path, value in values.items()}
        for path in ("lobes.speeds.from", "lobes.speeds.to") if texts else ():
            texts.setdefault(path, by_path[path].text(self.sliders[path].value))
        words = ["chatter", "lobes", self._file]
        words += [word for path, text in texts.items() for word in ("--set", f"{path}={text}")]
        patch = f".patch({texts})" if texts else ""
        return f"{shlex.join(words)}\nchatter.lobes(chatter.load({self._file!r}){patch})"

    def _table(self) -> io.StringIO:
        text = io.StringIO()
        rows = self.limit.data
        columns = (rows["speed"], rows["depth"], rows["frequency"], rows["kind"])
        csv.writer(text).writerows([_HEADING, *zip(*columns, strict=True)])
        text.seek(0)
        return text

    def _lobes_figure(self) -> Any:
        drawn = figure(
            width=820, height=430, x_range=(0, 1), y_range=(0, 1), tools="pan,wheel_zoom,reset,save"
        )
        drawn.xaxis.axis_label, drawn.yaxis.axis_label = "spindle speed [rpm]", "axial depth [mm]"
        drawn.varea(
            "speed", 0.0, "stable", source=self.limit, color="#9ccc9c", fill_alpha=0.45,
            legend_label="stable",
        )  # fmt: skip
        line = drawn.line("speed", "depth", source=self.limit, line_width=2, color="#1f3b57",
                          legend_label="critical axial depth")  # fmt: skip
        drawn.scatter(
            "speed", "depth", source=self.operating, size=11, color="colour",
            legend_label="operating point",
        )  # fmt: skip
        told = [
            ("spindle speed", "@speed{0} rpm"),
            ("critical axial depth", "@depth{0.000} mm"),
            ("chatter frequency", "@frequency{0} Hz"),
            ("bifurcation", "@kind"),
        ]
        drawn.add_tools(HoverTool(renderers=[line], tooltips=told, mode="vline"))
        drawn.on_event(Tap, lambda event: self.simulate(event.x, event.y))
        return drawn

    def _motion_figure(self) -> Any:
        drawn = figure(width=820, height=230, tools="pan,wheel_zoom,reset,save")
        drawn.xaxis.axis_label, drawn.yaxis.axis_label = "revolution", "tool [um]"
        drawn.varea("revolution", "low", "high", source=self.motion, color="#5b84b1")
        return drawn


def _text() -> pn.pane.Str:
    return pn.pane.Str("", width=820, styles={"white-space": "pre-wrap"})


def _widget(one: Slider) -> pn.widgets.Widget:
    name = f"{one.label} [{one.unit}]" if one.unit else one.label
    ends: dict[str, Any] = {"value": one.value, "start": one.low, "end": one.high}
    if one.whole:
        return pn.widgets.IntSlider(label=name, **ends)
    step = (one.high - one.low) / _STEPS
    return pn.widgets.FloatSlider(label=name, step=step, format="0.[0000]", **ends)
