"""Engagement of an inclined tool against the bodies that it has swept, and areas by hand."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cutting.edge_segments import segments as segments_module
from cutting.edge_segments.engagement_arcs import segments_of_like_teeth
from cutting.edge_segments.inclined_edges import InclinedEdges
from cutting.edge_segments.segments import inclined_edge_segments
from cutting.engagement.inclined_tool import InclinedEngagement, ToolAxis
from cutting.force.linear import LinearLaw
from cutting.tool.cutter import Cutter

BALL = Cutter(10e-3, (math.radians(30.0),) * 2, (math.pi,) * 2, corner_radius=5e-3)
BULL_NOSE = Cutter(10e-3, (math.radians(30.0),) * 2, (math.pi,) * 2, corner_radius=1e-3)
END_MILL = Cutter(10e-3, (math.radians(30.0),) * 2, (math.pi,) * 2)
#: a tapered ball end mill of 10 deg a side, 4 mm at the ball
TAPERED = Cutter(4e-3, (math.radians(30.0),) * 2, (math.pi,) * 2, 2e-3, math.radians(80.0))
#: a chamfer mill of 30 deg a side and a face mill of 45 deg, both with a sharp corner
CHAMFER = Cutter(4e-3, (0.0,) * 2, (math.pi,) * 2, 0.0, math.radians(60.0))
FACE_MILL = Cutter(10e-3, (0.0,) * 2, (math.pi,) * 2, 0.0, math.radians(45.0))
DEPTH = 0.5e-3


def turned(lead, tilt):
    """Rotation of the tool: about +y by the lead, then about -x by the tilt."""
    return Rotation.from_euler("x", -tilt) * Rotation.from_euler("y", lead)


def inside(cutter, rotation, points, shrunk=0.0):
    """Whether points (n, 3), m from the tip, lie within the body of the tool, smaller by a bit."""
    x, y, height = (rotation.inv().apply(points)).T
    out, corner = np.hypot(x, y), cutter.corner_radius
    if cutter.edge_angle < 0.5 * math.pi and not corner:
        return inside_cone(cutter, out, height, shrunk)
    if cutter.edge_angle < 0.5 * math.pi:
        return inside_tapered_ball(cutter, out, height, shrunk)
    beyond = out - (cutter.radius - corner)
    on_corner = np.hypot(np.maximum(beyond, 0.0), height - corner) < corner - shrunk
    below = np.where(beyond > 0.0, on_corner, height > shrunk)
    return np.where(height < corner, below, out < cutter.radius - shrunk)


def inside_cone(cutter, out, height, shrunk):
    """Above the flat end and within the cone that begins at its rim."""
    half = 0.5 * math.pi - cutter.edge_angle
    apart = (out - cutter.radius) * math.cos(half) - height * math.sin(half)
    return (height > shrunk) & (apart < -shrunk)


def inside_tapered_ball(cutter, out, height, shrunk):
    """Within a ball and the cone that touches it, whose apex lies below the tip of the ball."""
    corner, half = cutter.corner_radius, 0.5 * math.pi - cutter.edge_angle
    over_middle = height - corner
    in_ball = np.hypot(out, over_middle) < corner - shrunk
    # distance from the cone, seen from its apex, which lies corner/sin(half) below the middle
    apart = out * math.cos(half) - (over_middle + corner / math.sin(half)) * math.sin(half)
    above = over_middle > -corner * math.sin(half)
    return in_ball | (above & (apart < -shrunk))


def edge_point(cutter, kappa, height, angle):
    """Point of an edge, m from the tip in the axes of the tool."""
    corner = cutter.corner_radius
    out = cutter.radius - corner + corner * math.sin(kappa)
    beyond = height - corner * (1.0 - math.cos(cutter.edge_angle))
    if beyond > 0.0 and cutter.edge_angle < 0.5 * math.pi:
        out += beyond / math.tan(cutter.edge_angle)
    return np.array([out * math.sin(angle), out * math.cos(angle), height])


def lowest_point(cutter, rotation):
    """Height of the lowest of many points of the profile, m."""
    kappa = np.linspace(0.0, cutter.edge_angle, 4001)
    out = cutter.radius - cutter.corner_radius * (1.0 - np.sin(kappa))
    height = cutter.corner_radius * (1.0 - np.cos(kappa))
    up = rotation.apply([0.0, 0.0, 1.0])[2]
    return float(np.min(height * up - out * math.sqrt(1.0 - up * up)))


def uncut(cutter, rotation, point, side, stepover, shrunk):
    """Whether a point is left by all earlier places of the tool, in this pass and the one before.

    Both are sampled along the feed.
    """
    behind = np.geomspace(2e-6, 15e-3, 1500)
    passed = point + np.outer(behind, [1.0, 0.0, 0.0])
    if np.any(inside(cutter, rotation, passed, shrunk)):
        return False
    if stepover is None:
        return True
    across = stepover if side == "up" else -stepover
    along = np.linspace(-15e-3, 15e-3, 6001)
    before = point + np.outer(along, [1.0, 0.0, 0.0]) + [0.0, across, 0.0]
    return not np.any(inside(cutter, rotation, before, shrunk))


@pytest.mark.parametrize(
    ("cutter", "lead", "tilt", "side", "stepover"),
    [
        (BALL, 15, 0, "up", 0.4e-3),
        (BALL, 10, -15, "up", 0.4e-3),
        (BALL, -8, 12, "down", 0.6e-3),
        (BALL, 0, 25, "slot", None),
        (BULL_NOSE, 12, 8, "down", 2e-3),
        (BULL_NOSE, 5, -10, "up", 3e-3),
        (END_MILL, 4, 6, "up", 4e-3),
        (TAPERED, 15, 0, "up", 0.4e-3),
        (TAPERED, -20, 12, "down", 0.6e-3),
        (TAPERED, 0, 62, "up", 0.8e-3),
        (TAPERED, 8, -55, "down", 0.8e-3),
        (CHAMFER, 6, 8, "up", 0.8e-3),
        (CHAMFER, 0, -20, "down", 0.5e-3),
        (CHAMFER, 25, 10, "slot", None),
        (FACE_MILL, 2, 0, "down", 3e-3),
        (FACE_MILL, 4, -6, "up", 4e-3),
    ],
)
def test_arcs_against_the_bodies_that_were_swept(cutter, lead, tilt, side, stepover):
    lead, tilt = math.radians(lead), math.radians(tilt)
    engaged = InclinedEngagement(cutter, ToolAxis(lead, tilt), DEPTH, side, stepover)
    edges = InclinedEdges(engaged, 2e-4)
    rotation = turned(lead, tilt)
    surface = lowest_point(cutter, rotation) + DEPTH
    rng = np.random.default_rng(1)
    place = rng.uniform(0.0, edges.position(engaged.top), 700)
    angle = rng.uniform(-0.5 * math.pi, 1.5 * math.pi, 700)
    profile = edges.profile(place)
    found = edges.arcs(np.zeros(700, dtype=np.int64), place)
    compared = in_the_cut = 0
    for k in range(700):
        kappa, height = float(profile.immersion[k]), float(profile.height[k])
        point = rotation.apply(edge_point(cutter, kappa, height, angle[k]))
        if abs(point[2] - surface) < 2e-6:
            continue
        # what a smaller and a larger tool would leave as well is beyond doubt
        left = {
            point[2] < surface and uncut(cutter, rotation, point, side, stepover, shrunk)
            for shrunk in (2e-6, -1e-7)
        }
        if len(left) > 1:
            continue
        before = np.flatnonzero((found.angle[k] <= angle[k]) & (found.kind[k] >= 0))
        cuts = before.size > 0 and found.tooth[k, before[-1]] >= 0
        assert cuts == left.pop(), (math.degrees(kappa), math.degrees(angle[k]))
        compared, in_the_cut = compared + 1, in_the_cut + cuts
    assert compared > 500
    assert in_the_cut > 10


def test_arcs_are_searched_once_for_any_coefficients(monkeypatch):
    """Every sample of an uncertain coefficient searched them anew at each of some 180 depths."""
    searched = []

    def counted(*given):
        searched.append(given)
        return segments_of_like_teeth(*given)

    monkeypatch.setattr(segments_module, "segments_of_like_teeth", counted)
    engaged = InclinedEngagement(BALL, ToolAxis(0.3, 0.1), 0.41e-3, "down", 0.6e-3, None)
    laws = [[LinearLaw((kt, 2e8, 1e8)), LinearLaw((2.0 * kt, 2e8, 1e8))] for kt in (7e8, 9e8)]
    one, other = (inclined_edge_segments(engaged, pair, 1e-4) for pair in laws)
    assert len(searched) == 1
    assert np.array_equal(one.entry, other.entry)
    assert set(one.cutting[:, 0]) == {7e8, 14e8}
    assert set(other.cutting[:, 0]) == {9e8, 18e8}
    # the second tooth, half a turn behind at the tip, has its own law
    second = one.angle[:, 0] > 0.5 * math.pi
    assert set(one.cutting[second, 0]) in ({7e8}, {14e8})


def swept_section(engaged):
    """Area that the edges sweep over the feed: the chip over the feed, times length and arc."""
    cutter = engaged.cutter
    feed = 1e-4
    segments = inclined_edge_segments(engaged, [LinearLaw((1e9, 0.0, 0.0))] * 2, feed)
    node, weight = np.polynomial.legendre.leggauss(12)
    total = 0.0
    for i in range(segments.bottom.size):
        for x, w in zip(node, weight, strict=True):
            share = 0.5 * (1.0 + x)
            begin, end = (
                arc[i, 0] + share * (arc[i, 1] - arc[i, 0])
                for arc in (segments.entry, segments.exit)
            )
            kappa = segments.immersion[i] @ [1.0 - share, share]
            out = segments.radius[i] @ [1.0 - share, share]
            phi = begin + 0.5 * (1.0 + node) * (end - begin)
            rise = segments.feed * math.sin(kappa) * np.sin(phi)
            chip = (rise - segments.axial_feed * math.cos(kappa)) * 2.0 * math.pi / feed
            mean = 0.5 * (weight @ chip) * (end - begin) * out
            total += 0.5 * w * segments.length[i] * mean
    return total / cutter.teeth


@pytest.mark.parametrize(("lead", "tilt"), [(15, 0), (0, 20), (10, -15), (-8, 5)])
@pytest.mark.parametrize(("side", "stepover"), [("slot", None), ("up", 0.4e-3), ("down", 2e-3)])
def test_edges_of_a_ball_remove_what_lies_between_two_passes(lead, tilt, side, stepover):
    axis = ToolAxis(math.radians(lead), math.radians(tilt))
    found = swept_section(InclinedEngagement(BALL, axis, DEPTH, side, stepover))
    # a ball sweeps a circle however it is inclined
    z = DEPTH * (np.arange(200000) + 0.5) / 200000
    width = 2.0 * np.sqrt(z * (BALL.diameter - z))
    wanted = DEPTH * np.mean(width if stepover is None else np.minimum(width, stepover))
    assert found == pytest.approx(wanted, rel=5e-4)


def test_edges_of_a_tilted_end_mill_remove_a_trapezium():
    tilt, step = math.radians(5.0), 4e-3
    engaged = InclinedEngagement(END_MILL, ToolAxis(0.0, tilt), DEPTH, "down", step)
    # in the section the tool is the corner between its end, which rises by tan(tilt), and its side
    z = DEPTH * (np.arange(200000) + 0.5) / 200000
    wide = z / math.tan(tilt) + z * math.tan(tilt)
    wanted = DEPTH * np.mean(np.minimum(wide, step))
    assert swept_section(engaged) == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize(
    ("lead", "tilt", "side", "stepover"),
    [
        (0, 0, "slot", None),
        (12, -8, "up", 0.4e-3),
        (-15, 0, "slot", None),
        (-10, 6, "down", 0.8e-3),
    ],
)
def test_a_tapered_ball_that_cuts_on_its_ball_alone_is_a_ball(lead, tilt, side, stepover):
    axis = ToolAxis(math.radians(lead), math.radians(tilt))
    ball = Cutter(4e-3, TAPERED.helix, TAPERED.pitch, 2e-3)
    found = [
        swept_section(InclinedEngagement(cutter, axis, 0.2e-3, side, stepover))
        for cutter in (TAPERED, ball)
    ]
    assert found[0] == pytest.approx(found[1], rel=1e-4)


@pytest.mark.parametrize(("tilt", "side"), [(62.0, "up"), (-62.0, "down"), (30.0, "slot")])
def test_edges_of_a_tapered_ball_remove_what_its_outline_leaves(tilt, side):
    """Ball and straight flank in the section across the feed, by hand."""
    depth, step, corner = 1.5e-3, 0.8e-3, 2e-3
    axis = ToolAxis(0.0, math.radians(tilt))
    stepover = None if side == "slot" else step
    found = swept_section(InclinedEngagement(TAPERED, axis, depth, side, stepover))
    z = depth * (np.arange(200000) + 0.5) / 200000
    half = 0.5 * math.pi - TAPERED.edge_angle

    def reach(leaning):
        """Outline towards a side that the axis leans to by an angle, over the lowest point."""
        # the flank rises from the horizontal by 90 deg - leaning - half, and touches the ball
        rise = 0.5 * math.pi - leaning - half
        tangent = corner * (1.0 - math.cos(rise))
        on_ball = np.sqrt(np.maximum(corner**2 - (corner - z) ** 2, 0.0))
        on_flank = corner * math.sin(rise) + (z - tangent) / math.tan(rise)
        return np.where(z < tangent, on_ball, on_flank)

    leaning = abs(axis.tilt)
    # away from the lean a tapered ball leans back: its flank rises by more than upright
    width = reach(leaning) + reach(-leaning)
    wanted = depth * np.mean(width if side == "slot" else np.minimum(width, step))
    assert found == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize(("tilt", "side"), [(8.0, "up"), (-8.0, "down"), (12.0, "slot")])
def test_edges_of_a_tilted_cone_remove_what_its_outline_leaves(tilt, side):
    """Seen along the feed the flat end rises by the tilt on one side, the flank on the other."""
    axis, half = ToolAxis(0.0, math.radians(tilt)), math.radians(30.0)
    step = None if side == "slot" else 0.8e-3
    found = swept_section(InclinedEngagement(CHAMFER, axis, 0.3e-3, side, step))
    z = 0.3e-3 * (np.arange(200000) + 0.5) / 200000
    lean = abs(axis.tilt)
    # from the lowest point on the rim: the flank on its side, the end on the other, both straight
    # up to the depth of the cut: the end reaches up 4 mm sin(tilt), more than that depth
    wide = z * math.tan(half + lean) + z / math.tan(lean)
    wanted = 0.3e-3 * np.mean(wide if step is None else np.minimum(wide, step))
    assert found == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize("cutter", [CHAMFER, FACE_MILL])
def test_a_cone_that_hardly_leads_cuts_what_an_upright_one_does(cutter):
    """Beside a wall at its rim, whose width grows with the cone: by hand."""
    wide = 1e-3
    axis = ToolAxis(1e-7, 0.0)
    engaged = InclinedEngagement(cutter, axis, DEPTH, "up", None, wide)
    taper = math.tan(0.5 * math.pi - cutter.edge_angle)
    wanted = DEPTH * (wide + 0.5 * DEPTH * taper)
    assert swept_section(engaged) == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize(("lead", "tilt", "side"), [(0.0, 1e-7, "up"), (9.0, 0.0, "down")])
def test_a_tapered_ball_beside_a_wall(lead, tilt, side):
    """The wall counts from the outermost point of the ball; the cone above reaches further.

    Leading, its outline across the feed is that of an upright cone of another angle.
    """
    wide, depth = 0.6e-3, 2.6e-3
    axis = ToolAxis(math.radians(lead), math.radians(tilt))
    engaged = InclinedEngagement(TAPERED, axis, depth, side, None, wide)
    z, corner = depth * (np.arange(200000) + 0.5) / 200000, TAPERED.corner_radius
    # seen along the feed: the flank touches the ball where its normal, turned by the lead, does
    half = 0.5 * math.pi - TAPERED.edge_angle
    seen = math.atan(math.tan(half) * _outline_factor(half, engaged.axis.lead))
    tangent = corner * (1.0 - math.sin(seen))
    on_ball = np.sqrt(np.maximum(corner**2 - (corner - z) ** 2, 0.0))
    on_flank = corner * math.cos(seen) + (z - tangent) * math.tan(seen)
    reach = np.where(z < tangent, on_ball, on_flank)
    wanted = depth * np.mean(np.clip(reach - (corner - wide), 0.0, None))
    assert swept_section(engaged) == pytest.approx(wanted, rel=2e-3)


def _outline_factor(half, lead):
    """Growth of tan(half) of a cone whose axis leans by the lead along the line of sight.

    The cone y^2 + x^2 = (tan(half) h)^2 about the axis (sin lead, cos lead): its outline is where
    a line along x touches it, y = z tan(half)/sqrt(cos^2 lead - tan^2(half) sin^2 lead).
    """
    return 1.0 / math.sqrt(math.cos(lead) ** 2 - (math.tan(half) * math.sin(lead)) ** 2)


def test_no_edge_reaches_down_above_the_top():
    """The lowest point of every height above it lies over the uncut surface."""
    axis = ToolAxis(math.radians(-20.0), math.radians(50.0))
    engaged = InclinedEngagement(TAPERED, axis, 1e-3, "slot")
    up = float(axis.direction[2])
    for height, above in [(engaged.top * 1.001, True), (engaged.top * 0.999, False)]:
        lowest = height * up - TAPERED.radius_at(height) * math.sqrt(1.0 - up * up)
        assert (lowest > engaged.floor + 1e-3) == above


def arcs_of(side, tilt, stepover=0.6e-3):
    engaged = InclinedEngagement(BALL, ToolAxis(math.radians(6.0), tilt), DEPTH, side, stepover)
    edges = InclinedEdges(engaged, 2e-4)
    found = edges.arcs(np.zeros(80, dtype=np.int64), np.linspace(1e-5, 4.2e-3, 80))
    return [
        [
            (float(row[k]), float(row[k + 1]))
            for k in range(row.size - 1)
            if met[k] >= 0
        ]
        for row, met in zip(found.angle, found.tooth, strict=True)
    ]  # fmt: skip


def test_up_milling_is_down_milling_in_a_mirror():
    tilt = math.radians(14.0)
    up, down = arcs_of("up", tilt), arcs_of("down", -tilt)
    assert sum(map(len, up)) > 20
    for here, there in zip(up, down, strict=True):
        mirrored = sorted((math.pi - end, math.pi - begin) for begin, end in there)
        assert np.allclose(here, mirrored, atol=1e-8)


@pytest.mark.parametrize("radial_depth", [2e-3, 6e-3])
def test_a_wall_beside_a_tool_that_leads(radial_depth):
    # the tool is as wide across the feed as upright: the wall is where it is beside an upright one
    engaged = InclinedEngagement(
        END_MILL, ToolAxis(math.radians(3.0), 0.0), 0.2e-3, "up", None, radial_depth
    )
    y = np.array([5e-3 - radial_depth - 1e-6, 5e-3 - radial_depth + 1e-6])
    assert np.all((engaged.beside_pass(y, np.zeros(2)) > 0.0) == [False, True])
