"""Channels of a rig turned into the axes of the case."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from chatter.explain.measurement import Run
from chatter.explain.records.description import (
    ACCELERATION,
    DISPLACEMENT,
    FORCE,
    VECTORS,
    VELOCITY,
    Channel,
)

#: quantity -> name of the channel along an axis of the case
NAMES = {FORCE: "F{}", DISPLACEMENT: "{}", VELOCITY: "v{}", ACCELERATION: "a{}"}
_AXES = "xyz"
#: smallest singular value of directions that still span the axes
_SPANS = 0.2
#: deviation of a direction from an axis that is none
_ALONG = 1e-3


class Component(NamedTuple):
    """What a channel in the axes of the case holds: a quantity of the tool along a direction.

    Spindle power and drive torque have none.
    """

    quantity: str
    direction: tuple[float, float, float]
    noise: float = 0.0  # where it is known before any fit, SI
    axis: str = ""  # of a drive


#: channels that need no description
USUAL = {
    NAMES[quantity].format(axis): Component(quantity, tuple(float(axis == k) for k in _AXES))
    for quantity in VECTORS
    for axis in _AXES
}


def in_case_axes(run: Run, channels: Mapping[str, Channel]) -> tuple[Run, dict[str, Component]]:
    """Run whose described channels are turned into the axes of the case where they span them.

    Forces then act on the tool. A channel along no axis keeps its name and its direction. Channels
    without a known direction are left out, other quantities stay. The directions are those of
    every channel that can be predicted.
    """
    described = {name: one for name, one in channels.items() if one.is_vector}
    signals = {name: values for name, values in run.signals.items() if name not in described}
    components = {name: one for name, one in USUAL.items() if name in signals}
    for quantity in VECTORS:
        group = {
            name: _of_tool(one)
            for name, one in described.items()
            if one.quantity == quantity and one.direction is not None and name in run.signals
        }
        rest = dict(group)
        for axes in ("xyz", "xy"):
            columns = [_AXES.index(axis) for axis in axes]
            names = [name for name, d in rest.items() if _lies_in(d, columns)]
            matrix = np.array([rest[name] for name in names]).reshape(-1, 3)[:, columns]
            if len(names) >= len(axes) and np.linalg.svd(matrix)[1][-1] > _SPANS:
                values = np.linalg.pinv(matrix) @ np.array([run.signals[name] for name in names])
                for axis, row in zip(axes, values, strict=True):
                    signals[NAMES[quantity].format(axis)] = row
                    components[NAMES[quantity].format(axis)] = USUAL[NAMES[quantity].format(axis)]
                rest = {name: d for name, d in rest.items() if name not in names}
        for name, direction in rest.items():
            _add_single(run, name, Component(quantity, direction), signals, components)
    return replace(run, signals=signals), components


def _of_tool(channel: Channel) -> tuple[float, float, float]:
    """Direction along which a channel shows what acts on the tool."""
    x, y, z = channel.direction
    return (-x, -y, -z) if channel.on == "workpiece" else (x, y, z)


def _lies_in(direction: tuple[float, ...], columns: list[int]) -> bool:
    return all(abs(v) < _ALONG for k, v in enumerate(direction) if k not in columns)


def _add_single(run: Run, name: str, one: Component, signals: dict, components: dict) -> None:
    """Add a channel by itself: by the name of its axis where it lies along one."""
    axis = int(np.argmax(np.abs(one.direction)))
    usual = NAMES[one.quantity].format(_AXES[axis])
    if abs(abs(one.direction[axis]) - 1.0) < 0.5 * _ALONG**2 and usual not in signals:
        signals[usual] = run.signals[name] * np.sign(one.direction[axis])
        components[usual] = USUAL[usual]
        return
    signals[name] = run.signals[name]
    components[name] = one
