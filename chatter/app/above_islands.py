"""What a diagram has above its islands of chatter: depths that are stable again, and their ends."""

from collections.abc import Mapping
from typing import Any

Columns = dict[str, list[float]]


def above_islands(diagram: Mapping[str, Any]) -> tuple[Columns, Columns]:
    """Bars of depths that are stable above an island, and all limits but the lowest.

    Parameters
    ----------
    diagram : mapping
        As of `LiveCase.diagram`.

    Returns
    -------
    dict, dict
        left and right (rpm), low and high (mm) of a bar at every speed; speed and depth of the
        limits.
    """
    speeds, deepest = diagram["spindle_speed_rpm"], diagram["max_axial_depth_mm"]
    half = 0.5 * (speeds[-1] - speeds[0]) / max(len(speeds) - 1, 1)
    bars: Columns = {"left": [], "right": [], "low": [], "high": []}
    limits: Columns = {"speed": [], "depth": []}
    for speed, found in zip(speeds, diagram["crossings_mm"], strict=True):
        ends = [*found, deepest]
        for low, high in zip(ends[1::2], ends[2::2], strict=False):
            for name, value in zip(bars, (speed - half, speed + half, low, high), strict=True):
                bars[name].append(value)
        limits["speed"] += [speed] * len(found[1:])
        limits["depth"] += found[1:]
    return bars, limits
