"""Dominant eigenpair of a monodromy operator by Arnoldi iteration, without forming its matrix.

Arnoldi 1951. The vectors that the operator makes one of the other span the space in which the
eigenvalue of largest magnitude is searched. An operator is a NamedTuple whose application is
registered here; compiled code finds it by its type. Collocation iterates on a SIMD batch of eight
operators whose members converge one by one: `batch_multipliers` holds that loop.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import overload

from chatter.engine.presets import SUMMING_KERNEL
from chatter.stability.hessenberg import dominant_pair

#: growth of the space from one check of convergence to the next
_GROWTH = 1.3


class _Operator(NamedTuple):
    scratch: Callable  # operator -> scratch arrays
    apply: Callable  # operator, vector, out, scratch


_OPERATORS: dict[type, _Operator] = {}


def register_operator(kind: type, scratch: Callable, apply: Callable) -> None:
    """Make compiled code apply operators of a NamedTuple class.

    Both functions are compiled: scratch(operator), and apply(operator, vector, out, scratch).
    """
    _OPERATORS[kind] = _Operator(scratch, apply)


def scratch_of(operator):
    """Scratch arrays for `apply_operator`."""
    return _OPERATORS[type(operator)].scratch(operator)


def apply_operator(operator, vector, out, scratch):
    """Set out to the image of a vector after one period."""
    _OPERATORS[type(operator)].apply(operator, vector, out, scratch)


@overload(scratch_of)
def _scratch_of(operator):
    scratch = _OPERATORS[operator.instance_class].scratch
    return lambda operator: scratch(operator)


@overload(apply_operator)
def _apply_operator(operator, vector, out, scratch):  # noqa: ARG001
    apply = _OPERATORS[operator.instance_class].apply
    return lambda operator, vector, out, scratch: apply(operator, vector, out, scratch)


@njit(**SUMMING_KERNEL)
def dominant_eigenpair(operator, start, check_at, tolerance, largest):
    """Eigenvalue of largest magnitude (imaginary part >= 0), its vector (d,), and the residual.

    The operator is of a registered class; the start (d,) is smoothed by one application.
    Convergence is first checked at a space of `check_at` dimensions, the largest space has
    `largest`. The iteration stops where the norm of the residual of the eigenpair over the
    magnitude of the value falls below the tolerance.
    """
    dimension = start.shape[0]
    scratch = scratch_of(operator)
    largest = min(dimension, largest)
    check_at = min(check_at, largest)
    basis = np.empty((largest + 1, dimension))
    hessenberg = np.zeros((largest + 1, largest))
    apply_operator(operator, start, basis[0], scratch)
    norm = math.sqrt((basis[0] ** 2).sum())
    value, residual = complex(0.0, 0.0), 0.0
    vector = np.zeros(dimension, dtype=np.complex128)
    if norm == 0.0:
        return value, vector, residual
    basis[0] /= norm
    coordinates = np.ones(1, dtype=np.complex128)
    used = 0
    for k in range(largest):
        apply_operator(operator, basis[k], basis[k + 1], scratch)
        before = math.sqrt((basis[k + 1] ** 2).sum())
        for _ in range(2):
            for j in range(k + 1):
                overlap = 0.0
                for i in range(dimension):
                    overlap += basis[j, i] * basis[k + 1, i]
                hessenberg[j, k] += overlap
                for i in range(dimension):
                    basis[k + 1, i] -= overlap * basis[j, i]
        norm = math.sqrt((basis[k + 1] ** 2).sum())
        used = k + 1
        invariant = norm <= 1e-14 * before
        hessenberg[k + 1, k] = norm
        if used in (check_at, largest) or invariant:
            value, coordinates = dominant_pair(hessenberg[:used, :used].copy())
            residual = norm * abs(coordinates[used - 1]) / max(abs(value), 1e-300)
            check_at = min(largest, math.ceil(check_at * _GROWTH))
            if residual < tolerance or invariant:
                break
        basis[k + 1] /= norm
    for j in range(used):
        for i in range(dimension):
            vector[i] += coordinates[j] * basis[j, i]
    return value, vector, residual
