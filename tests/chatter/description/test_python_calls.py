"""Python as people use it: paths where cases are, short reprs, units in names."""

import numpy as np
import pytest

import chatter
from tests.chatter.simulation.test_worn_flank import CASE


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
