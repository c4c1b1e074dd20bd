"""Entry and exit angles against the drawing, removal rate against a catalogue formula."""

import math

import numpy as np
import pytest

from cutting.engagement.immersion import cutting_speed, engagement, removal_rate, slice_engagement
from cutting.engagement.uncut_band import (
    SLOT,
    band_beside_pass,
    band_beside_wall,
    band_between_angles,
    band_of_workpiece,
)


def beside_wall(mode, radial_depth, diameter):
    return engagement(band_beside_wall(mode, radial_depth, 0.5 * diameter), 0.5 * diameter)


def test_half_immersion():
    assert beside_wall("up", 5e-3, 10e-3) == pytest.approx((0.0, math.pi / 2))
    assert beside_wall("down", 5e-3, 10e-3) == pytest.approx((math.pi / 2, math.pi))


def test_quarter_radius_immersion():
    # a_e = R/2: cos(arc) = 1 - a_e/R = 1/2
    assert beside_wall("up", 2.5e-3, 10e-3).exit == pytest.approx(math.pi / 3)
    assert beside_wall("down", 2.5e-3, 10e-3).entry == pytest.approx(2 * math.pi / 3)


def test_full_width_is_a_slot():
    assert beside_wall("up", 10e-3, 10e-3) == pytest.approx(beside_wall("slot", 10e-3, 10e-3))


@pytest.mark.parametrize("width", [0.0, -1e-3, 10.1e-3])
def test_impossible_width(width):
    with pytest.raises(ValueError, match="radial depth"):
        beside_wall("down", width, 10e-3)


def test_removal_rate_and_cutting_speed():
    # 10 000 rpm, 2 teeth, 0.1 mm: table feed 2000 mm/min; times 2 mm by 8 mm
    omega = 10_000 * math.pi / 30
    assert removal_rate(2e-3, 8e-3, 2, 1e-4, omega) * 6e7 == pytest.approx(32.0)
    assert cutting_speed(16e-3, omega) == pytest.approx(math.pi * 16e-3 * 10_000 / 60)


def test_a_centred_face_mill():
    """60 mm of work under 80 mm: sin of half the arc is 60/80, a textbook drawing."""
    arc = engagement(band_of_workpiece(60e-3, 0.0), 40e-3)
    half = math.asin(0.75)
    assert arc == pytest.approx((0.5 * math.pi - half, 0.5 * math.pi + half))


def test_an_offset_face_mill():
    """The tool moved by 5 mm towards +y: the work reaches from -35 to 25 mm beside its axis."""
    arc = engagement(band_of_workpiece(60e-3, 5e-3), 40e-3)
    assert arc == pytest.approx((math.acos(25.0 / 40.0), math.acos(-35.0 / 40.0)))
    # overhanging one side of wide work it is a peripheral cut
    wide = engagement(band_of_workpiece(100e-3, 30e-3), 40e-3)
    assert wide == pytest.approx(beside_wall("down", 60e-3, 80e-3))
    wide = engagement(band_of_workpiece(100e-3, -30e-3), 40e-3)
    assert wide == pytest.approx(beside_wall("up", 60e-3, 80e-3))


def test_angles_come_back():
    arc = (math.radians(20.0), math.radians(130.0))
    assert engagement(band_between_angles(*arc, 8e-3), 8e-3) == pytest.approx(arc)
    assert engagement(band_between_angles(0.0, math.pi, 8e-3), 8e-3) == pytest.approx((0, math.pi))
    assert band_between_angles(0.0, math.pi, 8e-3) == SLOT


@pytest.mark.parametrize("mode", ["up", "down"])
def test_a_pass_before_leaves_a_wall_that_follows_the_tool(mode):
    """Points of an edge that lie within the tool of the pass before, as drawn, do not cut."""
    step, radius = 0.4e-3, np.array([0.15e-3, 0.2e-3, 0.5e-3, 2.2e-3, 5e-3])
    entry, leave = slice_engagement(band_beside_pass(mode, step), radius)
    phi = np.linspace(1e-4, math.pi - 1e-4, 20001)
    for r, first, last in zip(radius, entry, leave, strict=True):
        x, y = r * np.sin(phi), r * np.cos(phi)
        before = -step if mode == "up" else step
        # the pass before has swept a strip along x as wide as the edge is at this height
        cut = np.abs(y - before) > r
        assert phi[cut][0] == pytest.approx(max(first, 1e-4), abs=3e-4)
        assert phi[cut][-1] == pytest.approx(min(last, math.pi - 1e-4), abs=3e-4)
        assert np.all(x[cut] >= 0.0)
    # the full radius of a cylinder: as a radial depth of the step
    assert (entry[-1], leave[-1]) == pytest.approx(beside_wall(mode, step, 10e-3))
