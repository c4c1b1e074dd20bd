"""Curves that are painted over the axes, which is fast, as long as they lie within the frame.

Bokeh clips what is drawn on the level of glyphs to the frame, and paints the whole figure again for
it; on the level of overlays only the curves are painted, and they are not clipped.
"""

from __future__ import annotations

from typing import Any

from bokeh.models import ColumnDataSource, CustomJS

FAST, CLIPPED = "overlay", "glyph"
_CHOOSE = """
const {start, end} = x_range;
let fits = y_range.start <= 0;
for (const source of sources) {
  const {data} = source;
  for (const name of Object.keys(data)) {
    const is_x = xs.includes(name), is_y = ys.includes(name);
    if (!is_x && !is_y) continue;
    const [low, high] = is_x ? [start, end] : [y_range.start, y_range.end];
    for (const value of data[name])
      if (value < low || value > high) fits = false;  // nothing is drawn of NaN
  }
}
const level = fits ? fast : clipped;
if (drawn.every(one => one.level === level)) return;
for (const one of drawn) one.level = level;
x_range.change.emit();  // the whole figure, once
"""


def keep_in_frame(drawn: Any, xs: tuple[str, ...], ys: tuple[str, ...]) -> None:
    """Clip the curves of a figure to its frame whenever they do not lie within it.

    Parameters
    ----------
    drawn : figure
        With its curves, on the level `FAST`.
    xs, ys : tuple of str
        Columns of their sources along each axis.
    """
    sources = list(dict.fromkeys(
        one.data_source for one in drawn.renderers if isinstance(one.data_source, ColumnDataSource)
    ))  # fmt: skip
    choose = CustomJS(
        code=_CHOOSE,
        args={"x_range": drawn.x_range, "y_range": drawn.y_range, "sources": sources,
              "drawn": list(drawn.renderers), "xs": list(xs), "ys": list(ys),
              "fast": FAST, "clipped": CLIPPED},
    )  # fmt: skip
    for axis in (drawn.x_range, drawn.y_range):
        axis.js_on_change("start", choose)
        axis.js_on_change("end", choose)
    for source in sources:
        source.js_on_change("data", choose)
