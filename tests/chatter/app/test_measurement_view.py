"""Measurement in the workbench: its channels, runs and files, driven in process."""

from __future__ import annotations

import time
from types import SimpleNamespace

import numpy as np
import tomlkit

from chatter.explain.measurement_file import read_measurement

PATIENCE = 600.0


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
