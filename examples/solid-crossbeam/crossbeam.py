"""A ribbed steel crossbeam from solid elements to a super-element of a few kilobytes.

scikit-fem meshes and integrates; M, K and the nodes go to files as another finite element program
would write them, are read back, tied to bolts and rail carriages, and reduced. `run.py` bolts the
result into a machine and needs no finite elements any more.

    python crossbeam.py        (needs scikit-fem, `pip install "chatter[solid]"`)
"""

from __future__ import annotations

import csv
import sys
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike, NDArray
from skfem import Basis, BilinearForm, ElementHexS2, MeshHex

from chatter.io.matrices import imported_structure, read_nodes
from dynamics.reduction.craig_bampton import super_element
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import LinearStructure
from dynamics.structure.surface_constraint import InterpolatedPoint, Nodes, RigidSurface

HERE = Path(__file__).parent

# Cross-section, m: y across (rails at the front, y < 0), z up.
DEPTH, HEIGHT = 0.25, 0.30
WALL, RIB, FLANGE = 0.015, 0.012, 0.025
RIM = 0.06  # of the flanges around the section, where the bolts are
RAIL_HEIGHT = 0.03
RAILS = {"lower": (0.03, 0.06), "upper": (0.24, 0.27)}
WINDOW = ((0.07, 0.18), (0.06, 0.24))  # opening of the ribs, y and z
# Along the beam, m: a place for a carriage between any two ribs.
PITCH, PATCH = 0.25, 0.08
STATIONS = 6
BOLTS = [
    (y, z)
    for y in (-0.5 * RIM, 0.5 * DEPTH, DEPTH + 0.5 * RIM)
    for z in (-0.5 * RIM, 0.5 * HEIGHT, HEIGHT + 0.5 * RIM)
    if (y, z) != (0.5 * DEPTH, 0.5 * HEIGHT)
]
WASHER = 0.035  # radius that a bolt clamps, m
LONGEST = 0.12  # side of an element, m: one element between ribs and carriages
# Hz, of the fixed-interface modes; the machine's below 350 Hz are then within 0.05 %.
HIGHEST = 2000.0


class Material(NamedTuple):
    """Isotropic material."""

    modulus: float  # N/m^2
    poisson: float
    density: float  # kg/m^3


STEEL = Material(210e9, 0.3, 7850.0)


def grid(lines: Sequence[float], longest: float) -> NDArray[np.float64]:
    """Lines (m,) of a mesh along one axis, with equal parts between those given."""
    lines = np.unique(np.round(lines, 9))
    parts = [
        np.linspace(low, high, int(np.ceil((high - low) / longest - 1e-9)) + 1)[:-1]
        for low, high in pairwise(lines)
    ]
    return np.append(np.concatenate(parts), lines[-1])


def boxes(
    lines: Sequence[Sequence[float]], filled: Callable[..., NDArray[np.bool_]], longest: float
) -> MeshHex:
    """Hexahedra between lines along x, y and z where `filled(x, y, z)` at their centres."""
    mesh = MeshHex.init_tensor(*(grid(along, longest) for along in lines))
    centres = mesh.p[:, mesh.t].mean(axis=1)
    return mesh.restrict(np.flatnonzero(filled(*centres)))


def crossbeam_length(stations: int = STATIONS) -> float:
    """m."""
    return PITCH * (stations + 2)


def carriage_places(stations: int = STATIONS) -> NDArray[np.float64]:
    """Places (stations,) of carriages along x, m."""
    return PITCH * (np.arange(stations) + 1.5)


def crossbeam_mesh(stations: int = STATIONS, longest: float = LONGEST) -> MeshHex:
    """Hollow section with ribs with a window, two rails in front and flanges at both ends."""
    length = crossbeam_length(stations)
    ribs = PITCH * (np.arange(stations + 1) + 1.0)
    places = carriage_places(stations)
    x = [0.0, FLANGE, length - FLANGE, length, *(ribs - 0.5 * RIB), *(ribs + 0.5 * RIB)]
    x += [*(places - 0.5 * PATCH), *(places + 0.5 * PATCH)]
    (left, right), (low, high) = WINDOW
    y = [-RIM, -RAIL_HEIGHT, 0.0, WALL, left, right, DEPTH - WALL, DEPTH, DEPTH + RIM]
    z = [-RIM, 0.0, WALL, low, high, HEIGHT - WALL, HEIGHT, HEIGHT + RIM, 0.5 * HEIGHT]
    z += [edge for rail in RAILS.values() for edge in rail]

    def filled(x: NDArray, y: NDArray, z: NDArray) -> NDArray[np.bool_]:
        section = (y > 0.0) & (y < DEPTH) & (z > 0.0) & (z < HEIGHT)
        hollow = (y > WALL) & (y < DEPTH - WALL) & (z > WALL) & (z < HEIGHT - WALL)
        window = (y > left) & (y < right) & (z > low) & (z < high)
        rib = np.min(abs(x[:, None] - ribs), axis=1) < 0.5 * RIB
        on_rail = np.any([(z > start) & (z < end) for start, end in RAILS.values()], axis=0)
        rail = (y > -RAIL_HEIGHT) & (y < 0.0) & on_rail
        flange = (x < FLANGE) | (x > length - FLANGE)
        return flange | rail | (section & ~hollow) | (section & rib & ~window)

    return boxes((x, y, z), filled, longest)


def solid_matrices(
    mesh: MeshHex, material: Material
) -> tuple[NDArray[np.float64], scipy.sparse.csr_array, scipy.sparse.csr_array]:
    """Consistent mass and stiffness of linear elasticity with 20-node hexahedra.

    The stiffness is put together from integrals of products of two derivatives of the scalar shape
    functions, which is quicker than a form over all pairs of displacements.

    Parameters
    ----------
    mesh : MeshHex
        Boxes: three Gauss points an axis integrate them exactly.
    material : Material

    Returns
    -------
    coordinates : (m, 3) array of float
        Nodes in order of x, m.
    mass, stiffness : (3 m, 3 m) sparse array of float
        x, y, z of each node in turn; kg, N/m.
    """
    basis = Basis(mesh, ElementHexS2(), intorder=5)
    order = np.lexsort(np.round(basis.doflocs, 9)[::-1])
    shear = material.modulus / (2.0 * (1.0 + material.poisson))
    lame = 2.0 * shear * material.poisson / (1.0 - 2.0 * material.poisson)

    def integral(form: Callable) -> scipy.sparse.csr_array:
        return scipy.sparse.csr_array(BilinearForm(form).assemble(basis))[order][:, order]

    slopes = {  # of the column's shape function along a, of the row's along b
        (a, b): integral(lambda u, v, _, a=a, b=b: u.grad[a] * v.grad[b])
        for a in range(3)
        for b in range(a, 3)
    }
    slopes |= {(b, a): slopes[a, b].T for a, b in ((0, 1), (0, 2), (1, 2))}
    laplace = shear * (slopes[0, 0] + slopes[1, 1] + slopes[2, 2])
    blocks = [
        [lame * slopes[a, b] + shear * slopes[b, a] + (laplace if a == b else 0 * laplace)
         for a in range(3)]
        for b in range(3)
    ]  # fmt: skip
    weight = material.density * integral(lambda u, v, _: u * v)
    one_after_another = np.arange(3 * len(order)).reshape(3, -1).T.ravel()
    stiffness = scipy.sparse.block_array(blocks, format="csr")
    stiffness = stiffness[one_after_another][:, one_after_another]
    mass = scipy.sparse.csr_array(scipy.sparse.kron(weight, np.eye(3)))
    return basis.doflocs[:, order].T, mass, stiffness


def write_model(
    folder: Path,
    coordinates: NDArray[np.float64],
    mass: scipy.sparse.csr_array,
    stiffness: scipy.sparse.csr_array,
) -> None:
    """Write mass.npz, stiffness.npz and nodes.csv."""
    folder.mkdir(parents=True, exist_ok=True)
    scipy.sparse.save_npz(folder / "mass.npz", mass, compressed=False)
    scipy.sparse.save_npz(folder / "stiffness.npz", stiffness, compressed=False)
    with (folder / "nodes.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["node", "x", "y", "z"])
        table.writerows([place + 1, *node] for place, node in enumerate(coordinates.tolist()))


def ties(
    nodes: Nodes, stations: int = STATIONS
) -> tuple[list[RigidSurface], list[InterpolatedPoint]]:
    """Points of the crossbeam: two bolted ends, and carriages on both rails.

    The washers of the eight bolts of an end follow one rigid column; a carriage pushes on its
    part of the rail and does not stiffen it.
    """
    x, y, z = nodes.coordinates.T
    clamped = np.any([np.hypot(y - by, z - bz) < WASHER for by, bz in BOLTS], axis=0)
    centre = (0.5 * DEPTH, 0.5 * HEIGHT)
    rigid = [
        RigidSurface(name, (end, *centre), names_of(nodes, clamped & near(x, end)))
        for name, end in (("left", 0.0), ("right", crossbeam_length(stations)))
    ]
    interpolated = []
    for rail, (low, high) in RAILS.items():
        top = near(y, -RAIL_HEIGHT) & (z > low - 1e-6) & (z < high + 1e-6)
        for number, place in enumerate(carriage_places(stations), start=1):
            at = (place, -RAIL_HEIGHT, 0.5 * (low + high))
            chosen = names_of(nodes, top & (abs(x - place) < 0.5 * PATCH + 1e-6))
            interpolated.append(InterpolatedPoint(f"{rail} {number}", at, chosen))
    return rigid, interpolated


def near(values: NDArray[np.float64], value: float) -> NDArray[np.bool_]:
    """Tell which are the same but for rounding."""
    return abs(values - value) < 1e-6


def names_of(nodes: Nodes, chosen: NDArray[np.bool_]) -> list[int]:
    """Numbers of the nodes chosen."""
    return nodes.names[chosen].tolist()


def tied_crossbeam(folder: Path, stations: int = STATIONS) -> tuple[LinearStructure, dict]:
    """Read the files of a folder and tie its points; also return where these are."""
    size = scipy.sparse.load_npz(folder / "mass.npz").shape[0]
    nodes = read_nodes(folder / "nodes.csv", size)
    rigid, interpolated = ties(nodes, stations)
    structure = imported_structure(
        folder / "mass.npz",
        folder / "stiffness.npz",
        nodes=nodes,
        rigid=rigid,
        interpolated=interpolated,
    )
    return structure, {tie.name: np.asarray(tie.at) for tie in (*rigid, *interpolated)}


def write_super_element(
    folder: Path, reduced: LinearStructure, places: dict[str, ArrayLike]
) -> list[Path]:
    """Write a super-element in the same formats as the full model.

    Its points are nodes with six freedoms, which are its first coordinates; the rest are modal
    coordinates, which no node has.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written = [folder / name for name in ("mass.npz", "stiffness.npz", "nodes.csv")]
    np.savez_compressed(written[0], matrix=reduced.mass)
    np.savez_compressed(written[1], matrix=reduced.stiffness)
    with written[2].open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["node", "x", "y", "z", "ux", "uy", "uz", "rx", "ry", "rz", "point"])
        for number, (name, at) in enumerate(places.items()):
            row = [f"{value:.9g}" for value in at]
            table.writerow([number + 1, *row, *(6 * number + np.arange(1, 7)), name])
    return written


def main(full: Path, reduced: Path) -> list[Path]:
    """Mesh, write the full model, read it, reduce it, write the super-element; print each."""
    clock = time.perf_counter()

    def told(what: str) -> None:
        print(f"{time.perf_counter() - clock:6.1f} s  {what}", flush=True)

    mesh = crossbeam_mesh()
    coordinates, mass, stiffness = solid_matrices(mesh, STEEL)
    told(f"{mesh.nelements} hexahedra, {mass.shape[0]} freedoms, mass {mass.sum() / 3.0:.1f} kg")
    write_model(full, coordinates, mass, stiffness)
    told(f"written to {full}")
    structure, places = tied_crossbeam(full)
    told(f"read back, {len(places)} points tied, {structure.size} freedoms")
    element = super_element(structure, list(places), HIGHEST)
    told(f"reduced to {element.size} coordinates")
    free = [undamped_modes(one, count=12).frequency[6:] for one in (structure, element)]
    told("natural frequencies of the free crossbeam, full and reduced:")
    for whole, part in zip(*free, strict=True):
        print(f"          {whole:8.2f} Hz  {part:8.2f} Hz  {part / whole - 1.0:+.1e}")
    return write_super_element(reduced, element, places)


if __name__ == "__main__":
    chosen = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out")
    main(chosen / "solid", HERE / "super-element")
