"""Examples with a story: what is missing is found again, the report holds what it should."""

import json
import math
from dataclasses import replace

import pytest

from chatter.description.case import load
from chatter.explain import lobes_before_after as lobes_before_after_module
from chatter.explain.comparison import compare
from chatter.explain.explanation import explain
from chatter.explain.measurement_file import read_measurement
from chatter.io.shipped_examples import examples

NAMES = ("explain-axis", "explain-frf", "explain-milling", "explain-stability")
HEADINGS = (
    "Effects added",
    "Error before and after",
    "Residual diagnostics",
    "Candidates",
    "Values refitted",
)


def measurement(name):
    return read_measurement(examples()[name].folder / "measurement")


@pytest.mark.parametrize("name", NAMES)
def test_every_example_tells_its_story(name):
    folder = examples()[name].folder
    text = (folder / "README.md").read_text(encoding="utf-8")
    assert "blind_sets" in text  # how the data were made
    for picture in (line for line in text.splitlines() if line.startswith("![")):
        assert (folder / picture.partition("](")[2].rstrip(")")).is_file()
    assert text.count("![") >= 1
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    assert size < 800_000
    assert measurement(name).runs


@pytest.mark.parametrize(
    ("name", "effect", "numbers", "lobes"),
    [
        ("explain-axis", "presliding", {"sigma0": 1588740.0}, False),
        ("explain-frf", "contact", {"stiffness": 1116321.5, "damping": 66.09}, True),
    ],
)
def test_example_runs_and_reports(name, effect, numbers, lobes, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(lobes_before_after_module, "_SPEEDS", 16)
    monkeypatch.setattr(lobes_before_after_module, "_ASKED", 6)
    written = examples()[name].run(tmp_path)
    assert f"missing: {effect}" in capsys.readouterr().out
    assert all(path.is_file() for path in written)
    summary = json.loads((tmp_path / "explanation.json").read_text())
    assert summary["verdict"] == "explained"
    assert summary["next_measurement"]["between"][0]["model"] == effect
    (found,) = summary["effects"]
    for key, true in numbers.items():  # as the generator drew them
        assert found["parameters"][key]["value"] == pytest.approx(true, rel=0.05)
    error = summary["error"]
    assert error["holdout_after"] < 1.3 * error["noise_floor"]
    signature = summary["signature"]
    assert any(view["significant"] for view in signature["refitted"]["diagnostics"])
    assert not any(view["significant"] for view in signature["repaired_model"]["diagnostics"])
    for channel in summary["error_by_channel"].values():
        assert channel["holdout_runs"]["repaired"] < channel["holdout_runs"]["refitted"]
        assert channel["holdout_runs"]["repaired"] < 1.5 * channel["noise_floor"]

    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for heading in (*HEADINGS, *(["Lobes before and after"] if lobes else [])):
        assert f"<h2>{heading}</h2>" in page
    for view in signature["refitted"]["diagnostics"]:
        if view["significant"]:
            assert view["description"][:40] in page
    assert "<script" not in page
    assert "http" not in page  # nothing is fetched
    assert page.count("data:image/png;base64") >= 3
    if lobes:
        # a contact acts in the cut, and the lobes with it are not those without
        assert "by itself does not act in linear lobes" not in page
        assert "From refitted to repaired, the lowest limit goes" in page
    load(tmp_path / "case-updated.toml")


def test_a_mode_that_was_missed_is_found_in_few_runs(monkeypatch):
    whole = measurement("explain-milling")
    few = replace(whole, runs=whole.runs[:3])
    result = explain(few)
    summary = result.summary()
    assert [effect["name"] for effect in summary["effects"]] == ["missing_mode"]
    found = summary["effects"][0]["parameters"]
    assert found["frequency"]["value"] == pytest.approx(1648.8, rel=0.01)
    frequency = next(
        view
        for view in summary["signature"]["refitted"]["diagnostics"]
        if view["name"] == "frequency"
    )
    assert "the case has no natural frequency" in frequency["description"]
    monkeypatch.setattr(lobes_before_after_module, "_SPEEDS", 24)
    lobes = result.lobes
    before, after = (
        lobes.diagrams[step].limits.critical_depth for step in ("refitted", "repaired")
    )
    assert not math.isclose(before.min(), after.min(), rel_tol=1e-3)
    assert not any("does not act" in sentence for sentence in lobes.description)


def test_declared_lobes_forbid_tests_that_were_stable(tmp_path):
    result = compare(measurement("explain-stability"))
    wrong = result.signature.findings[0]
    assert wrong.significant
    assert wrong.numbers["stable_though_predicted_chatter"] > 0.8 * wrong.numbers["misclassified"]
    written = result.save(tmp_path)
    assert {path.name for path in written} == {
        "compare.csv",
        "compare.json",
        "compare.png",
        "signature.png",
    }
    assert json.loads((tmp_path / "compare.json").read_text())["signature"]["diagnostics"]


def test_compare_tells_errors_over_the_noise(tmp_path):
    result = compare(measurement("explain-axis"))
    heading, *rows = result.save(tmp_path)[0].read_text().splitlines()
    assert heading.split(",")[2:4] == ["unit", "rms error"]
    assert heading.split(",")[-2:] == ["noise", "rms error over noise"]
    assert len(rows) == 6
    run, channel, unit, error, _, noise, over = rows[0].split(",")
    assert (run, channel, unit) == ("move01.npz", "force", "N")
    # near rest little is known of the direction, and samples count less
    assert 1.0 < float(over) < float(error) / float(noise)
    assert all(0.2 < float(row.split(",")[5]) < 5.0 for row in rows)
