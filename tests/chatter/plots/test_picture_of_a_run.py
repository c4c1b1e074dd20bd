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
