"""Receptances of Timoshenko beams from their exact solution, and of lines held at the far end.

The state of a section is deflection w, slope psi, moment M and shear V (Timoshenko 1921):

    w' = psi + V / (kappa G A)      psi' = M / (E I)
    M' = -V - rho I omega^2 psi     V' = -rho A omega^2 w

so that a length L carries it over by exp(A L); no elements, at any frequency.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.beam.element import Segment
from dynamics.receptance.coupling import Component
from dynamics.structure.linear_structure import StructureError


def timoshenko_beam(frequency: ArrayLike, segment: Segment, loss_factor: float = 0.0) -> Component:
    """Bending of a free round Timoshenko beam in one plane, between its ends.

    Parameters
    ----------
    frequency : (m,) array of float
        Hz, above 0.
    segment : Segment
        Its number of elements does not matter.
    loss_factor : float
        Structural damping: E and G times 1 + i loss_factor.

    Returns
    -------
    Component
        (m, 2, 2) blocks of deflection (m) and slope (rad) by force (N) and moment (N m), in the
        convention of `free_beam`.

    Raises
    ------
    StructureError
        If a frequency is not above 0 or the loss factor is negative.
    """
    omega = 2.0 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if not np.all(np.isfinite(omega) & (omega > 0.0)):
        raise StructureError("beam: frequencies must be above 0 Hz")
    if not (np.isfinite(loss_factor) and loss_factor >= 0.0):
        raise StructureError(f"beam: loss_factor is {loss_factor}; 0 or more")
    outer, inner = segment.outer_diameter, segment.inner_diameter
    area, inertia = segment.area, np.pi * (outer**4 - inner**4) / 64.0
    elastic = 1.0 + 1j * loss_factor
    bending = segment.material.young * inertia * elastic
    shear = segment.kappa * segment.material.shear_modulus * area * elastic
    length = segment.length
    # scaled to the size of 1: w / L, psi, M L / EI, V L^2 / EI
    unit = segment.material.young * inertia
    state = np.zeros((omega.size, 4, 4), dtype=np.complex128)
    state[:, 0, 1] = state[:, 1, 2] = 1.0
    state[:, 1, 2] = unit / bending
    state[:, 0, 3] = unit / (shear * length**2)
    state[:, 2, 3] = -1.0
    state[:, 2, 1] = -segment.material.density * inertia * omega**2 * length**2 / unit
    state[:, 3, 0] = -segment.material.density * area * omega**2 * length**4 / unit
    carried = scipy.linalg.expm(state)
    a, b = carried[:, :2, :2], carried[:, :2, 2:]
    c, d = carried[:, 2:, :2], carried[:, 2:, 2:]
    # loads (V, M) in the order of (w, psi): at the near end their opposite is what acts there
    swap = np.array([[0.0, 1.0], [1.0, 0.0]])
    b, c, d = b @ swap, swap @ c, swap @ d @ swap
    inverse = np.linalg.inv(c)
    blocks = inverse @ d, inverse, a @ inverse @ d - b, a @ inverse
    motion = np.array([length, 1.0])
    load = np.array([length**2, length]) / unit
    return Component(*(motion[:, None] * block * load for block in blocks))


def near_end_on(near: Component, stiffness: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Receptance (m, p, p) of the near end where the far end carries a dynamic stiffness.

    Stiffness (m, q, q), N/m and kin, 0 for a free far end: H11 - H12 Z (1 + H22 Z)^-1 H21.
    """
    inner = stiffness @ np.linalg.inv(np.eye(stiffness.shape[-1]) + near.far @ stiffness)
    return near.near - near.near_far @ inner @ near.far_near


def line_receptance(
    frequency: ArrayLike,
    segments: Sequence[Segment],
    stiffness: NDArray[np.complex128],
    loss_factor: float = 0.0,
) -> NDArray[np.complex128]:
    """Receptance (m, 2, 2) at the first end of a stepped line.

    Parameters
    ----------
    frequency : (m,) array of float
        Hz.
    segments : sequence of Segment
        From the end whose receptance is wanted to the end that is held.
    stiffness : (m, 2, 2) array of complex
        Dynamic stiffness that holds the last end; 0 for a free one.
    loss_factor : float
        Structural damping of the line.

    Raises
    ------
    StructureError
        As `timoshenko_beam`.
    """
    found = None
    for segment in reversed(segments):
        if found is not None:
            stiffness = np.linalg.inv(found)
        found = near_end_on(timoshenko_beam(frequency, segment, loss_factor), stiffness)
    if found is None:
        raise StructureError("a line needs at least one segment")
    return found


def rotations_from_translations(
    direct: NDArray[np.complex128],
    cross: NDArray[np.complex128],
    distance: float,
    behind: NDArray[np.complex128] | None = None,
) -> NDArray[np.complex128]:
    """Receptance (m, 2, 2) of deflection and slope from two or three translational FRFs.

    First-order differences over a distance: the slope by a force is (cross - direct) / distance,
    and so, by reciprocity, the deflection by a moment. The slope by a moment is
    (direct - 2 cross + behind) / distance^2 where the point behind was measured as well, else
    l n / h, which holds where one mode rules (Schmitz and Duncan 2005).

    Direct receptance (m,) at the end; cross (m,), motion `distance` (m) behind the end for a force
    at it; behind (m,), direct receptance there.
    """
    slope = (cross - direct) / distance
    if behind is None:
        turn = slope**2 / direct
    else:
        turn = (direct - 2.0 * cross + behind) / distance**2
    return np.stack([direct, slope, slope, turn], axis=-1).reshape(-1, 2, 2)


def at_two_points(first: Component, second: Component) -> Component:
    """Two free components joined rigidly, seen by deflections alone at two points.

    The near end of the result has the deflection at the near end of the first and that at the
    joint, as a hammer and an accelerometer reach them; its far end is that of the second, with
    deflection and slope. `without_tool` then needs no measured slope.
    """
    inner = np.linalg.inv(first.far + second.near)
    to_joint = second.near @ inner @ first.far_near  # joint by the load at the near end
    at_joint = first.far @ inner @ second.near
    whole_near = first.near - first.near_far @ inner @ first.far_near
    near = np.empty((to_joint.shape[0], 2, 2), dtype=np.complex128)
    near[:, 0, 0], near[:, 1, 1] = whole_near[:, 0, 0], at_joint[:, 0, 0]
    near[:, 1, 0] = to_joint[:, 0, 0]
    near[:, 0, 1] = (first.near_far @ inner @ second.near)[:, 0, 0]
    far_by_end = (second.far_near @ inner @ first.far_near)[:, :, 0]
    far_by_joint = (second.far_near @ inner @ first.far)[:, :, 0]
    end_by_far = (first.near_far @ inner @ second.near_far)[:, 0, :]
    joint_by_far = (first.far @ inner @ second.near_far)[:, 0, :]
    return Component(
        near,
        np.stack([end_by_far, joint_by_far], axis=1),
        np.stack([far_by_end, far_by_joint], axis=2),
        second.far - second.far_near @ inner @ second.near_far,
    )
