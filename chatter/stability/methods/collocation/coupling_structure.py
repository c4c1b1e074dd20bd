"""Coupling assemblies packed into integers that give their structure and reals that fill it."""

from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, IntegerArray
from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL

#: whole numbers before the lists of a structure
_HEADER = 5


class CouplingAssemblies(NamedTuple):
    """Coupling assemblies of N points, P distinct ones, one behind the other."""

    structure: IntegerArray  # see `packed_structure`
    first_structure: IntegerArray  # where that of each assembly begins (P + 1,)
    number: Array  # see `packed_numbers`
    first_number: IntegerArray  # (P + 1,)
    of_point: IntegerArray  # assembly of each point (N,)


class AssemblyStructure(NamedTuple):
    """Structure of an assembly: M elements, E in the cut, S distinct lengths, p points each."""

    cut: IntegerArray  # number of each element among those in the cut, or -1 (M,)
    shape: IntegerArray  # number of the length of each element (M,)
    length_cuts: IntegerArray  # 1 where an element in the cut has the length (S,)
    first_source: IntegerArray  # of each point (E p + 1,)
    source: IntegerArray  # element, counted from the period's first; negative before it
    point: IntegerArray  # the only one that a source needs of its element, or -1
    memory: int  # elements before the period that are referred to


@njit(**LEAF_KERNEL)
def _append(part, out, at):
    """Copy an array of one axis into another from a position on; returns the next position."""
    for i in range(part.shape[0]):
        out[at + i] = part[i]
    return at + part.shape[0]


@njit(**SINGLE_KERNEL)
def packed_structure(layout, first_source, element, point):
    """Pack what of an assembly is whole numbers."""
    count = first_source[first_source.shape[0] - 1]
    elements, lengths = layout.cut.shape[0], layout.length_cuts.shape[0]
    out = np.empty(
        _HEADER + 2 * elements + lengths + first_source.shape[0] + 2 * count, dtype=np.int64
    )
    out[0], out[1], out[2] = elements, lengths, layout.cut_start.shape[0]
    memory = 0
    for entry in range(count):
        memory = max(memory, -element[entry])
    out[3], out[4] = count, memory
    at = _append(layout.cut, out, _HEADER)
    at = _append(layout.shape, out, at)
    at = _append(layout.length_cuts, out, at)
    at = _append(first_source, out, at)
    at = _append(element[:count], out, at)
    _append(point[:count], out, at)
    return out


@njit(**SINGLE_KERNEL)
def packed_numbers(layout, stiffness, dashpot, block, sources):
    """Pack the reals of an assembly: period, lengths, starts, couplings, blocks of sources."""
    kept = sources * block.shape[1] * block.shape[2]
    out = np.empty(
        1 + layout.length.shape[0] + 2 * layout.cut_start.shape[0] + 2 * stiffness.size + kept
    )
    out[0] = layout.period
    at = _append(layout.length, out, 1)
    at = _append(layout.cut_start, out, at)
    at = _append(layout.cut_length, out, at)
    at = _append(stiffness.reshape(stiffness.size), out, at)
    at = _append(dashpot.reshape(stiffness.size), out, at)
    _append(block.reshape(block.size)[:kept], out, at)
    return out


@njit(**SINGLE_KERNEL)
def packed_assemblies(structures, numbers, of_point):
    """Lay lists of packed assemblies one behind the other.

    `of_point` (N,) is the place in the lists of the assembly of each point.
    """
    count = len(structures)
    first_structure = np.zeros(count + 1, dtype=np.int64)
    first_number = np.zeros(count + 1, dtype=np.int64)
    for assembly in range(count):
        first_structure[assembly + 1] = first_structure[assembly] + structures[assembly].shape[0]
        first_number[assembly + 1] = first_number[assembly] + numbers[assembly].shape[0]
    structure, number = np.empty(first_structure[count], np.int64), np.empty(first_number[count])
    for assembly in range(count):
        _append(structures[assembly], structure, first_structure[assembly])
        _append(numbers[assembly], number, first_number[assembly])
    return CouplingAssemblies(structure, first_structure, number, first_number, of_point)


@njit(**INNER_KERNEL)
def structure_at(assemblies, point):
    """Packed structure of the assembly of a point."""
    assembly = assemblies.of_point[point]
    return assemblies.structure[
        assemblies.first_structure[assembly] : assemblies.first_structure[assembly + 1]
    ]


@njit(**INNER_KERNEL)
def unpacked_structure(packed):
    """Unpack the `AssemblyStructure` of an assembly."""
    elements, lengths, count = packed[0], packed[1], packed[3]
    points = packed.shape[0] - _HEADER - 2 * elements - lengths - 2 * count
    a = _HEADER + elements
    b = a + elements
    c = b + lengths
    d = c + points
    e = d + count
    return AssemblyStructure(
        packed[_HEADER:a], packed[a:b], packed[b:c], packed[c:d], packed[d:e], packed[e:], packed[4]
    )


@njit(**LEAF_KERNEL)
def same_structure(one, other):
    """Whether two packed structures are the same: batch of one map may hold both assemblies."""
    if one.shape[0] != other.shape[0]:
        return False
    same = 0
    while same < one.shape[0] and one[same] == other[same]:
        same += 1
    return same == one.shape[0]
