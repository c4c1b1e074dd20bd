"""Random cuts."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.contradictions.confrontation import Document
from benchmarks.contradictions.drawing.quantities import (
    chosen,
    happens,
    log_uniform,
    number_of,
    text,
)
from benchmarks.contradictions.drawing.tool import lag_of, radius_of

#: edges do not wind farther than this, rad
_LARGEST_LAG = 6.0


def any_cut(rng: np.random.Generator, tool: Document) -> Document:
    """Cut of a tool: up, down, slot; 1 % to all of the diameter; 15 to 1500 m/min."""
    radius = radius_of(tool)
    mode = chosen(rng, ("up", "down", "up", "down", "slot"))
    speed = log_uniform(rng, 15.0, 1500.0) / 60.0
    cut = {
        "mode": mode,
        "spindle_speed": text(speed / radius * 30.0 / math.pi, "rpm"),
        "feed_per_tooth": text(_feed(rng, radius), "um"),
        "axial_depth": text(1e3 * any_depth(rng, tool), "mm"),
    }
    if mode != "slot":
        share = log_uniform(rng, 0.01, 0.98)
        cut["radial_depth"] = text(2e3 * radius * share, "mm")
    return reaching(tool, cut)


def reaching(tool: Document, cut: Document) -> Document:
    """The cut, so deep that a corner reaches the stock R - ae from the axis."""
    corner = radius_of(tool)
    if tool["kind"] != "ball":
        corner = 1e-3 * number_of(tool.get("corner_radius", "0 mm"))
    if cut["mode"] == "slot" or corner == 0.0:
        return cut
    needed = radius_of(tool) - 1e-3 * number_of(cut["radial_depth"])
    sine = (1.03 * needed - radius_of(tool) + corner) / corner
    if sine <= 0.0:
        return cut
    height = corner * (1.0 - math.sqrt(max(1.0 - min(sine, 1.0) ** 2, 0.0)))
    depth = max(1e-3 * number_of(cut["axial_depth"]), height)
    return {**cut, "axial_depth": text(1e3 * depth, "mm")}


def any_depth(rng: np.random.Generator, tool: Document) -> float:
    """Axial depth, m: 1 % to 150 % of the diameter, less where edges would wind too far."""
    depth = 2.0 * radius_of(tool) * log_uniform(rng, 0.01, 1.5)
    lag = lag_of(tool, depth)
    return depth * min(1.0, _LARGEST_LAG / lag) if lag > 0.0 else depth


def _feed(rng: np.random.Generator, radius: float) -> float:
    """Feed per tooth, um: up to 0.3 mm and to 4 % of the radius."""
    return log_uniform(rng, 5.0, min(300.0, 4e4 * radius))


def varying_speed(rng: np.random.Generator, cut: Document) -> Document:
    """The cut with a spindle speed that varies by up to 20 %."""
    speed = number_of(cut["spindle_speed"]) / 60.0
    return {
        **cut,
        "speed_variation": {
            "amplitude": round(rng.uniform(0.02, 0.2), 3),
            "frequency": text(speed / chosen(rng, (2, 3, 4, 5, 8)), "Hz"),
            "shape": "sine" if happens(rng, 0.6) else "triangle",
        },
    }
