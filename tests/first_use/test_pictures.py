"""Pictures answer what they are looked at for: no staircases, no white, no empty space."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.text import Annotation

import chatter
from chatter.description.unit_system import METRIC
from chatter.description.units import from_rpm
from chatter.explain.kinds.kind import Cuts
from chatter.explain.lobes_before_after import LobesBeforeAfter
from chatter.plots import style
from chatter.plots.explanation import plot_lobes_before_after
from chatter.plots.frf import plot_frf
from chatter.plots.optimum import _kept as _kept_of_an_optimum
from chatter.plots.pitch_design import draw_limits
from chatter.plots.stability_diagram import _between, _draw_across_jumps, _kept, plot_limits
from chatter.plots.uncertainty import _to_the_top, draw_distribution
from chatter.studies.bifurcation import BifurcationDiagram, BifurcationPoint
from chatter.studies.diagram_over_axes import lobes_over
from chatter.studies.pitch_design.pitch_search import Design
from tests.first_use.shop import cut


@pytest.fixture(scope="module")
def over_width():
    return lobes_over(cut(), "cut.radial_depth=2 mm..16 mm:6")


def fill_of(axes):
    """Centres of the cells of the fill, and what they are: 0 stable, 1 chatter, 2 not searched."""
    (image,) = axes.images
    pixels = np.asarray(image.get_array())
    kind = np.full(pixels.shape[:2], -1)
    for number, fill in enumerate(
        (style.STABLE_FILL, style.UNSTABLE_FILL, style.NOT_SEARCHED_FILL)
    ):
        kind[(pixels == np.round(255.0 * to_rgba_array(fill))).all(axis=-1)] = number
    assert (kind >= 0).all()
    left, right, bottom, top = image.get_extent()
    rows, columns = (np.arange(0.5, count) / count for count in kind.shape)
    return left + (right - left) * columns, bottom + (top - bottom) * rows, kind


def labels_of(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_colour_ends_at_the_curve_between_values_too(over_width):
    """`lobes --x`: a staircase of colour beside a smooth curve."""
    x, y, kind = fill_of(plot_limits(over_width).axes[0])
    values, limits = over_width.axis.values, over_width.limits.critical_depth * 1e3
    drawn = np.interp(x, values, limits)
    highest_stable = np.array([y[column == 0].max() for column in kind.T])
    # to within a row of the fill
    assert np.abs(highest_stable - drawn).max() <= 1.01 * (y[1] - y[0])


def test_what_is_not_searched_is_in_the_legend(over_width):
    """White that is not explained."""
    axes = plot_limits(over_width).axes[0]
    kind = fill_of(axes)[2]
    assert set(np.unique(kind)) <= {0, 1, 2}
    assert ("not searched" in labels_of(axes)) == bool((kind == 2).any())
    shallow = lobes_over(
        cut(**{"lobes.depths": {"to": "0.6 mm"}}), "cut.radial_depth=2 mm..16 mm:6"
    )
    axes = plot_limits(shallow).axes[0]
    assert ("not searched" in labels_of(axes)) == bool((fill_of(axes)[2] == 2).any())


def test_the_depth_axis_ends_a_little_above_the_lobes(over_width):
    """The depth axis went to 30 mm for lobes of 2 mm."""
    for diagram in (over_width, chatter.lobes(cut())):
        top = plot_limits(diagram).axes[0].get_ylim()[1]
        highest = 1e3 * diagram.limits.critical_depth.max()
        assert highest < top <= 1.3 * highest


def coarse(speed):
    """Six speeds, and a cut at a speed in rpm."""
    speeds = {"from": "1000 rpm", "to": "2000 rpm", "count": 6}
    values = {"cut__cutting_speed": None, "cut__feed_rate": None, "cut__feed_per_tooth": "0.08 mm"}
    values["cut__spindle_speed"] = f"{speed} rpm"
    return cut(lobes__method="collocation", lobes__speeds=speeds, **values)


def test_few_speeds_draw_the_limit_that_the_words_name():
    """Twenty speeds: 2.93 mm at the operating speed in the picture, 2.453 mm in words."""
    case = coarse(1353)
    diagram = chatter.lobes(case)
    axes = plot_limits(diagram).axes[0]
    (curve,) = [one for one in axes.get_lines() if str(one.get_label()).startswith("limit, coll")]
    wanted = 1e3 * chatter.check(case).critical_depth
    assert np.interp(1353.0, *curve.get_data()) == pytest.approx(wanted, rel=1e-3)
    x, y, kind = fill_of(axes)
    column = kind[:, np.argmin(np.abs(x - 1353.0))]
    assert y[column == 0].max() == pytest.approx(wanted, abs=2.0 * (y[1] - y[0]))
    # the table and the other samples stay those of the speeds asked for
    assert diagram.tables()["lobes"]["spindle_speed [rpm]"].values.size == 6
    lowest = diagram.summary()["lowest_limit"]["spindle_speed_rpm"]
    wanted = {*range(1000, 2001, 200), 1353.0, round(lowest, 6)}
    assert set(np.round(curve.get_xdata(), 6)) == wanted


def test_few_speeds_draw_the_lowest_limit_that_the_words_name():
    """Fourteen speeds: 2.8 mm at the nearest in the picture, 2.44 mm between them in words."""
    diagram = chatter.lobes(coarse(1400))
    figure = plot_limits(diagram)
    (curve,) = [
        one for one in figure.axes[0].get_lines()
        if str(one.get_label()).startswith("limit, coll")
    ]  # fmt: skip
    told = diagram.summary()["lowest_limit"]
    assert told["spindle_speed_rpm"] % 200.0 > 1.0
    drawn = np.nanmin(curve.get_ydata())
    assert drawn == pytest.approx(told["critical_depth_mm"], rel=1e-3)
    assert curve.get_xdata()[np.nanargmin(curve.get_ydata())] == pytest.approx(
        told["spindle_speed_rpm"]
    )
    dots = np.concatenate(
        [one.get_xdata() for one in figure.axes[1].get_lines() if one.get_marker() == "."]
    )
    assert np.isclose(dots, told["spindle_speed_rpm"]).any()


def test_the_frequencies_show_the_operating_speed():
    frequency = plot_limits(chatter.lobes(coarse(1353))).axes[1]
    (line,) = [one for one in frequency.get_lines() if one.get_label() == "operating speed"]
    assert list(line.get_xdata()) == [1353.0, 1353.0]


@pytest.mark.parametrize("speed", [900, 1000, 1400, 2100])
def test_no_limit_is_added_beside_the_speeds_or_at_one_of_them(speed):
    diagram = replace(chatter.lobes(coarse(speed)), at_lowest=None)
    axes = plot_limits(diagram).axes[0]
    (curve,) = [one for one in axes.get_lines() if str(one.get_label()).startswith("limit, coll")]
    assert curve.get_xdata().size == 6


def test_a_cut_far_above_the_lobes_does_not_press_them_to_the_ground():
    """Lobes of 2 mm below a cut of 20 mm filled a tenth of the picture."""
    diagram = chatter.lobes(cut(cut__axial_depth="20 mm", lobes__depths={"to": "30 mm"}))
    axes = plot_limits(diagram).axes[0]
    top = axes.get_ylim()[1]
    assert top <= 1.3e3 * diagram.limits.critical_depth.max()
    (mark,) = [line for line in axes.get_lines() if "operating point" in str(line.get_label())]
    assert "at 20 mm" in [text.get_text() for text in axes.texts]
    assert 0.8 * top < mark.get_ydata()[0] < top
    (arrow,) = [one for one in axes.texts if isinstance(one, Annotation) and one.arrow_patch]
    assert arrow.xy[1] == pytest.approx(top)


def test_a_bifurcation_ends_where_its_points_end():
    """The picture ended at 0.9 mm though points to 1.2 mm were judged."""
    section = np.zeros((3, 3))
    points = [
        BifurcationPoint(
            1e-3 * depth, section if depth < 1.0 else section[:0], "chatter", "hopf", 9e2
        )
        for depth in (0.3, 0.6, 0.9, 1.2)
    ]
    figure = BifurcationDiagram(cut(), "cut.axial_depth", tuple(points)).plot()
    low, high = figure.axes[0].get_xlim()
    assert low <= 0.3
    assert high >= 1.2


def before_after(depths, searched):
    diagram = chatter.lobes(cut(**{"lobes.depths": {"to": f"{searched} mm"}}))
    cuts = Cuts(np.full(len(depths), from_rpm(1500.0)), 1e-3 * np.array(depths),
                np.array([True] * len(depths)))  # fmt: skip
    return LobesBeforeAfter({"declared": diagram}, cuts, ())


@pytest.mark.parametrize(("depths", "searched"), [((0.1, 3.0), 4.0), ((2.0, 29.0), 9.0)])
def test_verdicts_stand_with_the_limit_on_an_axis_that_can_be_read(depths, searched):
    """Verdicts without a limit curve; one tick on a logarithmic axis."""
    figure = plot_lobes_before_after(before_after(depths, searched))
    figure.draw_without_rendering()
    (axes,) = figure.axes
    assert "limit, declared" in [line.get_label() for line in axes.lines]
    low, high = axes.get_ylim()
    labelled = [
        tick for which in ("major", "minor")
        for tick in axes.yaxis.get_ticklocs(minor=which == "minor")
        if low <= tick <= high
    ]  # fmt: skip
    shown = [
        text.get_text()
        for text in (*axes.yaxis.get_ticklabels(), *axes.yaxis.get_ticklabels(minor=True))
        if text.get_text() and low <= text.get_position()[1] <= high
    ]
    assert len(labelled) >= 3
    assert len(shown) >= 2


def test_the_legend_of_frfs_covers_no_curve():
    from chatter.simulation.virtual_tests.frf import FrfCurve, FrfResult
    from dynamics.frf.container import Frf

    frequency = np.linspace(10.0, 500.0, 200)
    one = Frf(frequency, 1e-7 / (1.0 - (frequency / 200.0) ** 2 + 0.05j))
    figure = plot_frf(FrfResult("machine", (FrfCurve("x", "", one),)))
    assert figure.axes[0].get_legend() is None
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["x"]
    assert math.isfinite(legend.get_window_extent().height)


def test_frfs_of_two_units_have_a_panel_each():
    """rad/(N m) and m/N on one axis, six powers of ten apart, made both flat."""
    from chatter.simulation.virtual_tests.frf import FrfCurve, FrfResult
    from dynamics.frf.container import Frf

    frequency = np.linspace(10.0, 500.0, 200)
    one = Frf(frequency, 1e-7 / (1.0 - (frequency / 200.0) ** 2 + 0.05j))
    curves = (
        FrfCurve("x", "", one),
        FrfCurve("motor", "", one, excited="torque", read="rotation"),
        FrfCurve("y", "", one),
    )
    figure = plot_frf(FrfResult("machine", curves))
    lines = {axes.get_ylabel(): [line.get_label() for line in axes.lines] for axes in figure.axes}
    assert lines["receptance [um/N]"] == ["x", "y"]
    assert lines["receptance [urad/(N*m)]"] == ["motor"]


def test_every_word_of_a_long_legend_is_in_the_picture():
    """States of a machine in words, in three columns, were wider than the picture."""
    from chatter.simulation.virtual_tests.frf import FrfCurve, FrfResult
    from dynamics.frf.container import Frf

    frequency = np.linspace(10.0, 500.0, 200)
    one = Frf(frequency, 1e-7 / (1.0 - (frequency / 200.0) ** 2 + 0.05j))
    state = "X: brake, Y: brake, Z: brake, X at 885 mm, Y at 327 mm, Z at 0 mm, no friction"
    for words, columns in ((state, 1), (state[:44], 2), (state[:8], 3)):
        curves = [FrfCurve(f"curve {number}", words, one) for number in range(6)]
        figure = plot_frf(FrfResult("machine", curves))
        figure.canvas.draw()
        (legend,) = figure.legends
        shown = [text.get_window_extent() for text in legend.get_texts()]
        assert len(shown) == 6
        assert min(one.x0 for one in shown) >= 0.0
        assert max(one.x1 for one in shown) <= figure.bbox.width
        assert len({round(one.x0) for one in shown}) == columns


def test_limits_go_on_where_stable_intervals_come_or_go_beside_them():
    """A pale strip at one speed, without a curve along it: an island that opens there."""
    before, after = np.array([0.67]), np.array([0.29, 0.51, 0.71])
    low, high = _kept(before, after)
    assert (low.tolist(), high.tolist()) == ([0.67], [0.71])
    low, high = _kept(after, np.array([0.42]))
    assert (low.tolist(), high.tolist()) == ([0.29], [0.42])
    # in the first half of the way the island is not there yet, and the upper limit goes on
    assert _between([before, after], 0, 0.25) == pytest.approx([0.68])
    assert _between([before, after], 0, 0.75) == pytest.approx([0.29, 0.51, 0.70])
    assert _kept(np.empty(0), after)[0].size == 0


def test_a_lone_value_between_jumps_is_marked():
    figure = Figure()
    axes = figure.subplots()
    x = np.array([1.0, 2.0, 3.0])
    crossings = [np.array([0.67]), np.array([0.29, 0.51, 0.71]), np.array([0.42])]
    _draw_across_jumps(axes, x, crossings, np.array([1, 2]))
    drawn = {tuple(map(float, np.round(line.get_ydata(), 6))) for line in axes.lines}
    assert drawn == {(0.67, 0.71), (0.29, 0.51, 0.71), (0.29, 0.42)}


def test_sections_at_the_ends_of_a_bifurcation_stand_within_the_frame():
    """Half of the first and the last section lay behind the frame."""
    section = np.array([[1e-6, 2e-6, 0.0]])
    points = [BifurcationPoint(v, section, "stable", "none", math.nan) for v in (1e-3, 2e-3)]
    axes = BifurcationDiagram(cut(), "cut.axial_depth", tuple(points)).plot().axes[0]
    low, high = axes.get_xlim()
    assert low < 1.0
    assert high > 2.0


def test_the_depth_of_the_cut_is_written_within_the_axes_of_the_distribution():
    """It stood across the numbers of the axis."""
    limits = np.linspace(0.6e-3, 1.2e-3, 50)
    found = SimpleNamespace(
        operating=limits,
        max_depth=5e-3,
        case=cut(),
        operating_quantiles=lambda: limits[[2, 25, 47]],
        units=METRIC,
    )
    figure = Figure(layout="constrained")
    axes = figure.subplots()
    draw_distribution(axes, found)
    figure.canvas.draw()
    (words,) = (one for one in axes.texts if one.get_text() == "depth of the cut")
    assert words.get_window_extent().x0 >= axes.get_window_extent().x0


def test_lowest_limits_of_a_pitch_design_stand_beside_the_curves():
    """ "3.74 mm" was written across the curve."""
    speeds = from_rpm(np.linspace(4500.0, 6500.0, 5))
    designs = [Design("even", (90.0,) * 4, np.full(5, depth), 0.0) for depth in (1.4e-3, 3.7e-3)]
    found = SimpleNamespace(
        speeds=speeds, original=designs[0], best=designs[1], max_depth=9e-3, units=METRIC
    )
    figure = Figure(layout="constrained")
    axes = figure.subplots()
    draw_limits(axes, found)
    figure.canvas.draw()
    assert [one.get_text() for one in axes.texts] == ["1.4 mm", "3.7 mm"]
    for words in axes.texts:
        assert words.get_window_extent().x0 >= axes.get_window_extent().x1


def test_the_legend_of_an_optimum_is_no_wider_than_its_axes():
    """A quarter of the picture was empty beside it."""
    limits = SimpleNamespace(depth_margin=0.0, speed_margin=0.0, confidence=0.95)
    assert len(_kept_of_an_optimum(limits)) <= 52


def hatched(axes, x, y):
    """Whether a point, in units of the axes, lies in what is hatched."""
    return any(
        path.contains_point((x, y))
        for collection in axes.collections
        if collection.get_hatch()
        for path in collection.get_paths()
    )


def is_near_an_end(found, depth):
    """Whether a depth, mm, is at a limit or at the end of what of it is not certain."""
    shares = [0.0, *(sign * one.share for one in found.neglected for sign in (1.0, -1.0))]
    ends = [1e3 * limit * (1.0 + share) for limit in found.limit.crossings[0] for share in shares]
    return min((abs(depth - end) for end in ends), default=1.0) < 0.02


@pytest.mark.parametrize(
    ("values", "depths"),
    [
        # edge forces at limits, and at speeds that have none
        ({}, (0.3, 0.75, 0.9, 1.0, 1.1, 3.0)),
        ({"tool__flute_length": "1.2 mm"}, (0.3, 1.0, 1.15)),
        # edge forces stiffer than the chip: nothing is certain
        ({"material__Kte": "400 N/mm", "material__Kre": "700 N/mm"}, (0.2, 1.1)),
    ],
)
def test_hatching_says_what_check_says(values, depths):
    """A share was hatched off the end of the axis where no limit is: a stable cut lay in it."""
    case = cut(lobes__method="collocation", **values)
    feed = {"cut.cutting_speed": None, "cut.feed_rate": None}
    feed["cut.feed_per_tooth"] = case.cut.feed_per_tooth
    axes = plot_limits(chatter.lobes(case)).axes[0]
    for speed in (1194, 1250, 1800):
        for depth in depths:
            there = {"cut.spindle_speed": f"{speed} rpm", "cut.axial_depth": f"{depth} mm"}
            found = chatter.check(case.patch({**feed, **there}))
            if depth < axes.get_ylim()[1] and not is_near_an_end(found, depth):
                assert hatched(axes, speed, depth) == (found.verdict == "not certain"), there


def test_nothing_is_hatched_where_no_limit_is_found():
    stiff = {f"structure__mode[{k}]__stiffness": "400 N/um" for k in (0, 1)}
    case = cut(tool__flute_length="1 mm", **stiff)
    axes = plot_limits(chatter.lobes(case)).axes[0]
    assert chatter.check(case).verdict == "stable"
    assert not any(hatched(axes, 1194.0, depth) for depth in (0.3, 0.5, 0.95))


def test_the_band_of_an_uncertain_limit_follows_its_lobes():
    """Thirty-one speeds made teeth of lobes; curves ended short of the top."""
    found = chatter.uncertainty(cut(material__Ktc="1900 +- 100 MPa"), 4)
    assert found.speeds.size > 100
    stop = _to_the_top(np.array([1.0, 2.0, np.inf, np.inf, 3.0, 4.0, np.inf]), 5.0)
    assert stop == pytest.approx([1.0, 2.0, 5.1, 5.1, 3.0, 4.0, 5.1])
    lone = _to_the_top(np.array([1.0, np.inf, np.inf, np.inf, 3.0]), 5.0)
    assert np.isnan(lone[2])
