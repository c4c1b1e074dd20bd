"""Residual diagnostics: records before and after, their errors, and each diagnostic."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource, HoverTool
from bokeh.plotting import figure

from chatter.app.workbench.diagnostic_figure import MODEL_COLOURS, diagnostic_figure
from chatter.app.workbench.picture_files import legend_above, picture
from chatter.app.workbench.residual_file import read_residuals
from chatter.app.workbench.wrapped_text import wrapped_text
from chatter.explain.residuals.by_channel import short_name

_MOST_RUNS = 12
_RESIDUAL = "residual, "


class ResidualView:
    """Residuals that a comparison or an explanation has left in its folder."""

    def __init__(self) -> None:
        self._found: dict[str, Any] = {}
        self.run = pn.widgets.Select(label="Run", options=[], width=200)
        self.channel = pn.widgets.Select(label="Channel", options=[], width=160)
        self.diagnostic = pn.widgets.Select(label="Diagnostic", options=[], width=420)
        self.record = ColumnDataSource(
            {"x": [], "measured": [], **{name: [] for name in MODEL_COLOURS}}
        )
        self.told = wrapped_text()
        self._drawn = _record_figure(self.record)
        self._errors, self._panel = pn.Column(), pn.Column()
        self._of_records = pn.Column(
            pn.Row(self.run, self.channel),
            pn.Row(picture(self._drawn, "record"), pn.Column(self._errors, width=640)),
        )
        self._view = pn.Column(
            self._of_records, self.diagnostic, self.told, self._panel, visible=False
        )
        self.run.param.watch(lambda _: self._draw_record(), "value")
        self.channel.param.watch(lambda _: self._draw_channel(), "value")
        self.diagnostic.param.watch(lambda _: self._draw_diagnostic(), "value")

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        return self._view

    def show(self, folder: Path) -> None:
        """Show the residuals of a folder, or nothing where it has none."""
        self._found = read_residuals(folder)
        self._view.visible = bool(self._found)
        self.diagnostic.options = {_named(one): place for place, one in self._ordered()}
        self.diagnostic.value = next(iter(self.diagnostic.options.values()), None)
        self._draw_diagnostic()
        records = self._found.get("records", [])
        self._of_records.visible = bool(records)
        if not records:
            return
        self.channel.options = list(dict.fromkeys(one["channel"] for one in records))
        self.run.options = list(dict.fromkeys(one["run"] for one in records))
        worst = max(records, key=_over_noise)
        self.run.value, self.channel.value = worst["run"], worst["channel"]
        self._draw_channel()

    def _ordered(self) -> list[tuple[int, dict[str, Any]]]:
        """Diagnostics with their places, what is significant first."""
        listed = list(enumerate(self._found.get("diagnostics", [])))
        return sorted(listed, key=lambda one: not one[1]["significant"])

    def _draw_channel(self) -> None:
        self._draw_record()
        of_channel = [one for one in self._found.get("records", [])
                      if one["channel"] == self.channel.value]  # fmt: skip
        # of many runs those that are farthest from their noise
        worst = sorted(of_channel, key=_over_noise, reverse=True)[:_MOST_RUNS]
        chosen = [one for one in of_channel if any(one is other for other in worst)]
        if not chosen:
            return
        models = list(chosen[0]["over_noise"])
        panel = {
            "kind": "Bars",
            "categories": [short_name(one["run"]) for one in chosen],
            "series": {name: [one["over_noise"].get(name) for one in chosen] for name in models},
            "label": "residual over noise",
            "floor": 1.0,
        }
        drawn = diagnostic_figure(panel, f"{self.channel.value}: 1 is the noise")
        self._errors.objects = [picture(drawn, "errors")]

    def _draw_record(self) -> None:
        found = next(
            (one for one in self._found.get("records", [])
             if (one["run"], one["channel"]) == (self.run.value, self.channel.value)), None,
        )  # fmt: skip
        if found is None:
            self.record.data = {name: [] for name in self.record.data}
            self._drawn.title.text = f"{self.run.value} has no {self.channel.value}"
            return
        nothing = [np.nan] * len(found["x"])
        self.record.data = {
            name: np.array(values, dtype=np.float64)
            for name, values in (
                ("x", found["x"]),
                ("measured", found["measured"]),
                *((name, found["residuals"].get(name, nothing)) for name in MODEL_COLOURS),
            )
        }
        for item in self._drawn.legend[0].items[1:]:
            item.visible = item.label.value.removeprefix(_RESIDUAL) in found["residuals"]
        unit = f" [{found['unit']}]" if found["unit"] else ""
        self._drawn.xaxis.axis_label = found["x_label"]
        self._drawn.yaxis.axis_label = f"{found['channel']}{unit}"
        times = ", ".join(f"{name} {value:.3g}" for name, value in found["over_noise"].items()
                          if value is not None)  # fmt: skip
        self._drawn.title.text = f"{found['run']}: residual over noise, {times}"

    def _draw_diagnostic(self) -> None:
        listed = self._found.get("diagnostics", [])
        if self.diagnostic.value is None or not listed:
            self._panel.objects, self.told.object = [], ""
            return
        chosen = listed[self.diagnostic.value]
        self.told.object = chosen["description"]
        self._panel.objects = [
            picture(diagnostic_figure(chosen["panel"], chosen["name"]), "diagnostic")
        ]


def _over_noise(record: dict[str, Any]) -> float:
    """Residual of a record over its noise, of the model that is farthest from it."""
    return max((value for value in record["over_noise"].values() if value is not None), default=0.0)


def _named(one: dict[str, Any]) -> str:
    told = "" if one["significant"] else " (no more than chance)"
    return f"{one['name']}, {one['model']} case{told}"


def _record_figure(source: ColumnDataSource) -> Any:
    drawn = figure(width=620, height=340, tools="pan,wheel_zoom,box_zoom,reset", title="")
    measured = drawn.line("x", "measured", source=source, color="#B5B5B5",
                          legend_label="measured")  # fmt: skip
    for name, colour in MODEL_COLOURS.items():
        drawn.line("x", name, source=source, color=colour, legend_label=_RESIDUAL + name)
    drawn.add_tools(HoverTool(renderers=[measured], mode="vline",
                              tooltips=[("x", "@x"), ("measured", "@measured")]))  # fmt: skip
    legend_above(drawn)
    return drawn
