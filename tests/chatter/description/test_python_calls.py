"""Python as people use it: paths where cases are, short reprs, units in names."""

import numpy as np
import pytest

import chatter
from tests.chatter.simulation.test_worn_flank import CASE
from tests.command_line import chatter_command
from tests.places import EXAMPLES


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text('title = "A cut"\n' + CASE)
    return file


def test_a_path_is_accepted_where_a_case_is(path):
    case = chatter.load(path)
    assert chatter.check(str(path)).critical_depth == chatter.check(case).critical_depth
    assert chatter.simulate(path).mean_power == chatter.simulate(case).mean_power
    found = chatter.bifurcation(path, "cut.axial_depth", ["0.2 mm", "0.3 mm"])
    assert [point.value for point in found.points] == pytest.approx([0.2e-3, 0.3e-3])


def test_a_path_that_is_none_is_refused_by_name():
    with pytest.raises(chatter.InputError, match=r"nowhere\.toml"):
        chatter.check("nowhere.toml")


def test_reprs_are_short_and_name_the_case(path):
    case = chatter.load(path)
    diagram = chatter.lobes(path)
    results = [case, chatter.check(path), diagram, diagram.limits, chatter.simulate(path)]
    assert all(len(repr(one)) < 150 for one in results)
    assert all("A cut" in repr(one) for one in results if one is not diagram.limits)
    assert str(case) == repr(case)


def test_limits_in_units_that_people_read(path):
    limits = chatter.lobes(path).limits
    # 1 rad/s is 60/(2 pi) rpm
    np.testing.assert_allclose(limits.spindle_speed_rpm, limits.spindle_speed * 30.0 / np.pi)
    np.testing.assert_allclose(limits.critical_depth_mm, limits.critical_depth * 1e3)


def test_what_is_listed_is_public():
    assert all(not name.startswith("_") for name in dir(chatter))
    assert {"check", "lobes", "simulate", "explain", "learn", "load"} <= set(dir(chatter))
    assert not {"Any", "TYPE_CHECKING", "import_module"} & set(dir(chatter))


def test_names_of_an_frf_may_be_one_text(tmp_path):
    machine = chatter.load_machine(EXAMPLES / "machine-coupled-milling" / "machine.toml")
    with pytest.raises(chatter.InputError, match=r"there is no \[frf\.nothing\]"):
        chatter.frf(machine, "nothing")


#: call -> words of the refusal; each ended in a TypeError, AttributeError or ValueError
REFUSED = {
    "count of samples": (lambda c, m: chatter.uncertainty(c, "10"), '--samples "10"'),
    "count that is no whole number": (lambda c, m: chatter.uncertainty(c, 2.5), "--samples 2.5"),
    "truth value": (lambda c, m: chatter.uncertainty(c, 10, True), "--seed true"),
    "samples of an optimum": (lambda c, m: chatter.optimum(c, range(3)), "--samples range"),
    "method": (lambda c, m: chatter.check(c, 3), "name of a method is required as text; 3"),
    "get": (lambda c, m: c.get(None), "a path is required as text; None"),
    "patch": (lambda c, m: c.patch("cut.axial_depth"), 'such as {"cut.axial_depth": "2 mm"}'),
    "overrides": (lambda c, m: chatter.simulate(c, ["1 mm"]), "a dictionary is required"),
    "text": (lambda c, m: chatter.Case.from_text(3.0), "a description is required as text; 3.0"),
    "folder": (lambda c, m: chatter.Case.from_text("", folder=1), "folder of its files is"),
    "bifurcation path": (lambda c, m: chatter.bifurcation(c, 1, [1]), "path of what changes"),
    "bifurcation values": (
        lambda c, m: chatter.bifurcation(c, "cut.axial_depth", 3),
        "cut.axial_depth: values are required as a list; 3",
    ),
    "axis": (lambda c, m: chatter.lobes_over(c, x=5), "a path and its values are required as"),
    "axis of one": (lambda c, m: chatter.lobes_over(c, x=("a",)), "a path and its values are"),
    "axis without values": (
        lambda c, m: chatter.lobes_over(c, x=("cut.axial_depth", 1)),
        "cut.axial_depth: values are required as a list; 1",
    ),
    "vary": (lambda c, m: chatter.whatif(c, 7), "--vary: variations are required as a list; 7"),
    "vary of numbers": (lambda c, m: chatter.whatif(c, [7]), "PATH=VALUES is required as text; 7"),
    "vary without values": (
        lambda c, m: chatter.whatif(c, {"cut.axial_depth": 0.001}),
        "--vary cut.axial_depth: values are required as a list; 0.001",
    ),
    "move": (lambda c, m: chatter.move(m, ["a"]), "name of [move.NAME] is required as text"),
    "frf": (lambda c, m: chatter.frf(m, 3), "names of [frf.NAME] are required as texts; 3"),
    "places": (lambda c, m: chatter.export(m, 3), "places of inputs are required as texts; 3"),
    "modes": (lambda c, m: chatter.mode_shapes(m, 1.5), "count of modes 1.5"),
    "positions": (lambda c, m: m.positions([1]), "positions: a dictionary is required"),
    "no files": (lambda c, m: chatter.modes([]), "a file of FRFs or of a hammer record"),
    "law": (lambda c, m: chatter.friction("a.csv", law=[1]), "law [1] is none of"),
    "zero in a path": (lambda c, m: chatter.load("a\0b"), "path of a case file is required"),
    "zero in a folder": (lambda c, m: chatter.check(c).save("a\0b"), "a folder for what is"),
    "path to write": (lambda c, m: c.save(True), "the case to be written is required; true"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_refused_in_words(path, name):
    call, words = REFUSED[name]
    machine = chatter.load_machine(EXAMPLES / "machine-coupled-milling" / "machine.toml")
    with pytest.raises(chatter.InputError) as told:
        call(chatter.load(path), machine)
    assert words in str(told.value)


def test_a_seed_of_learn_is_refused_in_words(tmp_path):
    folder = EXAMPLES / "explain-stability" / "measurement"
    done = chatter_command(
        "learn", folder / "case.toml", folder / "points.csv", "--seed", "-1", "--out", tmp_path
    )
    assert done.exit_code == 2
    assert "--seed -1: a number from 0 to" in done.stderr
