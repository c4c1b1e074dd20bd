"""Maps over one period, whatever method made them, behind three calls of compiled code.

A map is a NamedTuple with `output`; which functions act on it is settled when the caller is
compiled, by its type. A method adds itself by its entries here.
"""

from __future__ import annotations

from numba import njit, types
from numba.extending import overload

from chatter.kernels import KERNEL
from chatter.stability.element_map import ElementMap, apply_element_map, element_scratch
from chatter.stability.period_map import PeriodMap, apply_period_map, period_scratch


@njit(**KERNEL)
def _elements_kept(period):
    _, values, size = period.feedback.shape
    return size + period.memory * (values + period.output.shape[0])


@njit(**KERNEL)
def _nodes_kept(period):
    _, size, rank = period.from_left.shape
    return size + period.nodes * rank


_APPLY = {PeriodMap: apply_period_map, ElementMap: apply_element_map}
_SCRATCH = {PeriodMap: period_scratch, ElementMap: element_scratch}
_DIMENSION = {PeriodMap: _nodes_kept, ElementMap: _elements_kept}


def _kernel(kernels, period):
    return kernels.get(period.instance_class) if isinstance(period, types.BaseNamedTuple) else None


def apply_map(period, vector, out, scratch):
    """Set out to the image of the vector after one period."""
    _APPLY[type(period)](period, vector, out, scratch)


@overload(apply_map)
def _apply_map(period, vector, out, scratch):  # noqa: ARG001
    kernel = _kernel(_APPLY, period)
    if kernel is None:
        return None
    return lambda period, vector, out, scratch: kernel(period, vector, out, scratch)


def scratch_of(period):
    """Return the scratch arrays that `apply_map` needs."""
    return _SCRATCH[type(period)](period)


@overload(scratch_of)
def _scratch_of(period):
    kernel = _kernel(_SCRATCH, period)
    return None if kernel is None else lambda period: kernel(period)


def dimension_of(period):
    """Length of the vectors of a map: state, then motion that is still looked back to."""
    return _DIMENSION[type(period)](period)


@overload(dimension_of)
def _dimension_of(period):
    kernel = _kernel(_DIMENSION, period)
    return None if kernel is None else lambda period: kernel(period)
