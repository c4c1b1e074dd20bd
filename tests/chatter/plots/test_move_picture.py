"""Picture of a move."""

import numpy as np

from chatter.simulation.virtual_tests.move import MoveResult


def test_legends_cover_no_curve():
    time = np.linspace(0.0, 1.0, 200)
    wanted = 0.02 * np.stack([np.sin(6.0 * time), np.cos(6.0 * time)], axis=1)
    went = 0.999 * wanted
    error = 1e-5 * np.sin(9.0 * time)
    result = MoveResult(
        *("a circle", ("X", "Y"), time, wanted, wanted, went, went, went, wanted, error, {}, False)
    )
    figure = result.plot()
    figure.canvas.draw()
    legends = [axes for axes in figure.axes if axes.get_legend() is not None]
    assert len(legends) == 5
    for axes in legends:
        above = axes.get_legend().get_window_extent().y0
        assert above >= axes.get_window_extent().y1 - 1.0
