"""Assembly of the map over one period: what modes do over every element, and what the cut adds."""

from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array
from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL
from chatter.stability.methods.collocation.coupling_structure import (
    structure_at,
    unpacked_structure,
)
from chatter.stability.methods.collocation.element_cut import ElementCut
from chatter.stability.methods.collocation.element_response import (
    ElementPoints,
    ResponseTable,
    free_response,
    mode_response,
)
from chatter.stability.methods.collocation.monodromy import BatchMonodromy
from chatter.stability.simd_batch import BATCH_SIZE, load, spread, store


class Structure(NamedTuple):
    """Modes as the map sees them."""

    natural_frequency: Array  # rad/s (n,)
    damping: Array  # (n,)
    shape: Array  # (n, r)
    force_gain: Array  # 1/kg (n, r)


class OperatorArrays(NamedTuple):
    """What the map over a period needs to know beside the assemblies of its points."""

    structure: Structure
    points: ElementPoints
    response: ResponseTable
    damped: bool  # whether the cut has dashpots
    residual: float  # of the dominant eigenpair, relative, at which its search stops


class _Rates(NamedTuple):
    """Velocity at the Gauss points, which dashpots feel; of no lengths where there are none."""

    of_state: Array  # (S, q, 2n, 8)
    of_force: Array  # (S, q, q, 8)


def operator_arrays(cut: ElementCut) -> OperatorArrays:
    """What the monodromy operator needs to know of a cut."""
    arrays = cut.arrays
    return OperatorArrays(
        Structure(arrays.natural_frequency, arrays.damping, arrays.shape, arrays.force_gain),
        cut.points,
        cut.response,
        bool(arrays.segments.flank.radial > 0.0),
        cut.residual,
    )


@njit(**INNER_KERNEL)
def motion_of_state(structure):
    """Motion of the tool point from the state (r, 2n), scaled to be as large as that, and scale."""
    modes, rank = structure.shape.shape
    largest = 1e-300
    for m in range(modes):
        for k in range(rank):
            largest = max(largest, abs(structure.shape[m, k]) / structure.natural_frequency[m])
    output = np.zeros((rank, 2 * modes))
    for m in range(modes):
        for k in range(rank):
            reach = structure.shape[m, k] / structure.natural_frequency[m]
            output[k, 2 * m] = reach / largest
    return output, 1.0 / largest


@njit(**LEAF_KERNEL)
def _add_response(response, row, factor, k, l, of_force):  # noqa: E741
    """Add the response to the force in direction l, seen in direction k, from a row on."""
    points = response.shape[1] - 2
    rank = of_force.shape[0] // points
    for i in range(points):
        for j in range(points):
            at = (i * rank + k, j * rank + l)
            store(of_force, at, load(of_force, at) + factor * load(response, (row + i, 2 + j)))


@njit(**SINGLE_KERNEL)
def _mode_over_length(structure, m, scale, response, of_state, of_force, to_state):
    """Enter what mode m does over an element: motion at the points, state at the end."""
    rank, points = structure.shape.shape[1], response.shape[1] - 2
    w = structure.natural_frequency[m]
    for l in range(rank):  # noqa: E741
        gain = structure.force_gain[m, l] / w
        for j in range(points):
            for a in range(2):
                value = gain * load(response, (points + a, 2 + j))
                store(to_state, (2 * m + a, j * rank + l), value)
        for k in range(rank):
            factor = scale / w * structure.shape[m, k] * gain
            if factor != 0.0:
                _add_response(response, 0, factor, k, l, of_force)
    for k in range(rank):
        reach = scale / w * structure.shape[m, k]
        for i in range(points):
            for b in range(2):
                store(of_state, (i * rank + k, 2 * m + b), reach * load(response, (i, b)))


@njit(**SINGLE_KERNEL)
def _rates_over_length(structure, m, response, of_state, of_force):
    """Enter the velocity at the points that mode m makes over an element."""
    rank, points = structure.shape.shape[1], response.shape[1] - 2
    row = points + 2
    for k in range(rank):
        reach = structure.shape[m, k]
        for l in range(rank):  # noqa: E741
            factor = reach * structure.force_gain[m, l] / structure.natural_frequency[m]
            if factor != 0.0:
                _add_response(response, row, factor, k, l, of_force)
        for i in range(points):
            for b in range(2):
                store(of_state, (i * rank + k, 2 * m + b), reach * load(response, (row + i, b)))


@njit(**SINGLE_KERNEL)
def _fill_lengths(structure, table, durations, length_cuts, scale, period, rates):
    """Enter what all modes do over every distinct length, in batch durations (S, 8), s."""
    points = table.coefficient.shape[3] - 2
    rows = 2 * points + 2 if rates.of_state.shape[0] > 0 else points + 2
    response, position = np.empty((rows, points + 2, BATCH_SIZE)), np.empty((1, BATCH_SIZE))
    for s in range(length_cuts.shape[0]):
        for m in range(structure.shape.shape[0]):
            free = period.free[s, m]
            store(position, 0, structure.natural_frequency[m] * load(durations, s))
            if length_cuts[s] == 0:
                free_response(structure.damping[m], position, free)
                continue
            mode_response(table.coefficient[m], table.furthest[m], position, response)
            for a in range(2):
                for b in range(2):
                    store(free, (a, b), load(response, (points + a, b)))
            _mode_over_length(
                structure, m, scale, response, period.motion_of_state[s],
                period.motion_of_force[s], period.state_of_force[s],
            )  # fmt: skip
            if rates.of_state.shape[0] > 0:
                _rates_over_length(structure, m, response, rates.of_state[s], rates.of_force[s])


@njit(**LEAF_KERNEL)
def _add_row(matrix, row, factor, other, column):
    """Add factor times a row of another matrix to a row of one."""
    for j in range(matrix.shape[1]):
        value = load(matrix, (row, j)) + factor * load(other, (column, j))
        store(matrix, (row, j), value)


@njit(**LEAF_KERNEL)
def _enter_cut(coupling, row, of_force, of_state, matrix, couple):
    """Enter stiffness or dashpots (r, r, 8) at the point whose values begin at a row."""
    rank = coupling.shape[0]
    for k in range(rank):
        for l in range(rank):  # noqa: E741
            factor = load(coupling, (k, l))
            _add_row(matrix, row + k, factor, of_force, row + l)
            _add_row(couple, row + k, factor, of_state, row + l)


@njit(**LEAF_KERNEL)
def _enter_own(block, row, of_force, of_state, output, matrix, couple):
    """Enter a source that lies within the very element."""
    rank, width = block.shape[0], block.shape[1]
    for k in range(rank):
        for l in range(rank):  # noqa: E741
            start = load(block, (k, l))
            for j in range(couple.shape[1]):
                value = load(couple, (row + k, j)) - start * output[l, j]
                store(couple, (row + k, j), value)
        for column in range(width - rank):
            weight = -1.0 * load(block, (k, rank + column))
            _add_row(matrix, row + k, weight, of_force, column)
            _add_row(couple, row + k, weight, of_state, column)


@njit(**LEAF_KERNEL)
def _factorise(a):
    """Replace a (n, n, 8) by its factors; the diagonal of the upper one is inverted.

    No pivoting: the matrix is one plus a response to earlier forces alone, so that its leading
    parts are those of shorter elements.
    """
    n = a.shape[0]
    for k in range(n):
        pivot = 1.0 / load(a, (k, k))
        store(a, (k, k), pivot)
        for i in range(k + 1, n):
            factor = load(a, (i, k)) * pivot
            store(a, (i, k), factor)
            for j in range(k + 1, n):
                store(a, (i, j), load(a, (i, j)) - factor * load(a, (k, j)))


@njit(**LEAF_KERNEL)
def _side_by_side(assemblies, batch_points, first, count, out):
    """Set out (count, 8) to a part of the numbers of the assemblies of all batch."""
    for member in range(BATCH_SIZE):
        start = assemblies.first_number[assemblies.of_point[batch_points[member]]] + first
        for i in range(count):
            out[i, member] = assemblies.number[start + i]


@njit(**LEAF_KERNEL)
def _multiply_all(a, factor):
    """Multiply all of a (n, 8) by a plain factor or by a batch."""
    for i in range(a.shape[0]):
        store(a, i, load(a, i) * factor)


@njit(**INNER_KERNEL)
def _take(workspace, used, shape):
    """Return an array of a shape out of a workspace; used (1,) is how much of it is."""
    size = 1
    for length in shape:
        size *= length
    first = used[0]
    used[0] += size
    return workspace[first : first + size].reshape(shape)


@njit(**SINGLE_KERNEL)
def build_batch_monodromy(arrays, assemblies, batch_points, speeds, workspace):
    """Assemble the `BatchMonodromy` of one period from `OperatorArrays` and `CouplingAssemblies`.

    `batch_points` (8,) are the points of the members, whose assemblies have the same structure;
    `speeds` (1, 8) their mean spindle speeds, rad/s. The matrices lie in the workspace, which is
    returned along, larger where it has to be: new memory for every batch would cost as much as what
    is done with it.
    """
    structure, table = arrays.structure, arrays.response
    packed = structure_at(assemblies, batch_points[0])
    assembly = unpacked_structure(packed)
    modes, rank = structure.shape.shape
    points = table.coefficient.shape[3] - 2
    size, values = 2 * modes, points * rank
    lengths, cuts, sources = packed[1], packed[2], packed[3]
    output, scale = motion_of_state(structure)
    slowness = 1.0 / load(speeds, 0)
    pairs, blocks = cuts * points * rank * rank, sources * rank * (values + rank)
    rated = lengths if arrays.damped else 0
    needed = lengths * (1 + 4 * modes + 2 * values * size + values * values)
    needed += cuts * values * (values + size) + 2 * pairs + blocks
    needed += rated * values * (values + size)
    if needed * BATCH_SIZE > workspace.shape[0]:
        workspace = np.empty(needed * BATCH_SIZE)
    used = np.zeros(1, dtype=np.int64)
    durations = _take(workspace, used, (lengths, BATCH_SIZE))
    _side_by_side(assemblies, batch_points, 1, lengths, durations)
    _multiply_all(durations, slowness)
    stiffness = _take(workspace, used, (pairs, BATCH_SIZE))
    dashpot = _take(workspace, used, (pairs, BATCH_SIZE))
    first = 1 + lengths + 2 * cuts
    _side_by_side(assemblies, batch_points, first, pairs, stiffness)
    _side_by_side(assemblies, batch_points, first + pairs, pairs, dashpot)
    block = _take(workspace, used, (blocks, BATCH_SIZE))
    _side_by_side(assemblies, batch_points, first + 2 * pairs, blocks, block)
    _multiply_all(stiffness, 1.0 / scale)
    _multiply_all(dashpot, slowness)
    _multiply_all(block, 1.0 / scale)
    period = BatchMonodromy(
        assembly,
        _take(workspace, used, (lengths, modes, 2, 2, BATCH_SIZE)),
        _take(workspace, used, (lengths, values, size, BATCH_SIZE)),
        _take(workspace, used, (lengths, values, values, BATCH_SIZE)),
        _take(workspace, used, (lengths, size, values, BATCH_SIZE)),
        _take(workspace, used, (cuts, values, values, BATCH_SIZE)),
        _take(workspace, used, (cuts, values, size, BATCH_SIZE)),
        block.reshape((sources, rank, values + rank, BATCH_SIZE)), output,
    )  # fmt: skip
    rates = _Rates(
        _take(workspace, used, (rated, values, size, BATCH_SIZE)),
        _take(workspace, used, (rated, values, values, BATCH_SIZE)),
    )
    for added_up in (period.motion_of_force, period.factors, rates.of_force):
        added_up[:] = 0.0
    period.couple[:] = 0.0
    _fill_lengths(structure, table, durations, assembly.length_cuts, scale, period, rates)
    couplings = (cuts * points, rank, rank, BATCH_SIZE)
    _enter_elements(period, rates, stiffness.reshape(couplings), dashpot.reshape(couplings))
    return period, workspace


@njit(**SINGLE_KERNEL)
def _enter_elements(period, rates, stiffness, dashpot):
    """Fill in and factorise the matrices of all elements in the cut."""
    assembly, block = period.assembly, period.block
    _, values, _, _ = period.couple.shape
    rank = stiffness.shape[1]
    points = values // rank
    for m in range(assembly.cut.shape[0]):
        e, s = assembly.cut[m], assembly.shape[m]
        if e < 0:
            continue
        matrix, couple = period.factors[e], period.couple[e]
        of_force, of_state = period.motion_of_force[s], period.motion_of_state[s]
        for i in range(values):
            store(matrix, (i, i), spread(1.0))
        for i in range(points):
            at, row = e * points + i, i * rank
            _enter_cut(stiffness[at], row, of_force, of_state, matrix, couple)
            if rates.of_state.shape[0] > 0:
                _enter_cut(dashpot[at], row, rates.of_force[s], rates.of_state[s], matrix, couple)
            for entry in range(assembly.first_source[at], assembly.first_source[at + 1]):
                if assembly.source[entry] == e:
                    _enter_own(block[entry], row, of_force, of_state, period.output, matrix, couple)
        _factorise(matrix)
