"""Verdicts on simulated cuts whose truth comes from the multipliers of the linear equations."""

import json
from collections import Counter
from pathlib import Path

import pytest

import chatter

#: made by reference/verdict_cases.py
FILE = Path(__file__).parent / "reference" / "verdict_cases.json"


@pytest.fixture(scope="module")
def sixty():
    """Records with their truth, and the verdict on each."""
    records = json.loads(FILE.read_text())
    cases = [chatter.Case.from_dict(record["document"]) for record in records]
    return [
        (record, chatter.simulate(case).detection)
        for record, case in zip(records, cases, strict=True)
    ]


def test_the_sixty_records_are_of_all_kinds(sixty):
    counted = Counter((record["kind"], record["stable"]) for record, _ in sixty)
    assert len(sixty) == 60
    assert counted["runout", True] >= 5
    assert counted["plain", True] >= 4
    assert counted["plain", False] >= 4
    assert counted["pitch", True] >= 2
    kinds = Counter(record["bifurcation"] for record, _ in sixty if not record["stable"])
    assert kinds["hopf"] >= 5
    assert kinds["flip"] >= 2


def test_at_least_58_of_60_verdicts_are_right(sixty):
    wrong = [
        (record["document"]["title"], record["radius"], detection.reason)
        for record, detection in sixty
        if detection.stable != record["stable"]
    ]
    assert len(wrong) <= 2, wrong


def test_runout_raises_no_alarm(sixty):
    alarms = [
        (record["radius"], detection.reason)
        for record, detection in sixty
        if record["kind"] == "runout" and record["stable"] and not detection.stable
    ]
    assert not alarms
