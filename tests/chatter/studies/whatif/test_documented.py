"""What docs/what-if.md prints fits the shipped examples."""

import re
import shlex

import pytest

from chatter.description.assignments import parse_assignments
from chatter.studies.model import load_model, patched
from chatter.studies.uncertainty.uncertain_parameters import parameters_of
from chatter.studies.whatif.design import chosen_layout, points_of
from chatter.studies.whatif.preset_studies import preset_studies
from chatter.studies.whatif.variation import read_variation
from tests.places import ROOT

TEXT = (ROOT / "docs/what-if.md").read_text(encoding="utf-8")
COMMANDS = [
    words
    for line in re.findall(r"^ {4}(chatter .*)$", TEXT, re.MULTILINE)
    if (words := shlex.split(line))
]


def given(words, option):
    return [words[place + 1] for place, word in enumerate(words) if word == option]


def test_every_study_is_documented():
    assert set(re.findall(r"--study ([\w-]+)", TEXT)) == set(preset_studies())
    assert len(COMMANDS) == 5


@pytest.mark.parametrize("words", COMMANDS, ids=lambda words: " ".join(words[1:4]))
def test_documented_commands_fit_their_files(words):
    file = ROOT / words[2]
    model = patched(load_model(file), parse_assignments(given(words, "--set")))
    if words[1] == "uncertainty":
        assert len(parameters_of(model)) == 2
        return
    variations = [read_variation(text, model) for text in given(words, "--vary")]
    for point in points_of(variations, chosen_layout(variations, "--tornado" in words)):
        patched(model, point.patch)
