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


def test_dither_below_a_thousandth_of_the_feed_is_no_chatter():
    # a corner whose lowest slices hardly cut: their teeth come and go, and a perturbation of a
    # millionth of the feed grows among these kinks to some nanometres, at half of the limit
    case = chatter.Case.from_dict(
        {
            "tool": {
                "kind": "bull nose", "teeth": 2, "diameter": "60.4579 mm", "helix": "47.7362 deg",
                "corner_radius": "1.74628 mm",
                "runout": {"offset": "3.34324 um", "angle": "237.717 deg"},
            },
            "material": {"Ktc": "1186.86 MPa", "Krc": "253.353 MPa", "Kac": "157.497 MPa"},
            "cut": {
                "mode": "down", "spindle_speed": "1479.02 rpm", "feed_per_tooth": "20.4024 um",
                "axial_depth": "0.705 mm", "radial_depth": "23.5572 mm",
            },
            "structure": {
                "mode": [
                    {
                        "frequency": 212.238, "damping": 0.03181, "stiffness": 3.3579e6,
                        "direction": [0.647379729, -0.279146589, -0.70920848],
                    },
                    {
                        "frequency": 192.583, "damping": 0.015, "stiffness": 5.80321e6,
                        "direction": [0.897113491, -0.031998043, 0.440639887],
                    },
                    {
                        "frequency": 290.526, "damping": 0.015, "stiffness": 9.05292e6,
                        "direction": [1, 0, 0],
                    },
                    {
                        "frequency": 488.389, "damping": 0.06213, "stiffness": 1.27376e6,
                        "direction": [0, 1, 0],
                    },
                ]
            },
        }
    )  # fmt: skip
    assert chatter.check(case).spectral_radius < 0.7
    assert chatter.simulate(case).detection.verdict == "stable"
