"""Arcs of the pieces of an edge on cones and corners, and the chip down to where it vanishes."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from cutting.edge_segments.coupling import coupling_at, part_below
from cutting.edge_segments.segments import edge_segments
from cutting.engagement.uncut_band import band_beside_wall
from cutting.force.exponential import ExponentialLaw
from cutting.force.linear import LinearLaw
from cutting.tool.cutter import Cutter

RADIUS, DEPTH = 8e-3, 2e-3
ONE_TOOTH = (2.0 * RADIUS, (math.radians(30.0),), (2.0 * math.pi,))


def pieces_of(width, law=None, mode="down", **shape):
    band = band_beside_wall(mode, width, RADIUS)
    law = law or LinearLaw((6e8, 2e8, 0.0))
    return edge_segments(Cutter(*ONE_TOOTH, **shape), [law], band, 1e-4, DEPTH)


def arc_along_the_edge(width, radius_at, length):
    """Integral of the arc along an edge, rad m, from its radius at a share of its length."""

    def arc(share):
        return math.acos(min(1.0, (RADIUS - width) / radius_at(share)))

    return length * quad(arc, 0.0, 1.0, limit=200)[0]


@pytest.mark.parametrize("mode", ["up", "down"])
@pytest.mark.parametrize("angle_deg", [20.0, 45.0, 70.0])
@pytest.mark.parametrize("share", [0.0006, 0.02, 0.1, 0.4, 0.9994])
def test_pieces_of_a_cone_have_the_mean_of_its_arc(mode, angle_deg, share):
    angle, width = math.radians(angle_deg), share * 2.0 * RADIUS
    pieces = pieces_of(width, mode=mode, edge_angle=angle)
    found = np.sum(pieces.length * (pieces.exit - pieces.entry).mean(axis=1))
    exact = arc_along_the_edge(
        width, lambda x: RADIUS + x * DEPTH / math.tan(angle), DEPTH / math.sin(angle)
    )
    # chords are up to 1e-3 short; an edge that hardly touches has the steepest arc
    assert found == pytest.approx(exact, rel=6e-5 if share < 0.01 else 2e-5)


@pytest.mark.parametrize("top_over_tip", [10.0, 1000.0])
def test_a_cone_far_wider_at_its_top_takes_few_pieces(top_over_tip):
    """A chamfer mill or a nearly flat insert: each piece widens by a share of its own radius."""
    width = 0.8 * RADIUS
    angle = math.atan(DEPTH / (top_over_tip - 1.0) / RADIUS)
    pieces = pieces_of(width, edge_angle=angle)
    found = np.sum(pieces.length * (pieces.exit - pieces.entry).mean(axis=1))
    exact = arc_along_the_edge(
        width, lambda x: RADIUS + x * DEPTH / math.tan(angle), DEPTH / math.sin(angle)
    )
    assert found == pytest.approx(exact, rel=2e-5)
    assert pieces.bottom.size < 100 * math.log(top_over_tip)


def test_pieces_of_a_corner_have_the_mean_of_its_arc():
    corner, width = 2e-3, 9e-3
    pieces = pieces_of(width, corner_radius=corner)
    found = np.sum(pieces.length * (pieces.exit - pieces.entry).mean(axis=1))
    exact = arc_along_the_edge(
        width, lambda x: RADIUS - corner + corner * math.sin(0.5 * math.pi * x),
        0.5 * math.pi * corner,
    )  # fmt: skip
    assert found == pytest.approx(exact, rel=1e-7)


def test_arcs_of_an_upright_edge_are_as_they_were():
    pieces = pieces_of(1.6e-3)
    assert pieces.entry == pytest.approx(math.pi - math.acos(0.8))
    assert pieces.exit == pytest.approx(math.pi)


def test_the_slope_of_a_size_effect_grows_down_to_the_smallest_chip():
    """As h^(p-1) with h in proportion to sin(phi), with no floor that a multiplier would feel."""
    exponent = 0.3
    law = ExponentialLaw((6e8, 2e8, 0.0), 1e-4, exponent)
    pieces = pieces_of(1.6e-3, law, "up")
    sizes = []
    for turned in (1e-3, 1e-9, 1e-12):
        stiffness, dashpot = np.zeros((3, 3)), np.zeros((3, 3))
        spindle = turned - pieces.angle[0, 0]
        assert part_below(pieces, 0, DEPTH) == 1.0
        coupling_at(pieces, 0, 0.0, spindle, 1.0, 0.0, np.eye(3), stiffness, dashpot)
        # the push of the chip's normal force along y, which is the same at all these angles
        sizes.append(abs(stiffness[0, 1]))
    growth = np.array([1e6, 1e9]) ** (1.0 - exponent)
    assert np.array(sizes[1:]) / sizes[0] == pytest.approx(growth, rel=1e-3)
