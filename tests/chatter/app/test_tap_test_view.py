"""Tap tests in the workbench, driven in process: upload, overrule, pick, into the case."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import chatter
from chatter.app.workbench.page import Workbench
from tests.chatter.studies.test_modal_test import write_set
from tests.dynamics.frf.hammer.hammer_records import CLOSE

#: s; the first diagram may compile
PATIENCE = 300.0
ANSWERS = {
    "tool": "12 mm, 4",
    "material": "Al7075-T6",
    "cut": "8000 rpm, 0.05 mm, 1 mm",
    "engagement": "down, 6 mm",
}


@pytest.fixture(scope="module")
def taps(tmp_path_factory):
    folder = tmp_path_factory.mktemp("taps")
    write_set(folder, 0)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture
def tapped(tmp_path, taps):
    page = Workbench(tmp_path)
    page.tap_test.take(taps)
    assert page.tap_test.computations.wait(PATIENCE)
    yield page
    page.end()


def frequencies(view):
    return [mode.frequency for mode in view.test.fit.identified]


def test_hammer_files_become_a_case_and_its_modes(tapped, tmp_path):
    view = tapped.tap_test
    assert {name for name, box in view.records.items() if not box.value} == {"tap2.csv", "tap5.csv"}
    view.put_into_case()
    for name, answer in ANSWERS.items():
        tapped.case.new.answers[name].value = answer
    tapped.case.new.create()
    case = chatter.load(tmp_path / "case.toml")
    found = [(mode.frequency, mode.mass) for mode in case.structure.mode]
    for (f, m), (frequency, _, mass) in zip(found, CLOSE.modes, strict=True):
        assert f == pytest.approx(frequency, rel=0.002)
        assert m == pytest.approx(mass, rel=0.03)
    assert tapped.session.name == tapped.choice.value == "case.toml"


def test_a_new_case_is_titled_by_its_answers_and_offers_the_materials(tapped, tmp_path):
    new = tapped.case.new
    offered = new.answers["material"]
    assert {"Al7075-T6", "titanium, alpha and beta alloy, hardened (VDI 37)"} <= set(
        offered.options
    )
    tapped.tap_test.put_into_case()
    # free text stays possible
    for name, answer in {**ANSWERS, "material": "700 MPa, 210 MPa"}.items():
        new.answers[name].value = answer
    new.create()
    case = chatter.load(tmp_path / "case.toml")
    assert case.title == "End mill 12 mm, 4 teeth, Ktc and Krc 700 MPa, 210 MPa"
    assert case.material.values["Ktc"] == pytest.approx(700e6)


def test_files_of_the_direction_before_do_not_go_into_the_next(tapped, tmp_path, taps):
    """The second set of records took those of the first along that it had no names for."""
    view = tapped.tap_test
    assert not view.direction.disabled
    view.upload.value["of-x.csv"] = taps["tap1.csv"]
    view.direction.value = "y"
    name = min(taps)
    view.upload.value[name] = taps[name]
    view.upload.param.trigger("value")
    assert view.direction.disabled  # until the fit has ended
    assert view.computations.wait(PATIENCE)
    assert not view.direction.disabled
    assert [one.name for one in (tmp_path / "taps-tool-y").iterdir()] == [name]


def test_a_new_case_names_the_modes_that_it_takes_up(tapped):
    tapped.case.refresh()
    assert "once there are any" in tapped.case.new.measured.object
    tapped.tap_test.put_into_case()
    assert "the modes of modes-x.toml," in tapped.case.new.measured.object


@pytest.mark.parametrize("when", ["between", "before"])
def test_files_of_one_drop_stay_together_when_the_direction_is_changed_meanwhile(
    tapped, taps, tmp_path, when
):
    """The second file went under the direction that was chosen after the first had come."""
    view = tapped.tap_test
    first, second, later = sorted(taps)[:3]
    before = {one.name for one in (tmp_path / "taps-tool-x").iterdir()}
    view.direction.value = "z"
    with_parts(view.upload, "a.csv", taps[first], [1])
    if when == "before":  # the first has not come whole
        view.direction.value = "y"
    with_parts(view.upload, "a.csv", taps[first], [2])
    view.direction.value = "y"
    assert not view.direction.disabled
    with_parts(view.upload, "b.csv", taps[second], [1, 2])
    assert view.computations.wait(PATIENCE)
    folder = tmp_path / "taps-tool-z"
    assert {one.name: one.read_bytes() for one in folder.iterdir()} == {
        "a.csv": taps[first], "b.csv": taps[second]
    }  # fmt: skip
    assert not (tmp_path / "taps-tool-y").exists()
    assert "b.csv: in taps-tool-z" in view.message.object
    assert view.test is None  # nothing is fitted along y
    # the next drop is of the direction that is chosen now, and takes no file of the one before
    view.upload._last_part -= 10.0
    with_parts(view.upload, "c.csv", taps[later], [1, 2])
    assert view.computations.wait(PATIENCE)
    assert [one.name for one in (tmp_path / "taps-tool-y").iterdir()] == ["c.csv"]
    assert {one.name for one in (tmp_path / "taps-tool-x").iterdir()} == before


def with_parts(widget, name, content, parts):
    """Let parts of a file come, of two."""
    half = len(content) // 2
    for chunk in parts:
        data = content[:half] if chunk == 1 else content[half:]
        widget._process_event(
            SimpleNamespace(
                event_name="upload_event",
                data={"name": name, "chunk": chunk, "total_chunks": 2, "data": data,
                      "type": "text/csv"},
            )
        )  # fmt: skip


def test_a_faulty_record_stays_out_where_records_come_one_after_the_other(tapped, taps):
    """Found faulty after the first files, it was kept as if it were ticked by hand."""
    view = tapped.tap_test
    faulty = {one.record for one in view.test.hammer.excluded}
    assert faulty == {"tap2.csv", "tap5.csv"}
    view.take(taps)
    assert view.computations.wait(PATIENCE)
    assert {one.record for one in view.test.hammer.excluded} == faulty
    assert not faulty & set(view.test.hammer.used)


def test_modes_of_every_direction_that_was_fitted_go_into_the_case(tapped, tmp_path, taps):
    """The first direction was lost where both were dropped before the click."""
    view = tapped.tap_test
    view.direction.value = "y"
    view.take(taps)
    assert view.computations.wait(PATIENCE)
    view.put_into_case()
    assert "modes-x.toml, modes-y.toml" in view.message.object
    for name, answer in ANSWERS.items():
        tapped.case.new.answers[name].value = answer
    tapped.case.new.create()
    modes = chatter.load(tmp_path / "case.toml").structure.mode
    along = [tuple(round(abs(part)) for part in mode.direction) for mode in modes]
    assert along == [(1, 0, 0)] * len(CLOSE.modes) + [(0, 1, 0)] * len(CLOSE.modes)


def test_records_are_overruled_both_ways(tapped):
    view = tapped.tap_test
    view.overrule("tap2.csv", True)
    assert view.computations.wait(PATIENCE)
    assert "tap2.csv" in view.test.hammer.used
    view.overrule("tap1.csv", False)
    assert view.computations.wait(PATIENCE)
    assert "tap1.csv" not in view.test.hammer.used
    assert "--keep tap2.csv" in view.same_call.object
    assert "tap1.csv" not in view.same_call.object


def test_what_is_dropped_later_is_said_to_join_and_can_be_removed(tapped, tmp_path, taps):
    """The files of an earlier drop were used with it, and were not even listed."""
    view, folder = tapped.tap_test, tmp_path / "taps-tool-x"
    name = min(taps)
    with_parts(view.upload, "late.csv", taps[name], [1, 2])
    assert view.computations.wait(PATIENCE)
    assert view.joined.object.startswith(f"late.csv: judged together with the {len(taps)} files")
    assert set(view.records) == {*taps, "late.csv"}
    # the cross of the list in the page takes it out again
    view.upload._process_event(
        SimpleNamespace(event_name="delete_event", data={"name": "late.csv"})
    )
    assert view.computations.wait(PATIENCE)
    assert {one.name for one in folder.iterdir()} == set(view.records) == set(taps)
    view.remove_files()
    assert list(folder.iterdir()) == []
    assert {one.name for one in (tmp_path / "removed" / "taps-tool-x-2").iterdir()} == set(taps)
    assert "removed/taps-tool-x-2" in view.message.object
    assert not view._results.visible
    with_parts(view.upload, "alone.csv", taps[name], [1, 2])
    assert view.computations.wait(PATIENCE)
    assert (set(view.records), view.joined.object) == ({"alone.csv"}, "")


def test_a_tick_of_a_person_stays_when_a_file_joins(tapped, taps):
    view = tapped.tap_test
    view.overrule("tap2.csv", True)
    view.overrule("tap1.csv", False)
    with_parts(view.upload, "late.csv", taps["tap3.csv"], [1, 2])
    assert view.computations.wait(PATIENCE)
    assert "tap2.csv" in view.test.hammer.used
    assert "tap1.csv" not in view.test.hammer.used
    assert not view.records["tap1.csv"].value


def test_frf_files_are_listed_and_can_be_left_out(tmp_path):
    """FRFs had no ticks: a file once dropped could not be taken out."""
    frequency = np.arange(300.0, 1500.0, 1.0)
    omega, natural = 2.0 * np.pi * frequency, 2.0 * np.pi * 900.0
    values = 1.0 / (0.05 * (natural**2 - omega**2 + 0.04j * natural * omega))
    rows = [f"{f},{v.real},{v.imag}" for f, v in zip(frequency, values, strict=True)]
    text = "\n".join(["frequency [Hz],real [m/N],imag [m/N]", *rows]).encode()
    page = Workbench(tmp_path)
    view = page.tap_test
    view.take({"a.csv": text, "b.csv": text})
    assert view.computations.wait(PATIENCE)
    assert set(view.records) == {"a.csv", "b.csv"}
    view.overrule("b.csv", False)
    assert view.computations.wait(PATIENCE)
    assert "taps-tool-x/a.csv" in view.same_call.object
    assert "b.csv" not in view.same_call.object
    page.end()


def test_files_of_another_direction_are_taken_up_from_the_folder(tapped, tmp_path):
    """Records of y that lay there were not shown where x had none."""
    (tmp_path / "taps-tool-x").rename(tmp_path / "taps-tool-y")
    page = Workbench(tmp_path)
    assert page.tap_test.files == []
    page.tap_test.direction.value = "y"
    assert page.tap_test.computations.wait(PATIENCE)
    assert page.tap_test.test is not None
    page.end()


def test_picked_poles_are_the_modes(tapped):
    view = tapped.tap_test
    drawn = np.asarray(view.figures.diagram.data["f"])
    chosen = [CLOSE.modes[0][0], CLOSE.modes[2][0]]
    view.figures.pick([int(np.argmin(np.abs(drawn - f))) for f in chosen])
    view.fit_picked()
    assert view.computations.wait(PATIENCE)
    assert frequencies(view) == pytest.approx(chosen, rel=0.01)
    assert view.same_call.object.count("--pole") == 2


def test_files_that_are_no_records_are_reported(workbench):
    view = workbench.tap_test
    view.take({"notes.csv": b"a,b\n1,2\n"})
    assert view.computations.wait(PATIENCE)
    assert "notes.csv" in view.message.object
    assert str(workbench.session.root) not in view.message.object
