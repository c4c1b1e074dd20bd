"""Every code block of the tutorials runs and prints what the page says."""

import sys

import pytest

from tests.places import ROOT

sys.path.insert(0, str(ROOT / "docs" / "site"))
import code_blocks

TUTORIALS = sorted(
    path for path in (ROOT / "docs" / "tutorials").glob("*.md") if path.stem != "index"
)


#: ten seconds and more each; what they show has tests of its own
NIGHTLY = {
    "writing-your-own-law",
    "closing-the-loop-on-real-tests",
    "operators-sheet",
    "pitch-design",
    "learning-from-cuts",
}


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=[pytest.mark.nightly] if path.stem in NIGHTLY else [])
        for path in TUTORIALS
    ],
    ids=lambda path: path.stem,
)
def test_a_tutorial_runs_as_it_stands(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code_blocks.run_page(path)


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.stem)
def test_pictures_of_a_tutorial_are_there(path):
    for name in code_blocks.pictures(path.read_text(encoding="utf-8")):
        assert (ROOT / "docs" / "pictures" / "tutorials" / name).exists(), name


def test_nightly_tutorials_are_there():
    assert {path.stem for path in TUTORIALS} >= NIGHTLY


def test_a_block_that_prints_something_else_fails(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    page.write_text("```python\nprint('limit 1.50 mm')\n```\n```text\nlimit 1.60 mm\n```\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(code_blocks.BlockError, match=r"limit 1\.60 mm"):
        code_blocks.run_page(page)


def test_numbers_may_differ_by_a_hundredth():
    assert not code_blocks.missing("limit 1.50 mm", "limit 1.501 mm")
    assert code_blocks.missing("limit 1.50 mm", "limit 1.52 mm")
    assert code_blocks.missing("limit 1.50 mm", "depth 1.50 mm")
