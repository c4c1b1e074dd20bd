"""Structures given by their matrices: brought to SI, points tied to the nodes, masses checked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.structure.linear_structure import LinearStructure, Matrix, StructureError
from dynamics.structure.surface_constraint import (
    InterpolatedPoint,
    Nodes,
    RigidSurface,
    interpolation,
    rigid_transformation,
)

#: rows up to which a sparse mass matrix is checked as a dense one
MOST_DENSE_ROWS = 1000
#: of a mass matrix with a unit diagonal: rounding of a mode without mass
MASSLESS = 1e-12
#: of the mass stated: what a drawing leaves out, and what a wrong unit cannot hide in
MASS_TOLERANCE = 0.02


@dataclass(frozen=True)
class ModelUnits:
    """Units of a finite element model, in SI; force is mass times length over time squared."""

    length: float = 1.0  # m
    mass: float = 1.0  # kg
    time: float = 1.0  # s


def in_si(
    structure: LinearStructure, nodes: Nodes | None, units: ModelUnits
) -> tuple[LinearStructure, Nodes | None]:
    """Structure without points, and its nodes, from units of a model to SI.

    Displacements are lengths, rotations and coordinates that no node has are numbers: with their
    units d on the diagonal of D, energy E = m l^2 / t^2 and x = D^-1 x_SI, stiffness is
    E D^-1 K D^-1, damping t times and mass t^2 times as much. StructureError if a length other
    than m comes without nodes, which tell displacements from rotations.
    """
    if nodes is None:
        if units.length != 1.0:
            raise StructureError("units: a length needs nodes, which tell what is a displacement")
        per_unit = np.ones(structure.size)
    else:
        per_unit = np.ones(structure.size)
        rows = nodes.rows[:, :3]
        per_unit[rows[rows >= 0]] = 1.0 / units.length
        nodes = replace(nodes, coordinates=units.length * nodes.coordinates)
    energy = units.mass * units.length**2 / units.time**2
    mass, damping, stiffness = (
        _scaled(matrix, per_unit, energy * units.time**order)
        for matrix, order in ((structure.mass, 2), (structure.damping, 1), (structure.stiffness, 0))
    )
    return replace(structure, mass=mass, damping=damping, stiffness=stiffness), nodes


def refuse_other_mass(
    structure: LinearStructure, nodes: Nodes | None, stated: float, where: str
) -> None:
    """Refuse a structure whose mass in a rigid motion along x, y or z is not that stated, kg.

    The message of the StructureError begins with the file.
    """
    if nodes is None:
        raise StructureError(f"{where}: the total mass is stated, which needs nodes to be checked")
    for direction in range(3):
        motion = np.zeros(structure.size)
        rows = nodes.rows[:, direction]
        motion[rows[rows >= 0]] = 1.0
        found = float(motion @ (structure.mass @ motion))
        if abs(found - stated) > MASS_TOLERANCE * stated:
            raise StructureError(
                f"{where}: has {found:.4g} kg along {'xyz'[direction]}, {stated:.4g} kg are stated;"
                " see the units of the model, and freedoms that are held"
            )


def _scaled(matrix: Matrix, per_unit: NDArray[np.float64], factor: float) -> Matrix:
    if scipy.sparse.issparse(matrix):
        around = scipy.sparse.diags(per_unit)
        return scipy.sparse.csr_array(factor * (around @ matrix @ around))
    return factor * per_unit[:, None] * matrix * per_unit


def tied_structure(
    bare: LinearStructure,
    nodes: Nodes | None,
    rigid: Sequence[RigidSurface] = (),
    interpolated: Sequence[InterpolatedPoint] = (),
) -> LinearStructure:
    """Tie points to the surfaces of a structure given by its nodes' freedoms.

    Rigid surfaces take freedoms away: with x = T q the matrices become T' M T and so on.

    Its own points are kept. StructureError if a point cannot be tied, or two have one name.
    """
    tied = [*(surface.name for surface in rigid), *(point.name for point in interpolated)]
    names = [*bare.points, *tied]
    for name in names:
        if names.count(name) > 1:
            raise StructureError(f'point "{name}" is there twice; names must differ')
    if not (rigid or interpolated):
        return bare
    if nodes is None:
        raise StructureError(f'point "{names[-1]}" is tied to nodes, and no nodes are given')
    if nodes.rows.size and nodes.rows.max() >= bare.size:
        raise StructureError(
            f"nodes: row {nodes.rows.max() + 1} is named, the matrices have {bare.size}"
        )
    rows = {tie.name: interpolation(tie, nodes, bare.size) for tie in interpolated}
    transformation, first = rigid_transformation(rigid, nodes, bare.size)
    points = {name: row @ transformation for name, row in {**bare.points, **rows}.items()}
    for name, column in first.items():
        points[name] = np.eye(6, transformation.shape[1], k=column)
    mass, damping, stiffness = (
        symmetrised(transformation.T @ matrix @ transformation)
        for matrix in (bare.mass, bare.damping, bare.stiffness)
    )
    return LinearStructure(mass, damping, stiffness, points)


def _row(row: int) -> str:
    return f"row {row + 1}"


def refuse_indefinite(mass: Matrix, where: str, title: Callable[[int], str] = _row) -> None:
    """Refuse a mass matrix that is not positive definite.

    The matrix (n, n) is symmetric. The message of the StructureError begins with the file and names
    the row by its title.
    """
    diagonal = mass.diagonal()
    if np.any(diagonal <= 0.0):
        row = int(np.argmin(diagonal))
        raise StructureError(
            f"{where}: the diagonal at {title(row)} is {diagonal[row]:g}; every freedom needs mass "
            "(consistent mass matrices, or condense those without it before export)"
        )
    search = _sparse_eigenvalue if scipy.sparse.issparse(mass) else _dense_pivots
    found = search(mass, 1.0 / np.sqrt(diagonal))
    if found is not None:
        raise StructureError(
            f"{where}: the mass matrix is not positive definite, found at {title(found)}"
        )


def symmetrised(matrix: Matrix) -> Matrix:
    """Mean of a matrix and its transpose; a sparse one in rows."""
    half = 0.5 * (matrix + matrix.T)
    return scipy.sparse.csr_array(half) if scipy.sparse.issparse(half) else half


def _dense_pivots(mass: NDArray[np.float64], scale: NDArray[np.float64]) -> int | None:
    """Row where the elimination of the scaled matrix fails, if it does."""
    _, failed = scipy.linalg.lapack.dpotrf(scale[:, None] * mass * scale)
    return failed - 1 if failed else None


def _sparse_eigenvalue(mass: scipy.sparse.csr_array, scale: NDArray[np.float64]) -> int | None:
    """Row that has most of a mode without mass of the scaled matrix, if there is one.

    Scaled to a unit diagonal a consistent mass matrix has eigenvalues bounded by those of its
    elements, whatever the mesh (Wathen, IMA Journal of Numerical Analysis 7, 1987), so the
    smallest comes out in few products; a factorisation would cost as much as the stiffness's.
    """
    import scipy.sparse.linalg

    if len(scale) <= MOST_DENSE_ROWS:
        return _dense_pivots(mass.toarray(), scale)
    around = scipy.sparse.diags(scale)
    start = np.random.default_rng(0).standard_normal(len(scale))
    try:
        value, mode = scipy.sparse.linalg.eigsh(
            around @ mass @ around, k=1, which="SA", tol=1e-6, v0=start
        )
    except scipy.sparse.linalg.ArpackNoConvergence:
        # An eigenvalue this close to others is not one of a faulty export: take the matrix.
        return None
    return int(np.argmax(np.abs(mode))) if value[0] <= MASSLESS else None
