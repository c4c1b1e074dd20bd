"""An installed package adds laws, a method, an effect and a format by entry points."""

import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from tests.cases import TOOL_OF_922_HERTZ
from tests.places import ROOT

PACKAGE = ROOT / "tests" / "plugin" / "made_up_laws"
ENTRY_POINTS = """\
[chatter.force_laws]
root = made_up_laws.force_law:LAW
[chatter.friction_laws]
arctan-coulomb = made_up_laws.friction_law:LAW
[chatter.stability_methods]
cautious-zero-order = made_up_laws.stability_method:METHOD
[chatter.effects]
tilted_guide = made_up_laws.effect:EFFECT
[chatter.formats]
labbook = made_up_laws.file_format:FORMAT
"""
ROOT_LAW = """\
law = "root"
specific_force = "600 MPa"
force_ratio = 0.3333333333
h0 = "0.1 mm"
"""
LINEAR_LAW = 'Ktc = "600 MPa"\nKrc = "200 MPa"\n'
CASE = f"""{TOOL_OF_922_HERTZ.replace(LINEAR_LAW, ROOT_LAW)}friction = "guide"

[friction.guide]
law = "arctan-coulomb"
coulomb = "2 N"
smoothing_velocity = "10 mm/s"

[simulation]
revolutions = 6

[lobes]
speeds = {{ from = "9000 rpm", to = "11000 rpm", count = 5 }}
depths = {{ to = "4 mm", count = 20 }}
method = "cautious-zero-order"
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Folder with the package as pip lays it out."""
    folder = tmp_path_factory.mktemp("site")
    shutil.copytree(PACKAGE, folder / PACKAGE.name, ignore=shutil.ignore_patterns("__pycache__"))
    info = folder / "made_up_laws-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: made-up-laws\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(ENTRY_POINTS)
    return folder


@pytest.fixture(scope="module")
def run(site):
    def chatter(folder, *words):
        """Run a command with the package installed."""
        paths = os.pathsep.join([str(site), str(ROOT)])
        done = subprocess.run(
            [sys.executable, "-m", "chatter", *words],
            cwd=folder, env={**os.environ, "PYTHONPATH": paths},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout

    return chatter


EXPONENTIAL_LAW = """\
law = "exponential"
Ktc = "600 MPa"
Krc = "200 MPa"
h0 = "0.1 mm"
exponent = 0.5
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


def test_lobes_and_check_take_the_method(run, folder):
    found = json.loads(run(folder, "lobes", "case.toml", "--out", "own", "--json"))
    plain = json.loads(
        run(folder, "lobes", "case.toml", "--method", "zero-order", "--out", "plain", "--json")
    )
    assert found["method"] == "cautious-zero-order"
    ours, theirs = found["lowest_limit"], plain["lowest_limit"]
    assert ours["critical_depth_mm"] == pytest.approx(0.8 * theirs["critical_depth_mm"])
    checked = json.loads(run(folder, "check", "case.toml", "--json"))
    plain = json.loads(run(folder, "check", "case.toml", "--method", "zero-order", "--json"))
    assert checked["critical_depth_mm"] == pytest.approx(0.8 * plain["critical_depth_mm"])


NAMES = ("case.toml", "exponential.toml")


def limits_of(run, folder, name, method):
    shown = json.loads(run(folder, "check", name, "--method", method, "--json"))
    return shown["critical_depth_mm"]


def test_the_force_law_is_that_of_the_package(run, folder):
    """The root law is the exponential law of exponent 0.5, in the limits and in the cut."""
    text = CASE.replace(ROOT_LAW, EXPONENTIAL_LAW)
    assert text != CASE
    (folder / "exponential.toml").write_text(text)
    limits = [limits_of(run, folder, name, "zero-order") for name in NAMES]
    assert limits[0] == pytest.approx(limits[1], rel=1e-6)


@pytest.mark.nightly
def test_the_force_law_is_in_every_kind_of_kernel(run, folder):
    """Elements and steps of time compile it anew."""
    (folder / "exponential.toml").write_text(CASE.replace(ROOT_LAW, EXPONENTIAL_LAW))
    limits = [limits_of(run, folder, name, "collocation") for name in NAMES]
    assert limits[0] == pytest.approx(limits[1], rel=1e-6)
    found, expected = (
        json.loads(run(folder, "simulate", name, "--out", name[:-5], "--json"))["peak_force_N"]
        for name in NAMES
    )
    assert found == pytest.approx(expected, rel=1e-6)


def test_simulate_takes_the_friction_law(run, folder):
    def largest(*words):
        run(folder, "simulate", "case.toml", "--out", "cut", *words)
        rows = np.loadtxt(folder / "cut" / "signals.csv", delimiter=",", skiprows=1)
        return np.max(np.abs(rows[:, 5]))

    assert largest("--set", "friction.guide.coulomb=20 N") < 0.9 * largest()


def test_explain_reads_the_format_and_tries_the_effect(run, tmp_path):
    mass, tilt = 20.0, 0.03
    (tmp_path / "case.toml").write_text('[axis]\nmoving_mass = "20 kg"\n')
    runs = ""
    for number, frequency in enumerate((1.0, 1.5, 2.0, 2.5)):
        time = np.arange(800) * 1e-3
        angle = 2.0 * np.pi * frequency * time
        position = 20.0 * (1.0 - np.cos(angle))
        velocity = 40.0 * np.pi * frequency * np.sin(angle)
        acceleration = 0.02 * (2.0 * np.pi * frequency) ** 2 * np.cos(angle)
        noise = np.random.default_rng(number).standard_normal(time.size)
        force = mass * (acceleration + 9.81 * np.sin(tilt)) + 0.2 * noise
        rows = "\n".join(
            " | ".join(f"{cell:.9g}" for cell in row)
            for row in zip(time, position, position, velocity, force, strict=True)
        )
        heading = "time [s] | command [mm] | position [mm] | velocity [mm/s] | force [N]"
        (tmp_path / f"move{number}.lab").write_text(f"LABBOOK\n{heading}\n{rows}\n")
        runs += f'[[run]]\nfile = "move{number}.lab"\n'
    text = f'title = "a tilted axis"\nkind = "axis"\ncase = "case.toml"\n{runs}'
    (tmp_path / "measurement.toml").write_text(text)
    run(tmp_path, "explain", str(tmp_path), "--out", "out")
    found = json.loads((tmp_path / "out" / "explanation.json").read_text())
    assert found["verdict"] == "explained"
    (effect,) = found["effects"]
    alike = {effect["name"], *effect["confounded_with"]}
    # a constant force along the axis: by its weight or as such
    assert {"tilted_guide", "offset"} <= alike
    if effect["name"] == "tilted_guide":
        assert effect["parameters"]["tilt"]["value"] == pytest.approx(tilt, rel=0.05)
