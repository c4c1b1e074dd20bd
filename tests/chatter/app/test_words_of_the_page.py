"""Sentences on the page name no options of commands; legends keep their signs."""

from __future__ import annotations

import pytest
from bokeh.events import LegendItemClick
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

import chatter
from chatter.app.sliders import case_sliders, why_no_friction_slider
from chatter.app.workbench.legend_samples import put_samples_into_legend, set_style
from chatter.app.workbench.page_words import in_words_of_the_page
from chatter.app.workbench.picture_files import legend_above, picture_file
from chatter.app.workbench.stability_view import StabilityView
from tests.places import EXAMPLES


@pytest.mark.parametrize(
    ("told", "shown"),
    [
        ("the time domain decides (--method time-domain)",
         "the time domain decides (the view Cut simulates it)"),
        ('--set "cut time 3 s": PATH=VALUE is required', '"cut time 3 s": PATH=VALUE is required'),
        ('write Ktc = "1650 +- 80 MPa", or --set material.Ktc="1650 +- 80 MPa"',
         'write Ktc = "1650 +- 80 MPa"'),
        ("--set: cut.a: cut.b is given as well", "cut.a: cut.b is given as well"),
        ("--samples: 1 is out of range", "samples: 1 is out of range"),
        ("--mode-count 3", "mode count 3"),
        ("run-1--2.csv: no time, -- none", "run-1--2.csv: no time, -- none"),
    ],
)  # fmt: skip
def test_no_option_of_a_command_stands_on_the_page(told, shown):
    assert in_words_of_the_page(told) == shown


def test_the_legend_of_the_diagram_does_not_hang_on_its_curves():
    """Its signs were gone once the curves had other data and the figure was not painted anew."""
    case = chatter.load(EXAMPLES / "two-degrees-of-freedom" / "case.toml")
    view = StabilityView(case, "case.toml", lambda change: change())
    try:
        (legend,) = view._lobes.legend
        sources = {id(one) for one in (view.limit, view.operating, view.pockets, view.band)}
        samples = [item.renderers[0] for item in legend.items]
        assert not any(id(one.data_source) in sources for one in samples)
        assert not any(one.js_property_callbacks for one in samples)
        # all entries in one row: a second one lay over the frame
        assert legend.ncols == len(legend.items)
        view.show_band([1.0, 2.0], [1.0, 1.0], [2.0, 2.0])
        shown = {item.label.value for item in legend.items if item.visible}
        assert "5 to 95 %" in shown
        assert "optimum" not in shown
    finally:
        view.computations.end()


def test_a_click_on_the_legend_hides_the_curve_and_pictures_keep_it():
    drawn = figure(width=600, height=300, x_range=(0, 3), y_range=(0, 3))
    curve = drawn.scatter([1, 2], [1, 2], legend_label="cut", color="red")
    legend_above(drawn)
    assert put_samples_into_legend(drawn) == {"cut": curve}
    (hide,) = drawn.legend[0].js_event_callbacks[LegendItemClick.event_name]
    assert hide.args["curves"] == [curve]
    assert hide.args["samples"] == drawn.legend[0].items[0].renderers
    assert picture_file(drawn, "svg").read(100).startswith(b"<?xml")


def test_the_sign_of_a_point_has_its_colour():
    drawn = figure()
    columns = {"x": [1.0], "y": [1.0], "colour": ["red"], "marker": ["circle"]}
    drawn.scatter("x", "y", source=ColumnDataSource(columns), color="colour", marker="marker",
                  legend_label="cut")  # fmt: skip
    put_samples_into_legend(drawn)
    set_style(drawn, "cut", {"colour": "red", "marker": "triangle"})
    (sample,) = drawn.legend[0].items[0].renderers
    assert sample.data_source.data["colour"] == ["red"]
    assert sample.data_source.data["marker"] == ["triangle"]


def test_a_case_without_friction_says_how_to_add_it():
    """The card called *friction* held no slider of it and no word."""
    case = chatter.load(EXAMPLES / "two-degrees-of-freedom" / "case.toml")
    assert "friction: the case has none" in why_no_friction_slider(case)
    law = {"law": "coulomb-stribeck", "coulomb": "5 N", "static": "5 N",
           "stribeck_velocity": "1 mm/s"}  # fmt: skip
    stated = case.patch({"friction.guide": law, "structure.mode[0].friction": "guide"})
    assert why_no_friction_slider(stated) == ""
    assert "friction.guide.coulomb" in {one.path for one in case_sliders(stated)}
    machine = chatter.load(EXAMPLES / "friction-amplitude" / "case.toml")
    assert "beside machine.toml" in why_no_friction_slider(machine)
    # the vibration that the frictions of a machine are taken at has one
    (vibration,) = [
        one for one in case_sliders(machine) if one.path == "structure.friction_amplitude"
    ]
    assert vibration.unit == "um"
    assert vibration.value == pytest.approx(1e6 * machine.structure.amplitude_at_frictions)
    without = machine.patch({"structure.friction_amplitude": None, "structure.friction": False})
    assert "structure.friction_amplitude" not in {one.path for one in case_sliders(without)}
