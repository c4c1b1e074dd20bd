"""Survey of stated probabilities: bins, expected calibration error, wrong names, resume."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.calibration import answers as answers_of_survey
from benchmarks.calibration.answers import read_answers, surveyed
from benchmarks.calibration.picture import draw, interval
from benchmarks.calibration.reliability import bins_of, in_words, summary_of


def answer(truth, effects, partial=(), verdict="explained", kind="frf"):
    def named(name, probability, *beside):
        return {"name": name, "probability": probability, "confounded_with": list(beside)}

    return {
        "kind": kind,
        "number": 1,
        "seed": 1,
        "truth": truth,
        "true_verdict": "explained" if truth else "nothing-missing",
        "verdict": verdict,
        "effects": [named(*one) for one in effects],
        "partial": [named(*one) for one in partial],
        "seconds": 1.0,
    }


ANSWERS = [
    answer(["contact"], [("contact", 0.95)]),
    answer(["contact"], [("missing_mode", 0.95)]),
    answer([], [], [("contact", 0.3)], verdict="nothing-missing"),
    answer([], [("contact", 0.99)]),
    answer(["offset"], [("asymmetry", 0.95, "offset")]),
]


def test_the_calibration_error_is_the_mean_gap_of_the_bins():
    found = summary_of(ANSWERS)
    # 0.95 three times, two of them true; 0.3 once, false; 0.99 once, false
    expected = (3 * abs(0.95 - 2 / 3) + 0.3 + 0.99) / 5
    assert found.error == pytest.approx(expected)
    assert found.statements == 5
    assert [one.count for one in found.bins] == [1, 3, 1]


def test_wrong_names_and_sets_without_effect_are_counted():
    found = summary_of(ANSWERS)
    # a twin that is named as such is no wrong name
    assert (found.named, found.wrong) == (4, 2)
    assert found.nothing == (1, 2)
    assert found.right == (3, 5)
    assert "all" in in_words(ANSWERS)


def test_probabilities_that_come_true_as_often_as_stated_are_calibrated():
    random = np.random.default_rng(1)
    stated = random.uniform(0.0, 1.0, 40_000)
    bins = bins_of(stated, random.random(stated.size) < stated)
    assert sum(one.count for one in bins) == stated.size
    for one in bins:
        low, high = interval(one.true, one.count)
        assert low - 0.01 < one.stated < high + 0.01


def test_the_interval_of_a_share_is_that_of_wilson():
    # Brown, Cai and DasGupta (2001, Stat. Sci. 16:101): 0 of 10 and 5 of 10
    assert interval(0.0, 10) == pytest.approx((0.0, 0.2775), abs=1e-3)
    assert interval(0.5, 10) == pytest.approx((0.2366, 0.7634), abs=1e-3)


def test_a_survey_goes_on_where_it_stopped(tmp_path, monkeypatch):
    asked = []

    def answered(kind, number, seed):
        asked.append((kind, number))
        return {**ANSWERS[0], "kind": kind, "number": number, "seed": seed}

    monkeypatch.setattr(answers_of_survey, "answer_of", answered)
    survey = surveyed(tmp_path, ["frf", "axis"], 4, 7)
    next(survey)
    next(survey)
    survey.close()
    assert len(list(surveyed(tmp_path, ["frf", "axis"], 4, 7))) == 2
    assert asked == [("frf", 1), ("axis", 1), ("frf", 2), ("axis", 2)]
    assert len(read_answers(tmp_path / "answers.jsonl")) == 4
    draw(summary_of(ANSWERS), tmp_path / "reliability.png")
    assert (tmp_path / "reliability.png").stat().st_size > 5000


def test_the_survey_that_is_kept_states_what_comes_true():
    kept = read_answers(Path(answers_of_survey.__file__).parent / "survey" / "answers.jsonl")
    found = summary_of(kept)
    assert found.sets >= 300
    assert found.error < 0.05
    assert found.wrong < 0.02 * found.named
    assert found.nothing[0] == found.nothing[1] > 40
