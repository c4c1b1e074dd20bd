"""Modal truncation of a linear structure, what it leaves out, and its state space.

Undamped modes up to a frequency or a number stand for the whole (Gasch, Knothe and Liebich 2012;
equations 3 to 15 in the notation of drive simulation). The static compliance of the modes left
out is kept between the points asked for; of a free structure it is the inertia-relief one
(Craig and Kurdila, Fundamentals of Structural Dynamics, 2006, section 17.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.receptance.coupling import PointPort, residual_compliance
from dynamics.structure.linear_structure import LinearStructure, StructureError, dense

# Square of a frequency below which strain energy is rounding, over what its sum is made of.
ROUNDING = 1e3 * np.finfo(np.float64).eps


#: part of a static shape's inertia below which the modes hold it already
_NOTHING_NEW = 1e-8
#: share of the highest frequency below which a motion is that of a rigid body, but for rounding
_STILL = 1e-10


class Modes(NamedTuple):
    """Undamped modes; rigid-body modes have frequency 0 and come first."""

    frequency: NDArray[np.float64]  # Hz, (m,), ascending
    shapes: NDArray[np.float64]  # mass-normalised, 1/sqrt(kg) and kin, (n, m)


class StateSpace(NamedTuple):
    """z' = A z + B u, y = C z + D u; z is coordinates and their rates."""

    a: NDArray[np.float64]  # (2n, 2n), eq. 11
    b: NDArray[np.float64]  # (2n, inputs), eq. 12
    c: NDArray[np.float64]  # (3 outputs, 2n), eq. 14: displacements, velocities, accelerations
    d: NDArray[np.float64]  # (3 outputs, inputs), eq. 15


def undamped_modes(
    structure: LinearStructure,
    highest: float = np.inf,
    count: int | None = None,
    near: Modes | None = None,
) -> Modes:
    """Lowest undamped modes of (M, K), eq. 3.

    Parameters
    ----------
    structure : LinearStructure
        Dense matrices are solved whole; sparse ones by shift and invert (Lanczos), and the number
        of modes is checked against the signs of the pivots (Sylvester).
    highest : float
        Hz; all modes up to it.
    count : int, optional
        At most so many.
    near : Modes, optional
        All modes of a dense structure of the same mass, in whose coordinates those of this one are
        found sooner.

    Raises
    ------
    StructureError
        If neither is given for a sparse structure, the number is below that of rigid-body modes,
        the matrices are not those of a structure, or modes were missed.
    """
    if not highest > 0.0 or (count is not None and count < 1):
        raise StructureError(f"modes: highest is {highest} Hz and count {count}; above 0 both")
    sparse = scipy.sparse.issparse(structure.stiffness) or scipy.sparse.issparse(structure.mass)
    if sparse:
        shapes = _sparse_shapes(structure, highest, count)
    elif near is not None and near.shapes.shape[1] == structure.size:
        over = near.shapes.T @ (structure.stiffness @ near.shapes)
        shapes = near.shapes @ np.linalg.eigh(0.5 * (over + over.T))[1]
    else:
        shapes = _dense_shapes(structure.mass, structure.stiffness)
    inertia = np.einsum("nm,nm->m", shapes, structure.mass @ shapes)
    shapes = shapes / np.sqrt(inertia)
    energy = np.einsum("nm,nm->m", shapes, structure.stiffness @ shapes)
    _without_rounding(energy, shapes, abs(structure.stiffness))
    energy[abs(energy) <= _STILL**2 * np.max(energy, initial=0.0)] = 0.0
    if np.any(energy < 0.0):
        raise StructureError("modes: the stiffness is not positive: a motion gives energy back")
    order = np.argsort(energy, kind="stable")
    if count is not None and np.sum(energy == 0.0) > count:
        raise StructureError(f"modes: {count} asked for, but there are more rigid-body modes")
    frequency = np.sqrt(energy[order]) / (2.0 * np.pi)
    kept = int(np.searchsorted(frequency, highest, side="right"))
    kept = kept if count is None else min(kept, count)
    return Modes(frequency[:kept], shapes[:, order[:kept]])


def _without_rounding(
    energy: NDArray[np.float64], shapes: NDArray[np.float64], entries: Any
) -> None:
    """Set energies of shapes to 0 that are what rounding leaves of sums.

    The entries are those of the stiffness without their signs.
    """
    # twice |a b| is at most a^2 + b^2: the terms of a sum are bounded by those of its rows
    bound = np.asarray(entries.sum(axis=1)).ravel() @ shapes**2
    small = np.flatnonzero(energy <= 1e3 * ROUNDING * bound)
    moved = abs(shapes[:, small])
    terms = np.einsum("nm,nm->m", moved, entries @ moved)
    # a motion that gives a little energy back shows how far rounding reaches
    back = np.divide(energy[small], terms, out=np.zeros_like(terms), where=terms > 0.0)
    reach = max(ROUNDING, -10.0 * float(np.min(back, initial=0.0)))
    energy[small[abs(energy[small]) <= min(reach, 1e3 * ROUNDING) * terms]] = 0.0


def _dense_shapes(mass: NDArray[np.float64], stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
    try:
        return scipy.linalg.eigh(stiffness, mass)[1]
    except scipy.linalg.LinAlgError:
        pass
    # freedoms without mass: modes of the inverse, those at infinity left out
    shift = ROUNDING * np.trace(stiffness) / np.trace(mass)
    try:
        inverse, shapes = scipy.linalg.eigh(mass, stiffness + shift * mass)
    except scipy.linalg.LinAlgError as error:
        raise StructureError("modes: freedoms with neither mass nor stiffness") from error
    if inverse[0] < -ROUNDING * inverse[-1]:
        raise StructureError("modes: the mass matrix is not positive")
    return shapes[:, inverse > ROUNDING * inverse[-1]][:, ::-1]


def _sparse_shapes(
    structure: LinearStructure, highest: float, count: int | None
) -> NDArray[np.float64]:
    import scipy.sparse.linalg

    mass, stiffness = (
        scipy.sparse.csc_array(part) for part in (structure.mass, structure.stiffness)
    )
    size = structure.size
    if count is None and not np.isfinite(highest):
        raise StructureError("modes: say up to which frequency or how many")
    limit = (2.0 * np.pi * highest) ** 2
    below = _modes_below(mass, stiffness, limit) if np.isfinite(highest) else size
    # rigid-body modes are looked for beyond the number, to tell that one is left out
    wanted = min(below if count is None else min(below, count + 7), size)
    if wanted > size // 2:
        return _dense_shapes(mass.toarray(), stiffness.toarray())
    if wanted == 0:
        return np.zeros((size, 0))
    scale = stiffness.diagonal().max() / mass.diagonal().max()
    shift = -max((2.0 * np.pi) ** 2, 1e-11 * scale)
    shifted = symmetric_factors(stiffness - shift * mass)
    squared, shapes = scipy.sparse.linalg.eigsh(
        stiffness,
        wanted,
        mass,
        sigma=shift,
        v0=np.linspace(1.0, 2.0, size),
        OPinv=scipy.sparse.linalg.LinearOperator((size, size), shifted.solve, dtype=np.float64),
    )
    if count is not None:
        # just below the last one, so that a pair of equal frequencies is not cut in two
        limit = (1.0 - 1e-6) * squared.max()
        below = _modes_below(mass, stiffness, limit)
    if below > np.sum(squared < limit):
        raise StructureError(f"modes: only some of those up to {highest:g} Hz were found")
    return shapes


def symmetric_factors(matrix: scipy.sparse.csc_array) -> Any:
    """Factors (SuperLU) of a symmetric matrix in the order of least degree, pivots on the diagonal.

    RuntimeError if it is singular.
    """
    import scipy.sparse.linalg

    return scipy.sparse.linalg.splu(
        scipy.sparse.csc_array(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def _modes_below(
    mass: scipy.sparse.csc_array, stiffness: scipy.sparse.csc_array, limit: float
) -> int:
    """Number of modes with omega^2 below a limit: negative pivots of K - limit M (Sylvester)."""
    factors = symmetric_factors(stiffness - limit * mass)
    if not np.array_equal(factors.perm_r, factors.perm_c):
        raise StructureError("modes: pivots off the diagonal; take another highest frequency")
    return int(np.sum(factors.U.diagonal() < 0.0))


def damping_ratios(structure: LinearStructure, modes: Modes) -> NDArray[np.float64]:
    """Damping ratios (m,) of modes from the damping matrix, v' C v / (2 omega).

    Exact for proportional damping; otherwise the light-damping estimate (Rayleigh). Rigid-body
    modes have none: 0.
    """
    omega = 2.0 * np.pi * modes.frequency
    over = np.einsum("nm,nm->m", modes.shapes, structure.damping @ modes.shapes)
    return np.divide(over, 2.0 * omega, out=np.zeros_like(over), where=omega > 0.0)


def truncated(
    structure: LinearStructure,
    modes: Modes,
    damping: ArrayLike | None = None,
    residual_at: Sequence[str] = (),
) -> LinearStructure:
    """Structure in modal coordinates of the modes kept (eqs. 5 to 8 of the machine's model).

    Parameters
    ----------
    structure : LinearStructure
    modes : Modes
        From `undamped_modes`; all rigid-body modes must be among them.
    damping : float or (m,) array of float, optional
        Damping ratios, 1. By default the damping matrix is projected on the modes, with the
        coupling it makes between them; `damping_ratios` has the diagonal alone.
    residual_at : sequence of str
        Points between which the static compliance of the modes left out is kept.

    Returns
    -------
    LinearStructure
        Unit masses, stiffness omega^2; points as (6, m) modal matrices.

    Raises
    ------
    StructureError
        If damping ratios are negative, not finite or of another number, or a point is unknown.
    """
    omega = 2.0 * np.pi * modes.frequency
    if damping is None:
        over = modes.shapes.T @ (structure.damping @ modes.shapes)
    else:
        over = np.diag(2.0 * _ratios(damping, omega.size) * omega)
    points = {name: rows @ modes.shapes for name, rows in structure.points.items()}
    residual = {pair: np.array(left) for pair, left in structure.residual.items()}
    for pair, left in _left_out(structure, modes, residual_at).items():
        residual[pair] = residual.get(pair, 0.0) + left
    return LinearStructure(
        np.eye(omega.size), 0.5 * (over + over.T), np.diag(omega**2), points, residual
    )


def with_static_shapes(
    structure: LinearStructure,
    modes: Modes,
    rows: NDArray[np.float64],
    all_modes: Modes | None = None,
) -> tuple[LinearStructure, NDArray[np.float64]]:
    """Structure in coordinates of modes and of the static shapes that complete them.

    Modal truncation vectors (Dickens, Nakagawa and Wittbrodt 1997, Computers & Structures 62):
    the static answer to loads along the rows is that of the full structure, in time as in
    frequency, and the frequencies of the modes stay as they are.

    Modes are from `undamped_modes`, with all rigid-body modes among them; rows (p, n) are the
    loads, as ports of the structure. Where all modes of the structure are known, as many as it has
    freedoms, the static answer is their sum. The dense structure, without residuals, and its basis
    (n, m + static), motion per coordinate: rows of ports times it are the new ports.
    """
    loads = np.asarray(rows, dtype=np.float64).T
    if all_modes is not None and len(all_modes.frequency) == structure.size:
        elastic = all_modes.frequency > 0.0
        shapes = all_modes.shapes[:, elastic]
        squared = (2.0 * np.pi * all_modes.frequency[elastic]) ** 2
        static = shapes @ ((shapes.T @ loads) / squared[:, None])
    else:
        static = _elastic_answer(structure, modes.shapes[:, modes.frequency == 0.0], loads)
    whole = np.sqrt(np.einsum("np,np->p", static, structure.mass @ static))
    static = static[:, whole > 0.0] / whole[whole > 0.0]
    for _ in range(2):  # once more for the digits that cancelled
        static = static - modes.shapes @ (modes.shapes.T @ (structure.mass @ static))
    squared, turned = np.linalg.eigh(static.T @ (structure.mass @ static))
    new = squared > _NOTHING_NEW
    basis = np.hstack([modes.shapes, static @ (turned[:, new] / np.sqrt(squared[new]))])
    damping, stiffness = (
        basis.T @ (part @ basis) for part in (structure.damping, structure.stiffness)
    )
    points = {name: motion @ basis for name, motion in structure.points.items()}
    size = modes.frequency.size
    # what the modes make diagonal is so to the last digit
    mass = np.eye(basis.shape[1])
    stiffness[:size, :] = stiffness[:, :size] = 0.0
    stiffness[:size, :size] = np.diag((2.0 * np.pi * modes.frequency) ** 2)
    mass, damping, stiffness = (0.5 * (part + part.T) for part in (mass, damping, stiffness))
    return LinearStructure(mass, damping, stiffness, points), basis


def _ratios(damping: ArrayLike, count: int) -> NDArray[np.float64]:
    ratios = np.asarray(damping, dtype=np.float64)
    if ratios.shape not in ((), (count,)):
        raise StructureError(f"damping: {ratios.size} ratios for {count} modes")
    if not np.all(np.isfinite(ratios) & (ratios >= 0.0)):
        raise StructureError(f"damping: ratios must be 0 or more, not {damping!r}")
    return np.broadcast_to(ratios, (count,))


def _left_out(
    structure: LinearStructure, modes: Modes, names: Sequence[str]
) -> dict[tuple[str, str], NDArray[np.float64]]:
    """Static elastic compliance less that of the elastic modes kept."""
    if not names:
        return {}
    for name in names:
        structure.port(name, np.zeros(3))
    rows = np.vstack([structure.points[name] for name in names])
    elastic = modes.frequency > 0.0
    kept = rows @ modes.shapes[:, elastic] / (2.0 * np.pi * modes.frequency[elastic])
    rigid = modes.shapes[:, ~elastic]
    whole = rows @ _elastic_answer(structure, rigid, rows.T)
    left = 0.5 * (whole + whole.T) - kept @ kept.T
    return {
        (one, other): left[6 * i : 6 * i + 6, 6 * j : 6 * j + 6]
        for i, one in enumerate(names)
        for j, other in enumerate(names)
    }


def _elastic_answer(
    structure: LinearStructure, rigid: NDArray[np.float64], loads: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Strain (n, p) under loads balanced by inertia, free of rigid-body motion.

    The bordered system [K, M R; R' M, 0] holds the rigid-body part at zero without holding a
    freedom; its load is (I - M R R') f.
    """
    import scipy.sparse.linalg

    inertia = structure.mass @ rigid
    balanced = loads - inertia @ (rigid.T @ loads)
    stiffness = scipy.sparse.csc_array(structure.stiffness)
    if rigid.shape[1]:
        # a border of the size of the stiffness keeps the pivots of one magnitude
        border = scipy.sparse.csc_array(inertia * stiffness.diagonal().max() / abs(inertia).max())
        stiffness = scipy.sparse.block_array([[stiffness, border], [border.T, None]], format="csc")
    right = np.vstack([balanced, np.zeros((rigid.shape[1], loads.shape[1]))])
    try:
        answer = scipy.sparse.linalg.splu(stiffness).solve(right)
    except RuntimeError as error:
        raise StructureError(
            "residual compliance: the stiffness is singular beyond the rigid-body modes kept; "
            "keep all rigid-body modes"
        ) from error
    return answer[: structure.size]


def state_space(
    structure: LinearStructure, inputs: Sequence[PointPort], outputs: Sequence[PointPort]
) -> StateSpace:
    """State-space matrices between ports (eqs. 9 to 15).

    Parameters
    ----------
    structure : LinearStructure
        Usually in modal coordinates: there A is made of Gamma_1 = -diag(omega^2) and
        Gamma_2 = -diag(2 zeta omega) (eq. 11), B of Gamma_3 = V' F_u (eq. 12), C of
        Gamma_4 = U_u V (eq. 14). Others are brought to unit mass.
    inputs, outputs : sequence of PointPort
        Forces (N, N m) and motions read.

    Returns
    -------
    StateSpace
        z of eq. 9; outputs ordered displacements (m, rad), velocities, accelerations (eq. 13).
        D is eq. 15, and holds the residual compliance in the rows of the displacements. The
        velocities and accelerations of a residual would need rates of the force and are left out.

    Raises
    ------
    StructureError
        If the mass is singular or a point is unknown.
    """
    mass, damping, stiffness = (
        dense(part) for part in (structure.mass, structure.damping, structure.stiffness)
    )
    force = np.array([port.row(structure) for port in inputs]).reshape(-1, structure.size).T
    seen = np.array([port.row(structure) for port in outputs]).reshape(-1, structure.size)
    try:
        per_mass = np.linalg.solve(mass, np.hstack([stiffness, damping, force]))
    except np.linalg.LinAlgError as error:
        raise StructureError("state space: the mass matrix is singular; reduce first") from error
    n = structure.size
    gamma_1, gamma_2, gamma_3 = -per_mass[:, :n], -per_mass[:, n : 2 * n], per_mass[:, 2 * n :]
    none = np.zeros((len(seen), n))
    return StateSpace(
        a=np.block([[np.zeros((n, n)), np.eye(n)], [gamma_1, gamma_2]]),
        b=np.vstack([np.zeros_like(gamma_3), gamma_3]),
        c=np.block([[seen, none], [none, seen], [seen @ gamma_1, seen @ gamma_2]]),
        d=np.vstack(
            [
                residual_compliance(structure, outputs, inputs),
                np.zeros((len(seen), len(inputs))),
                seen @ gamma_3,
            ]
        ),
    )
