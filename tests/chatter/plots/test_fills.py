"""Fills of a stability diagram, and labels that are written without a formula."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_hex

from chatter.description.unit_system import METRIC
from chatter.plots import style
from chatter.plots.stability_diagram import _fill
from chatter.plots.style import new_figure, power_of_ten


def colour_at(axes, x, y):
    canvas = axes.figure.canvas
    column, row = axes.transData.transform((x, y))
    pixels = np.asarray(canvas.buffer_rgba())
    return to_hex(pixels[len(pixels) - 1 - int(row), int(column), :3] / 255.0).upper()


def filled(speeds, crossings, searched, *, over_speed):
    diagram = SimpleNamespace(
        axis=SimpleNamespace(values=np.array(speeds)),
        limits=SimpleNamespace(crossings=[1e-3 * np.array(one) for one in crossings]),
        max_depth=1e-3 * np.array(searched),
        is_over_speed=over_speed,
        units=METRIC,
    )
    axes = new_figure(6.0, 4.0).subplots()
    _fill(axes, diagram, 4e-3)
    axes.set(xlim=(speeds[0], speeds[-1]), ylim=(0.0, 4.0))
    axes.figure.canvas.draw()
    return axes


@pytest.mark.parametrize("order", [1, -1])
def test_what_lies_between_limits_is_filled_at_uneven_values(order):
    # straight from 1 to 2 mm over 1000 to 1200, then to 3 mm at 4000
    axes = filled(
        [1000.0, 1200.0, 4000.0][::order], [[1.0], [2.0], [3.0]][::order], [5.0] * 3,
        over_speed=True,
    )  # fmt: skip
    for speed, limit in ((1100.0, 1.5), (1190.0, 1.95), (2600.0, 2.5), (3900.0, 2.964)):
        assert colour_at(axes, speed, limit - 0.05) == style.STABLE_FILL, speed
        assert colour_at(axes, speed, limit + 0.05) == style.UNSTABLE_FILL, speed


def test_islands_and_what_was_not_searched_have_their_fills():
    axes = filled(
        [1.0, 2.0], [[1.0, 2.0, 2.5], [1.0, 2.0, 2.5]], [3.0, 3.0], over_speed=False
    )  # fmt: skip
    expected = {
        0.5: style.STABLE_FILL,
        1.5: style.UNSTABLE_FILL,
        2.2: style.STABLE_FILL,
        2.8: style.UNSTABLE_FILL,
        3.5: style.NOT_SEARCHED_FILL,
    }
    assert {depth: colour_at(axes, 1.5, depth) for depth in expected} == expected


def test_powers_of_ten_are_plain_text():
    assert power_of_ten(1e-3) == "10⁻³"
    assert power_of_ten(1.0) == "10⁰"
    assert power_of_ten(1e12) == "10¹²"
    assert power_of_ten(2e-3) == ""
