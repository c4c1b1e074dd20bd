"""What an assembly takes from one of the same parts, some of them elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.assembly import assembly
from dynamics.structure.bodies import Body, Connector, Point
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.spring_coupling import Coupling, Term

SHIFT = np.array([0.3, 0.0, 0.0])
STIFFNESS = (2e8, 3e8, 5e8, 1e6, 2e6, 3e6)
DAMPING = (100.0, 0.0, 300.0, 0.0, 0.0, 5.0)
COLUMN = Body("column", 900.0, (300.0, 200.0, 70.0), (0.0, 0.2, -0.4))
HEAD = Body("head", 160.0, (9.0, 5.0, 7.0), (1.0, -0.2, 0.1))
FEET = Connector("feet", "column", "ground", (0.0, 0.2, -1.1), STIFFNESS, DAMPING)
GUIDE = Connector("guide", "head", "column", (0.9, -0.03, 0.05), (0.0, *STIFFNESS[1:]))
NUT = Coupling("nut", [Term("head", (1, 0, 0), (1, 0, 0)), Term("column", (-1, 0, 0))], 1e8, 50.0)
TIP = Point("tip", "head", (1.0, -0.2, -0.3))


def joined(head=HEAD, guide=GUIDE, tip=TIP, column=COLUMN, feet=FEET, neighbour=None):
    return assembly([column, head], [feet, guide], [tip], couplings=[NUT], neighbour=neighbour)


def entries(one):
    structure = one.structure
    return [structure.mass, structure.damping, structure.stiffness, structure.points["tip"]]


ELSEWHERE = {
    "head": HEAD.shifted(SHIFT),
    "guide": GUIDE.shifted(SHIFT),
    "tip": replace(TIP, at=TIP.at + SHIFT),
}


def test_a_machine_beside_its_neighbour_is_the_one_assembled_alone():
    found, alone = joined(**ELSEWHERE, neighbour=joined()), joined(**ELSEWHERE)
    for one, other in zip(entries(found), entries(alone), strict=True):
        assert np.array_equal(one, other)
    assert not np.allclose(found.structure.stiffness, joined().structure.stiffness)


@pytest.mark.parametrize(
    "changed",
    [
        {"head": replace(HEAD, mass=200.0)},
        {"column": replace(COLUMN, centre=(0.5, 0.2, -0.4))},
        {"feet": replace(FEET, stiffness=tuple(2.0 * one for one in STIFFNESS))},
    ],
)
def test_what_differs_from_the_neighbour_is_not_taken_from_it(changed):
    found, alone = joined(**changed, neighbour=joined()), joined(**changed)
    for one, other in zip(entries(found), entries(alone), strict=True):
        assert np.array_equal(one, other)


def test_a_part_that_comes_loose_beside_its_neighbour_is_refused():
    loose = replace(GUIDE, stiffness=np.zeros(6))
    with pytest.raises(StructureError, match="no connector holds"):
        joined(guide=loose, neighbour=joined())


def test_parts_at_rest_are_not_deformed_again(monkeypatch):
    asked = []
    motion_at = Body.motion_at

    def counted(self, position):
        asked.append(self.name)
        return motion_at(self, position)

    neighbour = joined()
    monkeypatch.setattr(Body, "motion_at", counted)
    joined(**ELSEWHERE, neighbour=neighbour)
    assert asked.count("column") == 1  # under the guide, which has moved


def test_modes_in_the_coordinates_of_a_neighbour_are_those_of_the_pencil():
    here, there = joined().structure, joined(**ELSEWHERE).structure
    found = undamped_modes(there, near=undamped_modes(here))
    alone = undamped_modes(there)
    assert found.frequency == pytest.approx(alone.frequency, rel=1e-9)
    over = found.shapes.T @ there.mass @ found.shapes
    assert over == pytest.approx(np.eye(len(over)), abs=1e-12)
    energy = found.shapes.T @ there.stiffness @ found.shapes
    squared = (2.0 * np.pi * alone.frequency) ** 2
    assert energy == pytest.approx(np.diag(squared), abs=1e-9 * squared[-1])
