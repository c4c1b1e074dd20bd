"""Results in a notebook: sentences escaped, picture inlined."""

import ast
import base64
import gzip
import json
import re
import sys
from types import SimpleNamespace

import numpy as np
import panel
import pytest
from matplotlib.figure import Figure

import chatter
from chatter.description.case import loads
from chatter.plots.interactive_picture import interactive_picture
from chatter.report.summary_rows import summary_rows
from tests.cases import TOOL_OF_922_HERTZ
from tests.chatter.studies.test_modal_test import write_set
from tests.dynamics.frf.hammer.hammer_records import CLOSE
from tests.places import ROOT


@pytest.mark.parametrize("call", [chatter.check, chatter.simulate])
def test_a_result_shows_itself(call):
    case = loads(TOOL_OF_922_HERTZ).patch({"title": "<script>x</script>"})
    html = call(case)._repr_html_()
    assert "<script>" not in html
    (source,) = re.findall(r'src="data:image/png;base64,([^"]+)"', html)
    assert base64.b64decode(source).startswith(b"\x89PNG")


def test_a_check_shows_its_verdict_and_its_table():
    result = chatter.check(loads(TOOL_OF_922_HERTZ))
    html = result._repr_html_()
    assert result.sentences()[0] in html
    assert html.count("<tr>") == len(result.rows())


@pytest.fixture
def notebook(monkeypatch):
    """A kernel of Jupyter with Panel loaded in it."""
    shell = SimpleNamespace(get_ipython=lambda: SimpleNamespace(kernel=object()))
    monkeypatch.setitem(sys.modules, "IPython", shell)
    monkeypatch.setattr(panel.extension, "_loaded", True)


def drawn_data(html):
    """Columns of every source in the script of Bokeh."""
    (text,) = re.findall(r"const docs_json = '(.*)';\n", html)
    plain = text.encode().decode("unicode_escape")
    columns: list[dict] = []

    def look(value):
        if isinstance(value, dict):
            if value.get("name") == "ColumnDataSource":
                entries = value["attributes"]["data"]["entries"]
                columns.append({key: values_of(one) for key, one in entries})
            for one in value.values():
                look(one)
        if isinstance(value, list):
            for one in value:
                look(one)

    look(json.loads(plain))
    return columns


def values_of(column):
    if isinstance(column, dict) and column.get("type") == "ndarray":
        content = gzip.decompress(base64.b64decode(column["array"]["data"]))
        return np.frombuffer(content, column["dtype"]).reshape(column["shape"])
    return column


@pytest.mark.usefixtures("notebook")
def test_a_diagram_can_be_zoomed_in_a_notebook():
    case = loads(TOOL_OF_922_HERTZ).patch({"title": "<script>x</script>"})
    diagram = chatter.lobes(case, "zero-order")
    html = diagram._repr_html_()
    assert "<script>x" not in html
    assert "data:image/png" in html
    speeds = diagram.limits.spindle_speed * 30.0 / np.pi
    drawn = [one for one in drawn_data(html) if len(one.get("x", ())) >= 0.9 * len(speeds)]
    lowest = diagram.limits.critical_depth.min() * 1e3
    assert min(np.nanmin(one["y"]) for one in drawn) == pytest.approx(lowest, rel=1e-6)


def test_a_picture_is_drawn_after_the_session_of_a_page_has_ended():
    from bokeh.document import Document
    from bokeh.io.doc import patch_curdoc

    ended = Document()
    ended.callbacks.destroy()
    figure = Figure()
    figure.subplots().plot([1.0, 2.0], [3.0, 5.0])
    with patch_curdoc(ended):
        (line,) = drawn_data(interactive_picture(figure))
    assert line["y"] == pytest.approx([3.0, 5.0])


def test_lines_stand_where_they_were_drawn():
    figure = Figure()
    axes = figure.subplots()
    axes.plot([1.0, 2.0, 4.0], [3.0, 5.0, 1.0], label="limit")
    axes.axvline(3.0)
    axes.set(xlim=(0.0, 5.0), ylim=(0.0, 10.0))
    lines = drawn_data(interactive_picture(figure))
    assert any(np.allclose(one["y"], [3.0, 5.0, 1.0]) for one in lines if len(one["y"]) == 3)
    (upright,) = [one for one in lines if len(one["x"]) == 2]
    assert upright["x"] == pytest.approx([3.0, 3.0])
    assert upright["y"] == pytest.approx([0.0, 10.0])


def test_a_long_line_keeps_its_extremes_in_a_tenth_of_its_points():
    """A move of 50 000 steps made a page of 10 MB."""
    time = np.linspace(0.0, 1.0, 50_000)
    values = np.sin(40.0 * np.pi * time)
    values[12_345] = 7.0
    figure = Figure()
    figure.subplots().plot(time, values, label="force")
    (line,) = [one for one in drawn_data(interactive_picture(figure)) if len(one["y"]) > 100]
    assert len(line["y"]) <= 4002
    assert max(line["y"]) == 7.0
    assert line["x"][0] == 0.0
    assert line["x"][-1] == 1.0
    assert np.interp(line["x"], time, values) == pytest.approx(line["y"])
    # every half wave is there: no step along the line is longer than a part of it
    assert np.diff(line["x"]).max() < 2.5e-3


def test_the_script_waits_for_bokeh_longer_than_a_busy_browser_takes_to_load_it():
    """In JupyterLab the first picture stayed empty where BokehJS came a second late."""
    figure = Figure()
    figure.subplots().plot([0.0, 1.0], [0.0, 1.0])
    (attempts,) = re.findall(r"attempts > (\d+)", interactive_picture(figure))
    assert int(attempts) * 0.01 >= 20.0


def test_an_image_has_its_first_row_where_it_was_drawn():
    figure = Figure()
    rows = np.array([[[255, 0, 0, 255]], [[0, 0, 255, 255]]], dtype=np.uint8)
    figure.subplots().imshow(rows, extent=(0.0, 1.0, 0.0, 2.0), origin="upper")
    (drawn,) = [one for one in drawn_data(interactive_picture(figure)) if "image" in one]
    lowest = values_of(drawn["image"][0])[0]
    assert lowest.view(np.uint8).tolist() == [0, 0, 255, 255]


def test_a_map_stays_a_picture():
    figure = Figure()
    figure.subplots().pcolormesh(np.eye(3))
    assert interactive_picture(figure) is None


def classes_that_draw():
    """Classes of the package with a method `plot`: their methods, and what they are made from."""
    for path in sorted((ROOT / "chatter").rglob("*.py")):
        for one in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(one, ast.ClassDef):
                continue
            methods = {each.name for each in one.body if isinstance(each, ast.FunctionDef)}
            if "plot" in methods:
                bases = {base.id for base in one.bases if isinstance(base, ast.Name)}
                yield one.name, methods, bases


def test_every_result_that_draws_itself_shows_itself():
    found = {name: bases for name, _, bases in classes_that_draw()}
    assert len(found) > 12
    missing = [name for name, bases in found.items() if not bases & {"NotebookResult", "Protocol"}]
    assert [one for one in missing if one != "NotebookResult"] == []


def test_every_result_has_a_short_repr():
    """A notebook holds it beside the page: an explanation had 800 000 characters."""
    long = [
        name for name, methods, bases in classes_that_draw()
        if "NotebookResult" in bases and "__repr__" not in methods and "BriefRepr" not in bases
    ]  # fmt: skip
    assert long == []


def test_a_diagram_says_its_verdict_its_limit_and_its_pockets():
    diagram = chatter.lobes(loads(TOOL_OF_922_HERTZ), "zero-order")
    html, told = diagram._repr_html_(), diagram.summary()
    assert f"lowest limit {told['lowest_limit']['critical_depth_mm']:.4g} mm" in html
    assert f"{told['operating_point']['spindle_speed_rpm']:.0f} rpm" in html


def test_pages_of_a_sheet_are_all_shown():
    sheet = chatter.sheet(loads(TOOL_OF_922_HERTZ))
    assert sheet._repr_html_().count("data:image/png") == len(sheet.plot())


def test_a_modal_test_says_its_modes(tmp_path):
    write_set(tmp_path, 0)
    html = chatter.modes(tmp_path)._repr_html_()
    text = re.sub("<[^>]+>", " ", html.split("<img")[0])
    told = [float(one) for one in re.findall(r"([\d.]+) Hz, damping", text)]
    assert told == pytest.approx([mode[0] for mode in CLOSE.modes], rel=0.002)
    assert len(text) < 500


def test_a_simulation_is_named_in_words_with_its_numbers_in_usual_units():
    result = chatter.simulate(loads(TOOL_OF_922_HERTZ).patch({"title": "thin wall"}))
    html = result._repr_html_()
    assert html.startswith("<p>Simulation: thin wall</p>")
    assert "SimulationResult" not in html
    rows = dict(re.findall(r"<tr><td>(.*?)</td><td>(.*?)</td></tr>", html))
    # 60 times the feed per tooth, teeth and revolutions a second
    cut, tool = result.case.cut, result.case.tool
    feed = 60e3 * cut.feed_per_tooth * tool.teeth * cut.spindle_speed / (2.0 * np.pi)
    assert float(rows["feed rate [mm/min]"]) == pytest.approx(feed, rel=1e-3)
    speed = 60.0 * tool.diameter / 2.0 * cut.spindle_speed
    assert float(rows["cutting speed [m/min]"]) == pytest.approx(speed, rel=1e-3)


def test_rows_of_a_summary_leave_out_what_is_no_cell():
    power = {"mean_W": 1234.56, "deep": {"peak_W": 1.0}}
    summary = {"title": "x", "depth_mm": 1.23456, "list": [1], "damping": 0.01, "stable": True}
    summary |= {"power": power, "runs": 3, "none": None}
    # seconds and newtons below the line of a fraction are none above it
    summary |= {"growth_rate_per_s": -2.0, "receptance_m_per_N": 1e-6}
    assert summary_rows(summary) == [
        ("depth [mm]", "1.235"),
        ("stable", "yes"),
        ("power, mean [W]", "1235"),
        ("runs", "3"),
        ("growth rate [1/s]", "-2"),
        ("receptance [m/N]", "1e-06"),
    ]
