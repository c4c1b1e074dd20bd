"""Stability: a diagram that follows sliders, and points of it simulated by a click."""

import math
import shlex
from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, HoverTool
from bokeh.plotting import figure

from chatter.app.above_islands import above_islands
from chatter.app.depth_axis import steady_end_of_depth_axis
from chatter.app.live_case import LiveCase
from chatter.app.sliders import PROCESS, Slider, why_no_friction_slider
from chatter.app.workbench.compiling_note import reported_while_compiling
from chatter.app.workbench.computations import Computation, Computations
from chatter.app.workbench.curves_in_frame import CLIPPED, FAST, keep_in_frame
from chatter.app.workbench.legend_samples import put_samples_into_legend, set_style
from chatter.app.workbench.page_words import in_words_of_the_page
from chatter.app.workbench.picture_files import legend_above, picture
from chatter.app.workbench.result_panel import CODE, table_buttons
from chatter.app.workbench.session import without_folder
from chatter.app.workbench.table_files import PageTable
from chatter.app.workbench.wrapped_text import wrapped_text
from chatter.description.case import Case
from chatter.description.progress import Progress
from chatter.plots.style import ORANGE

_STEPS = 400
#: s after the last move of a slider until the fine diagram is begun: it would hold up the next move
_REST = 0.15
#: pixels
_WIDTH, _WIDTH_BESIDE = 820, 560
#: the handle goes to where it is put without gliding there: each frame of that would be painted
_AT_ONCE = ".noUi-state-tap .noUi-connect, .noUi-state-tap .noUi-origin {transition: none}"
#: height of the mark of a cut above the diagram, in that of the diagram
_EDGE = 0.97
_DOUBT = (
    "operating point: stability is not certain, as linear methods leave out what may decide it; "
    "a click on the point simulates it",
)
#: columns of what is drawn, along each axis
_ALONG_X, _ALONG_Y = ("speed", "left", "right"), ("depth", "stable", "low", "high")
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
    method : str, optional
        Stability method, as of `chatter.lobes`.
    beside : StabilityView, optional
        Another diagram, which this one shares its axes with.
    """

    def __init__(
        self,
        case: Case,
        file: str,
        show: Callable[[Callable[[], None]], None],
        method: str | None = None,
        beside: "StabilityView | None" = None,
    ) -> None:
        self._live, self._file, self._show = LiveCase(case, method), file, show
        self._method, self._beside = method, beside
        self._diagram: dict[str, Any] = {}
        self.top = 0.0  # mm
        self.sliders = {one.path: _widget(one) for one in self._live.sliders}
        self.limit = ColumnDataSource(
            {name: [] for name in ("speed", "depth", "stable", "frequency", "kind")}
        )
        # above islands of chatter
        self.regained = ColumnDataSource({"left": [], "right": [], "low": [], "high": []})
        self.further = ColumnDataSource({"speed": [], "depth": []})
        self.operating = ColumnDataSource({"speed": [], "depth": [], "colour": [], "marker": []})
        self.pockets = ColumnDataSource({"speed": [], "depth": [], "limit": [], "rate": []})
        self.optimum = ColumnDataSource({"speed": [], "depth": []})
        self.band = ColumnDataSource({"speed": [], "low": [], "high": []})
        self.motion = ColumnDataSource({"revolution": [], "low": [], "high": []})
        self.message, self.verdict = _text(), _text()
        self.same_call = wrapped_text(width=_WIDTH, styles=CODE)
        self.cancel = pn.widgets.Button(label="Stop")
        self.table, self.workbook = table_buttons(self.limits, "lobes")
        self.reset = pn.widgets.Button(label="Reset")
        self.computations = Computations(
            lambda text: self._later(self.message, in_words_of_the_page(text))
        )
        self.cancel.on_click(lambda _: self.computations.cancel())
        self.reset.on_click(lambda _: self.put_back())
        self._lobes, self._motion = self._lobes_figure(), self._motion_figure()
        # nothing is simulated before the first click
        self._motion_picture = picture(self._motion, "motion")
        self._motion_picture.visible = False
        self.make_room(beside is not None)
        for widget in self.sliders.values():
            widget.param.watch(lambda _: self.draw(), "value")
        self.draw()

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        groups = list(dict.fromkeys(one.group for one in self._live.sliders))
        cards = [
            pn.Card(
                *(self.sliders[one.path] for one in self._live.sliders if one.group == group),
                *(self._notes() if group == PROCESS else ()),
                title=group,
                collapsed=index > 1,
                width=330,
            )
            for index, group in enumerate(groups)
        ]
        pictures = pn.Column(
            pn.Row(self.table, self.workbook, self.reset, self.cancel),
            self.message,
            picture(self._lobes, "lobes"),
            self.same_call,
            self.verdict,
            self._motion_picture,
        )
        return pn.Row(pn.Column(*cards), pictures)

    def _notes(self) -> list[Any]:
        """What stands in place of a slider."""
        told = why_no_friction_slider(self._live.case)
        return [wrapped_text(told, width=300, styles={"color": "#555555"})] if told else []

    def make_room(self, is_beside: bool) -> None:
        """Leave room for a diagram beside this one, or take it back."""
        width = _WIDTH_BESIDE if is_beside else _WIDTH
        for drawn in (self._lobes, self._motion):
            drawn.width = width
        for told in (self.message, self.same_call, self.verdict):
            told.param.update(width=width, min_width=width)

    def diagram_alone(self) -> pn.viewable.Viewable:
        """Return the diagram without its sliders, as it stands beside another."""
        return pn.Column(
            pn.pane.Str(self._live.case.title or self._file), self.message,
            picture(self._lobes, "lobes-beside"), self.same_call, self.verdict,
        )  # fmt: skip

    def limits(self) -> PageTable:
        """Return the limits that are drawn."""
        rows = self.limit.data
        columns = (rows["speed"], rows["depth"], rows["frequency"], rows["kind"])
        return PageTable(_HEADING, list(zip(*columns, strict=True)))

    def put_back(self) -> None:
        """Put every slider back to the value of the case."""
        for one in self._live.sliders:
            self.sliders[one.path].value = one.value

    def patch(self) -> dict[str, Any]:
        """Return what the sliders change in the case, as a case file writes it."""
        values = self.moved()
        return {path: self._live.by_path[path].text(value) for path, value in values.items()}

    def show_band(self, speed: Any, low: Any, high: Any) -> None:
        """Draw the band of an uncertain limit: speeds in rpm, depths in mm."""
        self.band.data = {"speed": speed, "low": low, "high": high}
        self._update_legend()

    def mark_optimum(self, speed: float, depth: float) -> None:
        """Mark a cut: speed in rpm, depth in mm."""
        self.optimum.data = {"speed": [speed], "depth": [depth]}
        self._update_legend()

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
        self.computations.start(
            Computation(lambda go_on: self._follow(values, go_on), False),
            Computation(lambda go_on: self._compute(values, "fine", go_on), True, _REST),
        )

    def simulate(self, speed: float, depth: float) -> None:
        """Simulate the cut at a point of the diagram: speed in rpm, depth in mm."""
        values = self.moved()
        self.verdict.object = f"{speed:.0f} rpm, {depth:.3g} mm: computing ..."
        self.computations.start(
            Computation(lambda go_on: self._simulate(values, speed, depth, go_on), True)
        )

    def _follow(self, values: dict[str, float], go_on: Progress) -> None:
        """Draw a coarse diagram, and again where following its limits has missed something."""
        self._compute(values, "coarse", go_on)
        diagram = self._live.checked_diagram(go_on)
        if diagram is not None:
            self._show(lambda: self._draw(diagram))

    def _compute(self, values: dict[str, float], stage: str, go_on: Progress) -> None:
        try:
            with reported_while_compiling(lambda text: self._later(self.message, text)):
                diagram = self._live.diagram(values, stage, go_on)
            self._show(lambda: self._draw(diagram))
        finally:
            # after the diagram, which is waited for
            self._later(self.same_call, self._same_call(values))

    def _draw(self, diagram: dict[str, Any]) -> None:
        self._diagram, cut = diagram, diagram["operating"]
        none = float("nan")
        deepest = diagram["max_axial_depth_mm"]
        if self._beside is None:
            self.top = (
                deepest if self._depth_is_stated() else steady_end_of_depth_axis(diagram, self.top)
            )
        top = self.top if self._beside is None else self._beside.top
        self.limit.data = {
            "speed": diagram["spindle_speed_rpm"],
            "depth": [found[0] if found else none for found in diagram["crossings_mm"]],
            "stable": [found[0] if found else deepest for found in diagram["crossings_mm"]],
            "frequency": [none if f is None else f for f in diagram["chatter_frequency_Hz"]],
            "kind": diagram["bifurcation"],
        }
        found = diagram["pockets"]
        pockets = {
            "speed": [one["spindle_speed_rpm"] for one in found],
            "depth": [one["axial_depth_mm"] for one in found],
            "limit": [one["critical_depth_mm"] for one in found],
            "rate": [one["removal_rate_cm3_per_min"] for one in found],
        }
        above = cut["axial_depth_mm"] > top
        operating = {
            "speed": [cut["spindle_speed_rpm"]],
            "depth": [_EDGE * top if above else cut["axial_depth_mm"]],
            "colour": [_colour_of(cut)],
            # points to a cut above the diagram
            "marker": ["triangle" if above else "circle"],
        }
        regained, further = above_islands(diagram)
        # what stays is not sent again
        for source, data in (
            (self.pockets, pockets), (self.operating, operating),
            (self.regained, regained), (self.further, further),
        ):  # fmt: skip
            if source.data != data:
                source.data = data
        if self._beside is None:
            self._lobes.x_range.update(
                start=diagram["spindle_speed_rpm"][0], end=diagram["spindle_speed_rpm"][-1]
            )
            self._lobes.y_range.update(start=0.0, end=top)
        style = {name: operating[name][0] for name in ("colour", "marker")}
        set_style(self._lobes, "operating point", style)
        self._update_legend()
        told = "; ".join([*_DOUBT[: not cut["certain"]], *diagram["notes"]])
        self.message.object = without_folder(told, self._live.case.folder)

    def _update_legend(self) -> None:
        """Name what is drawn; an entry that comes is painted, one of a source that fills is not."""
        (legend,) = self._lobes.legend
        for item in legend.items:
            if len(self._curves[item.label.value].data_source.data["speed"]):
                item.visible = True

    def _depth_is_stated(self) -> bool:
        """Whether the slider, or the case, says how deep the diagram is."""
        lobes = self._live.case.lobes
        return "lobes.depths.to" in self.moved() or bool(lobes and lobes.depths)

    def _simulate(
        self, values: dict[str, float], speed: float, depth: float, go_on: Progress
    ) -> None:
        with reported_while_compiling(lambda text: self._later(self.verdict, text)):
            run = self._live.simulation(values, speed, depth, go_on)
        self._show(lambda: self._draw_run(run))

    def _draw_run(self, run: dict[str, Any]) -> None:
        self._motion_picture.visible = True
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
        words += ["--method", self._method] if self._method else []
        method = f", {self._method!r}" if self._method else ""
        return f"{shlex.join(words)}\nchatter.lobes(chatter.load({self._file!r}){patch}{method})"

    def _lobes_figure(self) -> Any:
        of_other = self._beside
        drawn = figure(
            width=_WIDTH if of_other is None else _WIDTH_BESIDE, height=430,
            x_range=(0, 1) if of_other is None else of_other._lobes.x_range,
            y_range=(0, 1) if of_other is None else of_other._lobes.y_range,
            tools="pan,wheel_zoom,box_zoom,reset,save",
        )  # fmt: skip
        drawn.xaxis.axis_label, drawn.yaxis.axis_label = "spindle speed [rpm]", "axial depth [mm]"
        # the one beside has the axes of the other, whatever its limits are
        level = FAST if of_other is None else CLIPPED
        drawn.varea(
            "speed", 0.0, "stable", source=self.limit, color="#9ccc9c", fill_alpha=0.45,
            level=level, legend_label="stable",
        )  # fmt: skip
        drawn.quad("left", "right", "high", "low", source=self.regained, color="#9ccc9c",
                   line_color=None, fill_alpha=0.45, level=level)  # fmt: skip
        drawn.scatter("speed", "depth", source=self.further, size=3, color="#1f3b57",
                      level=level)  # fmt: skip
        drawn.varea("speed", "low", "high", source=self.band, color="#E69F00", fill_alpha=0.35,
                    level=level, legend_label="5 to 95 %")  # fmt: skip
        line = drawn.line("speed", "depth", source=self.limit, line_width=2, color="#1f3b57",
                          level=level, legend_label="critical axial depth")  # fmt: skip
        drawn.scatter(
            "speed", "depth", source=self.operating, size=11, color="colour", marker="marker",
            level=level, legend_label="operating point",
        )  # fmt: skip
        pockets = drawn.scatter(
            "speed", "depth", source=self.pockets, size=10, marker="triangle", color="#0072B2",
            level=level, legend_label="pockets",
        )  # fmt: skip
        drawn.scatter("speed", "depth", source=self.optimum, size=16, marker="star",
                      color="#D55E00", level=level, legend_label="optimum")  # fmt: skip
        told = [
            ("spindle speed", "@speed{0} rpm"),
            ("critical axial depth", "@depth{0.000} mm"),
            ("chatter frequency", "@frequency{0} Hz"),
            ("bifurcation", "@kind"),
        ]
        of_pockets = [
            ("pocket", "@speed{0} rpm, @depth{0.000} mm"),
            ("limit there", "@limit{0.000} mm"),
            ("removal rate", "@rate{0.0} cm³/min"),
        ]
        drawn.add_tools(
            HoverTool(renderers=[line], tooltips=told, mode="vline"),
            HoverTool(renderers=[pockets], tooltips=of_pockets),
        )
        legend_above(drawn)
        for item in drawn.legend[0].items:
            item.visible = False  # until there is something to draw
        if of_other is None:
            keep_in_frame(drawn, _ALONG_X, _ALONG_Y)
        self._curves = put_samples_into_legend(drawn)
        drawn.on_event(Tap, lambda event: self.simulate(event.x, event.y))
        return drawn

    def _motion_figure(self) -> Any:
        drawn = figure(width=_WIDTH, height=230, tools="pan,wheel_zoom,reset,save")
        drawn.xaxis.axis_label, drawn.yaxis.axis_label = "revolution", "tool [um]"
        drawn.varea("revolution", "low", "high", source=self.motion, color="#5b84b1")
        return drawn


def _colour_of(cut: Mapping[str, Any]) -> str:
    if not cut["certain"]:
        return ORANGE
    return "#2e7d32" if cut["stable"] else "#c62828"


class _PromptFloat(pn.widgets.FloatSlider):
    """Slider whose value is taken at once: Panel gathers those of others for 50 ms."""

    _priority_changes = ("value",)


class _PromptInteger(pn.widgets.IntSlider):
    """The same for whole numbers."""

    _priority_changes = ("value",)


def _text() -> pn.pane.Str:
    return wrapped_text(width=_WIDTH)


def _widget(one: Slider) -> pn.widgets.Widget:
    name = f"{one.label} [{one.unit}]" if one.unit else one.label
    ends: dict[str, Any] = {"value": one.value, "start": one.low, "end": one.high,
                            "stylesheets": [_AT_ONCE]}  # fmt: skip
    if one.whole:
        return _PromptInteger(label=name, **ends)
    step = (one.high - one.low) / _STEPS
    return _PromptFloat(label=name, step=step, format=_format(one.high), **ends)


def _format(high: float) -> str:
    """Decimals that a value of a slider is shown with, five digits at its upper end."""
    decimals = min(6, max(0, 4 - math.floor(math.log10(high)))) if high > 0.0 else 4
    return f"0.[{'0' * decimals}]" if decimals else "0"
