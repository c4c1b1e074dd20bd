"""Pictures of what-if studies: overlay, heat map, tornado."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure

from chatter.description.case import Case
from chatter.description.formatting import to_digits
from chatter.plots import style
from chatter.studies.whatif.summary import ranked, title_of, unit_of, value_text

if TYPE_CHECKING:
    from chatter.studies.whatif.variation import Variation
    from chatter.studies.whatif.whatif_study import WhatIf

_LONGEST_LABEL = 60
_MOST_TICKS = 10
_MOST_WRITTEN = 150
#: height of what has no value, as a share of the axes, and rows of it below each other
_TOP, _ROW, _ROWS = 0.95, 0.035, 6
_NONE_FOUND: dict[str, Any] = {
    "marker": "^", "linestyle": "none", "color": "white", "markeredgecolor": "black",
    "markersize": 8,
}  # fmt: skip
_FAILED: dict[str, Any] = {
    "marker": "x", "linestyle": "none", "color": style.RED, "markersize": 8,
}  # fmt: skip


def plot_whatif(study: WhatIf) -> Figure:
    """Draw a study as its layout asks for."""
    return {"overlay": _overlay, "heat map": _heat_map, "tornado": _tornado}[study.layout](study)


def _title(study: WhatIf) -> str:
    return study.model.title or study.model.name


def _quantity_label(study: WhatIf) -> str:
    quantity = study.measure.quantities[study.quantity]
    found = [unit_of(study, quantity, one, study.quantity).name for one in study.outcomes]
    unit = next((f" [{one}]" for one in found if one), "")
    return title_of(study, quantity) + unit.replace("[um]", "[µm]")


def _values_read(study: WhatIf) -> np.ndarray:
    """Number shown at every point, in the unit that it is read in; nan where there is none."""
    quantity = study.measure.quantities[study.quantity]
    factors = [unit_of(study, quantity, one, study.quantity).factor for one in study.outcomes]
    values = [np.nan if value is None else value for value in study.values()]
    return np.array(values, dtype=np.float64) * factors


def _colours(count: int) -> list:
    """From dark to light in the order of the values, readable without colour vision."""
    return [mpl.colormaps["viridis"](0.88 * k / max(count - 1, 1)) for k in range(count)]


def _overlay(study: WhatIf) -> Figure:
    panels = list(
        dict.fromkeys((curve.panel, curve.name) for one in study.outcomes for curve in one.curves)
    )
    path = study.variations[0]
    single = not panels
    count = len(panels) + 1
    figure = style.new_figure(8.5, 3.2 * max(count, 1.5) if single else 2.7 * count + 1.0)
    figure.suptitle(f"{_title(study)}: {study.measure.name}", fontsize=11.0, x=0.01, ha="left")
    axes = figure.subplots(count, 1, squeeze=False)[:, 0]
    colours = _colours(len(study.points))
    for index, (panel, name) in enumerate(panels):
        _draw_curves(axes[index], study, panel, name, colours)
    if panels:
        axes[0].legend(
            title=path.path, fontsize=8.0, title_fontsize=8.0, frameon=False,
            loc="center left", bbox_to_anchor=(1.0, 0.5),
        )  # fmt: skip
    _draw_numbers(axes[-1], study, colours)
    return figure


def _draw_curves(axes: Axes, study: WhatIf, panel: str, name: str, colours: list) -> None:
    across, without = "", 0
    label_of_y, of_y = _read_label(panel, study)
    for row, (outcome, point) in enumerate(zip(study.outcomes, study.points, strict=True)):
        label = point.labels[0][:_LONGEST_LABEL]
        if outcome.failure:
            axes.plot([], [], **_FAILED, label=f"{label}: failed")
        for curve in outcome.curves:
            if (curve.panel, curve.name) != (panel, name):
                continue
            across, of_x = _read_label(curve.across, study)
            x = np.array(curve.x, dtype=np.float64) * of_x
            y = np.array(curve.y, dtype=np.float64) * of_y
            none = np.isnan(y)
            look = {"marker": "^", "label": f"{label}: none found"} if none.all() else {}
            axes.plot(x, y, color=colours[row], linewidth=1.3, **{"label": label, **look})
            _draw_none_found(axes, x[none], colours[row], row)
            without = max(without, min(row + 1, _ROWS) if none.any() else 0)
    if study.measure.logarithmic:
        axes.set_yscale("log")
    else:
        low, high = min(0.0, axes.get_ylim()[0]), axes.get_ylim()[1]
        # marks of what has no value stand above every curve
        room = 1.0 - _TOP + _ROW * without if without else 0.0
        axes.set_ylim(low, low + (high - low) / (1.0 - room))
    if study.measure.name == "lobes" and isinstance(study.model, Case):
        look = {"color": "black", "markersize": 6}
        style.mark_cut(axes, study.model.cut, "operating point", study.units.length, **look)
    axes.margins(x=0.0)
    axes.set(xlabel=across, ylabel=f"{name}\n{label_of_y}" if name else label_of_y)
    style.finish(axes)


def _read_label(label: str, study: WhatIf) -> tuple[str, float]:
    """Label that ends with a metric unit in the unit that is read, and its number in one of it."""
    name, bracket, unit = label.partition(" [")
    read = study.units.instead_of(unit.removesuffix("]"))
    return (f"{name} [{read.name}]" if bracket else label), read.factor


def _draw_none_found(axes: Axes, x: np.ndarray, colour: object, row: int) -> None:
    """Mark where a curve has no value at the top of the axes, each curve in a row of its own."""
    if not x.size:
        return
    height = _TOP - _ROW * (row % _ROWS)
    axes.plot(
        x, np.full(x.size, height), transform=axes.get_xaxis_transform(), marker="^",
        linestyle="none", markersize=4.0, color=colour,
    )  # fmt: skip


def _draw_numbers(axes: Axes, study: WhatIf, colours: list) -> None:
    """The number shown, over the values of the path."""
    one = study.variations[0]
    numbers = one.numbers
    x = np.arange(len(one.values)) if numbers is None else np.array(numbers)
    y = _values_read(study)
    axes.plot(x, y, color=style.GREY, linewidth=1.0, zorder=1)
    for index, colour in enumerate(colours):
        axes.plot(x[index], y[index], "o", color=colour, markeredgecolor="black", markersize=7)
    missing = np.isnan(y)
    failed = np.array([bool(outcome.failure) for outcome in study.outcomes])
    for where, look, label in (
        (missing & ~failed, _NONE_FOUND, none_found(study)),
        (failed, _FAILED, "failed"),
    ):
        if where.any():
            height = np.full(int(where.sum()), _TOP)
            axes.plot(x[where], height, transform=axes.get_xaxis_transform(), **look, label=label)
    if missing.any():
        axes.legend(fontsize=8.0, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    if numbers is None:
        axes.set_xticks(x, [_wrapped(value.label[:_LONGEST_LABEL], 16) for value in one.values])
    if not missing.all():
        _mark_verdicts(axes, study, x, y)
        axes.margins(y=0.18)
    axes.set(xlabel=one.axis_label, ylabel=_wrapped(_quantity_label(study)))
    axes.ticklabel_format(axis="y", scilimits=(-3, 5), useOffset=False)
    style.finish(axes)


def none_found(study: WhatIf) -> str:
    """Label of points without a number: how far it was searched, where that is one number."""
    beyond = study.measure.quantities[study.quantity].beyond
    found = [one.numbers.get(beyond) for one in study.outcomes] if beyond else []
    searched = {value for value in found if value is not None}
    if len(searched) != 1:
        return "none found"
    (farthest,) = searched
    return f"no limit up to {study.units.instead_of('mm').text(farthest, '.3g')}"


def _mark_verdicts(axes: Axes, study: WhatIf, x: np.ndarray, y: np.ndarray) -> None:
    verdicts = [outcome.words.get("verdict", "") for outcome in study.outcomes]
    if len(set(verdicts)) < 2:
        return
    for index, verdict in enumerate(verdicts):
        if np.isfinite(y[index]):
            axes.annotate(
                verdict, (x[index], y[index]), xytext=(0, 8), textcoords="offset points",
                ha="center", fontsize=7.5,
                bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"},
            )  # fmt: skip


def _wrapped(label: str, width: int = 26) -> str:
    words, lines = label.split(), [""]
    for word in words:
        if len(lines[-1]) + len(word) > width and lines[-1]:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)


def _heat_map(study: WhatIf) -> Figure:
    down, across = study.variations
    shape = len(down.values), len(across.values)
    values = _values_read(study).reshape(shape)
    figure = style.new_figure(min(12.0, 4.0 + 0.62 * shape[1] + 1.2), 2.6 + 0.5 * shape[0])
    axes = figure.subplots()
    axes.set_facecolor("#FFFFFF")
    colours = mpl.colormaps["viridis"].with_extremes(bad="#FFFFFF")
    image = axes.imshow(
        np.ma.masked_invalid(values), origin="lower", aspect="auto", cmap=colours,
        interpolation="nearest",
    )  # fmt: skip
    axes.set_title(_title(study), fontsize=10.0, loc="left")
    _ticks(axes.xaxis, across)
    _ticks(axes.yaxis, down)
    axes.tick_params(axis="x", labelrotation=30)
    axes.set(xlabel=across.path, ylabel=_wrapped(down.path.replace(".", ". ")).replace(". ", "."))
    figure.colorbar(image, label=_quantity_label(study))
    if values.size <= _MOST_WRITTEN:
        _write_values(axes, study, values)
    return figure


def _ticks(axis: Axis, one: Variation) -> None:
    step = -(-len(one.values) // _MOST_TICKS)
    indices = range(0, len(one.values), step)
    axis.set_ticks(list(indices), [one.values[k].label[: _LONGEST_LABEL // 2] for k in indices])


def _write_values(axes: Axes, study: WhatIf, values: np.ndarray) -> None:
    """Values in their fields; stable and chatter where the verdict differs."""
    finite = values[np.isfinite(values)]
    middle = 0.5 * (finite.min() + finite.max()) if finite.size else 0.0
    for index, outcome in enumerate(study.outcomes):
        row, column = divmod(index, values.shape[1])
        value = values[row, column]
        if np.isfinite(value):
            text, colour = to_digits(value, 3), "black" if value > middle else "white"
        else:
            text = "failed" if outcome.failure else "none\nfound"
            colour = "black"
        axes.text(column, row, text, ha="center", va="center", fontsize=7.5, color=colour)


def _tornado(study: WhatIf) -> Figure:
    quantity = study.measure.quantities[study.quantity]
    base = study.values()[0] if study.values()[0] is None else _values_read(study)[0]
    order = list(ranked(study))
    figure = style.new_figure(9.0, 2.0 + 0.55 * len(order))
    axes = figure.subplots()
    for row, index in enumerate(reversed(order)):
        if base is not None:
            _draw_swing(axes, study, index, row)
    if base is not None:
        axes.axvline(base, color="black", linewidth=1.0)
        text = value_text(study, quantity, study.outcomes[0], study.quantity)
        axes.set_title(f"{_title(study)}; as given: {text}", fontsize=10.0, loc="left")
    axes.set_yticks(range(len(order)), [study.variations[k].path for k in reversed(order)])
    axes.set_xlabel(_quantity_label(study))
    for colour, label in _ENDS:
        axes.plot([], [], "s", color=colour, markersize=8, label=label)
    axes.legend(fontsize=8.0, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.margins(x=0.22)
    style.finish(axes)
    return figure


_ENDS = ((style.BLUE, "low value"), (style.ORANGE, "high value"))


def _draw_swing(axes: Axes, study: WhatIf, index: int, row: int) -> None:
    """Bars of one path; in two lanes where both ends lie on the same side."""
    values = [None if np.isnan(value) else value for value in _values_read(study)]
    base, low, high = values[0], values[1 + 2 * index], values[2 + 2 * index]
    known = low is not None and high is not None
    same_side = known and (low - base) * (high - base) > 0.0
    one = study.variations[index]
    ends = ((low, one.values[0].label, 0.15), (high, one.values[-1].label, -0.15))
    for (value, label, lane), (colour, _) in zip(ends, _ENDS, strict=True):
        if value is None:
            continue
        y, height = (row + lane, 0.28) if same_side else (row, 0.56)
        axes.barh(y, value - base, left=base, height=height, color=colour)
        right = value > base or (value == base and lane < 0.0)
        axes.annotate(
            label, (value, y), xytext=(4 if right else -4, 0), textcoords="offset points",
            ha="left" if right else "right", va="center", fontsize=7.5,
        )  # fmt: skip
