"""Zeroth-order limits of a model, for any tool and speed-dependent dynamics."""

import math

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.progress import Progress, no_progress
from chatter.stability.averaged_coefficients import AveragedCoefficients
from chatter.stability.methods.zeroth_order.distinct_delays import limits_of_delays
from chatter.stability.methods.zeroth_order.uniform_pitch import ZeroOrderLimit, zero_order_limit
from chatter.stability.model import MillingModel
from chatter.stability.reference_speeds import over_reference_speeds

#: steps, and speeds they take, to the depth at which a corner is averaged; share it may miss
_DEPTH_STEPS, _SPEEDS_FOR_DEPTH, _SAME_DEPTH = 8, 24, 0.05


def zero_order_of(model: MillingModel, speeds: Array) -> ZeroOrderLimit:
    """Zeroth-order limits of a model at given speeds (rad/s).

    The coefficients of any tool but a uniform-pitch cylindrical end mill are averaged at the depth
    of the case; on a corner or a cone at about the lowest limit, as it cuts ever more as the depth
    grows.
    """

    def limits(own: MillingModel, index: IntegerArray, _: Progress) -> ZeroOrderLimit:
        return _limits_of_structure(own, speeds[index])

    found = over_reference_speeds(model, speeds, limits, no_progress)
    depth, frequency = np.empty(len(speeds)), np.empty(len(speeds))
    for index, limit in found:
        depth[index], frequency[index] = limit.critical_depth, limit.chatter_frequency
    lowest = min((limit for _, limit in found), key=lambda limit: limit.lowest_depth)
    return ZeroOrderLimit(speeds, depth, frequency, lowest.lowest_depth, lowest.lowest_frequency)


def _limits_of_structure(model: MillingModel, speeds: Array) -> ZeroOrderLimit:
    if model.is_uniform:
        return zero_order_limit(*model.receptance, model.averaged_directional, model.teeth, speeds)
    averaged = model.averaged_coefficients
    if model.is_inclined or not model.cutter.is_cylindrical:
        depth = model.case.cut.axial_depth
        some = speeds[:: -(-len(speeds) // _SPEEDS_FOR_DEPTH)]
        for _ in range(_DEPTH_STEPS):
            lowest = limits_of_averages(model, averaged, some).lowest_depth
            if not np.isfinite(lowest) or abs(np.log(lowest / depth)) < _SAME_DEPTH:
                break
            # half the step: what is cut grows faster than the depth
            depth = float(np.sqrt(depth * lowest))
            averaged = model.averaged_coefficients_at(depth)
    return limits_of_averages(model, averaged, speeds)


def limits_of_averages(
    model: MillingModel, averaged: AveragedCoefficients, speeds: Array
) -> ZeroOrderLimit:
    """Limits of averaged coefficients; line by line only where teeth have delays of their own."""
    delays, means = averaged
    # a uniform pitch with the same mean gives the scale of the lowest limit
    even = zero_order_limit(*model.receptance, means.sum(axis=0), model.teeth, speeds)
    if delays.size == 1 and math.isclose(delays[0], 2.0 * math.pi / model.teeth, rel_tol=1e-9):
        return even
    depth, frequency = limits_of_delays(*model.receptance, delays, means, speeds)
    return even._replace(
        critical_depth=depth,
        chatter_frequency=frequency,
        lowest_depth=min(even.lowest_depth, float(depth.min())),
    )
