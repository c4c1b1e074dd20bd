"""Receptances of components, coupled and taken apart again (receptance coupling, RCSA).

Everything is a block over frequencies: p directions at a joint, displacements and rotations,
forces and moments. Bishop and Johnson, The Mechanics of Vibration, 1960; Schmitz and Duncan,
Journal of Manufacturing Science and Engineering 127, 2005; Ferreira and Ewins 1996 for the joint.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.beam.element import Segment
from dynamics.frf.container import MeasurementError
from dynamics.structure.bodies import finite
from dynamics.structure.linear_structure import LinearStructure, StructureError

# Largest condition of a block that may be inverted to take a component off.
WORST_CONDITION = 1e10


@dataclass(frozen=True, eq=False)
class PointPort:
    """Direction at a point, or between two points, along which a force acts or motion is read.

    Parameters
    ----------
    point : str
    direction : (3,) or (6,) array of float
        Displacements, or displacements and rotations.
    against : str, optional
        Point that takes the reaction and whose motion is subtracted.

    Raises
    ------
    StructureError
        If the direction is not 3 or 6 finite numbers.
    """

    point: str
    direction: ArrayLike
    against: str | None = None

    def __post_init__(self) -> None:
        size = 6 if np.size(self.direction) == 6 else 3
        along = finite(f'port at "{self.point}"', "direction", self.direction, (size,))
        object.__setattr__(self, "direction", along)

    def row(self, structure: LinearStructure) -> NDArray[np.float64]:
        """(n,): motion along the port per freedom of a structure."""
        return structure.port(self.point, self.direction, self.against)

    def ends(self) -> list[tuple[str, NDArray[np.float64]]]:
        """Points and directions (6,) that add up to the port."""
        along = np.concatenate([self.direction, np.zeros(6 - np.size(self.direction))])
        return [(self.point, along)] + ([(self.against, -along)] if self.against else [])


@dataclass(frozen=True, eq=False)
class Component:
    """Receptances of a component with a near and a far end, m/N and kin.

    Raises
    ------
    StructureError
        If the shapes do not fit together.
    """

    near: NDArray[np.complex128]  # (m, p, p), motion of the near end by loads there
    near_far: NDArray[np.complex128]  # (m, p, q), motion of the near end by loads at the far end
    far_near: NDArray[np.complex128]  # (m, q, p)
    far: NDArray[np.complex128]  # (m, q, q)

    def __post_init__(self) -> None:
        lines, p, q = self.near_far.shape
        shapes = [self.near.shape, self.far_near.shape, self.far.shape]
        if shapes != [(lines, p, p), (lines, q, p), (lines, q, q)]:
            raise StructureError(
                f"component: blocks of {shapes} do not fit near_far of {self.near_far.shape}"
            )

    def turned(self) -> Component:
        """Same component with its ends exchanged."""
        return Component(self.far, self.far_near, self.near_far, self.near)


def residual_compliance(
    structure: LinearStructure, outputs: Sequence[PointPort], inputs: Sequence[PointPort]
) -> NDArray[np.float64]:
    """Compliance (outputs, inputs) that a reduction left out between ports, m/N and kin."""
    found = np.zeros((len(outputs), len(inputs)))
    for i, output in enumerate(outputs):
        for j, port in enumerate(inputs):
            for one, seen in output.ends():
                for other, along in port.ends():
                    if (one, other) in structure.residual:
                        found[i, j] += seen @ structure.residual[one, other] @ along
    return found


def receptance_with_residual(
    structure: LinearStructure, frequency: ArrayLike, ports: Sequence[PointPort]
) -> NDArray[np.complex128]:
    """Receptance (m, p, p) between ports at frequencies (m,) in Hz, residuals included."""
    rows = np.array([port.row(structure) for port in ports])
    return structure.receptance(frequency, rows) + residual_compliance(structure, ports, ports)


def component(
    structure: LinearStructure,
    frequency: ArrayLike,
    near: Sequence[PointPort],
    far: Sequence[PointPort],
) -> Component:
    """Receptances of a structure between the ports of its near and far end, (m,) Hz."""
    whole = receptance_with_residual(structure, frequency, [*near, *far])
    p = len(near)
    return Component(whole[:, :p, :p], whole[:, :p, p:], whole[:, p:, :p], whole[:, p:, p:])


def joint_stiffness(
    frequency: ArrayLike, stiffness: ArrayLike, damping: ArrayLike = 0.0
) -> NDArray[np.complex128]:
    """Dynamic stiffness (m, p, p) k + i omega c of an elastic joint.

    Parameters
    ----------
    frequency : (m,) array of float
        Hz.
    stiffness, damping : (p, p) array of float, or (p,) for the diagonal
        N/m, N s/m and kin. Damping 0 for none. A direction of zero stiffness is not joined.

    Raises
    ------
    StructureError
        If they are not symmetric, negative or of different size.
    """
    elastic = joint_matrix("joint", "stiffness", stiffness)
    viscous = joint_matrix("joint", "damping", damping) if np.ndim(damping) else 0.0 * elastic
    if elastic.shape != viscous.shape:
        raise StructureError(f"joint: stiffness is {elastic.shape}, damping {viscous.shape}")
    omega = 2.0 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    return elastic + 1j * omega[:, None, None] * viscous


def joint_matrix(where: str, what: str, values: ArrayLike) -> NDArray[np.float64]:
    """Matrix (p, p) of a joint from itself or its diagonal (p,); symmetric and not negative.

    Raises
    ------
    StructureError
        If it is not; the message begins with `where` and `what`.
    """
    array = np.asarray(values, dtype=np.float64)
    matrix = np.diag(array) if array.ndim == 1 else array
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not np.all(np.isfinite(matrix)):
        raise StructureError(f"{where}: {what} must be p or p x p finite numbers")
    bound = 1e-9 * np.max(np.abs(matrix), initial=0.0)
    if np.any(abs(matrix - matrix.T) > bound) or np.any(np.linalg.eigvalsh(matrix) < -bound):
        raise StructureError(f"{where}: {what} must be symmetric and not negative")
    return matrix


def coupled_at(
    other: NDArray[np.complex128],
    own: NDArray[np.complex128],
    joint: NDArray[np.complex128] | None = None,
) -> NDArray[np.complex128]:
    """Receptance (m, p, p) of an assembly at the joint, on the side of `own`.

    G = F2 - F2 (F1 + F2 + 1/k)^-1 F2.

    Parameters
    ----------
    other, own : (m, p, p) array of complex
        F1 and F2, receptances of the two components at the joint, m/N and kin.
    joint : (m, p, p) array of complex, optional
        Dynamic stiffness k from `joint_stiffness`; rigid by default.
    """
    return own - own @ _joining(other + own, joint) @ own


def coupled(
    first: Component, second: Component, joint: NDArray[np.complex128] | None = None
) -> Component:
    """Join the far end of one component to the near end of another.

    Parameters
    ----------
    first, second : Component
        In common directions at the joint.
    joint : (m, p, p) array of complex, optional
        Dynamic stiffness from `joint_stiffness`; rigid by default.

    Returns
    -------
    Component
        Near end of the first, far end of the second.

    Raises
    ------
    StructureError
        If the directions at the joint differ in number or the joint is singular.
    """
    inner = _joining(first.far + second.near, joint)
    into_first, into_second = inner @ first.far_near, inner @ second.near_far
    return Component(
        first.near - first.near_far @ into_first,
        first.near_far @ into_second,
        second.far_near @ into_first,
        second.far - second.far_near @ into_second,
    )


def _joining(
    compliance: NDArray[np.complex128], joint: NDArray[np.complex128] | None
) -> NDArray[np.complex128]:
    """Inverse of compliance + 1/k as k (1 + compliance k)^-1, which a zero stiffness allows."""
    try:
        if joint is None:
            return np.linalg.inv(compliance)
        return joint @ np.linalg.inv(np.eye(compliance.shape[-1]) + compliance @ joint)
    except (np.linalg.LinAlgError, ValueError) as error:
        raise StructureError(f"joint: the components cannot be joined: {error}") from error


def without_tool(
    assembly: NDArray[np.complex128], tool: Component, joint: NDArray[np.complex128] | None = None
) -> NDArray[np.complex128]:
    """Receptance of holder and spindle from a measured assembly and a known tool.

    From G = H11 - H12 (H22 + R + 1/k)^-1 H21: R = H21 (H11 - G)^-1 H12 - H22 - 1/k (inverse
    coupling; Schmitz and Duncan 2005; Park, Altintas and Movahhedy 2003).

    Parameters
    ----------
    assembly : (m, p, p) array of complex
        At the near end (tip) of the tool, rotations included as far as the joint has them.
    tool : Component
        Free tool, near end the tip, far end at the joint; as many directions at both.
    joint : (m, p, p) array of complex, optional
        Dynamic stiffness of the joint, not singular; rigid by default.

    Raises
    ------
    MeasurementError
        If the assembly is of another size, not finite, or differs too little from the free tool
        to tell what it is held by.
    StructureError
        If the joint has no stiffness in a direction.
    """
    if assembly.shape != tool.near.shape or tool.near_far.shape != tool.near.shape:
        raise MeasurementError(
            f"assembly of {assembly.shape} and tool of {tool.near_far.shape}: taking the tool off "
            "needs as many directions at the tip as at the joint"
        )
    if not np.all(np.isfinite(assembly)):
        raise MeasurementError("assembly: receptances are not all finite numbers")
    shift = tool.near - assembly
    # rows and columns scaled, so that metres and radians do not look like a bad condition
    scale = np.sqrt(np.abs(np.einsum("mii->mi", tool.near)))
    scaled = shift / (scale[:, :, None] * scale[:, None, :])
    condition = np.linalg.cond(scaled)
    strength = np.linalg.norm(scaled, axis=(1, 2))
    if np.any(condition > WORST_CONDITION) or np.any(strength < 1.0 / WORST_CONDITION):
        worst = int(np.argmax(condition))
        raise MeasurementError(
            f"assembly: on frequency line {worst + 1} it does not tell what holds the tool "
            f"(condition {condition[worst]:.1e}); measure rotations too or leave the line out"
        )
    held = tool.far_near @ np.linalg.solve(shift, tool.near_far) - tool.far
    if joint is None:
        return held
    if np.any(np.linalg.matrix_rank(joint) < joint.shape[-1]):
        raise StructureError("joint: a direction without stiffness tells nothing of the holder")
    return held - np.linalg.inv(joint)


def free_beam(frequency: ArrayLike, segment: Segment, loss_factor: float = 0.0) -> Component:
    """Bending of a free Euler-Bernoulli beam in one plane, between its ends.

    Bishop and Johnson 1960, table 7.1(c), with E (1 + i loss_factor).

    Parameters
    ----------
    frequency : (m,) array of float
        Hz, above 0.
    segment : Segment
        Straight; its elements and shear coefficient do not matter.
    loss_factor : float
        Structural damping, 1.

    Returns
    -------
    Component
        (m, 2, 2) blocks of deflection (m) and slope (rad) by force (N) and moment (N m). The near
        end is at 0, the far end at the length; slope is the derivative of the deflection.

    Raises
    ------
    StructureError
        If a frequency is not above 0 or the loss factor is negative.
    """
    omega = 2.0 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if not np.all(np.isfinite(omega) & (omega > 0.0)):
        raise StructureError("free beam: frequencies must be above 0 Hz")
    if not (np.isfinite(loss_factor) and loss_factor >= 0.0):
        raise StructureError(f"free beam: loss_factor is {loss_factor}; 0 or more")
    outer, inner = segment.outer_diameter, segment.inner_diameter
    area = 0.25 * np.pi * (outer**2 - inner**2)
    bending = segment.material.young * np.pi * (outer**4 - inner**4) / 64.0
    bending = bending * (1.0 + 1j * loss_factor)
    wave = (omega**2 * segment.material.density * area / bending) ** 0.25
    own, across = _end_functions(wave * segment.length)
    unit = np.stack([1.0 / (bending * wave**power) for power in (3, 2, 1)])
    h, l, p = own * unit  # noqa: E741
    h_far, l_far, p_far = across * unit
    return Component(
        near=_blocks(h, -l, -l, p),
        near_far=_blocks(h_far, l_far, -l_far, p_far),
        far_near=_blocks(h_far, -l_far, l_far, p_far),
        far=_blocks(h, l, l, p),
    )


def _blocks(*entries: NDArray[np.complex128]) -> NDArray[np.complex128]:
    return np.stack(entries, axis=-1).reshape(-1, 2, 2)


def _end_functions(x: NDArray[np.complex128]) -> tuple[NDArray, NDArray]:
    """-F5, F1, F6 and F8, F10, F7 over F3 (3, m) of Bishop and Johnson.

    Both sides are divided by exp(x + |Im x|), which would overflow; below 1 the closed forms
    cancel and their series do not.
    """
    large = np.where(abs(x) < 1.0, 1.0, x)
    small = np.where(abs(x) < 1.0, x, 1.0)
    decay, growth = np.exp(-large), np.exp(-abs(large.imag))
    cosh, sinh = 0.5 * (1.0 + decay**2), 0.5 * (1.0 - decay**2)
    ahead, back = (np.exp(turn * large - abs(large.imag)) for turn in (1j, -1j))
    cos, sin = 0.5 * (ahead + back), -0.5j * (ahead - back)
    far = np.array(
        [sin * decay - sinh * growth, cos * decay - cosh * growth, sin * decay + sinh * growth]
    )
    near = np.array([sin * cosh - cos * sinh, sin * sinh, cos * sinh + sin * cosh])
    by_hand = cos * cosh - decay * growth
    turns = [_series(small, power, -4.0) for power in (3, 2, 1)]
    plain = [_series(small, power, 1.0) for power in (3, 2, 1)]
    near_small = np.array([4.0 * turns[0], 2.0 * turns[1], 2.0 * turns[2]])
    far_small = np.array([-2.0 * plain[0], -2.0 * plain[1], 2.0 * plain[2]])
    by_series = -4.0 * _series(small, 4, -4.0)
    use = abs(x) < 1.0
    return (
        np.where(use, near_small / by_series, near / by_hand),
        np.where(use, far_small / by_series, far / by_hand),
    )


def _series(x: NDArray[np.complex128], power: int, factor: float) -> NDArray[np.complex128]:
    """Sum of factor^k x^(4k + power) / (4k + power)! over k."""
    terms = [factor**k * x ** (4 * k + power) / math.factorial(4 * k + power) for k in range(6)]
    return np.sum(terms, axis=0)
