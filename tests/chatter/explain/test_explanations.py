"""What is missing is named, with its numbers; where nothing is, that is said."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest
import tomlkit

from chatter.description.case import load
from chatter.description.errors import InputError
from chatter.explain import explanation
from chatter.explain.comparison import compare
from chatter.explain.explanation import Explanation, explain
from chatter.explain.measurement_file import read_measurement
from tests.places import DATA

SETS = DATA / "measurements"


def truth(name: str) -> dict:
    return tomlkit.parse((SETS / name / "truth.toml").read_text()).unwrap()


def explained(name: str) -> Explanation:
    return explain(read_measurement(SETS / name))


@pytest.mark.parametrize(
    ("name", "numbers", "closeness"),
    [
        ("set-111", {"coulomb": "coulomb"}, 0.02),
        ("set-112", {"sigma0": "sigma0", "sigma1": "sigma1"}, 0.05),
        ("set-131", {"stiffness": "stiffness_N_per_m", "damping": "damping_Ns_per_m"}, 0.01),
    ],
)
def test_the_missing_effect_is_named_with_its_numbers(name, numbers, closeness):
    summary = explained(name).summary()
    told = truth(name)
    assert summary["verdict"] == "explained"
    assert [effect["name"] for effect in summary["effects"]] == told["effects"]
    (effect,) = summary["effects"]
    for key, true_key in numbers.items():
        found = effect["parameters"][key]
        assert found["value"] == pytest.approx(
            told["true"][effect["name"]][true_key], rel=closeness
        )
        assert found["ci95"][0] < found["value"] < found["ci95"][1]
        assert found["ci95"][0] < told["true"][effect["name"]][true_key] < found["ci95"][1]
    error = summary["error"]
    assert error["after"] < 0.5 * error["before"]
    assert error["holdout_after"] < 0.5 * error["holdout_before"]


@pytest.mark.parametrize("name", ["set-113", "set-132"])
def test_nothing_missing_is_said(name):
    summary = explained(name).summary()
    assert summary["verdict"] == "nothing-missing"
    assert summary["effects"] == []
    assert summary["error"]["before"] == pytest.approx(summary["error"]["after"])


def test_the_updated_case_is_one_and_predicts_as_told(tmp_path):
    result = explained("set-112")
    written = {path.name for path in result.save(tmp_path)}
    assert written == {"explanation.json", "report.html", "residual.png", "case-updated.toml"}
    summary = json.loads((tmp_path / "explanation.json").read_text())
    updated = load(tmp_path / "case-updated.toml")
    measurement = read_measurement(SETS / "set-112", updated)
    assert compare(measurement).summary()["nrmse"] == pytest.approx(
        summary["error"]["after"], rel=1e-3
    )
    assert "<script" not in (tmp_path / "report.html").read_text()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('kind = "drilling"', "drilling"),
        ('kind = "axis"\ncase = 3', "case"),
        ('kind = "axis"\ncase = "case.toml"', "run"),
        ('kind = "axis"\ncase = "case.toml"\n[[run]]\nfile = "none.csv"', "none.csv"),
        ("kind =", "TOML"),
    ],
)
def test_a_wrong_folder_is_told(tmp_path, text, words):
    (tmp_path / "measurement.toml").write_text(text)
    (tmp_path / "case.toml").write_text('[axis]\nmoving_mass = "10 kg"\n')
    with pytest.raises(InputError, match=words):
        read_measurement(tmp_path)


def test_a_missing_channel_is_told(tmp_path):
    (tmp_path / "measurement.toml").write_text(
        'kind = "axis"\ncase = "case.toml"\n[[run]]\nfile = "a.csv"\n'
    )
    (tmp_path / "case.toml").write_text('[axis]\nmoving_mass = "10 kg"\n')
    rows = "\n".join(f"{0.001 * i},{i}" for i in range(50))
    (tmp_path / "a.csv").write_text(f"time [s],force [N]\n{rows}\n")
    with pytest.raises(InputError, match="position"):
        explain(read_measurement(tmp_path))


def test_runs_are_left_out_until_the_case_found_leaves_out_no_more(monkeypatch):
    """Without one run another search; what that finds stands, judged without further ones."""
    found = SimpleNamespace(
        problem=SimpleNamespace(case=lambda _: "case"), of_fitted=SimpleNamespace(by_name={})
    )
    searched, judged = [], []

    def search(runs, *_):
        searched.append(runs)
        return found

    def judged_again(_, runs, __):
        judged.append(runs)
        return found

    def without_too_slow(runs, _):
        return (runs[:-1], [runs[-1]]) if len(runs) > 2 else (runs, [])

    monkeypatch.setattr(explanation, "search", search)
    monkeypatch.setattr(explanation, "judged_again", judged_again)
    monkeypatch.setattr(explanation, "verdict_of", lambda _: explanation.UNEXPLAINED)
    kind = SimpleNamespace(name="milling", without_too_slow=without_too_slow)
    left = explanation._searched((1, 2, 3, 4), SimpleNamespace(kind=kind), None)
    assert left == ((1, 2), found, [4, 3])
    assert searched == [(1, 2, 3, 4), (1, 2, 3)]
    assert judged == [(1, 2)]
