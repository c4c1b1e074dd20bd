"""Every kind of panel is drawn, also where something is missing in it."""

import numpy as np
import pytest

import chatter
from chatter.explain.residuals.dependence import Sample, dependence
from chatter.explain.residuals.finding import Bars, Curve, Curves, Finding, Map, Points
from chatter.explain.residuals.residual_dependence import residual_dependence
from chatter.explain.residuals.signature import diagnosed
from chatter.explain.stability_margin import limits_over
from chatter.io.shipped_examples import examples
from chatter.plots.residual_diagnostics import plot_findings

X = np.array([0.01, 0.1, 1.0, 10.0])
PANELS = {
    "bars": Bars(("run1", "run2"), {"Fx": np.array([1.0, np.nan])}, "left over noise", 1.0),
    "curves": Curves(
        (Curve(X, X, "a", 0.1 * X),), "way [mm]", "left [N]", {"mode": (1.0,)}, 1.0, "xy"
    ),
    "map": Map(X, X, np.full((3, 3), np.nan), "x", "y", "left [N]", "x"),
    "points": Points({"stable": (X, X), "chatter": (X[:0], X[:0])}, "speed", "depth", "y"),
}


@pytest.mark.parametrize("panel", PANELS.values(), ids=PANELS)
def test_a_panel_is_drawn(panel, tmp_path):
    figure = plot_findings([Finding("view", "description", True, {}, panel)])
    assert figure.axes[0].get_title(loc="left") == "view"
    figure.savefig(tmp_path / "panel.png")


def test_all_views_and_the_lead_are_drawn(milling, axis, tmp_path):
    for made in (
        milling(lambda case, time, force: 0.1 * force),
        axis(lambda r: 6.0 * np.sign(r.signals["velocity"]) * np.sign(r.signals["position"])),
    ):
        findings = diagnosed(made)
        figure = plot_findings([*findings, residual_dependence(made, findings).finding])
        figure.savefig(tmp_path / "views.png")
        titles = {axes.get_title(loc="left") for axes in figure.axes}
        assert {one.name for one in findings if one.panel is not None} <= titles


def test_nothing_is_told_where_nothing_is_predicted():
    # bins 0 to 3 hold a cut; in bin 4 hardly anything is predicted, and noise is not a share of it
    rng = np.random.default_rng(1)
    samples = []
    for _ in range(5):
        place = rng.integers(0, 5, 1000)
        weight = np.where(place == 4, 1e-9, 50.0)
        values = 0.2 * weight * (place == 2) + rng.standard_normal(1000)
        samples.append(Sample(values, weight, place))
    found = dependence(samples, 5)
    assert found.significant
    np.testing.assert_allclose(found.coefficients[:4], [0.0, 0.0, 0.2, 0.0], atol=0.01)
    assert np.isnan(found.coefficients[4])


def test_the_limit_among_cutting_tests_is_that_of_another_method():
    case = chatter.load(examples()["one-degree-of-freedom"].folder / "case.toml")
    speeds = np.linspace(7000.0, 9500.0, 7) * np.pi / 30.0
    near = case.patch(
        {"lobes.speeds": {"from": "7000 rpm", "to": "9500 rpm", "count": 7}, "lobes.depths": None}
    )
    other = np.asarray(chatter.lobes(near, method="semi-discretization").limits.critical_depth)
    found = limits_over(case, speeds, np.geomspace(0.2e-3, 6e-3, 60))
    np.testing.assert_allclose(found, other, rtol=0.03)
    # of a grid that ends below it there is none
    assert np.isinf(limits_over(case, speeds[:1], np.array([0.05e-3, 0.1e-3]))).all()
