"""Every view says the command and the Python call that give the same; its tables are saved."""

from __future__ import annotations

import csv
import json
import math
import shlex
import shutil
from itertools import pairwise

import openpyxl
import panel as pn
import pytest

import chatter
from chatter.app.workbench.page import Workbench
from chatter.cli import COMMANDS
from tests.chatter.app.test_views import PATIENCE
from tests.chatter.simulation.virtual_tests.conftest import FILE as SMALL_MACHINE
from tests.chatter.simulation.virtual_tests.test_mode_shapes import BLOCK
from tests.chatter.studies.test_modal_test import write_set
from tests.command_line import chatter_command
from tests.places import EXAMPLES

#: commands that take seconds
QUICK = ("modes", "lobes", "simulate", "whatif", "move", "mode-shapes")


@pytest.fixture
def workbench(tmp_path):
    shutil.copy(EXAMPLES / "two-degrees-of-freedom" / "case.toml", tmp_path / "case.toml")
    (tmp_path / "machine.toml").write_text(BLOCK)
    folder = tmp_path / "measurements" / "set-1"
    folder.mkdir(parents=True)
    (folder / "measurement.toml").write_text('kind = "milling"\ncase = "../../case.toml"\n')
    taps = tmp_path / "taps-tool-x"
    taps.mkdir()
    write_set(taps, 0)
    page = Workbench(tmp_path)
    assert page.tap_test.computations.wait(PATIENCE)
    yield page
    page.end()


def texts(view):
    """Sentences of a view that stand under its pictures, before anything is started."""
    panes = pn.panel(view.__panel__()).select(pn.pane.Str)
    return "\n".join(str(pane.object) for pane in panes if pane.object)


def test_every_view_says_what_gives_the_same(workbench):
    for number, (name, view) in enumerate(workbench.views.items()):
        workbench.tabs.active = number
        if name == "Stability":
            assert view.diagram.computations.wait(PATIENCE)
        told = texts(view)
        calls = [line for line in told.splitlines() if line.startswith("chatter")]
        commands = [shlex.split(line)[1] for line in calls if line.startswith("chatter ")]
        assert commands, name
        assert set(commands) <= set(COMMANDS), name
        functions = [line.split(".")[1].split("(")[0] for line in calls if line[7:8] == "."]
        assert functions, name
        assert all(callable(getattr(chatter, one)) for one in functions), name


def shown_pairs(workbench):
    """Command and call of every button that is quick, as the views show them."""
    told = ""
    for number, name in enumerate(workbench.views):
        workbench.tabs.active = number
        told += texts(workbench.views[name]) + "\n"
    workbench.studies.choice.value = "whatif"
    told += texts(workbench.studies)
    lines = [line for line in told.splitlines() if line.startswith("chatter")]
    pairs = {shlex.split(one)[1]: (one, other) for one, other in pairwise(lines)
             if one.startswith("chatter ") and other.startswith("chatter.")}  # fmt: skip
    return {name: pairs[name] for name in QUICK}


def numbers_of(told):
    """Every number of a summary, by its path, but times of computation."""
    if isinstance(told, dict):
        return {
            f"{key}.{path}": one
            for key, value in told.items()
            if "second" not in key
            for path, one in numbers_of(value).items()
        }
    if isinstance(told, list):
        return {
            f"{index}.{path}": one
            for index, value in enumerate(told)
            for path, one in numbers_of(value).items()
        }
    return {"": told} if isinstance(told, float) and math.isfinite(told) else {}


def test_command_and_call_of_a_view_give_the_same_numbers(workbench, tmp_path, monkeypatch):
    text = (tmp_path / "case.toml").read_text().replace(":400", ":20")
    (tmp_path / "case.toml").write_text(text)
    (tmp_path / "machine.toml").write_text(SMALL_MACHINE)
    workbench.machine.refresh()
    workbench.machine._opened()
    pairs = shown_pairs(workbench)
    monkeypatch.chdir(tmp_path)
    for name, (command, call) in pairs.items():
        spoken = chatter_command(*shlex.split(command)[1:], "--json")
        assert spoken.exit_code == 0, spoken.stderr
        of_command = numbers_of(json.loads(spoken.stdout))
        of_call = numbers_of(eval(call, {"chatter": chatter}).summary())
        assert len(of_call) > 2, name
        # `simulate` says besides what the linear analysis says, `move` answers by name
        of_one = {key.removeprefix("fast."): one for key, one in of_command.items()}
        same = {key: one for key, one in of_one.items() if key in of_call}
        assert same == pytest.approx(of_call), name


def test_the_calls_follow_what_is_chosen(workbench):
    cut = workbench.cut
    workbench.tabs.active = list(workbench.views).index("Cut")
    assert "dexel" not in texts(cut)
    cut.carve.value = True
    assert "--set simulation.chip=dexel" in texts(cut)
    measurement = workbench.measurement
    measurement.case.value = measurement.case.options[1]
    assert "chatter explain measurements/set-1 --case case.toml" in texts(measurement)


def test_modes_and_numbers_of_a_cut_are_saved_as_tables(workbench):
    as_text, as_book = workbench.tap_test.tables
    rows = list(csv.reader(as_text.callback()))
    shown = workbench.tap_test.mode_table()
    assert rows[0] == list(shown.headings)
    # the modes that the set was made of
    assert [float(row[0]) for row in rows[1:]] == pytest.approx([660.0, 700.0, 1480.0], rel=0.002)
    sheet = openpyxl.load_workbook(as_book.callback()).active
    assert [one.value for one in sheet[1]] == list(shown.headings)
    workbench.session.set_values([("cut.axial_depth", "0.5 mm")])
    workbench.cut.start()
    assert workbench.cut.computations.wait(PATIENCE)
    numbers = dict(csv.reader(workbench.cut.tables[0].callback()))
    told = workbench.cut.result.summary()
    assert numbers["verdict"] == "stable"
    assert float(numbers["largest force [N]"]) == pytest.approx(told["peak_resultant_N"])
