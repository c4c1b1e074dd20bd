"""The manual builds without a warning and without a network; its links lead somewhere."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from urllib.parse import unquote

import pytest

import chatter
from tests.places import ROOT

# the site takes a minute to build
pytestmark = pytest.mark.nightly


class Links(HTMLParser):
    """Targets and identifiers of a page."""

    def __init__(self):
        super().__init__()
        self.targets, self.identifiers, self.fetched = [], set(), []

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.identifiers.update(given[key] for key in ("id", "name") if given.get(key))
        if tag == "a" and given.get("href"):
            self.targets.append(given["href"])
        source = given.get("src") if tag in ("script", "img", "iframe") else None
        if tag == "link" and given.get("rel") in ("stylesheet", "preload", "icon"):
            source = given.get("href")
        if source:
            self.fetched.append(source)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("manual")
    words = ["-W", "--keep-going", "-q", "-b", "html", "-d", str(folder / "doctrees")]
    built = subprocess.run(
        [sys.executable, "-m", "sphinx", *words, str(ROOT / "docs"), str(folder / "html")],
        capture_output=True,
        text=True,
        timeout=900,
    )
    assert built.returncode == 0, built.stderr[-3000:]
    return folder / "html"


@pytest.fixture(scope="module")
def pages(site):
    found = {}
    for path in site.rglob("*.html"):
        reader = Links()
        reader.feed(path.read_text(encoding="utf-8"))
        found[path] = reader
    return found


def test_links_lead_to_pages_and_their_places(pages):
    dead = []
    for path, page in pages.items():
        for target in page.targets:
            if re.match(r"(https?|mailto|javascript):", target):
                continue
            name, _, place = target.partition("#")
            there = (path.parent / unquote(name)).resolve() if name else path
            if there not in pages:
                dead += [] if there.exists() else [f"{path.name}: {target}"]
            elif place and unquote(place) not in pages[there].identifiers:
                dead.append(f"{path.name}: {target}")
    assert not dead


def test_pages_fetch_nothing_from_elsewhere(pages):
    fetched = {source for page in pages.values() for source in page.fetched}
    assert not [source for source in fetched if re.match(r"(https?:)?//", source)]


def test_every_public_name_is_in_the_reference(site):
    page = (site / "reference" / "python.html").read_text(encoding="utf-8")
    names = set(re.findall(r'id="chatter\.([\w.]+)"', page))
    assert {name.rsplit(".", 1)[-1] for name in names} >= set(chatter.__all__)


def test_every_key_of_a_file_is_in_the_reference(site):
    from chatter.description.json_schema import machine_schema
    from chatter.stability.case_schema import schema

    for name, content in (("case", schema()), ("machine", machine_schema())):
        page = (site / "generated" / f"{name}-keys.html").read_text(encoding="utf-8")
        for section in content["$defs"].values():
            for key in section.get("properties", {}):
                assert re.search(rf"\b{re.escape(key)}\b", page), f"{name}: {key}"


def test_formulas_need_no_script(pages, site):
    for path in site.rglob("theory/*.html"):
        assert "\\(" not in path.read_text(encoding="utf-8")
