"""Directions and signs of channels that are not told, by how predictions fit the records."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.records.alignment import USUAL_FILTER, Recorded, low_pass
from chatter.explain.records.case_axes import Component
from chatter.explain.records.description import Channel
from chatter.explain.records.steady_cut import SteadyCut

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: angles that are tried of a pair of unknown direction, and start angles
_TURNS, _STARTS = 360, 360


class Found(NamedTuple):
    """Channels with directions, and how well they fit."""

    channels: dict[str, Channel]
    share: float  # of the power of the records that the prediction has, 1
    next_share: float  # the same of the best quite different orientation


class _Content(NamedTuple):
    """Orders of one run: measured (c, K) and predicted (3, K) for each channel's quantity."""

    measured: Complex
    predicted: Complex  # (c, 3, K)
    power: float


def oriented(channels: Mapping[str, Channel], runs: Sequence[tuple[Recorded, SteadyCut]]) -> Found:
    """Find directions and signs of channels, in the order of the rows of the records.

    Two channels of a quantity without a direction stand at a right angle in the plane of x and y,
    turned by any angle or mirrored; one stands anywhere in the plane. A sign is tried both ways.
    """
    names = list(channels)
    contents = [_content(channels, *one) for one in runs]
    tried = []
    for directions in _directions(channels):
        matrix = np.array([directions[name] for name in names])
        tried.append((_fit(matrix, contents), directions))
    tried.sort(key=lambda entry: -entry[0])
    best = tried[0]
    other = next((fit for fit, one in tried if _apart(best[1], one)), 0.0)
    found = {
        name: replace(one, direction=tuple(float(v) for v in _as_told(one, best[1][name])))
        for name, one in channels.items()
    }
    return Found({k: replace(v, has_sign=True) for k, v in found.items()}, best[0], other)


def _as_told(channel: Channel, of_tool: Array) -> Array:
    return -of_tool if channel.on == "workpiece" else of_tool


def _apart(one: Mapping[str, Array], other: Mapping[str, Array]) -> bool:
    """Whether two orientations differ by more than a fine turn."""
    return any(float(one[name] @ other[name]) < math.cos(math.radians(20.0)) for name in one)


def _directions(channels: Mapping[str, Channel]) -> list[dict[str, Array]]:
    """Sets of directions of the quantity of the tool, one a channel."""
    known = {
        name: _as_told(one, np.array(one.direction))
        for name, one in channels.items()
        if one.direction is not None
    }
    unsigned = [name for name, one in channels.items() if name in known and not one.has_sign]
    signed = [
        {**known, **{n: known[n] * s for n, s in zip(unsigned, signs, strict=True)}}
        for signs in itertools.product((1.0, -1.0), repeat=len(unsigned))
    ]
    free = [name for name, one in channels.items() if one.direction is None]
    groups = [
        [name for name in free if channels[name].quantity == quantity]
        for quantity in dict.fromkeys(channels[name].quantity for name in free)
    ]
    found = signed
    for group in groups:
        found = [{**one, **turned} for one in found for turned in _turned(group)]
    return found


def _turned(names: Sequence[str]) -> list[dict[str, Array]]:
    angles = np.arange(_TURNS) * 2.0 * math.pi / _TURNS
    found = []
    for angle in angles:
        first = np.array([math.cos(angle), math.sin(angle), 0.0])
        second = np.array([-math.sin(angle), math.cos(angle), 0.0])
        if len(names) == 1:
            found.append({names[0]: first})
        else:
            found += [
                dict(zip(names, (first, sense * second), strict=True)) for sense in (1.0, -1.0)
            ]
    return found


def _content(channels: Mapping[str, Channel], recorded: Recorded, cut: SteadyCut) -> _Content:
    orders = recorded.orders[: recorded.in_band]
    frequency = recorded.frequency[: orders.size]
    filtered = low_pass(frequency, USUAL_FILTER, recorded.sampling).gain
    predicted = np.array(
        [
            [
                cut.harmonics(Component(one.quantity, tuple(axis)), orders) * filtered / level
                for axis in np.eye(3)
            ]
            for one, level in zip(channels.values(), recorded.deviation, strict=True)
        ]
    )
    power = float(np.sum(np.abs(recorded.content) ** 2))
    return _Content(recorded.content, predicted, power)


def _fit(matrix: Array, contents: Sequence[_Content]) -> float:
    """Share of the power of records that is predicted, by the best start angle of each."""
    residual = total = 0.0
    for one in contents:
        predicted = np.einsum("ca,cak->ck", matrix, one.predicted)
        product = np.sum(np.conj(predicted) * one.measured, axis=0)
        size = 1 << math.ceil(math.log2(max(_STARTS, 4 * product.size)))
        padded = np.zeros(size, dtype=np.complex128)
        padded[1 : product.size + 1] = product
        best = float(np.real(np.fft.fft(padded)).max())
        own = float(np.sum(np.abs(predicted) ** 2))
        residual += (one.power - 2.0 * best + own) / one.power
        total += 1.0
    return 1.0 - residual / total
