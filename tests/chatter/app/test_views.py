"""Views of the workbench driven in process: upload, pick, slide, click, cancel, save, reopen."""

from __future__ import annotations

import io
import json

import numpy as np
import openpyxl
import pytest

import chatter
from chatter.app.workbench.computations import Computation, Computations
from chatter.app.workbench.page import Workbench
from chatter.app.workbench.picture_files import picture_file
from chatter.app.workbench.separate_process import in_own_process
from chatter.app.workbench.session import LARGEST_FILE, Session
from chatter.app.workbench.studies import run_study
from chatter.app.workbench.table_files import PageTable, as_xlsx, table_of
from chatter.app.workbench.upload import dropper
from chatter.description.errors import InputError, RunError
from chatter.plots.page_picture import drawn_again
from tests.chatter.app.crash import ends_at_once
from tests.places import EXAMPLES

#: s; the first diagram may compile
PATIENCE = 300.0


def test_modes_are_numbered_in_the_form_as_people_count(workbench):
    """ "structure.mode[0].frequency" stood beside "spindle speed"."""
    labels = {path: widget.label for path, widget in workbench.case.widgets.items()}
    assert labels["structure.mode[0].frequency"] == "mode 1: frequency"
    assert labels["structure.mode[1].speed_dependence.mass"] == "mode 2: speed dependence, mass"
    assert labels["cut.spindle_speed"] == "spindle speed"


@pytest.mark.parametrize(
    ("typed", "left_with", "answer"),
    [
        ("Steel 42CrMo4", "Al6061-T6", "Steel 42CrMo4"),  # pasted, the list still whole
        ("7075", "Al7075-T6", "Al7075-T6"),  # an entry that was looked for
        ("", "Al7075-T6", "Al7075-T6"),  # clicked without a word
    ],
)
def test_a_material_that_was_pasted_is_not_the_first_of_the_table(
    tmp_path, typed, left_with, answer
):
    page = Workbench(tmp_path)
    field = page.case.new.answers["material"]
    field.value_input = typed
    field.value = left_with
    assert field.value == answer
    page.end()


def test_form_and_text_follow_each_other_and_comments_stay(workbench, tmp_path):
    view = workbench.case
    view.enter("cut.axial_depth", "80 thou")
    assert 'axial_depth = "80 thou"' in view.text.value or view.errors["cut.axial_depth"].object
    view.enter("cut.axial_depth", "0.1 in")
    assert workbench.session.case.cut.axial_depth == pytest.approx(2.54e-3)
    view.text.value = view.text.value.replace('"0.1 in"', '"3 mm"')
    assert view.widgets["cut.axial_depth"].value == "3 mm"
    assert workbench.session.changed
    view.save()
    saved = (tmp_path / "case.toml").read_text()
    comments = [line for line in saved.splitlines() if "#" in line]
    original = (EXAMPLES / "two-degrees-of-freedom" / "case.toml").read_text()
    assert comments
    assert comments == [line for line in original.splitlines() if "#" in line]
    assert chatter.load(tmp_path / "case.toml").cut.axial_depth == pytest.approx(3e-3)


def test_an_error_stands_beside_its_field(workbench):
    view = workbench.case
    view.enter("cut.spindle_speed", "20 mm")
    assert "20 mm" in view.errors["cut.spindle_speed"].object
    assert not view.errors["cut.axial_depth"].object
    view.save()
    assert "spindle_speed" in view.message.object
    view.text.value = "title = "
    assert view.message.object
    view.enter("cut.axial_depth", "2 mm")  # the text is no TOML: nothing breaks
    assert view.text.value == "title = "


def test_a_section_is_added_with_its_errors(workbench):
    view = workbench.case
    view.add("process_damping")
    assert "missing" in view.errors["process_damping.coefficient"].object
    view.enter("process_damping.coefficient", "12 N/mm")
    assert workbench.session.case.process_damping.coefficient == pytest.approx(12e3)
    view.enter("process_damping.coefficient", "")
    assert workbench.session.case is None


def test_a_mode_is_given_a_friction_by_the_form(workbench):
    """The list of sections had none chosen at first, and no friction."""
    view = workbench.case
    assert view.section.value in view.section.options
    view.add("friction: of mode 2")
    assert "missing" in view.errors["friction.mode_2.coulomb"].object
    view.enter("friction.mode_2.coulomb", "12 N")
    case = workbench.session.case
    assert case.structure.mode[1].friction == "mode_2"
    assert case.friction["mode_2"].coulomb == pytest.approx(12.0)
    assert "friction: of mode 2" not in view.section.options
    workbench.stability.refresh()
    assert workbench.stability.diagram.sliders["friction.mode_2.coulomb"].value == 12.0


def test_sliders_go_into_the_case(workbench):
    workbench.stability.refresh()
    diagram = workbench.stability.diagram
    diagram.sliders["cut.axial_depth"].value = 1.25
    workbench.stability.keep_sliders()
    assert workbench.session.case.cut.axial_depth == pytest.approx(1.25e-3)
    assert workbench.case.widgets["cut.axial_depth"].value == "1.25 mm"


def test_a_slider_goes_into_the_case_in_its_unit_and_comments_stay(workbench, tmp_path):
    """Among inches there were millimetres of seven digits."""
    text = workbench.session.text.replace("[tool]", "# of the drawer\n[tool]")
    workbench.session.set_text(text)
    workbench.session.set_values([("cut.axial_depth", "80 thou"), ("cut.spindle_speed", "200 Hz")])
    tab = workbench.stability
    tab.refresh()
    tab.diagram.sliders["cut.axial_depth"].value = 2.54
    tab.diagram.sliders["cut.spindle_speed"].value = 9000.0
    tab.keep_sliders()
    assert 'axial_depth = "100 thou"' in workbench.session.text
    assert 'spindle_speed = "150 Hz"' in workbench.session.text
    assert "# of the drawer" in workbench.session.text


def test_friction_of_a_machine_follows_a_slider_and_is_saved_as_another_machine(tmp_path):
    for name in ("case.toml", "machine.toml"):
        text = (EXAMPLES / "friction-amplitude" / name).read_text()
        (tmp_path / name).write_text(text)
    page = Workbench(tmp_path)
    tab = page.stability
    tab.refresh()
    slider = tab.diagram.sliders["machine.friction.guide.coulomb"]
    assert (slider.label, slider.value) == ("friction guide of the machine [N]", 10.0)
    slider.value = 25.0
    assert "'machine.friction.guide.coulomb=25 N'" in tab.diagram._same_call(tab.diagram.moved())
    tab.keep_sliders()
    assert 'machine = "case-machine-1.toml"' in page.session.text
    assert 'coulomb = "25 N"' in (tmp_path / "case-machine-1.toml").read_text()
    assert (tmp_path / "machine.toml").read_text() == text  # other cases may name it
    page.end()


def test_two_cases_stand_side_by_side(workbench, tmp_path):
    case = chatter.load(tmp_path / "case.toml")
    case.patch({"material.Ktc": "1200 MPa", "material.Krc": "400 MPa"}).save(tmp_path / "hard.toml")
    tab = workbench.stability
    tab.refresh()
    tab.other.value = "hard.toml"
    for one in (tab.diagram, tab.beside):
        assert one.computations.wait(PATIENCE)
    lowest = [np.nanmin(one.limit.data["depth"]) for one in (tab.diagram, tab.beside)]
    assert lowest[1] == pytest.approx(0.5 * lowest[0], rel=0.01)


def test_process_damping_raises_the_limit_of_a_case_without_it(workbench):
    tab = workbench.stability
    tab.refresh()
    assert tab.diagram.computations.wait(PATIENCE)
    before = np.nanmin(tab.diagram.limit.data["depth"])
    tab.diagram.sliders["process_damping.coefficient"].value = 50.0
    assert tab.diagram.computations.wait(PATIENCE)
    assert np.nanmin(tab.diagram.limit.data["depth"]) > 1.05 * before


def test_frfs_take_the_place_of_the_modes(workbench, tmp_path):
    frequency = np.arange(300.0, 1500.0, 1.0)
    omega = 2.0 * np.pi * frequency
    values = 1.0 / (
        0.05 * ((2.0 * np.pi * 900.0) ** 2 - omega**2 + 0.04j * 2.0 * np.pi * 900.0 * omega)
    )
    lines = ["frequency [Hz],real [m/N],imag [m/N]"]
    lines += [f"{f},{v.real},{v.imag}" for f, v in zip(frequency, values, strict=True)]
    workbench.stability.take_frfs({"tip.csv": "\n".join(lines).encode()})
    assert workbench.stability.message.object.startswith("tip.csv: in place of the modes")
    assert "tip.csv" in workbench.session.text
    assert "structure.mode" not in workbench.session.text


def test_a_study_runs_and_its_results_open_again(workbench, tmp_path):
    view = workbench.sheet
    view.start()
    assert view.work.computations.wait(PATIENCE)
    folder = workbench.session.results("sheet")
    assert (folder / "sheet.pdf").read_bytes().startswith(b"%PDF")
    assert (folder / "sheet.xlsx").is_file()
    assert "<svg" in (folder / "page-1.svg").read_text()
    assert json.loads((folder / "call.json").read_text())["command"] == "chatter sheet case.toml"
    again = Workbench(tmp_path)
    assert len(again.sheet._result.objects) >= 3
    again.end()


def test_a_study_that_did_not_end_says_so_when_the_session_is_opened_again(
    workbench, tmp_path, monkeypatch
):
    folder = workbench.session.results("optimum")

    class Ended(BaseException):
        """As the end of a process, of which no line of the study sees anything."""

    def ended(*_, **__):
        raise Ended

    def told(view):
        view.choice.value = "optimum"
        return [str(one.object) for one in view._result.objects]

    assert not told(workbench.studies)
    # what a process that is ended leaves: it began, and took nothing away
    monkeypatch.setattr("chatter.app.workbench.studies.forget_started", lambda folder: None)
    monkeypatch.setattr(chatter, "optimum", ended)
    with pytest.raises(Ended):
        run_study("optimum", workbench.session.case_text, {}, folder, lambda *_: None)
    again = Workbench(tmp_path)
    (words,) = told(again.studies)
    again.end()
    assert "has not come to its end" in words
    assert "Start goes on where it stopped" in words
    # a study that fails has said why, and leaves nothing
    monkeypatch.undo()
    monkeypatch.setattr(chatter, "optimum", ended)
    with pytest.raises(Ended):
        run_study("optimum", workbench.session.case_text, {}, folder, lambda *_: None)
    workbench.studies.choice.value = "pitch"
    assert not told(workbench.studies)


def test_a_value_that_varies_is_chosen_by_its_words(workbench):
    view = workbench.studies
    view.choice.value = "whatif"
    view.options["vary"].value = ""
    offered = view.varied.options
    assert offered["Cut: radial depth"] == "cut.radial_depth"
    assert "Tool: teeth" not in offered  # 20 % more of them are none
    for words in ("Cut: radial depth", "Material: Ktc", "Cut: radial depth"):
        view.varied.value = offered[words]
    assert view.options["vary"].value.splitlines() == [
        "cut.radial_depth=+-20%", "material.Ktc=+-20%"
    ]  # fmt: skip
    view.varied.value = ""
    view.choice.value = "optimum"
    assert view.varied not in list(view._option_row.objects)


@pytest.mark.nightly
def test_a_study_is_cancelled_and_goes_on(workbench, tmp_path):
    text = (tmp_path / "case.toml").read_text().replace('"600 MPa"', '"600 +- 30 MPa"')
    workbench.session.set_text(text)
    view = workbench.studies
    view.choice.value = "uncertainty"
    view.options["count"].value = 40
    view.options["speeds"].value = 5
    done: list[float] = []
    report = view.work.report

    def cancels(stage, share):
        done.append(share)
        report(stage, share)
        if share > 0.3:
            view.work.computations.cancel()

    view.work.report = cancels
    view.start()
    assert view.work.computations.wait(PATIENCE)
    assert view.work.message.object.startswith("cancelled; Start goes on")
    assert max(done) < 1.0
    view.work.report = lambda stage, share: done.append(share)
    done.clear()
    view.start()
    assert view.work.computations.wait(PATIENCE)
    # what was finished before is not computed again
    assert min(share for share in done if share > 0.0) > 0.2
    assert (workbench.session.results("uncertainty") / "uncertainty.csv").is_file()


def test_a_crash_of_a_process_is_a_sentence():
    with pytest.raises(RunError, match="crashed"):
        in_own_process(ends_at_once, (), lambda *_: None, lambda *_: None)


def test_two_sessions_do_not_overwrite_each_other(workbench, tmp_path):
    second = Workbench(tmp_path)
    workbench.case.enter("cut.axial_depth", "1 mm")
    assert second.session.case.cut.axial_depth != pytest.approx(1e-3)
    workbench.case.save()
    second.case.enter("cut.axial_depth", "4 mm")
    second.case.save()
    assert "has changed" in second.case.message.object
    assert chatter.load(tmp_path / "case.toml").cut.axial_depth == pytest.approx(1e-3)
    second.case.save_name.value = "other.toml"
    second.case.save()
    assert chatter.load(tmp_path / "other.toml").cut.axial_depth == pytest.approx(4e-3)
    second.end()


@pytest.mark.parametrize("name", ["../out.toml", "/tmp/x.toml", ".hidden.toml", "a/../../b.toml",
                                  "x.py", "a\0.toml", ""])  # fmt: skip
def test_no_file_outside_the_folder_is_written(tmp_path, name):
    session = Session(tmp_path / "inside")
    with pytest.raises(InputError):
        session.store("taps", {name: b"x"}, (".toml",))
    assert not list(tmp_path.glob("*.toml"))


def test_an_upload_without_end_is_given_up():
    taken: list = []
    widget = dropper(taken.append, "files")

    class Part:
        event_name = "upload_event"

    part = b"x" * (8 * 1024**2)
    for chunk in range(1, LARGEST_FILE // len(part) + 3):
        event = Part()
        event.data = {"name": "big.csv", "chunk": chunk, "total_chunks": 1000, "data": part,
                      "type": "text/csv"}  # fmt: skip
        widget._process_event(event)
    assert sum(len(one) for parts in widget._file_buffer.values() for one in parts) == 0
    assert not taken


def test_pictures_and_tables_are_exported(workbench):
    workbench.stability.refresh()
    diagram = workbench.stability.diagram
    assert diagram.computations.wait(PATIENCE)
    assert picture_file(diagram._lobes, "png").read(8) == b"\x89PNG\r\n\x1a\n"
    assert b"<svg" in picture_file(diagram._lobes, "svg").read(2000)
    (axes,) = drawn_again(diagram._lobes).axes
    named = {one.get_text() for one in axes.get_legend().get_texts()}
    assert "critical axial depth" in named
    assert "5 to 95 %" not in named  # nothing is uncertain, and no band is drawn
    book = openpyxl.load_workbook(as_xlsx(diagram.limits()))
    assert book.active["A1"].value == "spindle_speed [rpm]"
    assert book.active.max_row == 1 + len(diagram.limit.data["speed"])


def test_a_text_of_a_table_is_no_formula():
    content = io.BytesIO(as_xlsx(PageTable(["a"], [["=1+1"]])).read())
    assert openpyxl.load_workbook(content).active["A2"].value == "'=1+1"


def test_an_ended_session_leaves_no_thread():
    computations = Computations(lambda _: None)
    computations.start(Computation(lambda go_on: None, False))
    computations.end()
    computations._thread.join(10.0)
    assert not computations._thread.is_alive()


def test_frfs_of_a_table_are_in_the_units_in_which_people_read_them(tmp_path):
    file = tmp_path / "frf.csv"
    file.write_text("frequency [Hz],real [m/N],imag [m/s/N],run\n100,5e-08,-2e-06,1\n")
    assert table_of(file) == PageTable(
        ["frequency [Hz]", "real [um/N]", "imag [mm/s/N]", "run"],
        [[100.0, pytest.approx(0.05), pytest.approx(-0.002), 1.0]],
    )
