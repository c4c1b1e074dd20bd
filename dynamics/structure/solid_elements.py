"""Mass and stiffness of solid bodies from hexahedra of 20 nodes, by scikit-fem (an extra).

For parts that are drawn of boxes: beds, columns, crossbeams. Bodies of any shape come in by the
matrices of a finite element program.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

if TYPE_CHECKING:
    from skfem import MeshHex


class Material(NamedTuple):
    """Isotropic material."""

    modulus: float  # N/m^2
    poisson: float
    density: float  # kg/m^3


STEEL = Material(210e9, 0.3, 7850.0)
ALUMINIUM = Material(70e9, 0.33, 2700.0)


def grid(lines: Sequence[float], longest: float) -> NDArray[np.float64]:
    """Lines (m,) of a mesh along one axis, m, with equal parts between those given."""
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
    from skfem import MeshHex

    mesh = MeshHex.init_tensor(*(grid(along, longest) for along in lines))
    centres = mesh.p[:, mesh.t].mean(axis=1)
    return mesh.restrict(np.flatnonzero(filled(*centres)))


def solid_matrices(
    mesh: MeshHex, material: Material, *others: tuple[Material, Callable[..., NDArray[np.bool_]]]
) -> tuple[NDArray[np.float64], scipy.sparse.csr_array, scipy.sparse.csr_array]:
    """Consistent mass and stiffness of linear elasticity with 20-node hexahedra.

    The stiffness is put together from integrals of products of two derivatives of the scalar shape
    functions, which is quicker than a form over all pairs of displacements.

    Parameters
    ----------
    mesh : MeshHex
        Boxes: three Gauss points an axis integrate them exactly.
    material : Material
    *others : (Material, callable)
        Of elements where the callable of the centres x, y, z is true.

    Returns
    -------
    coordinates : (m, 3) array of float
        Nodes in order of x, m.
    mass, stiffness : (3 m, 3 m) sparse array of float
        x, y, z of each node in turn; kg, N/m.
    """
    from skfem import Basis, ElementHexS2

    centres = mesh.p[:, mesh.t].mean(axis=1)
    rest = np.ones(mesh.nelements, dtype=bool)
    whole = Basis(mesh, ElementHexS2(), intorder=5)
    order = np.lexsort(np.round(whole.doflocs, 9)[::-1])
    regions = []
    for other, within in others:
        inside = rest & within(*centres)
        rest &= ~inside
        regions.append((other, inside))
    pairs = [
        _of_one_material(
            Basis(mesh, ElementHexS2(), intorder=5, elements=np.flatnonzero(inside)), one, order
        )
        for one, inside in [(material, rest), *regions]
        if np.any(inside)
    ]
    mass, stiffness = (sum(several[1:], several[0]) for several in zip(*pairs, strict=True))
    one_after_another = np.arange(3 * len(order)).reshape(3, -1).T.ravel()
    stiffness = scipy.sparse.csr_array(stiffness)[one_after_another][:, one_after_another]
    return whole.doflocs[:, order].T, scipy.sparse.csr_array(mass), stiffness


def _of_one_material(
    basis: Any, material: Material, order: NDArray[np.int64]
) -> tuple[scipy.sparse.csr_array, scipy.sparse.csr_array]:
    """Mass with x, y, z of each node in turn, stiffness with all x first, then y, then z."""
    from skfem import BilinearForm

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
    return (
        scipy.sparse.csr_array(scipy.sparse.kron(weight, np.eye(3))),
        scipy.sparse.block_array(blocks, format="csr"),
    )
