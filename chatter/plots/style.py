"""One look for every picture: readable in print, distinguishable without colour vision."""

import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from os import PathLike
from typing import IO, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter
from PIL import Image

from chatter.description.sections.cut import Cut
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit

#: Okabe and Ito's palette
BLUE, ORANGE, GREEN, RED, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#666666"
STABLE_FILL, UNSTABLE_FILL = "#E8F3EE", "#F6E3D8"
NOT_SEARCHED_FILL = "#ECECEC"

#: dots an inch: what is finer takes longer to draw than the result takes to compute
_DPI = 120
#: of zlib: what more would save is hardly worth its time
_COMPRESSION = 4
_FONT = 9.0
#: a title of axes whose ticks are below and beside them: matplotlib need not look for its place
TITLE: dict[str, Any] = {"loc": "left", "y": 1.0}
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def new_figure(width: float, height: float, **layout: Any) -> Figure:
    """Return an empty figure (inches) that needs no display."""
    figure = Figure(figsize=(width, height), dpi=_DPI, layout="constrained", **layout)
    FigureCanvasAgg(figure)
    return figure


@contextmanager
def any_letters() -> Iterator[None]:
    """A title in letters that the font lacks is no reason for a warning."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


def write_png(figure: Figure, file: str | PathLike | IO[bytes]) -> None:
    """Write a figure of `new_figure` as PNG; `savefig` would draw it twice."""
    canvas = FigureCanvasAgg(figure)
    with any_letters():
        canvas.draw()
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])
    resolution = (figure.dpi, figure.dpi)
    picture.save(file, format="png", dpi=resolution, compress_level=_COMPRESSION)


def png_of(figure: Figure) -> bytes:
    """Return a figure of `new_figure` as PNG."""
    buffer = BytesIO()
    write_png(figure, buffer)
    return buffer.getvalue()


def mark_cut(axes: Any, cut: Cut, label: str, length: UsualUnit, **look: Any) -> None:
    """Mark the speed and depth of a cut among spindle speeds (rpm) and axial depths."""
    point = {"marker": "o", "markersize": 9, "markeredgecolor": "black", "linestyle": "none"}
    x, y = rpm(cut.spindle_speed), cut.axial_depth * length.factor
    axes.plot(x, y, **{**point, **look}, label=label, zorder=5)


def write_powers(axis: Any) -> None:
    """Write the powers of ten of a logarithmic axis as plain text: formulas take longer to set."""
    axis.set_major_formatter(FuncFormatter(lambda value, _: power_of_ten(value)))
    axis.set_minor_formatter(NullFormatter())


def power_of_ten(value: float) -> str:
    """Label of a power of ten, "10⁻³"; empty for what is none."""
    exponent = round(math.log10(value))
    if not math.isclose(value, 10.0**exponent, rel_tol=1e-9):
        return ""
    return "10" + str(exponent).translate(_RAISED)


def finish_at_right(axes: Any) -> None:
    """Give a second axis, at the right of axes with a grid, the common look."""
    axes.tick_params(labelsize=_FONT)
    axes.spines["top"].set_visible(False)
    axes.yaxis.label.set_fontsize(_FONT + 1.0)


def finish(axes: Any) -> None:
    """Give axes the common look."""
    axes.grid(visible=True, color="#DDDDDD", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=_FONT)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for label in (axes.xaxis.label, axes.yaxis.label):
        label.set_fontsize(_FONT + 1.0)
    axes.title.set_fontsize(_FONT + 2.0)
