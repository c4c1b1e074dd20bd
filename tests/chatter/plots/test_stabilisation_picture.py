"""The picture of the stabilisation diagram: both its axes have a name and a unit."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from chatter.plots.modes import plot_stabilisation
from dynamics.frf.container import Frf, Point
from dynamics.identification.fit import identify_modes

FREQUENCY = np.arange(100.0, 1500.0, 2.0)
STIFFNESS, NATURAL, DAMPING = 8e6, 640.0, 0.03


@pytest.mark.parametrize(
    ("quantity", "unit", "power", "factor"),
    [("receptance", "um/N", 0, 1e6), ("accelerance", "m/s^2/N", 2, 1.0)],
)
def test_the_axis_of_the_frfs_behind_has_its_quantity_and_unit(quantity, unit, power, factor):
    ratio = FREQUENCY / NATURAL
    receptance = 1.0 / STIFFNESS / (1.0 - ratio**2 + 2j * DAMPING * ratio)
    values = receptance * (2j * np.pi * FREQUENCY) ** power
    point = Point("tip", "x")
    frf = Frf(FREQUENCY, values, quantity, point, point)
    figure = plot_stabilisation(identify_modes([frf]), "tap")
    axes, _, behind = figure.axes
    assert axes.get_ylabel() == "model order"
    assert behind.get_ylabel() == f"{quantity} [{unit}]"
    assert behind.get_yscale() == "log"
    drawn = behind.lines[0]
    peak = np.argmax(drawn.get_ydata())
    # of the textbook: the response at resonance is that at rest over twice the damping
    at_rest = factor / STIFFNESS * (2.0 * np.pi * NATURAL) ** power
    assert drawn.get_ydata()[peak] == pytest.approx(at_rest / (2.0 * DAMPING), rel=0.01)
    figure.canvas.draw()
    labels = [one.get_text() for one in behind.get_yticklabels() if one.get_text()]
    assert labels
    named = [one.get_text() for one in axes.get_legend().get_texts()]
    assert named == ["pole", "stable pole", "measured FRF"]
    # the legend lies above all poles
    bottom = axes.get_legend().get_window_extent().transformed(axes.transData.inverted()).y0
    assert bottom > max(line.get_ydata().max() for line in axes.lines[:2] if line.get_ydata().size)
    plt.close(figure)
