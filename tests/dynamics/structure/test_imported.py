"""Imported matrices and points tied to surfaces, on a lattice of springs built here."""

import itertools
import zipfile

import numpy as np
import pytest
import scipy.io
import scipy.linalg
import scipy.sparse

from chatter.io.matrices import imported_structure, read_matrix, read_nodes
from dynamics.structure.imported import refuse_indefinite, tied_structure
from dynamics.structure.linear_structure import LinearStructure, StructureError
from dynamics.structure.surface_constraint import (
    InterpolatedPoint,
    Nodes,
    RigidSurface,
    interpolation,
)

SIDE = 0.1


def lattice():
    """Coordinates, mass (kg) and stiffness (N/m) of a free 3 x 3 x 3 lattice of springs."""
    coordinates = SIDE * np.array(list(itertools.product(range(3), repeat=3)), dtype=float)
    size = coordinates.size
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for first, second in itertools.combinations(range(len(coordinates)), 2):
        span = coordinates[second] - coordinates[first]
        if np.max(np.abs(span)) > 1.01 * SIDE:
            continue
        along = span / np.linalg.norm(span)
        pull = np.zeros(size)
        pull[3 * first : 3 * first + 3], pull[3 * second : 3 * second + 3] = -along, along
        stiffness += 4e6 * np.outer(pull, pull)
        for axis in range(3):  # consistent mass of a bar of 0.06 kg
            pair = [3 * first + axis, 3 * second + axis]
            mass[np.ix_(pair, pair)] += 0.01 * np.array([[2.0, 1.0], [1.0, 2.0]])
    return coordinates, mass, stiffness


def held_lattice():
    """The lattice with its nine lowest nodes removed by holding them: 18 nodes, 54 freedoms."""
    coordinates, mass, stiffness = lattice()
    free = np.flatnonzero(coordinates[:, 2] > 0.0)
    rows = np.add.outer(3 * free, np.arange(3)).ravel()
    inner = np.ix_(rows, rows)
    return coordinates[free], mass[inner], stiffness[inner]


def numbered(coordinates):
    return Nodes.in_order(np.arange(len(coordinates)) + 101, coordinates, coordinates.size)


def on_top(coordinates):
    return list(101 + np.flatnonzero(coordinates[:, 2] > 1.9 * SIDE))


def bare(mass, stiffness):
    return LinearStructure(mass, 1e-5 * stiffness, stiffness, {})


TOP = (0.12, 0.07, 0.31)


def rigid_row(offset):
    """Displacements (3, 6) at an offset: u + theta x r."""
    turns = [np.cross(axis, offset) for axis in np.eye(3)]
    return np.column_stack([np.eye(3), *turns])


def test_interpolated_point_keeps_resultants_and_rigid_motion():
    coordinates, _, stiffness = lattice()
    names = on_top(coordinates)
    weights = np.linspace(1.0, 3.0, len(names))
    rows = interpolation(
        InterpolatedPoint("tool", TOP, names, weights), numbered(coordinates), stiffness.shape[0]
    )
    load = np.array([30.0, -20.0, 50.0, 1.0, 2.0, -4.0])
    forces = (rows.T @ load).reshape(-1, 3)
    np.testing.assert_allclose(forces.sum(axis=0), load[:3], atol=1e-11)
    moments = np.cross(coordinates - np.array(TOP), forces).sum(axis=0)
    np.testing.assert_allclose(moments, load[3:], atol=1e-11)
    assert not np.any(forces[coordinates[:, 2] < 1.9 * SIDE])
    motion = np.array([0.1, 0.2, -0.3, 0.01, -0.02, 0.03])
    moved = np.concatenate([rigid_row(place - TOP) @ motion for place in coordinates])
    np.testing.assert_allclose(rows @ moved, motion, atol=1e-13)


def test_weights_share_a_force_as_given():
    # Four corners of a square about the point: a force spreads in proportion to the weights once
    # it acts at their centre of weight.
    corners = np.array([[1.0, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]])
    weights = np.array([1.0, 2.0, 3.0, 4.0])
    centre = weights @ corners / 10.0
    point = InterpolatedPoint("tool", centre, [101, 102, 103, 104], weights)
    forces = interpolation(point, numbered(corners), 12).T @ [0.0, 0.0, 10.0, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(forces[2::3], weights, atol=1e-12)


def test_interpolated_point_adds_no_stiffness():
    coordinates, mass, stiffness = held_lattice()
    point = InterpolatedPoint("tool", TOP, on_top(coordinates))
    structure = tied_structure(bare(mass, stiffness), numbered(coordinates), (), [point])
    np.testing.assert_array_equal(structure.stiffness, stiffness)
    np.testing.assert_array_equal(structure.mass, mass)


def test_rigid_surface_is_the_limit_of_stiff_springs():
    coordinates, mass, stiffness = held_lattice()
    names = on_top(coordinates)
    point = RigidSurface("tool", TOP, names)
    tied = tied_structure(bare(mass, stiffness), numbered(coordinates), [point])
    assert tied.size == len(mass) - 3 * len(names) + 6
    exact = tied.points["tool"] @ np.linalg.solve(tied.stiffness, tied.points["tool"].T)
    frequencies = tied.natural_frequencies(8)
    differences = []
    for spring in (1e9, 1e10):
        size = len(mass) + 6
        sprung = np.zeros((size, size))
        sprung[:-6, :-6] = stiffness
        for name in names:
            gap = np.zeros((3, size))
            gap[:, 3 * (name - 101) : 3 * (name - 101) + 3] = np.eye(3)
            gap[:, -6:] = -rigid_row(coordinates[name - 101] - TOP)
            sprung += spring * gap.T @ gap
        compliance = np.linalg.inv(sprung)[-6:, -6:]
        # The point has no mass and follows the springs.
        follow = np.linalg.solve(sprung[-6:, -6:], sprung[-6:, :-6])
        condensed = sprung[:-6, :-6] - sprung[:-6, -6:] @ follow
        squared = scipy.linalg.eigh(condensed, mass, eigvals_only=True)[:8]
        differences.append(
            (
                np.max(np.abs(compliance / np.diag(exact) - exact / np.diag(exact))),
                np.max(np.abs(np.sqrt(squared) / (2.0 * np.pi) / frequencies - 1.0)),
            )
        )
    for soft, stiff in zip(*differences, strict=True):
        assert stiff < 3e-3
        assert stiff == pytest.approx(0.1 * soft, rel=0.1)


def test_all_nodes_rigid_have_the_mass_and_inertia_of_the_lattice():
    coordinates, mass, stiffness = lattice()
    surface = RigidSurface("all", TOP, list(range(101, 128)))
    structure = tied_structure(bare(mass, stiffness), numbered(coordinates), [surface])
    rigid = np.vstack([rigid_row(place - TOP) for place in coordinates])
    np.testing.assert_allclose(structure.mass, rigid.T @ mass @ rigid, atol=1e-12)
    np.testing.assert_allclose(structure.mass[:3, :3], mass.sum() / 3 * np.eye(3), atol=1e-12)
    np.testing.assert_allclose(structure.stiffness, 0.0, atol=1e-7)
    np.testing.assert_array_equal(structure.points["all"], np.eye(6))


def test_rigid_rotation_of_nodes_with_six_freedoms():
    # One node: the point's motion in the node's freedoms, rotations too.
    stiffness = np.diag([1e6, 2e6, 3e6, 1e3, 2e3, 3e3])
    nodes = Nodes.in_order([1], [[0.0, 0.0, 0.0]], 6)
    structure = tied_structure(
        LinearStructure(np.eye(6), np.zeros((6, 6)), stiffness, {}),
        nodes,
        [RigidSurface("tip", (0.0, 0.0, 0.2), [1])],
    )
    compliance = np.linalg.inv(structure.stiffness)
    assert compliance[0, 0] == pytest.approx(1e-6 + 0.2**2 / 2e3)
    assert compliance[0, 4] == pytest.approx(0.2 / 2e3)
    assert compliance[1, 3] == pytest.approx(-0.2 / 1e3)


def test_two_surfaces_and_an_interpolated_point_of_a_sparse_model():
    coordinates, mass, stiffness = held_lattice()
    sparse = [scipy.sparse.csr_array(matrix) for matrix in (mass, 1e-5 * stiffness, stiffness)]
    ties = (
        [RigidSurface("one", TOP, [101, 103, 105]), RigidSurface("two", TOP, [102, 112, 115, 118])],
        [InterpolatedPoint("three", TOP, on_top(coordinates)[1:])],
    )
    # Three nodes on one line do not tell rotations; take another for the first surface.
    with pytest.raises(StructureError, match='rigid surface "one": its 3 nodes lie on one line'):
        tied_structure(LinearStructure(*sparse, {}), numbered(coordinates), *ties)
    ties[0][0] = RigidSurface("one", TOP, [104, 106, 107])
    tied = tied_structure(LinearStructure(*sparse, {}), numbered(coordinates), *ties)
    dense = tied_structure(bare(mass, stiffness), numbered(coordinates), *ties)
    assert scipy.sparse.issparse(tied.mass)
    np.testing.assert_allclose(tied.mass.toarray(), dense.mass, atol=1e-14)
    np.testing.assert_allclose(tied.damping.toarray(), dense.damping, atol=1e-8)
    for name in ("one", "two", "three"):
        np.testing.assert_allclose(tied.points[name], dense.points[name], atol=1e-14)
    assert tied.size == 54 - 21 + 12


def write(folder, mass, stiffness):
    scipy.io.mmwrite(folder / "mass.mtx", scipy.sparse.coo_array(mass), precision=17)
    scipy.io.mmwrite(folder / "dense.mtx", mass, precision=17)
    scipy.io.mmwrite(folder / "whole.mtx", scipy.sparse.coo_array(mass), symmetry="general")
    scipy.sparse.save_npz(folder / "stiffness.npz", scipy.sparse.csc_array(stiffness))
    scipy.sparse.save_npz(folder / "triplets.npz", scipy.sparse.coo_array(stiffness))
    np.savez(folder / "plain.npz", stiffness=stiffness)


def test_files_of_each_kind_are_read(tmp_path):
    coordinates, mass, stiffness = held_lattice()
    write(tmp_path, mass, stiffness)
    kinds = {"mass.mtx": True, "dense.mtx": False, "whole.mtx": True}
    kinds |= {"stiffness.npz": True, "triplets.npz": True, "plain.npz": False}
    for name, sparse in kinds.items():
        matrix = read_matrix(tmp_path / name)
        assert scipy.sparse.issparse(matrix) == sparse
        expected = mass if name.endswith("mtx") else stiffness
        found = matrix.toarray() if sparse else matrix
        np.testing.assert_allclose(found, expected, atol=1e-14 * np.max(expected))
    lines = ["node, x, y, z"]
    lines += [f"{101 + place}, {x}, {y}, {z}" for place, (x, y, z) in enumerate(coordinates)]
    (tmp_path / "nodes.csv").write_text("\n".join(lines), encoding="utf-8")
    structure = imported_structure(
        tmp_path / "mass.mtx",
        tmp_path / "stiffness.npz",
        nodes=tmp_path / "nodes.csv",
        rigid=[RigidSurface("tool", TOP, on_top(coordinates))],
    )
    expected = tied_structure(
        bare(mass, stiffness),
        numbered(coordinates),
        [RigidSurface("tool", TOP, on_top(coordinates))],
    )
    np.testing.assert_allclose(
        structure.natural_frequencies(), expected.natural_frequencies(), rtol=1e-9
    )
    assert structure.damping.nnz == 0


def test_table_with_rows_of_held_freedoms(tmp_path):
    path = tmp_path / "nodes.csv"
    path.write_text("node,x,y,z,ux,uy,uz\n7,0,0,0,,2,1\n9,1,0,0.5,4,3,\n", encoding="utf-8")
    nodes = read_nodes(path, 4)
    np.testing.assert_array_equal(nodes.rows[:, :3], [[-1, 1, 0], [3, 2, -1]])
    assert np.all(nodes.rows[:, 3:] == -1)
    np.testing.assert_array_equal(nodes.coordinates, [[0, 0, 0], [1, 0, 0.5]])


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("node,x,y\n1,0,0\n", 'no column "z"'),
        ("node,x,y,z,ux\n1,0,0,0,\n1,1,0,0,\n", "node 1 is there twice"),
        ("node,x,y,z\n1,0,0,0\n2,1,zero,0\n", 'line 3: y is "zero"'),
        ("node,x,y,z\n1,0,0,nan\n", 'line 2: z is "nan"'),
        ("node,x,y,z\n1.5,0,0,0\n", 'node is "1.5", not a whole number'),
        ("node,x,y,z\n1,0,0\n", "line 2: z is"),
        ("node,x,y,z\n", "has no nodes"),
        ("node,x,y,z\n1,0,0,0\n", "3 or 6 freedoms, the matrices have 7"),
        ("node,x,y,z,ux\n1,0,0,0,8\n", "ux is 8; rows are 1 to 7"),
        ("node,x,y,z,ux,uy\n1,0,0,0,3,3\n", "row 3 has two freedoms"),
    ],
)
def test_faulty_tables_are_refused(tmp_path, table, message):
    path = tmp_path / "nodes.csv"
    path.write_text(table, encoding="utf-8")
    with pytest.raises(StructureError, match=message) as refusal:
        read_nodes(path, 7)
    assert "nodes.csv" in str(refusal.value)


def spoilt(matrix, row, column, value):
    matrix = matrix.copy()
    matrix[row, column] = value
    return matrix


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.ones((3, 2)), "is 3 x 2; it must be square"),
        (np.ones(4), "is 4; it must be square"),
        (spoilt(np.eye(4), 1, 2, np.nan), "row 2, column 3 is nan"),
        (spoilt(np.eye(4), 3, 3, np.inf), "row 4, column 4 is inf"),
        (
            spoilt(spoilt(np.eye(4), 0, 3, 0.5), 2, 0, 0.1),
            "not symmetric: row 1, column 4 is 0.5, row 4, column 1 is 0",
        ),
        ((1.0 + 0.02j) * np.eye(3), "is complex; give its real part"),
        (np.array([[None]]), "cannot be read"),
    ],
)
def test_faulty_matrices_are_refused(tmp_path, matrix, message):
    path = tmp_path / "stiffness.npz"
    np.savez(path, matrix=matrix)
    with pytest.raises(StructureError, match=message) as refusal:
        read_matrix(path)
    assert "stiffness.npz" in str(refusal.value)


@pytest.mark.parametrize("pack", [np.asarray, scipy.sparse.csr_array])
@pytest.mark.parametrize(
    ("mass", "message"),
    [
        (spoilt(np.eye(4), 2, 2, -1.0), "diagonal at row 3 is -1"),
        (spoilt(np.eye(4), 2, 2, 0.0), "every freedom needs mass"),
        (
            spoilt(spoilt(np.eye(4), 1, 2, 1.5), 2, 1, 1.5),
            "not positive definite, found at row [23]",
        ),
        (
            spoilt(spoilt(np.eye(4), 1, 2, 1.0), 2, 1, 1.0),
            "not positive definite, found at row [23]",
        ),
    ],
)
def test_indefinite_mass_is_refused(tmp_path, pack, mass, message):
    mass = pack(mass)
    path = tmp_path / "mass.npz"
    if scipy.sparse.issparse(mass):
        scipy.sparse.save_npz(path, mass)
    else:
        np.savez(path, mass)
    np.savez(tmp_path / "stiffness.npz", np.eye(4))
    with pytest.raises(StructureError, match=message) as refusal:
        imported_structure(path, tmp_path / "stiffness.npz")
    assert "mass.npz" in str(refusal.value)


def chain(rows, coupling):
    """Shuffled mass of a chain; scaled, its smallest eigenvalue is nearly 1 - 2 coupling."""
    random = np.random.default_rng(3)
    beside = np.full(rows - 1, coupling)
    plain = scipy.sparse.csr_array(scipy.sparse.diags([beside, np.ones(rows), beside], [-1, 0, 1]))
    order = random.permutation(rows)
    spread = scipy.sparse.diags(10.0 ** random.uniform(-6.0, 3.0, rows))
    return scipy.sparse.csr_array(spread @ plain[order][:, order] @ spread)


@pytest.mark.parametrize("rows", [300, 3000])
def test_definite_sparse_mass_is_taken_and_an_indefinite_one_not(rows):
    refuse_indefinite(chain(rows, 0.49), "mass.npz")
    with pytest.raises(StructureError, match=r"mass.npz: the mass matrix is not positive definite"):
        refuse_indefinite(chain(rows, 0.51), "mass.npz")


def test_sizes_must_agree(tmp_path):
    np.savez(tmp_path / "mass.npz", np.eye(3))
    np.savez(tmp_path / "stiffness.npz", np.eye(4))
    with pytest.raises(StructureError, match=r"stiffness.npz: 4 rows; .*mass.npz has 3"):
        imported_structure(tmp_path / "mass.npz", tmp_path / "stiffness.npz")
    with pytest.raises(StructureError, match=r"stiffness.npz: 4 rows; .*mass.npz has 3"):
        imported_structure(tmp_path / "mass.npz", tmp_path / "mass.npz", tmp_path / "stiffness.npz")


def test_broken_and_foreign_files_are_refused(tmp_path):
    good = tmp_path / "good.npz"
    scipy.sparse.save_npz(good, scipy.sparse.csr_array(np.eye(50)), compressed=True)
    whole = good.read_bytes()
    contents = {
        "empty.npz": b"",
        "cut.npz": whole[: len(whole) // 2],
        "scrambled.npz": whole[:90] + bytes(40) + whole[130:],
        "text.mtx": b"not a matrix\n",
        "short.mtx": b"%%MatrixMarket matrix coordinate real general\n2 2 3\n1 1 1.0\n",
        "huge.mtx": b"%%MatrixMarket matrix array real general\n900000 900000\n1.0\n",
        "more.mtx": b"%%MatrixMarket matrix coordinate real general\n9000000 9000000 0\n",
        "complex.mtx": b"%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 1\n",
        "pattern.mtx": b"%%MatrixMarket matrix coordinate pattern general\n1 1 1\n1 1\n",
        "matrix.txt": b"1.0",
    }
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)
    with zipfile.ZipFile(tmp_path / "other.npz", "w") as archive:
        archive.writestr("readme.txt", "nothing")
    outside = {"format": b"csr", "shape": (2, 2), "data": [1.0, 1.0], "indptr": [0, 1, 2]}
    np.savez(tmp_path / "outside.npz", indices=[0, 999], **outside)
    np.savez(tmp_path / "two.npz", first=np.eye(2), second=np.eye(2))
    for name in [*contents, "other.npz", "outside.npz", "two.npz", "absent.mtx"]:
        with pytest.raises(StructureError, match=name.replace(".", r"\.")):
            read_matrix(tmp_path / name)


COORDINATES, MASS, STIFFNESS = held_lattice()


@pytest.mark.parametrize(
    ("rigid", "interpolated", "message"),
    [
        ([RigidSurface("a", TOP, [101, 999])], [], 'rigid surface "a": there is no node 999'),
        ([RigidSurface("a", TOP, [101, 101])], [], "named twice"),
        ([RigidSurface("a", TOP, [])], [], "no nodes"),
        (
            [RigidSurface("a", TOP, [101, 103, 107]), RigidSurface("b", TOP, [101, 102, 104])],
            [],
            'surfaces "a" and "b" share a node',
        ),
        (
            [RigidSurface("a", TOP, [101, 103, 107])],
            [InterpolatedPoint("a", TOP, [101, 103, 107])],
            'point "a" is there twice',
        ),
        ([], [InterpolatedPoint("a", TOP, [101, 102])], "2 nodes lie on one line"),
        ([], [InterpolatedPoint("a", TOP, [101, 103, 107], [1, -1, 1])], "weights must be above"),
        ([], [InterpolatedPoint("a", TOP, [101, 103, 107], [1, 1])], "weights must be 3 finite"),
        ([], [InterpolatedPoint("a", (0, 0), [101, 103, 107])], "at must be 3 finite"),
    ],
)
def test_impossible_ties_are_refused(rigid, interpolated, message):
    with pytest.raises(StructureError, match=message):
        tied_structure(bare(MASS, STIFFNESS), numbered(COORDINATES), rigid, interpolated)


def test_held_node_cannot_follow_a_point():
    rows = np.array([[0, 1, 2, -1, -1, -1], [3, -1, 4, -1, -1, -1]])
    nodes = Nodes(np.array([1, 2]), np.array([[0.0, 0, 0], [1.0, 0, 0]]), rows)
    with pytest.raises(StructureError, match="node 2 is held in y"):
        tied_structure(bare(np.eye(5), np.eye(5)), nodes, [RigidSurface("a", TOP, [1, 2])])
