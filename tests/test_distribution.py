"""The wheel, built from the sdist, holds what runs, no more, and runs in a folder of its own."""

import os
import subprocess
import sys
import tarfile
import zipfile
from email import message_from_bytes

import pytest
import tomlkit

from tests.places import ROOT

MOST_BYTES = 10_000_000
PROJECT = tomlkit.parse((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.fixture(scope="module")
def distributions(tmp_path_factory):
    out = tmp_path_factory.mktemp("distributions")
    words = [sys.executable, "-m", "build", "--no-isolation", "--outdir", out, ROOT]
    built = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stdout + built.stderr
    return out


@pytest.fixture(scope="module")
def wheel(distributions):
    (path,) = distributions.glob("*.whl")
    return path


def test_the_sdist_can_be_tested(distributions):
    (path,) = distributions.glob("*.tar.gz")
    with tarfile.open(path) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    for file in ("Makefile", "README.md", "LICENSE", "CHANGELOG.md", "pyproject.toml"):
        assert file in names
    for folder in ("chatter", "tests", "examples", "docs", "benchmarks"):
        sources = {one.relative_to(ROOT).as_posix() for one in (ROOT / folder).rglob("*.py")}
        assert sources <= names
    assert not [name for name in names if name.endswith((".pyc", ".nbi", ".nbc"))]


def test_it_holds_the_packages_the_examples_and_the_licence(wheel):
    assert wheel.stat().st_size < MOST_BYTES
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    tops = {name.split("/")[0] for name in names if ".dist-info/" not in name}
    assert tops == {"chatter", "cutting", "dynamics"}
    for package in ("chatter", "cutting", "dynamics"):
        sources = {path.relative_to(ROOT).as_posix() for path in (ROOT / package).rglob("*.py")}
        assert sources <= names
    templates = (ROOT / "chatter/report/templates").glob("*.html")
    assert {path.relative_to(ROOT).as_posix() for path in templates} <= names
    assert "chatter/py.typed" in names
    for case in (ROOT / "examples").glob("*/case.toml"):
        assert f"chatter/examples/{case.parent.name}/case.toml" in names
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in names)
    assert not [name for name in names if name.endswith((".pyc", ".nbi", ".nbc"))]


def test_its_metadata_name_licence_extras_and_versions(wheel):
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (one for one in archive.namelist() if one.endswith(".dist-info/METADATA"))
        metadata = message_from_bytes(archive.read(name))
    assert metadata["License-Expression"] == "MIT"
    assert set(metadata.get_all("Provides-Extra")) == set(PROJECT["optional-dependencies"])
    assert metadata.get_all("Classifier") == list(PROJECT["classifiers"])
    assert metadata["Requires-Python"] == PROJECT["requires-python"]


def test_it_runs_from_any_folder(wheel, tmp_path):
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "installed")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "installed")}

    def ran(*words):
        words = [sys.executable, "-m", "chatter", *words]
        return subprocess.run(
            words, cwd=elsewhere, env=environment, capture_output=True, text=True, check=False
        )

    copied = ran("examples", "slotting", "--out", "mine", "--report", "page.html")
    assert copied.returncode == 0, copied.stderr
    assert (elsewhere / "mine/case.toml").is_file()
    assert "chatter examples slotting" in (elsewhere / "page.html").read_text(encoding="utf-8")
