"""`--report` of every command: one page that stands alone, as HTML and as PDF."""

import hashlib
import math
import re
from html.parser import HTMLParser

import pytest
import typer.main

from chatter import __version__
from chatter.cli import COMMANDS, program
from chatter.explain.comparison import Comparison
from chatter.explain.errors import ChannelError
from chatter.report.methods import METHODS
from tests.cases import TOOL_OF_922_HERTZ
from tests.command_line import chatter_command
from tests.places import ROOT

CASE = f"""{TOOL_OF_922_HERTZ}
[lobes]
speeds = {{ from = "9000 rpm", to = "11000 rpm", count = 4 }}
depths = {{ to = "4 mm", count = 6 }}
[simulation]
revolutions = 12
"""
RUNS = {
    "check": ["case.toml"],
    "lobes": ["case.toml"],
    "simulate": ["case.toml"],
    "whatif": ["case.toml", "--vary", "cut.axial_depth=0.5 mm, 1 mm", "--result", "critical depth"],
    "modes": [ROOT / "tests/data/frf-beam/point_1.csv"],
    "materials": ["titanium"],
    "examples": [],
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


class Page(HTMLParser):
    """Tags of a page, and its text."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.text = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.text += data


def page_of(path):
    return Page(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_it_and_says_what_it_answers(name):
    command = typer.main.get_command(program).commands[name]
    assert "--report" in [word for one in command.params for word in one.opts]
    assert METHODS[name].question
    assert METHODS[name].how


def test_no_other_method_is_described():
    assert set(METHODS) == set(COMMANDS)


@pytest.mark.parametrize("name", RUNS)
def test_page_stands_alone(name, folder):
    result = chatter_command(name, *RUNS[name], "--report", "deep/page.html")
    assert result.exit_code == 0, result.stderr
    page = page_of(folder / "deep/page.html")
    assert not {tag for tag, _ in page.tags} & {"script", "link", "iframe", "object"}
    sources = [attrs["src"] for tag, attrs in page.tags if "src" in attrs]
    assert all(one.startswith("data:image/png;base64,") for one in sources)
    assert bool(sources) == (name not in {"materials", "examples"})
    assert METHODS[name].how in page.text
    assert f"chatter {name} " in page.text
    assert f"chatter {__version__}" in page.text
    # no length in metres, no bare 1e-05
    assert not re.search(r"0\.000\d+ m\b", page.text)


def test_a_result_whose_files_are_no_pictures_is_drawn(folder):
    """The operator's sheet writes PDF and XLSX: its report had no picture."""
    shown = chatter_command("sheet", "case.toml", "--report", "page.html")
    assert shown.exit_code == 0, shown.output
    pictures = [found for tag, found in page_of(folder / "page.html").tags if tag == "img"]
    assert len(pictures) == 1
    assert pictures[0]["src"].startswith("data:image/png;base64,")


def test_the_case_is_there_with_units_and_its_file_with_its_hash(folder):
    chatter_command("check", "case.toml", "--set", "cut.axial_depth=0.31 mm", "--report", "p.html")
    text = page_of(folder / "p.html").text
    assert "0.31 mm" in text
    assert hashlib.sha256((folder / "case.toml").read_bytes()).hexdigest() in text
    assert "chatter check case.toml --set 'cut.axial_depth=0.31 mm' --report p.html" in text


def test_bare_numbers_of_a_file_have_their_units(folder):
    text = CASE.replace('"600 MPa"', "600e6").replace('"0.03993 kg"', "0.03993")
    assert text.count("600e6") == 1
    (folder / "bare.toml").write_text(text, encoding="utf-8")
    chatter_command("check", "bare.toml", "--report", "p.html")
    page = (folder / "p.html").read_text(encoding="utf-8")
    assert "<td>material.Ktc</td><td>600 MPa</td>" in page
    assert "<td>structure.mode[0].mass</td><td>0.03993 kg</td>" in page
    # pure numbers stay as they are
    assert "<td>structure.mode[0].damping</td><td>0.011</td>" in page


def test_the_verdict_is_the_answer_with_json_too(folder):
    spoken = chatter_command("check", "case.toml", "--report", "words.html")
    silent = chatter_command("check", "case.toml", "--json", "--report", "json.html")
    answer = spoken.stdout.splitlines()[0]
    assert silent.stdout.startswith("{")
    for page in ("words.html", "json.html"):
        assert f'<p class="verdict">{answer}</p>' in (folder / page).read_text(encoding="utf-8")


def test_what_was_found_is_the_answer_and_not_how_well(folder):
    """The report on modes answered with its synthesis error, that on a comparison with a note."""
    chatter_command("modes", *RUNS["modes"], "--report", "modes.html")
    answers = re.findall(r'class="verdict">([^<]*)<', (folder / "modes.html").read_text())
    assert len(answers) == 1
    assert re.fullmatch(r"\d+ modes?: [\d., ]+ Hz", answers[0])


def test_a_comparison_answers_with_its_misses():
    errors = [
        ChannelError(run="a", channel="Fx", error=1.0, relative=0.12, noise=0.5, over_noise=2.0),
        ChannelError(run="b", channel="Fx", error=2.0, relative=0.34, noise=0.5, over_noise=4.0),
    ]
    found = Comparison(None, errors, None).headline
    assert found == "the prediction misses by 12 to 34 % of the signals, 2 to 4 times their noise"
    shares = Comparison(None, [errors[0]._replace(over_noise=math.nan)], None).headline
    assert shares == "the prediction misses by 12 % of the signals"
    assert Comparison(None, [], None).headline == "nothing could be predicted"


def test_hostile_names_are_inert(folder):
    title = "<script>alert(1)</script><img src=x onerror=alert(2)> $\\\\x$"
    hostile = folder / "a<b>&'.toml"
    text = re.sub(r"^title = .*$", "", CASE, flags=re.M)
    hostile.write_text(f'title = "{title}"\n{text}', encoding="utf-8")
    for page in ("p.html", "p.pdf"):
        result = chatter_command("check", hostile.name, "--report", page)
        assert result.exit_code == 0, result.stderr
    page = page_of(folder / "p.html")
    assert "alert(1)" in page.text
    assert "script" not in {tag for tag, _ in page.tags}
    assert not any("onerror" in attrs for _, attrs in page.tags)


def test_chatter_as_exit_code_still_leaves_a_page(folder):
    words = ["check", "case.toml", "--set", "cut.axial_depth=4 mm", "--exit-code"]
    assert chatter_command(*words, "--report", "p.html").exit_code == 3
    assert "chatter: 4 mm" in page_of(folder / "p.html").text


def test_pdf_has_text_in_fonts(folder):
    assert chatter_command("check", "case.toml", "--report", "p.pdf").exit_code == 0
    content = (folder / "p.pdf").read_bytes()
    assert content.startswith(b"%PDF")
    # TrueType with a table of its characters: text that can be selected
    assert b"/ToUnicode" in content
    assert b"/Type3" not in content


@pytest.mark.parametrize("name", ["page.docx", "page"])
def test_other_kinds_are_refused_before_the_work(name, folder):
    result = chatter_command("check", "case.toml", "--report", name)
    assert result.exit_code == 2
    assert "must end in .html or .pdf" in result.stderr
    assert not (folder / name).exists()
