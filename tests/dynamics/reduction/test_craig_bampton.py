"""Super-elements and joined structures against unreduced ones and printed errors."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

from dynamics.beam.element import element_mass, element_stiffness
from dynamics.beam.shaft import BeamLine, Bearing, Material, Segment, hutchinson
from dynamics.reduction.craig_bampton import ElasticJoint, RigidJoint, joined, super_element
from dynamics.reduction.modal_truncation import truncated, undamped_modes
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Connector, Point
from dynamics.structure.linear_structure import LinearStructure, StructureError

STEEL = Material(young=200e9, density=7800.0, poisson=0.29)


def euler_bernoulli(elements, length, held):
    """Plane Euler-Bernoulli beam, d = 20 mm: deflection and slope of each node; textbook matrices.

    Its ends are the points "near" and "far" (z and rotation about y, slope of opposite sign).
    """
    diameter, part = 0.020, length / elements
    area, bending = np.pi / 4 * diameter**2, 200e9 * np.pi * diameter**4 / 64
    k = np.array(
        [
            [12, 6 * part, -12, 6 * part],
            [6 * part, 4 * part**2, -6 * part, 2 * part**2],
            [-12, -6 * part, 12, -6 * part],
            [6 * part, 2 * part**2, -6 * part, 4 * part**2],
        ]
    )
    m = np.array(
        [
            [156, 22 * part, 54, -13 * part],
            [22 * part, 4 * part**2, 13 * part, -3 * part**2],
            [54, 13 * part, 156, -22 * part],
            [-13 * part, -3 * part**2, -22 * part, 4 * part**2],
        ]
    )
    size = 2 * elements + 2
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for element in range(elements):
        place = slice(2 * element, 2 * element + 4)
        stiffness[place, place] += bending / part**3 * k
        mass[place, place] += 7800.0 * area * part / 420.0 * m
    points = {}
    for name, first in (("near", 0), ("far", size - 2)):
        points[name] = np.zeros((6, size))
        points[name][2, first] = 1.0
        points[name][4, first + 1] = -1.0
    start = 2 if held else 0
    points = {name: rows[:, start:] for name, rows in points.items() if rows[:, start:].any()}
    mass, stiffness = mass[start:, start:], stiffness[start:, start:]
    return LinearStructure(mass, 0.0 * mass, stiffness, points)


FULL = np.array([354.20004877, 2219.73835311, 6215.42036364])


@pytest.mark.parametrize(
    ("count", "printed"),
    [
        (1, [6.756e-5, 6.362e-3, 1.0895e-1]),
        (2, [2.793e-6, 3.372e-4, 5.657e-4]),
        (4, [9.97e-8, 1.488e-5, 6.309e-6]),
        (6, [1.32e-8, 2.069e-6, 4.154e-7]),
    ],
)
def test_benchmark_errors(count, printed):
    assert euler_bernoulli(20, 0.2, True).natural_frequencies(3) == pytest.approx(FULL, rel=1e-7)
    root = super_element(euler_bernoulli(10, 0.1, True), ["far"], count=count)
    tip = super_element(euler_bernoulli(10, 0.1, False), ["near"], count=count)
    whole = joined({"root": root, "tip": tip}, [RigidJoint(("root", "far"), ("tip", "near"))])
    assert whole.size == 2 + 2 * count
    error = undamped_modes(whole).frequency[:3] / FULL - 1.0
    assert np.all(error > 0.0)
    assert error == pytest.approx(printed, rel=2e-3, abs=2e-9)


def shaft(free=True, elements=6, damping=1e-6):
    """Timoshenko beam along x, root at 0, with a point in the middle."""
    bearings = [] if free else [Bearing("held", 0.02, (8e7, 6e7), 1e8, (1e4, 1e4), 1e4)]
    line = BeamLine(
        "shaft",
        [Segment(0.2, 0.03, STEEL, elements=elements)],
        axis=(1, 0, 0),
        bearings=bearings,
        stiffness_damping=damping,
    )
    places = {"root": 0.0, "middle": 0.1, "tip": 0.2}
    points = [Point(name, "shaft", (at, 0, 0)) for name, at in places.items()]
    return assemble([], [], points, [line], allowed_rigid_motions=6 if free else 0)


def as_sparse(structure):
    matrices = (structure.mass, structure.damping, structure.stiffness)
    return LinearStructure(*(scipy.sparse.csr_array(one) for one in matrices), structure.points)


def test_published_timoshenko_frequencies_from_above():
    segment = Segment(0.125 / 25, 0.010, STEEL, shear_coefficient=hutchinson)
    size = 6 * 26
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for element in range(25):
        place = slice(6 * element, 6 * element + 12)
        mass[place, place] += element_mass(segment, 0.005)
        stiffness[place, place] += element_stiffness(segment, 0.005)
    rows = np.eye(size)
    clamped = {"tip": rows[-6:, 6:], "inner": rows[60:66, 6:]}
    full = LinearStructure(mass[6:, 6:], 0.0 * mass[6:, 6:], stiffness[6:, 6:], clamped)
    published = [451.78726, 2774.08876, 7533.25453]
    reduced = super_element(full, ["tip", "inner"], highest=200e3)
    # between the second and third pair lies the first torsion
    bending = undamped_modes(reduced).frequency[[0, 2, 5]]
    assert bending == pytest.approx(published, rel=2e-4)
    assert np.all(bending > np.array(published) * (1.0 - 1e-8))


@pytest.mark.parametrize("sparse", [False, True])
def test_super_element_keeps_statics_mass_and_boundary(sparse):
    structure = shaft(free=False)
    reduced = super_element(as_sparse(structure) if sparse else structure, ["tip", "root"], count=3)
    assert reduced.size == 15
    assert reduced.points["tip"] == pytest.approx(np.eye(15)[:6], abs=1e-12)
    assert reduced.points["root"] == pytest.approx(np.eye(15)[6:12], abs=1e-12)
    for one in ("tip", "root", "middle"):
        exact = structure.points[one] @ np.linalg.solve(
            structure.stiffness, structure.points["tip"].T
        )
        found = reduced.points[one] @ np.linalg.solve(reduced.stiffness, reduced.points["tip"].T)
        assert found == pytest.approx(exact, rel=1e-7, abs=1e-9 * np.max(abs(exact)))
    for matrix in (reduced.mass, reduced.damping, reduced.stiffness):
        assert np.array_equal(matrix, matrix.T)


def test_rigid_body_mass_is_kept():
    structure = shaft()
    reduced = super_element(structure, ["root"], count=2)
    motion = np.zeros((reduced.size, 6))
    motion[:6] = np.eye(6)
    inertia = motion.T @ reduced.mass @ motion
    mass = np.pi / 4 * 0.03**2 * 0.2 * 7800.0
    assert inertia[:3, :3] == pytest.approx(mass * np.eye(3), rel=1e-9, abs=1e-9)
    assert inertia[1, 5] == pytest.approx(mass * 0.1, rel=1e-9)
    assert undamped_modes(reduced).frequency[:6] == pytest.approx(np.zeros(6))


def test_more_modes_never_raise_a_frequency_and_all_are_exact():
    structure = shaft(free=False, elements=6)
    exact = undamped_modes(structure).frequency[:8]
    before = np.full(8, np.inf)
    for count in (2, 4, 8, 16, 1000):
        found = undamped_modes(super_element(structure, ["tip"], count=count)).frequency[:8]
        assert np.all(found >= exact * (1.0 - 1e-9))
        assert np.all(found <= before * (1.0 + 1e-9))
        before = found
    assert before == pytest.approx(exact, rel=1e-8)


def test_raw_freedoms_and_points_that_average_nodes_may_be_the_boundary():
    structure = shaft(free=False)
    mean = 0.5 * (structure.points["root"] + structure.points["tip"])
    given = LinearStructure(
        structure.mass, structure.damping, structure.stiffness, {**structure.points, "mean": mean}
    )
    reduced = super_element(given, ["mean"], count=1000, freedoms=[22])
    assert reduced.size == structure.size
    assert reduced.points["mean"] == pytest.approx(np.eye(structure.size)[:6], abs=1e-9)
    assert undamped_modes(reduced).frequency[:5] == pytest.approx(
        undamped_modes(structure).frequency[:5], rel=1e-8
    )
    with pytest.raises(StructureError, match="depend on one another"):
        super_element(given, ["mean", "root", "tip"], count=1)


@pytest.mark.parametrize("sparse", [False, True])
def test_joined_rigidly_equals_one_beam(sparse):
    first, second = shaft(free=False), shaft()
    if sparse:
        first, second = as_sparse(first), as_sparse(second)
    whole = joined({"a": first, "b": second}, [RigidJoint(("a", "tip"), ("b", "root"))])
    assert scipy.sparse.issparse(whole.mass) == sparse
    line = BeamLine(
        "shaft",
        [Segment(0.4, 0.03, STEEL, elements=12)],
        axis=(1, 0, 0),
        bearings=[Bearing("held", 0.02, (8e7, 6e7), 1e8, (1e4, 1e4), 1e4)],
        stiffness_damping=1e-6,
        stations=(0.1, 0.2, 0.3),
    )
    exact = assemble([], [], [Point("tip", "shaft", (0.4, 0, 0))], [line])
    lines = [50.0, 400.0, 1500.0]
    found = whole.receptance(lines, whole.points["b.tip"][1:3])
    assert found == pytest.approx(exact.receptance(lines, exact.points["tip"][1:3]), rel=1e-6)


def test_joined_by_springs_equals_a_connector():
    springs, dampers = [4e7, 5e7, 6e7, 1e4, 2e4, 3e4], [10.0] * 6
    joint = ElasticJoint(("a", "tip"), ("b", "root"), springs, dampers)
    whole = joined({"a": shaft(free=False), "b": shaft()}, [joint])
    lines = [
        BeamLine(
            name,
            [Segment(0.2, 0.03, STEEL, elements=6)],
            origin=(start, 0, 0),
            axis=(1, 0, 0),
            bearings=bearings,
            stiffness_damping=1e-6,
            stations=(0.1,),
        )
        for name, start, bearings in (
            ("a", 0.0, [Bearing("held", 0.02, (8e7, 6e7), 1e8, (1e4, 1e4), 1e4)]),
            ("b", 0.2, []),
        )
    ]
    connector = Connector("joint", "a", "b", (0.2, 0, 0), springs, dampers)
    exact = assemble([], [connector], [Point("tip", "b", (0.4, 0, 0))], lines)
    frequency = [50.0, 400.0, 1500.0]
    found = whole.receptance(frequency, whole.points["b.tip"])
    wanted = exact.receptance(frequency, exact.points["tip"])
    assert found == pytest.approx(wanted, rel=1e-6, abs=1e-9 * np.max(abs(wanted)))
    assert found == pytest.approx(np.swapaxes(found, 1, 2), abs=1e-9 * np.max(abs(wanted)))


def test_joint_given_twice_changes_nothing():
    joint = RigidJoint(("a", "tip"), ("b", "root"))
    parts = {"a": shaft(free=False), "b": shaft()}
    assert joined(parts, [joint, joint]).natural_frequencies(4) == pytest.approx(
        joined(parts, [joint]).natural_frequencies(4), rel=1e-6
    )


def test_refusals():
    structure = shaft()
    with pytest.raises(StructureError, match="boundary is empty"):
        super_element(structure, [])
    with pytest.raises(StructureError, match='no point "nose"'):
        super_element(structure, ["nose"])
    with pytest.raises(StructureError, match="no freedom 9999"):
        super_element(structure, [], freedoms=[9999])
    for given in (structure, as_sparse(structure)):
        with pytest.raises(StructureError, match="moves freely"):
            super_element(given, [], count=0, freedoms=[0, 1, 2])
    with pytest.raises(StructureError, match=r'no point "b\.nose"'):
        joined({"a": structure, "b": structure}, [RigidJoint(("a", "tip"), ("b", "nose"))])
    solid = LinearStructure(np.eye(3), np.eye(3), np.eye(3), {"p": np.eye(6)[:, :3]})
    with pytest.raises(StructureError, match=r'point "b\.p" has no rotation about x'):
        joined({"a": structure, "b": solid}, [RigidJoint(("a", "tip"), ("b", "p"))])
    with pytest.raises(StructureError, match="negative"):
        ElasticJoint(("a", "tip"), ("b", "root"), [-1.0] + [0.0] * 5)
    with pytest.raises(StructureError, match="there are no parts"):
        joined({}, [])
    modal = truncated(structure, undamped_modes(structure, count=8), residual_at=["tip"])
    with pytest.raises(StructureError, match="residual compliance"):
        super_element(modal, ["tip"], count=1)
