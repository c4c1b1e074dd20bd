"""Table of what a publication found beside what a model obtains."""

import csv

import pytest

from chatter.report.published_against_obtained import CALIBRATED, PREDICTED, Finding, write_findings


def test_each_row_says_what_it_proves(tmp_path, capsys):
    findings = [
        Finding("near", 100.0, 114.0, "N"),
        Finding("off", 100.0, 116.0, "N"),
        Finding("a frequency off by 6 %", 50.0, 53.0, "Hz"),
        Finding("fitted", 2.0, 2.0, "N", "", CALIBRATED),
        Finding("in words", "later", "1.5 s"),
    ]
    path = write_findings(findings, tmp_path)
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert [row["kind"] for row in rows] == [PREDICTED] * 3 + [CALIBRATED, PREDICTED]
    assert rows[1]["deviation"] == "+16.0 %"
    assert "of 3 predicted numbers 1 within 15 % (frequencies 5 %)" in capsys.readouterr().out


def test_no_other_kind():
    with pytest.raises(ValueError, match="guessed"):
        Finding("x", 1.0, 1.0, kind="guessed")
