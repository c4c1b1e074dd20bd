"""Pictures of a modal test in the browser: FRF, phase, coherence, poles to be picked."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, TapTool
from bokeh.plotting import figure

from chatter.plots.modes import FRF_UNITS
from chatter.studies.modal_test import ModalTest

_TOOLS = "pan,box_zoom,wheel_zoom,reset"
_WIDTH = 600
#: poles that belong to one mode lie this close, as a share of the frequency
_SAME_POLE = 0.005


class ModalTestFigures:
    """Measured and fitted FRF, coherence, and the stabilisation diagram of a modal test."""

    def __init__(self) -> None:
        self.measured = ColumnDataSource({"f": [], "magnitude": [], "phase": []})
        self.fitted = ColumnDataSource({"f": [], "magnitude": [], "phase": []})
        self.coherences = ColumnDataSource({"f": [], "coherence": []})
        self.behind = ColumnDataSource({"f": [], "magnitude": []})
        self.diagram = ColumnDataSource({"f": [], "order": [], "damping": [], "colour": []})
        self.chosen = ColumnDataSource({"xs": [], "ys": []})
        self.magnitude = figure(width=_WIDTH, height=290, y_axis_type="log", tools=_TOOLS,
                                x_range=(0, 1), y_range=(0.1, 1))  # fmt: skip
        self.phase = figure(width=_WIDTH, height=180, tools=_TOOLS,
                            x_range=self.magnitude.x_range, y_range=(-190, 190))  # fmt: skip
        self.coherence = figure(width=_WIDTH, height=160, tools=_TOOLS,
                                x_range=self.magnitude.x_range, y_range=(0, 1.05))  # fmt: skip
        self._show_functions()
        self.stabilisation = self._stabilisation_figure()

    def draw(self, test: ModalTest) -> None:
        """Draw what was measured and fitted."""
        self._draw_functions(test)
        self._draw_diagram(test)

    def pick(self, indices: list[int]) -> None:
        """Pick poles of the stabilisation diagram by their place in it, as a click does."""
        self.diagram.selected.indices = indices

    def picked_poles(self) -> list[tuple[float, float]]:
        """Frequency, Hz, and damping of the poles picked; several orders of one count once."""
        drawn = self.diagram.data
        picked = self.diagram.selected.indices
        groups: list[list[tuple[float, float]]] = []
        for pole in sorted((drawn["f"][k], drawn["damping"][k]) for k in picked):
            near = groups and pole[0] - groups[-1][-1][0] < _SAME_POLE * pole[0]
            groups[-1].append(pole) if near else groups.append([pole])
        means = [np.mean(group, axis=0) for group in groups]
        return [(float(f"{f:.7g}"), float(f"{d:.4g}")) for f, d in means]

    def _show_functions(self) -> None:
        """Lay the lines of the FRF and its coherence into their figures."""
        for drawn, column, label in (
            (self.magnitude, "magnitude", "FRF"), (self.phase, "phase", "phase [deg]"),
        ):  # fmt: skip
            drawn.line("f", column, source=self.measured, color="#888888", line_width=1.5,
                       legend_label="measured")  # fmt: skip
            drawn.line("f", column, source=self.fitted, color="#D55E00", legend_label="fitted")
            drawn.yaxis.axis_label = label
        self.phase.legend.visible = False
        self.coherence.line("f", "coherence", source=self.coherences, color="#0072B2")
        self.coherence.yaxis.axis_label = "coherence"
        self.coherence.xaxis.axis_label = "frequency [Hz]"

    def _draw_functions(self, test: ModalTest) -> None:
        frf, model, band = test.fit.frfs[0], test.fit.models[0], test.fit.band
        unit, factor = FRF_UNITS[frf.quantity]
        inside = (frf.frequency > 0.0) & (frf.frequency <= 1.2 * band.highest)
        f, values = frf.frequency[inside], frf.values[inside]
        lines = np.linspace(band.lowest, band.highest, 2000)
        fitted = model.values(lines)
        self.measured.data = _function(f, values, factor)
        self.fitted.data = _function(lines, fitted, factor)
        shown = test.hammer.frf if test.hammer is not None else frf
        known = shown.coherence is not None
        self.coherences.data = {
            "f": shown.frequency if known else [],
            "coherence": shown.coherence if known else [],
        }
        self.magnitude.yaxis.axis_label = f"{frf.quantity} [{unit}]"
        for one in (self.magnitude, self.phase, self.coherence):
            one.x_range.update(start=float(f[0]), end=float(f[-1]))
        size = np.abs(values[values != 0.0]) * factor
        self.magnitude.y_range.update(
            start=0.5 * float(np.percentile(size, 1)), end=2.0 * size.max()
        )

    def _draw_diagram(self, test: ModalTest) -> None:
        diagrams, band = test.fit.diagrams, test.fit.band
        stable = np.concatenate([one.stable for one in diagrams])
        order = np.concatenate([one.order for one in diagrams])
        self.diagram.selected.indices = []
        self.diagram.data = {
            "f": np.concatenate([one.frequency for one in diagrams]),
            "order": order,
            "damping": np.concatenate([one.damping for one in diagrams]),
            "colour": np.where(stable, "#0072B2", "#E69F00"),
        }
        top = float(order.max(initial=1)) + 2.0
        self.chosen.data = {
            "xs": [[mode.frequency] * 2 for mode in test.fit.identified],
            "ys": [[0.0, top] for _ in test.fit.identified],
        }
        frf = test.fit.frfs[0].band(band.lowest, band.highest)
        size = np.log10(np.maximum(np.abs(frf.values), 1e-300))
        span = max(float(np.ptp(size)), 1e-9)
        self.behind.data = {"f": frf.frequency, "magnitude": (size - size.min()) / span * top}
        self.stabilisation.x_range.update(start=band.lowest, end=band.highest)
        self.stabilisation.y_range.update(start=0.0, end=top)

    def _stabilisation_figure(self) -> Any:
        drawn = figure(width=_WIDTH, height=330, x_range=(0, 1), y_range=(0, 1),
                       tools=f"{_TOOLS},box_select")  # fmt: skip
        drawn.line("f", "magnitude", source=self.behind, color="#BBBBBB")
        drawn.multi_line("xs", "ys", source=self.chosen, color="#009E73", line_width=1.5,
                         legend_label="modes")  # fmt: skip
        poles = drawn.scatter(
            "f", "order", source=self.diagram, size=6, color="colour", fill_alpha=0.5,
            nonselection_alpha=0.35, selection_line_color="black", selection_line_width=2,
        )  # fmt: skip
        told = [("frequency", "@f{0.0} Hz"), ("damping ratio", "@damping{0.0000}"),
                ("order", "@order")]  # fmt: skip
        drawn.add_tools(TapTool(renderers=[poles]), HoverTool(renderers=[poles], tooltips=told))
        drawn.xaxis.axis_label = "frequency [Hz]"
        drawn.yaxis.axis_label = "model order"
        drawn.title.text = "poles: blue stable, orange not; click picks one"
        return drawn


def _function(f: Any, values: Any, factor: float) -> dict[str, Any]:
    return {"f": f, "magnitude": np.abs(values) * factor, "phase": np.degrees(np.angle(values))}
