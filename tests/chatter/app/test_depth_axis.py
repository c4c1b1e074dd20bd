"""Depth axis of the diagram on the page."""

import pytest

from chatter.app.depth_axis import steady_end_of_depth_axis


def diagram(limits, cut=1.0, deepest=20.0):
    return {"crossings_mm": limits, "max_axial_depth_mm": deepest,
            "operating": {"axial_depth_mm": cut}}  # fmt: skip


@pytest.mark.parametrize(
    ("limits", "cut", "shown"),
    [
        ([[2.0], [4.0]], 1.0, 4.6),  # half of the picture was empty above the lobes
        ([[2.0, 9.0], [4.0, 15.0]], 1.0, 17.25),  # islands end below the upper edge: 1.15 x 15
        ([[2.0], [4.0], []], 1.0, 5.0),  # room for a speed without a limit
        ([[2.0], [4.0]], 8.0, 8.8),  # a cut a little above them is in the picture
        ([[0.2], [0.4]], 8.0, 0.46),  # one far above them presses no lobes to the ground
        ([[2.0], [19.0]], 1.0, 20.0),  # nothing is known beyond the search
        ([[], []], 1.0, 20.0),
    ],
)
def test_the_axis_ends_a_little_above_the_lobes(limits, cut, shown):
    assert steady_end_of_depth_axis(diagram(limits, cut), 0.0) == pytest.approx(shown)


def test_the_axis_stays_under_small_moves_and_follows_large_ones():
    assert steady_end_of_depth_axis(diagram([[4.2]]), 4.6) == 4.6
    assert steady_end_of_depth_axis(diagram([[2.5]]), 4.6) == 4.6
    assert steady_end_of_depth_axis(diagram([[4.6]]), 4.6) == pytest.approx(5.29)
    assert steady_end_of_depth_axis(diagram([[2.0]]), 4.6) == pytest.approx(2.3)
    # not above the depth searched
    assert steady_end_of_depth_axis(diagram([[3.0]], deepest=4.0), 4.6) == pytest.approx(3.45)
