"""The table of figures: what is met, and a chart that is right."""

import subprocess
import sys

import numpy as np
import pytest

from benchmarks.figures.figure import Figure, Reached
from benchmarks.figures.stability import stable_chart
from benchmarks.scaling import case_of, operations
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model
from tests.places import ROOT


@pytest.mark.parametrize(
    ("value", "more_is_better", "met"),
    [(0.9, False, True), (1.1, False, False), (1.1, True, True), (0.9, True, False)],
)
def test_a_figure_is_met_on_its_side(value, more_is_better, met):
    figure = Figure("name", "work", 1.0, "s", lambda: Reached(value), more_is_better)
    assert figure.is_met(figure.measured()) is met


def test_a_chart_has_the_colour_of_the_spectral_radius():
    cut = element_cut(milling_model(case_of(1)), 20e-3, 6, 1.0)
    speeds = np.linspace(3000.0, 9000.0, 40) * np.pi / 30.0
    chart = stable_chart(cut, speeds, 20e-3, 30)
    depths = (np.arange(30) + 0.5) * 20e-3 / 30
    s, d = np.meshgrid(speeds, depths)
    radius = np.abs(collocation.multipliers(cut, s.ravel(), d.ravel())).reshape(chart.shape)
    clear = np.abs(np.log(radius)) > 1e-3
    assert 0.05 < chart.mean() < 0.95
    assert np.array_equal(chart[clear], radius[clear] < 1.0)


def test_operations_grow_with_the_modes():
    few, many = (operations(element_cut(milling_model(case_of(n)), 1e-3), 60, 7) for n in (2, 8))
    # the response to a mode is the same for each; the rest grows no faster than the state
    assert 1.0 < many / few <= 4.0


def test_unknown_figures_are_named():
    run = [sys.executable, "-m", "benchmarks", "nonsense"]
    found = subprocess.run(run, cwd=ROOT, capture_output=True, text=True, check=False)
    assert found.returncode == 2
    assert "nonsense" in found.stderr
    assert "varying speed" in found.stderr


def test_records_of_the_hammer_are_counted_wherever_they_were_misjudged(monkeypatch):
    from benchmarks import hammer_examination
    from benchmarks.figures import tap_tests

    monkeypatch.setattr(tap_tests, "_SETS", 1)
    examined = tap_tests.FIGURES[0].measured()
    assert examined.value == 0.0
    # where nothing is found, every record with a fault is counted, and no good one
    monkeypatch.setattr(hammer_examination, "examine_records", lambda records: [])
    blind = tap_tests.FIGURES[0].measured()
    assert blind.value > 0.0
    assert blind.bound.startswith(f"0 of {blind.value:.0f} faults found, 0 of ")
