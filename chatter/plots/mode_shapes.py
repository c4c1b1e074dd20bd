"""Picture of the mode shapes of a machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from chatter.plots import style

if TYPE_CHECKING:
    from chatter.simulation.virtual_tests.mode_shapes import ModeShapes

_MOST = 6
#: largest displacement that is drawn, as a share of the machine's size
SHARE = 0.12


def isometric(points: np.ndarray) -> np.ndarray:
    """Places (..., 3) in m on a picture (..., 2), x to the lower right, y to the right, z up."""
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    return np.stack((y * 0.866 + x * 0.5, z + y * 0.25 - x * 0.433), axis=-1)


def drawn_scale(found: ModeShapes) -> float:
    """Displacement, m, that the largest of a mode is drawn as."""
    return SHARE * float(np.linalg.norm(np.ptp(found.points, axis=0)))


def plot_mode_shapes(found: ModeShapes) -> Figure:
    """Draw the first modes over the machine at rest."""
    shown = min(_MOST, len(found.frequency))
    figure = style.new_figure(11.0, 3.6 * max(1, -(-shown // 3)))
    scale, rest = drawn_scale(found), isometric(found.points) * 1e3
    for place in range(shown):
        axes = figure.add_subplot(-(-shown // 3), 3, place + 1)
        moved = isometric(found.points + scale * found.shapes[place]) * 1e3
        for a, b in found.lines:
            axes.plot(*rest[[a, b]].T, color="#BBBBBB", linewidth=0.8)
            axes.plot(*moved[[a, b]].T, color=style.BLUE, linewidth=1.2)
        axes.set_title(f"{found.frequency[place]:.4g} Hz", fontsize=10)
        axes.set_aspect("equal", "datalim")
        axes.set_xlabel("[mm]")
        # labels such as -1500 run into each other where there are more
        axes.locator_params(axis="x", nbins=4)
        style.finish(axes)
    of_all = f"first {shown} of {len(found.frequency)} mode shapes"
    figure.suptitle(f"{found.machine}: {of_all}, enlarged; grey: at rest", fontsize=12)
    return figure
