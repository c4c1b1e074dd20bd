"""Legends whose signs stay while curves move.

Bokeh makes the signs of a legend anew whenever the data of a curve in it change, and paints them
only with the whole figure: where the curves alone are painted, the signs are gone. Samples of the
curves, with data of their own, stand in the legend instead.
"""

from __future__ import annotations

import math
from typing import Any

from bokeh.events import LegendItemClick
from bokeh.models import ColumnDataSource, CustomJS

#: the sample itself may be hidden before or after
_HIDE = """
const place = samples.indexOf(cb_obj.item.renderers[0]);
if (place >= 0) curves[place].visible = !curves[place].visible;
"""
#: columns that say how a point style, and how it does until there is one
_STYLE = {"colour": "black", "marker": "circle"}


def put_samples_into_legend(drawn: Any) -> dict[str, Any]:
    """Let samples of the curves stand in the legend of a figure; a click on one hides its curve.

    Returns
    -------
    dict of str to GlyphRenderer
        Entry of the legend -> its curve.
    """
    curves, samples = {}, []
    (legend,) = drawn.legend
    for item in legend.items:
        (curve,) = item.renderers
        sample = drawn.add_glyph(ColumnDataSource(_one_point(curve)), curve.glyph.clone())
        item.renderers = [sample]
        samples.append(sample)
        curves[item.label.value] = curve
    given = {"samples": samples, "curves": list(curves.values())}
    # of the legend: what an entry refers to counts as its content
    legend.js_on_event(LegendItemClick, CustomJS(code=_HIDE, args=given))
    return curves


def set_style(drawn: Any, entry: str, style: dict[str, str]) -> None:
    """Give a sample in the legend of a figure the colour and shape of its curve."""
    (legend,) = drawn.legend
    (sample,) = next(item.renderers for item in legend.items if item.label.value == entry)
    data = {**sample.data_source.data, **{name: [one] for name, one in style.items()}}
    if any(data[name] != sample.data_source.data[name] for name in style):
        sample.data_source.data = data


def _one_point(curve: Any) -> dict[str, list[Any]]:
    """A point that is drawn nowhere: no colour or shape of a point is known yet."""
    return {name: [_STYLE.get(name, math.nan)] for name in curve.data_source.data}
