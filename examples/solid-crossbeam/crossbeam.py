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
from pathlib import Path

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from skfem import MeshHex

from chatter.io.matrices import imported_structure, read_nodes
from chatter.io.super_element import write_super_element
from dynamics.reduction.craig_bampton import super_element
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import LinearStructure
from dynamics.structure.solid_elements import STEEL, boxes, solid_matrices
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
