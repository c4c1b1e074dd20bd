"""Jobs of docs/ordinary-jobs.md, run as they stand there; their numbers by hand."""

import math
import re
import shlex

import pytest

from tests.command_line import chatter_command
from tests.places import ROOT

PAGE = (ROOT / "docs" / "ordinary-jobs.md").read_text(encoding="utf-8")
#: lines of a job that are indented: its command, and what is printed
JOB = re.compile(r"^    (chatter .+)\n((?:    > .+\n)*)", re.MULTILINE)
JOBS = [
    (command, [line.removeprefix("    > ") for line in printed.splitlines()])
    for command, printed in JOB.findall(PAGE)
]


def case_file(folder):
    """The case of the page."""
    begin, end = PAGE.index("    title ="), PAGE.index("\n## ")
    lines = [line.removeprefix("    ") for line in PAGE[begin:end].splitlines()]
    (folder / "job.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")


@pytest.mark.parametrize(("command", "printed"), JOBS, ids=[command for command, _ in JOBS])
def test_a_job_prints_what_the_page_says(command, printed, tmp_path, monkeypatch):
    case_file(tmp_path)
    monkeypatch.chdir(tmp_path)
    result = chatter_command(*shlex.split(command)[1:])
    shown = result.stdout + result.stderr
    assert printed
    for words in printed:
        assert words in shown
    if "--exit-code" in command:
        assert result.exit_code == 3


def test_numbers_of_the_page_are_those_of_the_textbook():
    speed = 60.0 / (math.pi * 0.016)
    assert f"{speed:.2f} rpm" in PAGE
    assert f"{380.0 / (4.0 * speed):.4f} mm" in PAGE
    cutting = 1900e6 * 0.5e-3 * 8e-3 * 0.38 / 60.0
    edge = 25e3 * 0.5e-3 * 1.0
    assert f"= {cutting:.1f} W" in PAGE
    assert f"power {cutting + edge:.2f} W mean" in PAGE
    assert f"power {cutting + edge + 0.3 * 200e6 * 0.3e-3 * 0.5e-3:.2f} W mean" in PAGE
    effective = 2.0 * math.sqrt(0.5 * 9.5)
    assert f"= {effective:.3f} mm" in PAGE
    assert f"{math.degrees(math.acos(1.0 - 0.4 / (0.5 * effective))):.1f}° at the depth" in PAGE
    assert f"{90.0 - math.degrees(math.asin(30 / 40)):.2f}° to" in PAGE
    angles = [math.degrees(math.acos(y / 40)) for y in (25, -35)]
    assert f"{angles[0]:.2f}° to acos(-35/40) = {angles[1]:.2f}°" in PAGE
    width = 8.0 * (math.cos(math.radians(30.0)) - math.cos(math.radians(100.0)))
    assert f"= {width:.3f} mm across" in PAGE
    assert f"{math.pi * effective * 60.0 / (math.pi * 0.01) * 1e-3:.2f} m/min there" in PAGE


def test_there_are_jobs():
    assert len(JOBS) >= 16
