"""The docs: their tables are those of the registries, their links lead somewhere."""

import importlib.util
import re

import pytest

from tests.places import ROOT

DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md"))]


@pytest.fixture(scope="module")
def tables():
    specification = importlib.util.spec_from_file_location("docs_tables", DOCS / "tables.py")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", sorted(DOCS.glob("*.md")), ids=lambda path: path.name)
def test_tables_are_current(tables, path):
    page = path.read_text(encoding="utf-8")
    assert tables.current(page) == page, "run python docs/tables.py"


def test_every_table_stands_in_a_page(tables):
    pages = "".join(path.read_text(encoding="utf-8") for path in DOCS.glob("*.md"))
    assert set(re.findall(r"<!-- table: (.+?) -->", pages)) == set(tables.TABLES)


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_links_lead_to_files(path):
    for target in re.findall(r"\]\(([^)#]+)\)", path.read_text(encoding="utf-8")):
        assert target.startswith("https://") or (path.parent / target).exists(), target


def test_the_readme_is_short():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").split()) <= 700


def places_named(page):
    """Modules and packages of the project that a page names in backquotes or by their path."""
    found = set(
        re.findall(r"\b(?:chatter|cutting|dynamics|tests|benchmarks)/[\w/]+(?:\.py)?", page)
    )
    # commands of a shell may name folders that a study writes
    return {one.rstrip("/") for one in found}


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_modules_that_pages_name_are_there(path):
    for one in places_named(path.read_text(encoding="utf-8")):
        place = ROOT / one
        assert any(place.with_suffix(end).exists() for end in ("", ".py", ".md", ".txt")), one


PACKAGES = [
    path
    for folder in ("chatter", "cutting", "dynamics")
    for path in sorted((ROOT / folder).rglob("__init__.py"))
]


@pytest.mark.parametrize("path", PACKAGES, ids=lambda path: str(path.parent.relative_to(ROOT)))
def test_tables_of_packages_name_what_is_in_them(path):
    rule = re.compile(r"^=+ =+$")
    lines = path.read_text(encoding="utf-8").splitlines()
    rules = [index for index, line in enumerate(lines) if rule.match(line)]
    if not rules:
        return
    width = lines[rules[0]].index(" ")
    for line in lines[rules[1] + 1 : rules[2]]:
        for name in re.findall(r"[\w.]+", line[:width]):
            entry = path.parent / name
            assert entry.exists() or entry.with_suffix(".py").exists(), name


THEORY = [one for one in sorted((DOCS / "theory").glob("*.md"))
          if one.stem not in ("index", "bibliography")]  # fmt: skip


@pytest.mark.parametrize("path", THEORY, ids=lambda path: path.stem)
def test_a_method_has_equations_a_figure_and_a_source(path):
    page = path.read_text(encoding="utf-8")
    assert page.count("$$") >= 2
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", page)
    assert pictures
    assert all((path.parent / one).is_file() for one in pictures)
    cited = {key for keys in re.findall(r"\{cite\}`([^`]+)`", page) for key in keys.split(",")}
    known = set(re.findall(r"^@\w+\{(\w+),", (DOCS / "references.bib").read_text(), re.M))
    assert cited
    assert cited <= known
