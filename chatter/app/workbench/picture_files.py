"""Pictures of the page as PNG and SVG: what a Bokeh figure shows, drawn again by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import panel as pn

from chatter.plots.page_picture import drawn_again
from chatter.plots.style import write_png

#: pixels of a letter of a legend and of a sign with its distances, and of what is beside the axes
_LETTER, _SIGN, _BESIDE = 6, 40, 90
#: of a letter as it is on the average, where the entries stand in one line
_MEAN_LETTER = 5


def legend_above(figure: Any) -> None:
    """Put the legend of a figure above it, where it covers no curve; a click hides a curve."""
    for legend in list(figure.legend):
        legend.update(
            orientation="horizontal", label_text_font_size="8pt", click_policy="hide",
            border_line_alpha=0.0, ncols=_columns_of_legend(legend, figure.width),
        )  # fmt: skip
        figure.center.remove(legend)
        figure.add_layout(legend, "above")


def _columns_of_legend(legend: Any, width: int) -> int:
    """Entries side by side, as many as the figure is wide for."""
    texts = [str(getattr(item.label, "value", item.label) or "") for item in legend.items]
    if sum(len(text) * _MEAN_LETTER + _SIGN for text in texts) <= width - _BESIDE:
        return max(1, len(texts))
    widest = max((len(text) for text in texts), default=0) * _LETTER + _SIGN
    return max(1, min(len(texts), int((width - _BESIDE) // widest)))


def picture_file(figure: Any, form: str) -> io.BytesIO:
    """File of a picture, "png" or "svg"."""
    content = io.BytesIO()
    drawing = drawn_again(figure)
    if form == "svg":
        drawing.savefig(content, format="svg")
    else:
        write_png(drawing, content)
    content.seek(0)
    return content


def picture(figure: Any, name: str) -> pn.Column:
    """Figure with the buttons that save it."""
    buttons = [
        pn.widgets.FileDownload(
            callback=_saving(figure, form), filename=f"{name}.{form}", label=form.upper(),
            width=70, margin=2,
        )
        for form in ("png", "svg")
    ]  # fmt: skip
    return pn.Column(pn.pane.Bokeh(figure), pn.Row(*buttons))


def _saving(figure: Any, form: str) -> Callable[[], io.BytesIO]:
    return lambda: picture_file(figure, form)
