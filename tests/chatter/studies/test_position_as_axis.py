"""A position in the workspace as axis of a stability diagram."""

import numpy as np
import pytest

import chatter
from chatter.compile.real_modes import lines_around, real_modes
from chatter.description.case import Case
from chatter.studies.model import field_of
from dynamics.modal.modes import Mode, receptance_matrix
from tests.places import EXAMPLES

FACE_MILL = EXAMPLES / "face-mill-chatter/case.toml"


def test_limits_over_a_position_are_those_of_the_machine_there():
    case = chatter.load(FACE_MILL).patch(
        # the structure is in question: friction that carries the axis would hide a part of it
        {"lobes": {"method": "zero-order"}, "structure.friction_amplitude": "0 um"}
    )
    assert field_of(case, "structure.position.Z").dimension == "length"
    found = chatter.lobes_over(case, "structure.position.Z=-200 mm..200 mm:2")
    assert found.axis.unit == "mm"
    moved = chatter.check(case.patch({"structure.position": {"Z": "0.2 m"}}))
    assert found.limits.crossings[1][0] == pytest.approx(moved.critical_depth, rel=1e-9)
    # the head stands on a longer column: the tool gives way more
    assert found.limits.crossings[1][0] < 0.75 * found.limits.crossings[0][0]


def test_a_path_by_name_that_holds_no_quantity_is_none():
    case = Case.from_dict({"title": "nothing"})
    assert field_of(case, "structure.condition.Z") is None
    assert field_of(case, "structure.nowhere.Z") is None


def test_what_hardly_vibrates_is_still_fitted_by_modes_that_do():
    """The stability methods take modes with damping ratios below one alone."""
    modes = (Mode(60.0, 0.04, 20.0, (1.0, 0.0, 0.0)), Mode(30.0, 2.0, 50.0, (1.0, 0.0, 0.0)))
    lines = lines_around(modes, 1.0, 300.0)
    fitted = real_modes(lines, receptance_matrix(modes, lines), modes[:1])
    assert max(mode.damping for mode in fitted) < 1.0
    apart = receptance_matrix(fitted, lines) - receptance_matrix(modes, lines)
    assert np.abs(apart).max() < 0.05 * np.abs(receptance_matrix(modes, lines)).max()
