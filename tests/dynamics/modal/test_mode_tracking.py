"""Modes followed along an axis: a beam with a mass that moves on it."""

import numpy as np
import pytest

from dynamics.beam.shaft import BeamLine, Bearing, Material, Segment
from dynamics.modal.mode_tracking import ModalModel, ModalModelAlongAxis, aligned, assurance, paired
from dynamics.reduction.modal_truncation import truncated, undamped_modes
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Body, Connector, Point
from dynamics.structure.linear_structure import StructureError

STEEL = Material(young=210e9, density=7850.0)
POINTS = [f"p{place}" for place in range(7)]


def beam_with_mass(position, mass=3.0, count=4, spring_y=3e5):
    """Beam along x on springs at its ends, stiff along z at the right one only; mass on it.

    The supports along y are soft, so that the first modes along y and z cross as the mass moves.
    """
    bearings = [
        Bearing("left", 0.0, (spring_y, 4e6), 1e8, torsion=1e5),
        Bearing("right", 0.6, (spring_y, 2e5)),
    ]
    line = BeamLine(
        "beam", [Segment(0.6, 0.03, STEEL, elements=6)], (0, 0, 0), (1, 0, 0), (), bearings
    )
    slide = Body("slide", mass, (1e-3, 1e-3, 1e-3), (position, 0.0, 0.0))
    held = Connector("held", "beam", "slide", (position, 0.0, 0.0), [1e10] * 3 + [1e6] * 3)
    points = [Point(name, "beam", (0.1 * place, 0, 0)) for place, name in enumerate(POINTS)]
    structure = assemble([slide], [held], points, [line])
    return truncated(structure, undamped_modes(structure, count=count), 0.01, POINTS[:2])


def model(position, **others):
    return ModalModel.of_reduced(beam_with_mass(position, **others), POINTS)


def lateral(found):
    """Part (m,) of each mode's motion that is along z."""
    motion = np.stack([found.shapes[name][1:3] for name in POINTS])
    along = np.sum(motion**2, axis=0)
    return along[1] / np.sum(along, axis=0)


def test_assurance_of_known_shapes():
    first = np.array([[1.0, 0.0], [0.0, 2.0]])
    second = np.array([[-3.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    assert assurance(first, second) == pytest.approx(np.array([[1, 0.5, 0], [0, 0.5, 0]]))


def test_crossing_of_modes_of_different_direction_is_followed():
    positions = np.linspace(0.05, 0.55, 6)
    models = [model(position) for position in positions]
    along = ModalModelAlongAxis(positions, models)
    ends = [along.at(position) for position in positions[[0, -1]]]
    order = [end.frequency[0] < end.frequency[1] for end in ends]
    assert order[0] != order[1]
    directions = np.array([lateral(along.at(position))[:2] for position in positions])
    assert np.all(np.abs(directions - directions[0]) < 1e-6)
    assert sorted(directions[0]) == pytest.approx([0.0, 1.0], abs=1e-6)


def test_between_positions_the_model_is_near_the_computed_one():
    positions = np.linspace(0.05, 0.55, 11)
    along = ModalModelAlongAxis(positions, [model(position) for position in positions])
    for position in (0.125, 0.33, 0.475):
        exact = aligned(along.at(position), model(position))
        found = along.at(position)
        assert found.frequency == pytest.approx(exact.frequency, rel=5e-3)
        assert found.damping == pytest.approx(exact.damping)
        size = np.max(abs(exact.stacked()))
        assert found.stacked() == pytest.approx(exact.stacked(), abs=0.02 * size)
        assert found.residual.keys() == exact.residual.keys()
        assert found.structure().natural_frequencies() == pytest.approx(np.sort(found.frequency))


def test_signs_do_not_matter():
    first, second = model(0.2), model(0.25)
    turned = second.in_order([3, 1, 0, 2], [-1.0, 1.0, -1.0, -1.0])
    assert aligned(first, turned).stacked() == pytest.approx(aligned(first, second).stacked())
    assert aligned(first, turned).frequency == pytest.approx(second.frequency)


def test_at_a_given_position_it_is_the_given_model():
    models = [model(position) for position in (0.1, 0.2)]
    along = ModalModelAlongAxis([0.1, 0.2], models)
    assert along.at(0.1).frequency == pytest.approx(models[0].frequency)
    assert np.sort(along.at(0.2).frequency) == pytest.approx(models[1].frequency)
    with pytest.raises(StructureError, match=r"outside 0\.1 to 0\.2"):
        along.at(0.3)


def test_lost_modes_are_refused():
    with pytest.raises(StructureError, match="is not found again"):
        # a mode of the first is beyond the number kept in the second
        paired(model(0.3).in_order([0, 1]), model(0.3).in_order([2, 3]))
    with pytest.raises(StructureError, match="cannot be found among 2"):
        paired(model(0.3), model(0.3).in_order([0, 1]))
    first = ModalModel(np.array([50.0, 50.0]), np.zeros(2), {"p": np.eye(6)[:, :2]})
    half = np.zeros((6, 2))
    half[:2] = np.sqrt(0.5) * np.array([[1.0, -1.0], [1.0, 1.0]])
    # equal frequencies: shapes turned by 45 degrees tell nothing
    with pytest.raises(StructureError, match=r"MAC of 0\.50"):
        paired(first, ModalModel(np.array([50.0, 50.0]), np.zeros(2), {"p": half}))
    with pytest.raises(StructureError, match="towards position 2"):
        ModalModelAlongAxis(
            [1.0, 2.0], [first, ModalModel(np.array([50.0, 50.0]), np.zeros(2), {"p": half})]
        )


def test_modes_that_look_alike_at_too_few_points_are_refused():
    rows = np.zeros((6, 2))
    rows[0] = [1.0, 0.5]
    one = ModalModel(np.array([50.0, 90.0]), np.zeros(2), {"p": rows})
    with pytest.raises(StructureError, match="take more points"):
        paired(one, one)


def test_rotations_count_by_a_lever():
    first = ModalModel(np.array([10.0, 20.0]), np.zeros(2), {"p": np.eye(6)[:, [0, 3]]})
    with pytest.raises(StructureError, match="is not found again"):
        paired(first, first)
    order, agreement = paired(first, first.in_order([1, 0]), lever=0.1)
    assert list(order) == [1, 0]
    assert agreement == pytest.approx([1.0, 1.0])


def test_refusals():
    with pytest.raises(StructureError, match="negative"):
        ModalModel(np.array([-1.0]), np.zeros(1), {})
    with pytest.raises(StructureError, match="6 x 2"):
        ModalModel(np.ones(2), np.zeros(2), {"p": np.zeros((6, 3))})
    with pytest.raises(StructureError, match="different points"):
        paired(
            ModalModel(np.ones(1), np.zeros(1), {"p": np.ones((6, 1))}),
            ModalModel(np.ones(1), np.zeros(1), {"q": np.ones((6, 1))}),
        )
    with pytest.raises(StructureError, match="ascending"):
        ModalModelAlongAxis([1.0, 0.5], [model(0.1), model(0.2)])
    line = BeamLine("beam", [Segment(0.6, 0.03, STEEL)])
    free = assemble([], [], [], [line], allowed_rigid_motions=6)
    with pytest.raises(StructureError, match="not in modal coordinates"):
        ModalModel.of_reduced(free, [])
