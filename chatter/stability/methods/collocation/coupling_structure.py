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

    structure: IntegerArray  # see `packed_behind`
    first_structure: IntegerArray  # where that of each assembly begins (P + 1,)
    number: Array  # the same
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


@njit(**INNER_KERNEL)
def empty_assemblies(points):
    """Return room for no assemblies as yet, of so many points at the most."""
    return CouplingAssemblies(
        np.empty(0, dtype=np.int64), np.zeros(points + 1, dtype=np.int64), np.empty(0),
        np.zeros(points + 1, dtype=np.int64), np.empty(points, dtype=np.int64),
    )  # fmt: skip


@njit(**INNER_KERNEL)
def counted_assemblies(assemblies, count):
    """Return the first of the assemblies, without the room beyond them."""
    last, last_number = assemblies.first_structure[count], assemblies.first_number[count]
    return CouplingAssemblies(
        assemblies.structure[:last], assemblies.first_structure[: count + 1],
        assemblies.number[:last_number], assemblies.first_number[: count + 1], assemblies.of_point,
    )  # fmt: skip


@njit(**INNER_KERNEL)
def _with_room(array, used, needed, like_it):
    """Return the array with room for more behind what is used, and for more like it if it grows."""
    if used + needed <= array.shape[0]:
        return array
    larger = np.empty(max(used + needed * like_it, 2 * used), dtype=array.dtype)
    for i in range(used):
        larger[i] = array[i]
    return larger


@njit(**INNER_KERNEL)
def packed_behind(assemblies, count, layout, couplings, first_source, sources):
    """Pack an assembly behind the first ones; returns them with it.

    What is whole numbers: counts of elements, lengths, elements in the cut, sources, and elements
    before the period; the lists of `AssemblyStructure`. Reals: period, lengths (S,), starts and
    lengths of the elements in the cut (E,), rad; stiffness (E p, r, r), dashpots (E p, r, r) times
    the mean speed, blocks of the sources, N/m.
    """
    stiffness, block = couplings.stiffness, sources.block
    used, used_numbers = assemblies.first_structure[count], assemblies.first_number[count]
    entries = first_source[first_source.shape[0] - 1]
    elements, lengths, cuts = layout.cut.shape[0], layout.length.shape[0], layout.cut_start.shape[0]
    kept = entries * block.shape[1] * block.shape[2]
    whole = _HEADER + 2 * elements + lengths + first_source.shape[0] + 2 * entries
    reals = 1 + lengths + 2 * cuts + 2 * stiffness.size + kept
    left = assemblies.of_point.shape[0] - count
    packed = CouplingAssemblies(
        _with_room(assemblies.structure, used, whole, left), assemblies.first_structure,
        _with_room(assemblies.number, used_numbers, reals, left), assemblies.first_number,
        assemblies.of_point,
    )  # fmt: skip
    packed.first_structure[count + 1] = used + whole
    packed.first_number[count + 1] = used_numbers + reals
    _pack_structure(layout, first_source, sources, packed.structure[used : used + whole])
    out = packed.number[used_numbers : used_numbers + reals]
    out[0] = layout.period
    at = _append(layout.length, out, 1)
    at = _append(layout.cut_start, out, at)
    at = _append(layout.cut_length, out, at)
    at = _append(stiffness.reshape(stiffness.size), out, at)
    at = _append(couplings.dashpot.reshape(stiffness.size), out, at)
    _append(block.reshape(block.size)[:kept], out, at)
    return packed


@njit(**SINGLE_KERNEL)
def _pack_structure(layout, first_source, sources, out):
    """Set `out` to what of an assembly is whole numbers."""
    count = first_source[first_source.shape[0] - 1]
    out[0], out[1], out[2] = layout.cut.shape[0], layout.length.shape[0], layout.cut_start.shape[0]
    memory = 0
    for entry in range(count):
        memory = max(memory, -sources.element[entry])
    out[3], out[4] = count, memory
    at = _append(layout.cut, out, _HEADER)
    at = _append(layout.shape, out, at)
    at = _append(layout.length_cuts, out, at)
    at = _append(first_source, out, at)
    at = _append(sources.element[:count], out, at)
    _append(sources.point[:count], out, at)


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
