"""Matrices and nodes as finite element programs write them, against values written by hand."""

import math
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.io
import scipy.linalg
import scipy.sparse

from chatter.io.matrices import imported_model, read_matrix, read_nodes
from dynamics.structure.imported import ModelUnits
from dynamics.structure.linear_structure import StructureError

# two nodes, 3 and 8, along x; node 8 comes first in the files
FREEDOMS = [[3, 1], [3, 2], [8, 1], [8, 2]]
STIFFNESS = np.array(
    [[4.0, 1.0, -4.0, 0.0], [1.0, 6.0, 0.0, -2.5], [-4.0, 0.0, 4.0, 0.0], [0.0, -2.5, 0.0, 7.0]]
)
MASS = np.diag([2.0, 2.0, 3.0, 3.0])

SMALL = """$ punch of a model
DMIG    KAAX           0       6       2       0                       4
DMIG    KAAX           8       1               8       1     4.0
               3       1    -4.0
DMIG    KAAX           8       2               8       2     7.0
+              3       2    -2.5
DMIG    KAAX           3       1               3       1     4.0
               3       2     1.0
DMIG    KAAX           3       2               3       2     6.0
DMIG    MAAX           0       6       2       0                       4
DMIG    MAAX           3       1               3       1     2.0
DMIG    MAAX           3       2               3       2    .2+1
DMIG    MAAX           8       1               8       1     3.0
DMIG    MAAX           8       2               8       2   30.-1
"""
LARGE = """DMIG    KAAX           0       6       2       0                       4
DMIG*   KAAX                           8               1
*                      8               1 4.000000000D+00
*                      3               1-4.000000000D+00
DMIG*   KAAX                           8               2
*                      8               2 7.000000000D+00
*                      3               2-2.500000000D+00
DMIG*   KAAX                           3               1
*                      3               1 4.000000000D+00
*                      3               2 1.000000000D+00
DMIG*   KAAX                           3               2
*                      3               2 6.000000000D+00
"""
FREE = """DMIG,KAAX,0,1,2,0
DMIG,KAAX,3,1,,3,1,4.0
+,3,2,1.0,,8,1,-4.0
DMIG,KAAX,3,2,,3,1,1.0
,3,2,6.0,,8,2,-2.5
DMIG,KAAX,8,1,,3,1,-4.
,8,1,4.0
DMIG,KAAX,8,2,,3,2,-2.5,,,
,8,2,7.+0
"""
BY_NODE = """** matrix of Abaqus
8,1, 8,1,  4.00000000000e+00
8,2, 8,2,  7.0
8,1, 3,1, -4.0
3,1, 3,1,  4.0
3,2, 3,1,  1.0
3,2, 3,2,  6.0
8,2, 3,2, -2.5
"""
BY_ROW = "1 1 4.\n2 1 1.\n2 2 6.\n3 1 -4.\n3 3 4.\n4 2 -2.5\n4 4 7.\n"
TABLE = "node,x,y,z\n3,0,0,0\n8,1,0,0\n"


def written(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("large.pch", LARGE),
        ("free.bdf", FREE),
        ("job_STIF1.mtx", BY_NODE),
        ("job_STIF2.mtx", BY_ROW),
    ],
)
def test_stiffness_as_each_program_writes_it(tmp_path, name, text):
    matrix = read_matrix(written(tmp_path, name, text))
    np.testing.assert_array_equal(matrix.toarray(), STIFFNESS)


def test_both_matrices_of_one_punch_file(tmp_path):
    path = written(tmp_path, "model.pch", SMALL)
    structure, nodes = imported_model(path, path, nodes=written(tmp_path, "n.csv", TABLE))
    np.testing.assert_array_equal(structure.stiffness.toarray(), STIFFNESS)
    np.testing.assert_allclose(structure.mass.toarray(), MASS, rtol=1e-15)
    np.testing.assert_array_equal(nodes.names, [3, 8])
    np.testing.assert_array_equal(nodes.rows[:, :3], [[0, 1, -1], [2, 3, -1]])


def test_matrices_with_names_of_one_s_own(tmp_path):
    path = written(tmp_path, "model.pch", SMALL.replace("KAAX", "STIF").replace("MAAX", "MAS2"))
    nodes = written(tmp_path, "n.csv", TABLE)
    with pytest.raises(StructureError, match=r'holds "STIF", "MAS2" \(mass\); say by its name'):
        imported_model(path, path, nodes=nodes)
    named = imported_model(path, path, nodes=nodes, names={"stiffness": "stif"})
    np.testing.assert_array_equal(named.structure.stiffness.toarray(), STIFFNESS)
    with pytest.raises(StructureError, match='no matrix "K"; there is "STIF"'):
        imported_model(path, path, nodes=nodes, names={"stiffness": "K"})


def test_other_matrices_of_a_punch_file_are_passed_over(tmp_path):
    """Structural damping K4AAX is no stiffness; shapes are rectangular."""
    others = "DMIG,K4AAX,0,6,2,0\nDMIG,K4AAX,3,1,,3,1,9.0\nDMIG,MUG1,0,9,2,0,,,4\n"
    others += "DMIG,MUG1,1,0,,3,1,9.0\nDMIG,KC,0,6,4,0\nDMIG,KC,3,1,,3,1,9.0,1.0\n"
    path = written(tmp_path, "model.pch", others + SMALL)
    structure, _ = imported_model(path, path, nodes=written(tmp_path, "n.csv", TABLE))
    np.testing.assert_array_equal(structure.stiffness.toarray(), STIFFNESS)


def test_freedoms_that_one_matrix_lacks(tmp_path):
    """A row without entries is in no sparse file; it is where its node is nevertheless."""
    stiffness = written(tmp_path, "k_STIF1.mtx", "3,1,3,1,5.\n8,2,8,2,7.\n")
    mass = written(tmp_path, "m_MASS1.mtx", "3,1,3,1,1.\n8,1,8,1,2.\n8,2,8,2,3.\n")
    structure, _ = imported_model(mass, stiffness, nodes=written(tmp_path, "n.csv", TABLE))
    np.testing.assert_array_equal(structure.stiffness.toarray(), np.diag([5.0, 0.0, 7.0]))


NODES = {
    "model.bdf": "GRID,3,,10.,0.5,-2.\nGRID*                  8               0"
    "              1.              0.\n*                    2.5\nENDDATA\n",
    "model.inp": "*HEADING\n*NODE, NSET=a\n 3, 10., .5, -2.\n 8, 1., 0., 2.5\n*ELEMENT\n1, 3, 8\n",
    "model.cdb": "/PREP7\nNBLOCK,6,SOLID,  8,  2\n(3i9,6e21.13e3)\n"
    "        3        0        0 1.0000000000000E+001 5.0000000000000E-001-2.0000000000000E+000\n"
    "        8        0        0 1.0000000000000E+000 0.0000000000000E+000 2.5000000000000E+000\n"
    "N,R5.3,LOC,       -1,\n",
    "nodes.csv": "node,x,y,z\n3,10,0.5,-2\n8,1,0,2.5\n",
}


@pytest.mark.parametrize("name", NODES)
def test_nodes_as_each_program_writes_them(tmp_path, name):
    nodes = read_nodes(written(tmp_path, name, NODES[name]), 6)
    np.testing.assert_array_equal(nodes.names, [3, 8])
    np.testing.assert_array_equal(nodes.coordinates, [[10.0, 0.5, -2.0], [1.0, 0.0, 2.5]])


def cantilever_in_mm(folder):
    """Element of Euler and Bernoulli in N, mm, t and s; near end held: 210 GPa, 50 mm, d 10 mm."""
    young, length, second, line_mass = 210e3, 50.0, math.pi * 10.0**4 / 64.0, 7.85e-9 * 25 * math.pi
    bending = young * second / length**3
    stiffness = bending * np.array([[12.0, -6 * length], [-6 * length, 4 * length**2]])
    mass = line_mass * length / 420.0
    mass = mass * np.array([[156.0, -22 * length], [-22 * length, 4 * length**2]])
    texts = [
        f"7,2,7,2,{m[0, 0]:.17g}\n7,6,7,2,{m[1, 0]:.17g}\n7,6,7,6,{m[1, 1]:.17g}\n"
        for m in (mass, stiffness)
    ]
    return [
        written(folder, "b_MASS1.mtx", texts[0]),
        written(folder, "b_STIF1.mtx", texts[1]),
        None,
        written(folder, "b.inp", "*NODE\n7, 50., 0., 0.\n"),
    ]


def test_units_of_a_model(tmp_path):
    units = ModelUnits(length=1e-3, mass=1e3)
    structure, nodes = imported_model(*cantilever_in_mm(tmp_path), units=units)
    np.testing.assert_array_equal(nodes.coordinates, [[0.05, 0.0, 0.0]])
    second = math.pi * 0.01**4 / 64.0
    compliance = np.linalg.inv(structure.stiffness.toarray())
    closed = [[0.05**3 / 3.0, 0.05**2 / 2.0], [0.05**2 / 2.0, 0.05]]
    np.testing.assert_allclose(compliance, np.array(closed) / (210e9 * second), rtol=1e-12)
    # clamped beam: 1.8751^2 / 2 pi sqrt(E I / (rho A L^4)); one element is 0.5 % above
    squared = scipy.linalg.eigh(
        structure.stiffness.toarray(), structure.mass.toarray(), eigvals_only=True
    )
    exact = 1.875104**2 / (2 * math.pi) * math.sqrt(210e9 * 0.01**2 / 16 / (7850 * 0.05**4))
    assert math.sqrt(squared[0]) / (2 * math.pi) == pytest.approx(1.005 * exact, rel=2e-3)
    # in ms: stiffness in kg/ms^2
    seconds = imported_model(*cantilever_in_mm(tmp_path), units=ModelUnits(1e-3, 1e3, 1e-3))
    np.testing.assert_allclose(
        seconds.structure.stiffness.toarray(), 1e6 * structure.stiffness.toarray(), rtol=1e-12
    )
    np.testing.assert_array_equal(seconds.structure.mass.toarray(), structure.mass.toarray())


def test_another_total_mass_is_refused(tmp_path):
    mass = written(tmp_path, "m_MASS1.mtx", "3,1,3,1,2.\n3,2,3,2,2.\n3,3,3,3,2.\n")
    nodes = written(tmp_path, "n.csv", "node,x,y,z\n3,0,0,0\n")
    imported_model(mass, written(tmp_path, "k_STIF1.mtx", "3,1,3,1,1.\n"), None, nodes,
                   total_mass=2.03)  # fmt: skip
    with pytest.raises(StructureError, match=r"m_MASS1.mtx: has 0.002 kg along x, 2 kg are stated"):
        imported_model(mass, tmp_path / "k_STIF1.mtx", None, nodes, total_mass=2.0,
                       units=ModelUnits(1.0, 1e-3))  # fmt: skip


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.pch", "GRID,1\n", "has no DMIG entries of a real square matrix$"),
        ("a.pch", "DMIG,K,3,1,,3,1,4.0\n", "line 1: DMIG K has a column but no header"),
        ("a.pch", "DMIG,K,0,6,4,0\n", "DMIG K is complex"),
        ("a.pch", "DMIG,K,0,2,2,0\n", "DMIG K is of form 2"),
        ("a.pch", "DMIG,K,0,6,2,0\nDMIG,K,3,1,,3,x,4.0\n", 'line 2: DMIG has "x" where a whole'),
        ("a.pch", "DMIG,K,0,6,2,0\nDMIG,K,3,1,,3,1,4.0.\n", '"4.0." stands where a number'),
        (
            "a.pch",
            "DMIG,K,0,6,2,0\nDMIG,K,3,1,,3,1,4.0\n,3,1,5.\n",
            "entry node 3 x, node 3 x is there twice",
        ),
        ("a.mtx", "3,1,3,1,1e36\n8,1,8,1,1.\n", r"node 3 x is held .*1 in all"),
        ("a.mtx", "-2,1,-2,1,1.0\n", "node -2 is an internal one"),
        ("a.mtx", "3,7,3,7,1.0\n", "direction 7"),
        ("a.mtx", "3,1.5,3,7,1.0\n", "whole numbers"),
        ("a.mtx", "0 1 1.0\n", "rows and columns begin at 1"),
        ("a.mtx", "*USER ELEMENT, NODES=4, LINEAR\n", "matrix of a substructure"),
        ("a.mtx", "1, 2\n", "is no matrix of Abaqus"),
        ("a.mtx", "one two three\n", "is no matrix of Abaqus"),
        ("a.mtx", "3,1,3,1,4.\n3,2,3,1,1.\n3,1,3,2,2.\n3,2,3,2,3.\n", "not symmetric: node 3"),
        ("a.full", "nothing", "chatter|no .full file"),
    ],
)
def test_wrong_matrices_are_refused(tmp_path, name, text, said):
    with pytest.raises(StructureError, match=said) as refusal:
        read_matrix(written(tmp_path, name, text))
    assert name in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.bdf", "GRID,1,2,0.,0.,0.\n", "GRID 1 has a coordinate system"),
        ("a.bdf", "GRID,1,,0.,0.,0.,5\n", "GRID 1 has a coordinate system"),
        ("a.bdf", "CBEAM,1\n", "has no GRID entries"),
        ("a.inp", "*ELEMENT\n1,2\n", "has no nodes"),
        ("a.inp", "*NODE\n1, a, 0, 0\n", "line 2: is no node"),
        ("a.inp", "*NODE, SYSTEM=C\n1, 0, 0, 0\n", "must be rectangular"),
        ("a.inp", "*INSTANCE, NAME=a\n1., 0., 0.\n", "an instance is moved"),
        ("a.inp", "*NODE\n1,0,0,0\n*INSTANCE\n*INSTANCE\n", "has 2 instances"),
        ("a.cdb", "/PREP7\n", "has no nodes"),
        (
            "a.cdb",
            NODES["model.cdb"].replace("-2.0000000000000E+000\n",
                                       "-2.0000000000000E+000 9.0000000000000E+001\n"),
            "node 3 has turned axes",
        ),
    ],
)  # fmt: skip
def test_wrong_nodes_are_refused(tmp_path, name, text, said):
    with pytest.raises(StructureError, match=said) as refusal:
        read_nodes(written(tmp_path, name, text), 6)
    assert name in str(refusal.value)


def test_freedoms_and_nodes_must_fit(tmp_path):
    path = written(tmp_path, "model.pch", SMALL)
    with pytest.raises(StructureError, match=r"n.csv: lacks node 8, which the matrices have"):
        imported_model(path, path, nodes=written(tmp_path, "n.csv", "node,x,y,z\n3,0,0,0\n"))
    rows = "node,x,y,z,ux\n3,0,0,0,1\n8,1,0,0,2\n"
    with pytest.raises(StructureError, match=r"n.csv: says rows .*the matrices name"):
        imported_model(path, path, nodes=written(tmp_path, "n.csv", rows))
    plain = tmp_path / "mass.npz"
    np.savez(plain, MASS)
    with pytest.raises(StructureError, match=r"model.pch names the freedoms of its rows"):
        imported_model(plain, path)
    light = written(tmp_path, "light.pch", SMALL.replace(".2+1", " 0.0"))
    with pytest.raises(StructureError, match=r"light.pch: the diagonal at node 3 y is 0; every"):
        imported_model(light, light, nodes=written(tmp_path, "n.csv", TABLE))
    mass = written(tmp_path, "job_MASS1.mtx", BY_NODE)
    with pytest.raises(StructureError, match=r"job_MASS1.mtx: holds mass; stiffness is to be"):
        imported_model(mass, mass, nodes=written(tmp_path, "n.csv", TABLE))


@pytest.mark.parametrize("one", [np.tril, np.triu, np.asarray])
@pytest.mark.parametrize("kind", ["market", "array", "sparse"])
def test_one_triangle_is_enough(tmp_path, one, kind):
    path = tmp_path / ("k.mtx" if kind == "market" else "k.npz")
    if kind == "market":
        scipy.io.mmwrite(path, scipy.sparse.coo_array(one(STIFFNESS)), symmetry="general")
    elif kind == "array":
        np.savez(path, one(STIFFNESS))
    else:
        scipy.sparse.save_npz(path, scipy.sparse.csc_matrix(one(STIFFNESS)))
    matrix = read_matrix(path)
    np.testing.assert_array_equal(scipy.sparse.csr_array(matrix).toarray(), STIFFNESS)


def test_complex_entries_without_imaginary_parts(tmp_path):
    path = tmp_path / "k.mtx"
    scipy.io.mmwrite(path, scipy.sparse.coo_array(STIFFNESS + 0j), symmetry="general")
    np.testing.assert_array_equal(read_matrix(path).toarray(), STIFFNESS)
    scipy.io.mmwrite(path, scipy.sparse.coo_array(STIFFNESS * (1 + 0.02j)), symmetry="general")
    with pytest.raises(StructureError, match=r"k.mtx: is complex; give its real part"):
        read_matrix(path)


@pytest.mark.parametrize("names", [("M", "K", "C"), ("mass", "stiffness", "damping")])
def test_several_arrays_of_one_archive(tmp_path, names):
    path = tmp_path / "part.npz"
    held = dict(zip(names, (MASS, STIFFNESS, 0.5 * MASS), strict=True))
    np.savez(path, labels=np.arange(4), **held)
    structure, _ = imported_model(path, path, path)
    np.testing.assert_array_equal(structure.mass, MASS)
    np.testing.assert_array_equal(structure.stiffness, STIFFNESS)
    np.testing.assert_array_equal(structure.damping, 0.5 * MASS)
    np.savez(path, m_red=MASS, k_red=STIFFNESS)
    with pytest.raises(StructureError, match='holds "m_red", "k_red"; say by its name'):
        imported_model(path, path)
    own = imported_model(path, path, names={"mass": "m_red", "stiffness": "k_red"})
    np.testing.assert_array_equal(own.structure.stiffness, STIFFNESS)
    np.savez(path, a=np.arange(3), b=np.ones((2, 3)))
    with pytest.raises(StructureError, match=r"part.npz: has no square array; there is a, b"):
        read_matrix(path)


@pytest.mark.parametrize(
    "text",
    [
        "Node ID;X;Y;Z\n3;10,0;0,5;-2,0\n8;1,0;0,0;2,5\n",
        "NID\tX_coord\tY_coord\tZ_coord\n3\t10\t0.5\t-2\n8\t1\t0\t2.5\n",
        "  Label   x      y     z\n  3      10   0.5    -2\n   8   1.0     0   2.5\n",
        '"node","x","y","z"\n3.0,10,0.5,-2\n8.0,1,0,2.5\n',
    ],
)
def test_tables_of_nodes_of_other_programs(tmp_path, text):
    nodes = read_nodes(written(tmp_path, "nodes.txt", text), 6)
    np.testing.assert_array_equal(nodes.names, [3, 8])
    np.testing.assert_array_equal(nodes.coordinates, [[10.0, 0.5, -2.0], [1.0, 0.0, 2.5]])


def test_units_in_a_table_of_nodes_are_refused(tmp_path):
    path = written(tmp_path, "n.csv", "node,x [mm],y [mm],z [mm]\n3,0,0,0\n")
    with pytest.raises(StructureError, match=r'n.csv: the column "x \[mm\]" has a unit; leave'):
        read_nodes(path, 6)


def test_bulk_data_of_another_extension(tmp_path):
    bulk = "BEGIN BULK\n" + NODES["model.bdf"].replace("ENDDATA\n", "") + SMALL + "ENDDATA\n"
    path = written(tmp_path, "model.dat", bulk)
    structure, nodes = imported_model(path, path, nodes=path)
    np.testing.assert_array_equal(structure.stiffness.toarray(), STIFFNESS)
    np.testing.assert_array_equal(nodes.coordinates, [[10.0, 0.5, -2.0], [1.0, 0.0, 2.5]])


def test_full_file_of_ansys_by_its_library(tmp_path, monkeypatch):
    """Upper triangles, directions from 0, rows without entries where a freedom is held."""
    reference = np.array([[3, 0], [3, 1], [5, 0], [8, 0], [8, 1]])
    wide = np.zeros((5, 5))
    wide[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])] = STIFFNESS
    heavy = np.diag([2.0, 2.0, 0.0, 3.0, 3.0])
    upper = [scipy.sparse.csc_matrix(np.triu(one)) for one in (wide, heavy)]
    file = SimpleNamespace(load_km=lambda sort: (reference, *upper))
    reader = SimpleNamespace(read_binary=lambda path: file)
    for name in ("ansys", "ansys.mapdl"):
        monkeypatch.setitem(sys.modules, name, SimpleNamespace())
    monkeypatch.setitem(sys.modules, "ansys.mapdl.reader", reader)
    path = written(tmp_path, "job.full", "binary")
    structure, nodes = imported_model(path, path, nodes=written(tmp_path, "n.csv", TABLE))
    np.testing.assert_array_equal(structure.stiffness.toarray(), STIFFNESS)
    np.testing.assert_array_equal(structure.mass.toarray(), MASS)
    np.testing.assert_array_equal(nodes.rows[:, :2], [[0, 1], [2, 3]])


@pytest.mark.parametrize("kind", ["op4", "op2"])
def test_matrices_of_nastran_by_its_library(tmp_path, monkeypatch, kind):
    """Square ones by their names; K4AA is structural damping, PHG is of shapes, KDICT names nodes.

    The library's answers are made up here; OP4 was tried with pyNastran 1.4.1.
    """
    held = {
        "KAA": SimpleNamespace(data=scipy.sparse.coo_matrix(STIFFNESS), is_matpool=False),
        "maa ": SimpleNamespace(data=MASS, is_matpool=False),
        "K4AA": SimpleNamespace(data=0.1 * MASS, is_matpool=False),
        "PHG": SimpleNamespace(data=MASS[:, :2], is_matpool=False),
        "KDICT": SimpleNamespace(data=STIFFNESS, is_matpool=True),
    }
    modules = {
        "pyNastran.op2.op2": SimpleNamespace(
            read_op2=lambda path, **_: SimpleNamespace(matrices=held)
        ),
        "pyNastran.op4.op4": SimpleNamespace(read_op4=lambda path: held),
    }
    for name in ("pyNastran", "pyNastran.op2", "pyNastran.op4"):
        modules[name] = SimpleNamespace()
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    path = written(tmp_path, f"part.{kind}", "binary")
    structure, nodes = imported_model(
        path, path, nodes=written(tmp_path, "n.csv", "node,x,y,z,ux,uy\n3,0,0,0,1,2\n8,1,0,0,3,4\n")
    )
    np.testing.assert_array_equal(structure.stiffness.toarray(), STIFFNESS)
    np.testing.assert_array_equal(structure.mass, MASS)
    np.testing.assert_array_equal(nodes.rows[:, :2], [[0, 1], [2, 3]])
    for name in ("KAA", "maa ", "K4AA"):
        del held[name]
    with pytest.raises(
        StructureError, match=r"part.op. *: has no square .* KDICT names nodes: pun"
    ):
        read_matrix(path)


def test_without_the_library_of_nastran(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyNastran", None)
    monkeypatch.setitem(sys.modules, "pyNastran.op4.op4", None)
    with pytest.raises(StructureError, match=r"part.op4: needs pip install .chatter\[nastran\]"):
        read_matrix(written(tmp_path, "part.op4", "binary"))


@pytest.mark.ansys
def test_full_file_of_ansys_itself():
    """Natural frequencies that the library's manual prints for the beam that it ships.

    A steel-like beam clamped at one end; bending in both planes alike.
    """
    from ansys.mapdl.reader import examples

    structure, nodes = imported_model(
        examples.fullfile, examples.fullfile, nodes=examples.hexarchivefile
    )
    printed = [1283.200, 1283.200, 5781.975, 6919.399, 6919.399]
    np.testing.assert_allclose(structure.natural_frequencies(5), printed, rtol=1e-6)
    assert nodes.coordinates[:, 2].min() > 0.0  # the nodes of one end are held
