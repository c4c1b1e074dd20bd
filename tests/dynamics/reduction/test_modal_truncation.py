"""Modal truncation, residual compliance and state space against exact answers."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

from dynamics.beam.shaft import BeamLine, Bearing, Material, Segment
from dynamics.receptance.coupling import PointPort, receptance_with_residual, residual_compliance
from dynamics.reduction.modal_truncation import (
    damping_ratios,
    state_space,
    truncated,
    undamped_modes,
)
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Point
from dynamics.structure.linear_structure import LinearStructure, StructureError

STEEL = Material(young=210e9, density=7850.0)
TIP = PointPort("tip", [1.0, 0.0, 0.0])
ROOT = PointPort("root", [1.0, 0.0, 0.0])


def shaft(free=False, elements=10):
    """Beam along z, 0.3 m; on two bearings or free."""
    bearings = [
        Bearing("front", 0.05, (8e7, 6e7), 1e8, torsion=1e4),
        Bearing("rear", 0.25, (5e7, 4e7)),
    ]
    line = BeamLine(
        "shaft",
        [Segment(0.3, 0.04, STEEL, elements=elements)],
        bearings=[] if free else bearings,
        stiffness_damping=1e-6,
    )
    points = [Point("root", "shaft", (0, 0, 0)), Point("tip", "shaft", (0, 0, 0.3))]
    return assemble([], [], points, [line], allowed_rigid_motions=6 if free else 0)


def as_sparse(structure):
    matrices = (structure.mass, structure.damping, structure.stiffness)
    return LinearStructure(*(scipy.sparse.csr_array(one) for one in matrices), structure.points)


def chain(masses, springs, grounded=0.0):
    """Masses in a row along x, every one a point."""
    count = len(masses)
    stiffness = np.zeros((count, count))
    stiffness[0, 0] = grounded
    for place, spring in enumerate(springs):
        stiffness[place : place + 2, place : place + 2] += spring * np.array([[1, -1], [-1, 1]])
    points = {str(place): np.zeros((6, count)) for place in range(count)}
    for place in range(count):
        points[str(place)][0, place] = 1.0
    return LinearStructure(np.diag(masses), 1e-5 * stiffness, stiffness, points)


def test_modes_are_mass_normalised_and_diagonalise_the_stiffness():
    structure = shaft()
    modes = undamped_modes(structure, highest=20e3)
    squared = (2 * np.pi * modes.frequency) ** 2
    assert modes.shapes.T @ structure.mass @ modes.shapes == pytest.approx(
        np.eye(len(squared)), abs=1e-8
    )
    strain = modes.shapes.T @ structure.stiffness @ modes.shapes
    assert strain == pytest.approx(np.diag(squared), abs=1e-7 * squared[-1])
    assert modes.frequency[-1] <= 20e3
    assert structure.natural_frequencies(len(squared) + 1)[-1] > 20e3


@pytest.mark.parametrize("free", [False, True])
def test_sparse_modes_equal_dense_ones(free):
    structure = shaft(free, elements=16)
    dense = undamped_modes(structure, highest=8e3)
    sparse = undamped_modes(as_sparse(structure), highest=8e3)
    assert sparse.frequency == pytest.approx(dense.frequency, rel=1e-6)
    assert np.sum(sparse.frequency == 0.0) == (6 if free else 0)
    by_number = undamped_modes(as_sparse(structure), count=9)
    assert by_number.frequency == pytest.approx(
        undamped_modes(structure, count=9).frequency, rel=1e-6
    )


def test_equal_frequencies_of_a_round_beam_are_all_found_sparse():
    modes = undamped_modes(as_sparse(shaft(free=True, elements=16)), count=10)
    assert modes.frequency[6] == pytest.approx(modes.frequency[7], rel=1e-6)
    assert modes.frequency[8] == pytest.approx(modes.frequency[9], rel=1e-6)


def test_freedom_without_mass_is_condensed():
    # 1 kg behind two springs in series through a massless node
    structure = chain([0.0, 1.0], [3e4], grounded=6e4)
    modes = undamped_modes(structure)
    assert modes.frequency == pytest.approx([np.sqrt(2e4) / (2 * np.pi)])


@pytest.mark.parametrize("sparse", [False, True])
def test_truncation_with_residual_is_exact_in_statics(sparse):
    structure = shaft()
    given = as_sparse(structure) if sparse else structure
    reduced = truncated(given, undamped_modes(given, highest=3e3), residual_at=["root", "tip"])
    ports = [TIP, ROOT, PointPort("tip", [0, 0, 0, 0, 1.0, 0])]
    rows = np.array([port.row(structure) for port in ports])
    exact = rows @ np.linalg.solve(structure.stiffness, rows.T)
    found = receptance_with_residual(reduced, [0.0], ports)[0]
    assert np.max(abs(found - exact) / np.sqrt(np.outer(np.diag(exact), np.diag(exact)))) < 1e-9


@pytest.mark.parametrize("free", [False, True])
def test_residual_improves_the_receptance_below_the_cut(free):
    structure = shaft(free)
    modes = undamped_modes(structure, highest=6e3)
    reduced = truncated(structure, modes, residual_at=["tip"])
    lines = np.linspace(50.0, 1500.0, 40)
    exact = receptance_with_residual(structure, lines, [TIP])[:, 0, 0]
    with_it = receptance_with_residual(reduced, lines, [TIP])[:, 0, 0]
    without = reduced.receptance(lines, TIP.row(reduced))[:, 0, 0]
    assert np.median(abs(with_it - exact)) < 0.1 * np.median(abs(without - exact))
    # left-out modes are stiffer than the residual by (f / cut)^2 at most; the rest is damping
    left = residual_compliance(reduced, [TIP], [TIP])[0, 0]
    assert np.all(abs(with_it - exact) < left * 0.25**2 / (1 - 0.25**2) + 5e-3 * abs(exact))


def test_inertia_relief_residual_of_a_free_chain_is_that_of_its_left_out_modes():
    structure = chain([2.0, 1.0, 3.0, 0.5], [1e6, 2e6, 5e5])
    modes = undamped_modes(structure)
    assert modes.frequency[0] == 0.0
    reduced = truncated(structure, undamped_modes(structure, count=2), residual_at=["0", "3"])
    ports = [PointPort("0", [1, 0, 0]), PointPort("3", [1, 0, 0])]
    left = modes.shapes[[0, 3], 2:] / (2 * np.pi * modes.frequency[2:])
    assert residual_compliance(reduced, ports, ports) == pytest.approx(left @ left.T, rel=1e-9)


def test_ratio_from_stiffness_damping_is_proportional_to_frequency():
    structure = shaft(free=True)
    modes = undamped_modes(structure, highest=10e3)
    expected = np.pi * modes.frequency * 1e-6
    assert damping_ratios(structure, modes) == pytest.approx(expected, rel=1e-6)


def test_modal_damping_per_mode():
    structure = shaft()
    modes = undamped_modes(structure, count=3)
    reduced = truncated(structure, modes, [0.01, 0.02, 0.03])
    again = undamped_modes(reduced)
    assert again.frequency == pytest.approx(modes.frequency)
    assert damping_ratios(reduced, again) == pytest.approx([0.01, 0.02, 0.03])
    with pytest.raises(StructureError, match="2 ratios for 3 modes"):
        truncated(structure, modes, [0.01, 0.02])
    with pytest.raises(StructureError, match="0 or more"):
        truncated(structure, modes, -0.01)


def test_state_space_has_the_receptance_and_its_derivatives():
    structure = shaft()
    reduced = truncated(structure, undamped_modes(structure, count=8), 0.02, ["tip", "root"])
    ports = [TIP, ROOT]
    space = state_space(reduced, ports, ports)
    assert np.all(np.linalg.eigvals(space.a).real < 0.0)
    line = 700.0
    s = 2j * np.pi * line
    response = space.c @ np.linalg.solve(s * np.eye(16) - space.a, space.b) + space.d
    exact = receptance_with_residual(reduced, [line], ports)[0]
    assert response[:2] == pytest.approx(exact, rel=1e-9)
    modal = exact - residual_compliance(reduced, ports, ports)
    assert response[2:4] == pytest.approx(s * modal, rel=1e-9)
    assert response[4:] == pytest.approx(s**2 * modal, rel=1e-9)


def test_state_space_of_the_oscillator_is_the_published_one():
    structure = LinearStructure(
        np.array([[2.0]]), np.array([[3.0]]), np.array([[50.0]]), {"p": np.eye(6)[:, :1]}
    )
    port = PointPort("p", [1, 0, 0])
    space = state_space(structure, [port], [port])
    assert space.a == pytest.approx(np.array([[0, 1], [-25.0, -1.5]]))
    assert space.b == pytest.approx(np.array([[0], [0.5]]))
    assert space.c == pytest.approx(np.array([[1, 0], [0, 1], [-25.0, -1.5]]))
    assert space.d == pytest.approx(np.array([[0], [0], [0.5]]))


def test_energy_of_free_motion_falls_by_what_dampers_take():
    reduced = truncated(shaft(), undamped_modes(shaft(), count=4), 0.05)
    space = state_space(reduced, [TIP], [TIP])
    metric = scipy.linalg.block_diag(reduced.stiffness, reduced.mass)
    power = 0.5 * (metric @ space.a + space.a.T @ metric)
    loss = scipy.linalg.block_diag(np.zeros((4, 4)), -reduced.damping)
    assert power == pytest.approx(loss, abs=1e-9 * np.max(reduced.stiffness))


def test_refusals():
    free = shaft(free=True)
    with pytest.raises(StructureError, match="more rigid-body modes"):
        undamped_modes(free, count=4)
    with pytest.raises(StructureError, match="more rigid-body modes"):
        undamped_modes(as_sparse(free), count=4)
    with pytest.raises(StructureError, match="up to which frequency"):
        undamped_modes(as_sparse(free))
    with pytest.raises(StructureError, match="above 0"):
        undamped_modes(free, highest=-1.0)
    with pytest.raises(StructureError, match='no point "nose"'):
        truncated(free, undamped_modes(free, count=7), residual_at=["nose"])
    with pytest.raises(StructureError, match="gives energy back"):
        undamped_modes(chain([1.0, 1.0], [1e3], grounded=-1e3))
    with pytest.raises(StructureError, match="mass matrix is singular"):
        state_space(chain([0.0, 1.0], [1e3], 1e3), [], [])
