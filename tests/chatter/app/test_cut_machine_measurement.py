"""Cut, machine and measurement in the workbench, driven in process."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.io.wavfile
import tomlkit

import chatter
from chatter.app.workbench.cut_view import sound_of
from chatter.app.workbench.diagnostic_figure import MODEL_COLOURS, diagnostic_figure
from chatter.app.workbench.page import Workbench
from chatter.app.workbench.repaired_case import take_repaired_case
from chatter.app.workbench.studies import explanation_in_words
from chatter.description.errors import InputError
from chatter.explain.measurement_file import read_measurement
from tests.chatter.simulation.virtual_tests.test_mode_shapes import BLOCK
from tests.chatter.studies.whatif.conftest import MACHINE
from tests.places import EXAMPLES

PATIENCE = 600.0


@pytest.fixture
def workbench(tmp_path):
    shutil.copy(EXAMPLES / "two-degrees-of-freedom" / "case.toml", tmp_path / "case.toml")
    (tmp_path / "machine.toml").write_text(BLOCK)
    page = Workbench(tmp_path)
    yield page
    page.end()


def test_a_cut_is_simulated_and_heard(workbench):
    view = workbench.cut
    workbench.session.set_values([("cut.axial_depth", "0.5 mm")])
    assert not view._pictures.visible  # axes of nothing
    view.start()
    assert view.computations.wait(PATIENCE)
    assert (view._pictures.visible, view._carved.visible) == (True, False)
    assert view.message.object.startswith("stable")
    told = json.loads((workbench.session.results("simulate") / "summary.json").read_text())
    # the peak of the summary is that of the settled cut
    settled = view.signals.data["time"] >= view.result.time[view.result.judged.start]
    drawn = np.abs(view.signals.data["Fx"][settled]).max()
    assert drawn == pytest.approx(told["peak_force_N"]["Fx"], rel=0.02)
    rate, heard = scipy.io.wavfile.read(view._sound_file())
    assert rate == 44_100
    assert len(heard) >= 2 * rate
    # the wall in micrometres, the last revolutions of it
    deviation = view.result.finish.walls[0].profiles.deviation * 1e6
    drawn = np.array(view.surface.faces.data["deviation"])
    assert deviation.min() <= drawn.min() < drawn.max() <= deviation.max()
    assert np.ptp(drawn) > 0.2 * np.ptp(deviation[:, len(deviation[0]) // 2 :])
    view.player.value = 50
    assert view._figures["force"].x_range.end == pytest.approx(0.5 * view.result.time[-1])


def test_the_cut_on_the_page_is_that_of_the_open_case(workbench, tmp_path):
    """Another case was opened, and the cut of the one before stood under its name."""
    (tmp_path / "other.toml").write_text((tmp_path / "case.toml").read_text())
    view = workbench.cut
    view.start()
    assert view.computations.wait(PATIENCE)
    view.refresh()
    workbench.session.set_values([("cut.axial_depth", "0.4 mm")])
    view.refresh()
    assert "was changed after" in view.message.object
    assert view._pictures.visible
    workbench.open("other.toml")
    view.refresh()
    assert view.result is None
    assert not view._pictures.visible
    assert view._before.objects == []
    workbench.session.open("case.toml")
    view.refresh()
    assert view._before.objects  # as it was saved


def test_the_sound_has_the_frequency_of_the_tool():
    time = np.arange(0.0, 0.5, 2e-5)
    moved = np.zeros((len(time), 3))
    moved[:, 1] = 1e-5 * np.sin(2.0 * np.pi * 500.0 * time)
    heard = sound_of(SimpleNamespace(settled=slice(0, len(time)), time=time, displacement=moved))
    line = np.argmax(np.abs(np.fft.rfft(heard.astype(float)))) * 44_100 / len(heard)
    assert line == pytest.approx(500.0, abs=2.0)


def test_mode_shapes_swing(workbench):
    view = workbench.machine
    view.refresh()
    assert view.file.value == "machine.toml"
    view.start("mode_shapes")
    assert view.work.computations.wait(PATIENCE)
    assert len(view.rest.data["xs"]) == 12
    view.player.value = 0
    assert np.allclose(view.moved.data["xs"], view.rest.data["xs"])
    view.player.value = 6  # a quarter of the period
    assert not np.allclose(view.moved.data["xs"], view.rest.data["xs"])
    told = view.call.objects[0].object
    assert told.splitlines() == [
        "chatter mode-shapes machine.toml",
        "chatter.mode_shapes(chatter.load_machine('machine.toml'))",
    ]


def test_results_of_a_machine_stay_beside_one_another(workbench, tmp_path):
    """FRFs were gone from the page once a move was made."""
    view = workbench.machine
    view.refresh()
    for name in ("frf", "move"):
        folder = view._folder(name)
        folder.mkdir(parents=True)
        (folder / "call.json").write_text(json.dumps({"title": f"heading {name}"}))
        view._done(name)
    headings = [one.object for one in view._results if "heading" in str(getattr(one, "object", ""))]
    assert [text.count("heading move") for text in headings] == [1, 0]
    assert "heading frf" in headings[1]


def test_a_case_on_a_machine_leaves_no_path_of_this_computer(tmp_path):
    """Notes and files of results held the whole path of the machine file."""
    folder = tmp_path / "jobs"
    shutil.copytree(EXAMPLES / "solid-crossbeam", folder / "crossbeam")
    page = Workbench(folder)
    try:
        assert page.session.name == "crossbeam/case.toml"
        page.sheet.choice.value = "check"
        page.sheet.start()
        assert page.sheet.work.computations.wait(PATIENCE)
        results = page.session.results("check")
        notes = json.loads((results / "call.json").read_text())["notes"]
        assert any("dynamics of crossbeam/machine.toml" in note for note in notes)
        for path in results.iterdir():
            assert str(tmp_path).encode() not in path.read_bytes(), path.name
        page.stability.refresh()
        diagram = page.stability.diagram
        assert diagram.computations.wait(PATIENCE)
        assert "crossbeam/machine.toml" in diagram.message.object
        assert str(tmp_path) not in diagram.message.object
    finally:
        page.end()


def test_a_machine_without_a_move_says_so(workbench):
    view = workbench.machine
    view.refresh()
    view.start("move")
    assert "no [move.NAME]" in view.work.message.object


def test_channels_are_assigned_by_hand(workbench, tmp_path):
    view = workbench.measurement
    time = np.arange(0.0, 0.1, 1e-4)
    rows = ["time [s],F1 [N],a1 [m/s^2]", *(f"{t},{np.sin(t)},{np.cos(t)}" for t in time)]
    view.take({"run01.csv": "\n".join(rows).encode()})
    assert set(view.assignment.channels) == {"F1", "a1"}
    quantity, side, direction = view.assignment.channels["F1"]
    quantity.value, side.value, direction.value = "force", "workpiece", "-y"
    run = view.assignment.runs["run01.csv"]
    run.fields["spindle_speed"].value = "9000"
    run.fields["axial_depth"].value = "1000 um"
    run.others.value = "cut time 3 s"
    assert 'run01.csv: others: "cut time 3 s"' in view.fault.object
    run.others.value = "cut_time=3 s; mode=up"
    assert view.fault.object == ""
    view.write()
    written = tomlkit.parse((tmp_path / "measurements/set-1/measurement.toml").read_text())
    assert written["channels"]["F1"].unwrap() == {
        "quantity": "force", "on": "workpiece", "direction": [0, -1, 0]
    }  # fmt: skip
    assert written["run"][0].unwrap() == {
        "file": "run01.csv", "spindle_speed": "9000 rpm", "axial_depth": "1000 um",
        "cut_time": "3 s", "mode": "up",
    }  # fmt: skip
    assert (tmp_path / "measurements/set-1" / written["case"]).resolve() == tmp_path / "case.toml"


def test_a_usual_name_shows_what_it_tells_and_is_left_out_once_emptied(workbench, tmp_path):
    """A channel Fz that was left empty was compared all the same, as its name is a usual one."""
    view = workbench.measurement
    times = np.arange(0.0, 0.1, 1e-4)
    rows = ["time [s],Fx [N],Fz [N],F9 [N]", *(f"{t},{np.sin(t)},{np.cos(t)},1" for t in times)]
    view.take({"run01.csv": "\n".join(rows).encode()})
    told = {name: [one.value for one in row] for name, row in view.assignment.channels.items()}
    assert told["Fz"] == ["force", "tool", "z"]
    assert told["F9"] == ["", "tool", ""]
    assert "channels" not in tomlkit.parse(view.text.value)
    view.assignment.channels["Fz"][0].value = ""
    view.write()
    folder = tmp_path / "measurements" / "set-1"
    written = tomlkit.parse((folder / "measurement.toml").read_text())
    assert written["channels"].unwrap() == {"Fz": {"quantity": "unused"}}
    (run,) = read_measurement(folder).runs
    assert sorted(run.signals) == ["F9", "Fx", "time"]
    # where a record begins is said of usual names too
    view.assignment.begins.value = "air"
    assert tomlkit.parse(view.text.value)["record"]["begins"] == "air"


def test_a_bad_unit_of_a_run_is_told_at_its_fields(workbench):
    """It was told once *Compare* was pressed."""
    view = workbench.measurement
    view.take({"run01.csv": record("F1")})
    run = view.assignment.runs["run01.csv"]
    run.fields["axial_depth"].value = "2 kg"
    assert "axial_depth" in run.fault.object
    assert "kg" in run.fault.object
    run.fields["axial_depth"].value = "2 mm"
    assert run.fault.object == ""
    run.others.value = "flute=3"
    assert "flute is not a key of a run" in run.fault.object


def test_a_direction_is_an_axis_with_its_sign_or_three_numbers(workbench):
    view = workbench.measurement
    view.take({"run01.csv": record("F1")})
    quantity, _, direction = view.assignment.channels["F1"]
    quantity.value = "force"

    def written(text):
        direction.value = text
        return tomlkit.parse(view.text.value)["channels"]["F1"]["direction"]

    assert written(" -Z ") == [0, 0, -1]
    assert written("+x") == [1, 0, 0]
    assert written("0.6, -0.8, 0") == [0.6, -0.8, 0.0]
    assert written("") == written("unknown") == "unknown"
    written("normal")
    assert 'channel F1: direction: "normal"' in view.fault.object


def test_what_is_shown_is_compared_with_the_open_case_beside_the_folder(workbench, tmp_path):
    """The open case lies outside of the new folder: its own draft was refused in the process of a
    comparison, which took the file as it was before the channels were assigned."""
    view = workbench.measurement
    view.take({"run01.csv": record("F1")})
    view.assignment.channels["F1"][0].value = "force"
    view.start("compare")
    assert view.work.computations.wait(PATIENCE)
    assert "lies outside" not in view.work.message.object
    path = tmp_path / "measurements/set-1/measurement.toml"
    assert tomlkit.parse(path.read_text())["channels"]["F1"]["quantity"] == "force"
    # what another program has written meanwhile is not overwritten by what is shown
    path.write_text("kind = 'none'\n")
    view.start("compare")
    assert view.work.computations.wait(PATIENCE)
    assert "none of milling" in view.work.message.object


def test_files_of_one_drop_stay_together_when_work_begins_meanwhile(workbench, tmp_path):
    """The later ones went into the folder that was proposed for what is dropped next."""
    view = workbench.measurement
    view.upload.begun("run01.csv")
    view.take({"run01.csv": record("F1")})
    view.start("compare")
    assert view.work.computations.wait(PATIENCE)
    assert view.name.value == "set-2"
    view.upload._last_part = time.monotonic() - 5.0  # a busy page pauses
    view.upload.begun("run02.csv")
    view.take({"run02.csv": record("F1")})
    folder = tmp_path / "measurements" / "set-1"
    written = tomlkit.parse((folder / "measurement.toml").read_text())
    assert [run["file"] for run in written["run"]] == ["run01.csv", "run02.csv"]
    # the next drop is of the folder that is named now, and begins anew
    view.assignment.kind.value = "axis"
    view.upload._last_part -= 60.0
    view.upload.begun("run03.csv")
    view.take({"run03.csv": record("F1")})
    written = tomlkit.parse((tmp_path / "measurements/set-2/measurement.toml").read_text())
    assert (written["kind"], [run["file"] for run in written["run"]]) == ("milling", ["run03.csv"])
    # a file of a name that is there already is of another set, and so is one under a typed name
    view.start("compare")
    view.upload._last_part = time.monotonic() - 5.0
    view.upload.begun("run03.csv")
    view.take({"run03.csv": record("F2")})
    view.name.value = "typed"
    view.upload.begun("run04.csv")
    view.take({"run04.csv": record("F2")})
    measured = tmp_path / "measurements"
    assert "F1" in (measured / "set-2" / "run03.csv").read_text()
    assert "F2" in (measured / "set-3" / "run03.csv").read_text()
    assert (measured / "typed" / "run04.csv").is_file()


def test_a_large_file_is_told_to_arrive_and_a_later_drop_to_join(workbench):
    """The page stood still while a file came; a second set joined the first without a word."""
    view, told = workbench.measurement, []
    view.work.message.param.watch(lambda event: told.append(event.new), "object")

    def send(name, parts):
        for number, part in enumerate(parts, start=1):
            data = {"name": name, "chunk": number, "total_chunks": len(parts), "data": part,
                    "type": "text/csv"}  # fmt: skip
            view.upload._process_event(SimpleNamespace(event_name="upload_event", data=data))

    content = record("F1")
    send("run01.csv", [content[:400], content[400:800], content[800:1600], content[1600:]])
    arriving = [one for one in told if "is arriving" in one]
    assert arriving[0] == "run01.csv is arriving (25 %) ..."
    assert len(arriving) == 3
    assert "dropped last" not in view.work.message.object
    send("run02.csv", [content])  # of the same drop
    assert "dropped last" not in view.work.message.object
    view.upload._last_part -= 60.0
    send("run03.csv", [content])
    assert "the files dropped last are with those that were there before" in (
        view.work.message.object
    )


def test_judged_cuts_are_a_table_of_their_case(workbench, tmp_path):
    view = workbench.measurement
    own = (tmp_path / "case.toml").read_bytes()
    rows = b"spindle_speed [rpm],axial_depth [mm],stable\n20000,0.5,1\n20000,9.5,0\n"
    view.take({"points.csv": rows, "case.toml": own})
    view.assignment.kind.value = "stability"
    view.write()
    written = tomlkit.parse((tmp_path / "measurements/set-1/measurement.toml").read_text())
    assert written.unwrap() == {"kind": "stability", "case": "case.toml", "points": "points.csv"}
    assert "is written" in view.work.message.object


def record(channel):
    time = np.arange(0.0, 0.1, 1e-4)
    rows = [f"time [s],{channel} [N]", *(f"{t},{np.sin(t)}" for t in time)]
    return "\n".join(rows).encode()


def test_records_that_come_one_by_one_are_runs_all_of_them(workbench, tmp_path):
    """The first became a run; those that the page received after it did not."""
    view = workbench.measurement
    files = {"run01.csv": record("F1")}
    view.take(files)
    assert not view._channels.collapsed
    view.assignment.channels["F1"][0].value = "force"
    view.take({**files, "run02.csv": record("F1")})
    written = tomlkit.parse((tmp_path / "measurements/set-1/measurement.toml").read_text())
    assert [run["file"] for run in written["run"]] == ["run01.csv", "run02.csv"]
    # what was assigned meanwhile stays
    assert written["channels"]["F1"]["quantity"] == "force"
    # a measurement.toml that is dropped counts, whenever it comes
    own = b'kind = "milling"\ncase = "../../case.toml"\n[[run]]\nfile = "run02.csv"\n'
    view.take({**files, "run02.csv": record("F1"), "measurement.toml": own})
    assert (tmp_path / "measurements/set-1/measurement.toml").read_bytes() == own
    assert "no [[run]]" not in view.work.message.object


def test_files_of_the_folder_before_do_not_go_into_the_next(workbench, tmp_path):
    """The third set was the second one again, with its measurement.toml."""
    view = workbench.measurement

    def drop(name):
        view.upload.value[name] = record("F1")
        view.upload.param.trigger("value")

    drop("run01.csv")
    view.name.value = "other"
    drop("run02.csv")
    folder = tmp_path / "measurements" / "other"
    assert {path.name for path in folder.iterdir()} == {"run02.csv", "measurement.toml"}
    # once work on a folder has begun, what is dropped is a new one
    view.start("compare")
    assert view.name.value == "set-2"
    assert view.work.computations.wait(PATIENCE)


def test_the_repaired_case_is_accepted_under_a_new_name(workbench, tmp_path):
    view = workbench.measurement
    folder = tmp_path / "measurements" / "set-1"
    folder.mkdir(parents=True)
    (folder / "measurement.toml").write_text('kind = "milling"\ncase = "../../case.toml"\n')
    view.refresh()
    results = view._results("explain")
    results.mkdir(parents=True)
    chatter.load(tmp_path / "case.toml").patch({"material.Ktc": "700 MPa"}).save(
        results / "case-updated.toml"
    )
    (results / "explanation.json").write_text('{"effects": [{"name": "runout"}]}')
    view._show()
    assert not view.accept_button.disabled
    assert not view.none_to_accept.visible
    view.accept()
    assert workbench.session.name == "repaired.toml"
    assert chatter.load(tmp_path / "repaired.toml").material.Ktc == pytest.approx(700e6)
    view.accept()
    assert "is there already" in view.work.message.object


def test_a_repaired_machine_goes_with_its_case(workbench, tmp_path):
    """It stood among the results, where the next explanation would have changed it."""
    results = tmp_path / "results" / "set-1" / "explain"
    results.mkdir(parents=True)
    (tmp_path / "machine.toml").write_text(MACHINE)
    on_machine = chatter.load(tmp_path / "case.toml").patch(
        {"structure.mode": None, "structure.machine": str(tmp_path / "machine.toml")}
    )
    repaired = on_machine.patch({"machine.damping_ratio": 0.07})
    repaired.save(results / "case-updated.toml")
    assert (results / "case-updated-machine.toml").is_file()
    target = take_repaired_case(workbench.session, results, "repaired.toml")
    shutil.rmtree(results)
    case = chatter.load(target)
    assert Path(case.structure.machine) == tmp_path / "repaired-machine.toml"
    assert case.machine_file().damping_ratio == 0.07
    # another of the name is not written over
    results.mkdir(parents=True)
    repaired.save(results / "case-updated.toml")
    target.unlink()
    with pytest.raises(InputError, match=r"repaired-machine\.toml: is there already"):
        take_repaired_case(workbench.session, results, "repaired.toml")


def test_no_case_is_offered_where_nothing_was_found(workbench, tmp_path):
    """The refitted case, and the declared one of contradictory data, were offered as repaired."""
    view = workbench.measurement
    folder = tmp_path / "measurements" / "set-1"
    folder.mkdir(parents=True)
    (folder / "measurement.toml").write_text('kind = "milling"\ncase = "../../case.toml"\n')
    view.refresh()
    assert "no repaired case yet" in view.none_to_accept.object
    results = view._results("explain")
    results.mkdir(parents=True)
    shutil.copy(tmp_path / "case.toml", results / "case-updated.toml")
    fatal = {"severity": "fatal", "description": "Fx of all runs is a copy"}
    for found, told in (
        ({"verdict": "nothing-missing"}, "lacks nothing"),
        ({"verdict": "unexplained"}, "no known effect"),
        ({"verdict": "unexplained", "partial": [{"name": "wear"}]}, "not certain"),
        ({"verdict": "unexplained", "checks": [fatal]}, "Fx of all runs is a copy"),
    ):
        (results / "explanation.json").write_text(json.dumps(found))
        view._show()
        assert view.accept_button.disabled
        assert told in view.none_to_accept.object
    view.accept()
    assert not (tmp_path / "repaired.toml").exists()
    (results / "explanation.json").write_text('{"verdict": "unexplained", "empirical": [{}]}')
    view._show()
    assert not view.accept_button.disabled


def test_a_measurement_that_lacks_its_runs_says_so(workbench, tmp_path):
    view = workbench.measurement
    folder = tmp_path / "measurements" / "set-1"
    folder.mkdir(parents=True)
    (folder / "measurement.toml").write_text('kind = "milling"\ncase = "../../case.toml"\n')
    view.refresh()
    view.start("compare")
    assert view.work.computations.wait(PATIENCE)
    assert "there is no [[run]]" in view.work.message.object


def test_no_accepted_case_leaves_the_folder(workbench):
    with pytest.raises(InputError):
        workbench.session.new_path("../x.toml")


def test_an_explanation_is_told_in_the_units_of_people():
    """ "mode_shift: slope -5.421e-05 s/rad; error over the signal: noise floor 0.2418, ..." """
    stiffness = {"value": 1.25e7, "unit": "N/m", "ci95": [1.2e7, 1.3e7]}
    effect = {"name": "missing_mode", "description": "a mode that is not declared",
              "probability": 0.99, "parameters": {"stiffness": stiffness}}  # fmt: skip
    told = explanation_in_words({
        "verdict": "explained", "effects": [effect],
        "error": {"declared": 0.6446, "before": 0.453, "after": 0.0431, "noise_floor": None},
    })  # fmt: skip
    assert told == [
        "verdict: explained",
        "missing mode (probability 0.99): a mode that is not declared; "
        "stiffness 12.5 N/um (12 to 13)",
        "error of the prediction over the signal: of the declared case 64.5 %, refitted 45.3 %, "
        "with the effects 4.31 %",
    ]


def test_an_explanation_without_effects_has_no_errors_with_them():
    error = {"declared": 0.104, "before": 0.0319, "after": 0.0319, "noise_floor": 0.0327}
    _, told = explanation_in_words({"verdict": "nothing-missing", "effects": [], "error": error})
    assert told == ("error of the prediction over the signal: of the declared case 10.4 %, "
                    "refitted 3.19 %, of noise alone 3.27 %")  # fmt: skip


def test_a_cancelled_study_says_that_start_goes_on(workbench):
    """ "cancelled" alone: whoever read it believed that all was lost."""
    view = workbench.studies
    view.choice.value = "pitch"
    view.start()
    until = time.monotonic() + PATIENCE
    while not view.work.computations._running and time.monotonic() < until:
        time.sleep(0.01)
    view.work.computations.cancel()
    assert view.work.computations.wait(PATIENCE)
    assert "Start goes on where it stopped" in view.work.message.object
    # a sheet keeps nothing
    workbench.sheet.start()
    while not workbench.sheet.work.computations._running and time.monotonic() < until:
        time.sleep(0.01)
    workbench.sheet.work.computations.cancel()
    assert workbench.sheet.work.computations.wait(PATIENCE)
    assert workbench.sheet.work.message.object == "cancelled"


def test_bars_of_a_model_have_the_colour_of_its_curve():
    """The refitted case was orange in the curves and blue in the bars, the repaired one so too."""
    panel = {"kind": "Bars", "categories": ["run01"], "label": "residual over noise",
             "series": {"refitted": [9.0], "repaired": [1.0]}, "floor": 1.0}  # fmt: skip
    bars = {one.glyph.top: one.glyph.fill_color for one in diagnostic_figure(panel, "").renderers}
    assert bars == {name: MODEL_COLOURS[name] for name in ("refitted", "repaired")}
