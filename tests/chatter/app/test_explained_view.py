"""What was explained in the workbench, and the case that it repairs."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path

import pytest

import chatter
from chatter.app.workbench.repaired_case import take_repaired_case
from chatter.app.workbench.studies import explanation_in_words
from chatter.description.errors import InputError
from tests.chatter.studies.whatif.conftest import MACHINE

PATIENCE = 600.0


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
