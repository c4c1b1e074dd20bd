"""Picture of a run: the plane that moves, and frequencies as far as something is there."""

import pytest
from matplotlib.figure import Figure

import chatter
from chatter.description.case import loads
from chatter.plots.simulation import draw_spectrum, moving_plane
from tests.chatter.simulation.test_worn_flank import CASE

MODE = {"frequency": "900 Hz", "damping": 0.03, "stiffness": "9 N/um"}


def run_with(*modes):
    shallow = {"cut.axial_depth": "0.2 mm", "material.Kac": "300 MPa"}
    case = loads(CASE).patch({**shallow, "simulation.revolutions": 8})
    return chatter.simulate(case.patch({"structure.mode": list(modes)}))


@pytest.mark.parametrize(
    ("directions", "plane"),
    [("xy", (0, 1)), ("x", (0, 1)), ("xz", (0, 2)), ("z", (0, 2)), ("yz", (1, 2))],
)
def test_the_section_is_of_the_plane_that_moves(directions, plane):
    assert moving_plane(run_with(*({**MODE, "direction": one} for one in directions))) == plane


def test_the_spectrum_ends_where_nothing_is_left():
    stiff = {"frequency": "20 kHz", "damping": 0.03, "stiffness": "9000 N/um", "direction": "y"}
    axes = Figure().add_subplot()
    draw_spectrum(axes, run_with({**MODE, "direction": "x"}, stiff))
    # the mode at 20 kHz yields a thousandth of the other: nothing of it is seen
    low, high = axes.get_xlim()
    assert low == 0.0
    assert 1000.0 < high < 20000.0


def panels(result):
    """Titles of the panels of the picture of a run, and what it says below them."""
    figure = result.plot()
    assert all(axes.has_data() for axes in figure.axes)
    return [axes.get_title(loc="left") for axes in figure.axes], figure.get_supxlabel()


def run_of(content):
    return chatter.simulate(loads(content).patch({"simulation.revolutions": 8}))


RUN = ["whole run", "last revolutions"]


def test_a_cut_beside_a_wall_has_all_panels():
    titles, below = panels(run_of(CASE))
    surface = ["wall, deviation (positive: too much removed)", "profiles along the feed"]
    assert [one.split(", about")[0] for one in titles if one] == [
        *RUN, *RUN, "spectrum of the displacement, last half of the run", "once a revolution",
        *surface,
    ]  # fmt: skip
    assert below == ""


def test_a_face_mill_that_leaves_no_wall_has_no_empty_panels():
    """The last of four rows held two empty panels, each with the reason."""
    wide = CASE.replace('"down"', '"face"').replace('radial_depth = "8', 'workpiece_width = "12')
    titles, below = panels(run_of(wide))
    assert titles == [
        *RUN, *RUN, "spectrum of the displacement, last half of the run", "once a revolution",
    ]  # fmt: skip
    assert below == "wall: none is left, the tool overhangs the work on both sides"


def test_a_rigid_tool_has_no_panels_of_motion():
    rigid = CASE[: CASE.index("[[structure.mode]]")] + "[simulation]\nrevolutions = 6\n"
    titles, _ = panels(run_of(rigid))
    assert titles[:3] == [*RUN, "spectrum of the force, last half of the run"]
    assert "once a revolution" not in titles
