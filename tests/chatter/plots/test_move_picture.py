"""Picture of a move."""

import numpy as np
import pytest

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


def moved(velocity, units, error):
    time = np.linspace(0.0, 1.0, 200)
    wanted = 0.02 * np.stack([np.sin(6.0 * time), np.cos(6.0 * time)], axis=1)
    speed = velocity * np.stack([np.sin(6.0 * time), np.cos(6.0 * time)], axis=1)
    effort = np.stack([3.0 * np.sin(time), 800.0 * np.sin(time)], axis=1)
    contour = error * np.sin(9.0 * time)
    return MoveResult(
        "two axes", ("X", "Y"), time, wanted, speed, wanted - 1e-5, wanted - 3e-5, None, effort,
        contour, {}, False, units,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("velocity", "label", "largest"),
    [(0.5, "velocity [m/min]", 30.0), (1e-4, "velocity [mm/min]", 6.0)],
)
def test_velocities_are_in_the_units_of_feeds(velocity, label, largest):
    axes = moved(velocity, ("N*m", "N*m"), 1e-5).plot().axes[1]
    assert axes.get_ylabel() == label
    drawn = max(np.abs(line.get_ydata()).max() for line in axes.lines)
    assert drawn == pytest.approx(largest, rel=1e-3)


def test_torques_and_forces_have_an_axis_each():
    """A torque of 3 N m was a line at zero beside a force of 800 N."""
    figure = moved(0.1, ("N*m", "N"), 1e-5).plot()
    labels = {one.get_ylabel(): one for one in figure.axes}
    torque, force = labels["torque of the motors [N m]"], labels["force of the motors [N]"]
    assert torque.get_ylim()[1] < 10.0 < 650.0 < force.get_ylim()[1]
    assert sum(torque.get_ylim()) == pytest.approx(0.0)


def test_the_error_at_the_scale_is_drawn_where_it_differs():
    axes = next(one for one in moved(0.1, (), 1e-5).plot().axes
                if one.get_ylabel().startswith("set less actual"))  # fmt: skip
    drawn = {line.get_label(): line.get_ydata()[0] for line in axes.lines}
    assert drawn["X motor"] == pytest.approx(10.0)
    assert drawn["X scale"] == pytest.approx(30.0)


def test_the_sentences_say_where_an_error_is_read():
    told = moved(0.1, ("N*m", "N"), 1e-5).sentences()
    assert "tracking error at most 10 um at the motor, 30 um at the scale;" in told[1]


@pytest.mark.parametrize(("error", "factor"), [(0.6e-3, "5"), (1.5e-3, "2"), (1e-5, "200")])
def test_the_contour_error_is_enlarged_so_that_it_is_seen(error, factor):
    """0.1 of the 40 mm across, rounded down to 1, 2 or 5: an error of 0.6 mm was drawn once."""
    figure = moved(0.1, (), error).plot()
    told = [text.get_text() for one in figure.axes if one.get_legend()
            for text in one.get_legend().get_texts()]  # fmt: skip
    assert f"error x {factor}" in told
