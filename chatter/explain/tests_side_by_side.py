"""Dominant multipliers of cutting tests side by side: what they share is computed once.

Tests of one tool differ in speed and depth, in what wear made of the forces, and in what the speed
makes of the modes. Collocation solves eight points at once where their elements are alike
(`chatter.stability.methods.collocation`), so that tests of neighbouring speeds take the elements of
the slowest of them; and what the cut couples is in proportion to the cutting coefficients, to the
process damping, and, along a straight edge, to the depth.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.stability.cut_arrays import CHATTER_ABOVE_NATURAL, relevant_frequency
from chatter.stability.methods.collocation.coupling_assembly import coupling_assemblies
from chatter.stability.methods.collocation.coupling_structure import CouplingAssemblies
from chatter.stability.methods.collocation.drivers import element_multipliers
from chatter.stability.methods.collocation.element_assembly import operator_arrays
from chatter.stability.methods.collocation.element_cut import ElementCut, element_cut
from chatter.stability.methods.collocation.element_response import response_table
from chatter.stability.methods.collocation.first_use import compile_side_by_side
from chatter.stability.model import MillingModel
from chatter.stability.simd_batch import BATCH_SIZE
from chatter.stability.steady_flank import follows_steady_motion

Array = NDArray[np.float64]
Chosen = NDArray[np.bool_]

#: largest ratio of speeds that share their elements, and tests that do: each is at two depths
_ALIKE, _TOGETHER = 1.25, BATCH_SIZE // 2
#: vibrations in a period of the tool beyond which tests are left to `multipliers`, which refuses
_MOST_VIBRATIONS = 500


class ScaledPoints(NamedTuple):
    """Points of the stability diagram of one tool in one engagement."""

    speed: Array  # (n,), rad/s
    depth: Array  # (n,), axial, m
    cutting: Array  # (n,), factor of the cutting coefficients
    damping: Array  # (n,), factor of the process damping


def can_be_scaled(model: MillingModel, slowest: float) -> bool:
    """Whether what a model couples is in proportion to its coefficients, down to a speed, rad/s."""
    case = model.case
    if case.material.law != "linear" or case.tool.runout is not None:
        return False
    if case.cut.speed_variation is not None or follows_steady_motion(model):
        return False
    turns = slowest / (2.0 * math.pi)
    highest = max(mode.natural_frequency for mode in model.structure.modes) / (2.0 * math.pi)
    return highest / turns < _MOST_VIBRATIONS


def scaled_multipliers(
    models: Sequence[tuple[Chosen, MillingModel]], points: ScaledPoints, resolution: tuple
) -> NDArray[np.complex128]:
    """Dominant multiplier (n,) over a period of the tool at every point, imaginary part >= 0.

    `models` hold for some of the points (n,) each, and differ in their modes alone; `resolution` is
    that of `element_cut`.
    """
    cut = _common_cut(models, points, resolution)
    compile_side_by_side(cut)
    assemblies = _assemblies(models[0][1], cut, points)
    found = np.empty(points.speed.size, dtype=np.complex128)
    for chosen, model in models:
        own = _with_modes(cut, model) if len(models) > 1 else cut
        some = np.flatnonzero(chosen)
        # those that share their elements one behind the other
        some = some[np.argsort(assemblies.of_point[some], kind="stable")]
        found[some], _ = element_multipliers(
            operator_arrays(own),
            assemblies._replace(of_point=assemblies.of_point[some]),
            points.speed[some],
            np.zeros(some.size, dtype=np.bool_),
        )
    return found


def _common_cut(
    models: Sequence[tuple[Chosen, MillingModel]], points: ScaledPoints, resolution: tuple
) -> ElementCut:
    """Cut with elements that are short enough for the modes of all models."""
    cut = element_cut(models[0][1], float(np.max(points.cutting * points.depth)), *resolution)
    if len(models) == 1:
        return cut
    fastest = CHATTER_ABOVE_NATURAL * max(
        relevant_frequency(*model.modal_arrays) for _, model in models
    )
    longest = cut.longest * cut.arrays.fastest / fastest
    return cut._replace(arrays=cut.arrays._replace(fastest=fastest), longest=longest)


def _with_modes(cut: ElementCut, model: MillingModel) -> ElementCut:
    """The cut with the modes of another model."""
    natural, damping, shape, gain = model.modal_arrays
    arrays = cut.arrays._replace(
        natural_frequency=natural, damping=damping, shape=shape, force_gain=gain
    )
    return cut._replace(
        arrays=arrays, response=response_table(natural, damping, cut.points, cut.longest)
    )


def _assemblies(model: MillingModel, cut: ElementCut, points: ScaledPoints) -> CouplingAssemblies:
    """Couplings of every point, an assembly each."""
    group = neighbouring_speeds(points.speed)
    count = int(group.max()) + 1
    slowest, deepest = np.full(count, np.inf), np.zeros(count)
    np.minimum.at(slowest, group, points.speed)
    # stiffness of the cut shortens the elements
    np.maximum.at(deepest, group, points.cutting * points.depth)
    if is_straight(model):
        shared = coupling_assemblies(cut, slowest, deepest)
        share = points.depth / deepest[group]
        return _scaled(shared, shared.of_point[group], share * points.cutting,
                       share * points.damping, points_of_element(cut))  # fmt: skip
    order = np.lexsort((slowest[group], points.depth))
    shared = coupling_assemblies(cut, slowest[group][order], points.depth[order])
    of_point = np.empty_like(shared.of_point)
    of_point[order] = shared.of_point
    return _scaled(shared, of_point, points.cutting, points.damping, points_of_element(cut))


def is_straight(model: MillingModel) -> bool:
    """Whether all of the edges enter and leave at once, so that forces are as the depth."""
    cutter = model.cutter
    return (
        cutter.is_cylindrical
        and cutter.serration is None
        and all(helix == 0.0 for helix in cutter.helix)
    )


def points_of_element(cut: ElementCut) -> tuple[int, int]:
    """Gauss points of an element, and directions of motion."""
    return cut.points.weight.shape[0], cut.arrays.basis.shape[1]


def neighbouring_speeds(speed: Array) -> NDArray[np.intp]:
    """Number of the group (n,) of each speed: neighbours that are to share their elements."""
    distinct, index, counts = np.unique(speed, return_inverse=True, return_counts=True)
    number = np.zeros(distinct.size, dtype=np.intp)
    first, members, group = distinct[0], 0, 0
    for k, one in enumerate(distinct):
        if members >= 2 * _TOGETHER or one > _ALIKE * first:
            group, first, members = group + 1, one, 0
        number[k] = group
        members += int(counts[k])
    return number[index]


def _scaled(
    shared: CouplingAssemblies, of_point: NDArray[np.int64], cutting: Array, damping: Array,
    per_element: tuple[int, int],
) -> CouplingAssemblies:  # fmt: skip
    """Assemblies of points (n,), each from a shared one by factors of stiffness and dashpots."""
    gauss, rank = per_element
    order = np.argsort(of_point, kind="stable")
    structures, numbers, sizes = [], [], [(0, 0)]
    for assembly in np.unique(of_point).tolist():
        own = order[of_point[order] == assembly]
        structure = shared.structure[
            shared.first_structure[assembly] : shared.first_structure[assembly + 1]
        ]
        number = shared.number[shared.first_number[assembly] : shared.first_number[assembly + 1]]
        lengths, elements = int(structure[1]), int(structure[2])
        begin, pairs = 1 + lengths + 2 * elements, elements * gauss * rank * rank
        rows = np.tile(number, (own.size, 1))
        rows[:, begin:] *= cutting[own, None]
        rows[:, begin + pairs : begin + 2 * pairs] = np.outer(
            damping[own], number[begin + pairs : begin + 2 * pairs]
        )
        structures.append(np.tile(structure, own.size))
        numbers.append(rows.ravel())
        sizes += [(structure.size, number.size)] * own.size
    ends = np.cumsum(sizes, axis=0)
    place = np.empty_like(of_point)
    place[order] = np.arange(order.size)
    return CouplingAssemblies(
        np.concatenate(structures),
        np.ascontiguousarray(ends[:, 0]),
        np.concatenate(numbers),
        np.ascontiguousarray(ends[:, 1]),
        place,
    )
