"""Random tools."""

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

#: unequal pitch: teeth are set off by up to this share of the mean pitch
_PITCH_SPREAD = 0.25
#: flutes of different helix: by up to this, degrees
_HELIX_SPREAD = 3.0


def any_tool(rng: np.random.Generator) -> Document:
    """Tool of any kind, with any deviation of its teeth."""
    tool = chosen(rng, (end_mill, end_mill, ball, bull_nose, taper, inserted))(rng)
    for deviation, probability in (
        (with_unequal_pitch, 0.3),
        (with_helix_by_flute, 0.15),
        (with_runout, 0.3),
        (with_setting_errors, 0.1),
        (with_serration, 0.06),
    ):
        if happens(rng, probability):
            deviation(rng, tool)
    return tool


def end_mill(rng: np.random.Generator) -> Document:
    """Cylindrical end mill of uniform pitch and one helix."""
    helix = 0.0 if happens(rng, 0.3) else rng.uniform(-20.0, 55.0)
    return {
        "kind": "end mill",
        "teeth": int(chosen(rng, (1, 2, 2, 3, 4, 4, 5, 6, 8))),
        "diameter": text(log_uniform(rng, 1.0, 63.0), "mm"),
        "helix": text(helix, "deg"),
    }


def ball(rng: np.random.Generator) -> Document:
    """Ball end mill."""
    return {**end_mill(rng), "kind": "ball", "teeth": int(chosen(rng, (1, 2, 2, 3, 4)))}


def bull_nose(rng: np.random.Generator) -> Document:
    """End mill with corner radii from 2 % of the radius to nearly a ball."""
    tool = {**end_mill(rng), "kind": "bull nose"}
    radius = 0.5 * number_of(tool["diameter"])
    tool["corner_radius"] = text(radius * log_uniform(rng, 0.02, 0.95), "mm")
    return tool


def taper(rng: np.random.Generator) -> Document:
    """Tapered end mill, with and without a corner."""
    tool = {**end_mill(rng), "kind": "taper", "taper_angle": text(rng.uniform(0.5, 30.0), "deg")}
    if happens(rng, 0.4):
        radius = 0.5 * number_of(tool["diameter"])
        tool["corner_radius"] = text(radius * rng.uniform(0.05, 0.9), "mm")
    return tool


def inserted(rng: np.random.Generator) -> Document:
    """Face mill of inserts."""
    tool = {
        "kind": "inserted",
        "teeth": int(rng.integers(1, 11)),
        "diameter": text(log_uniform(rng, 16.0, 160.0), "mm"),
        "helix": text(0.0 if happens(rng, 0.5) else rng.uniform(-10.0, 15.0), "deg"),
        "cutting_edge_angle": text(chosen(rng, (90.0, 75.0, 45.0, rng.uniform(15.0, 88.0))), "deg"),
    }
    if happens(rng, 0.3):
        tool["corner_radius"] = text(log_uniform(rng, 0.2, 4.0), "mm")
    return tool


def with_unequal_pitch(rng: np.random.Generator, tool: Document) -> None:
    """Set teeth off from the uniform pitch."""
    teeth = tool["teeth"]
    if teeth == 1:
        return
    angles = 1.0 + _PITCH_SPREAD * rng.uniform(-1.0, 1.0, teeth)
    tool["pitch"] = [text(angle, "deg") for angle in _whole_turn(angles)]


def _whole_turn(angles: np.ndarray) -> list[float]:
    rounded = [round(float(angle), 2) for angle in 360.0 * angles / angles.sum()]
    rounded[-1] = round(360.0 - sum(rounded[:-1]), 2)
    return rounded


def with_helix_by_flute(rng: np.random.Generator, tool: Document) -> None:
    """Give each flute a helix of its own."""
    middle = number_of(tool["helix"])
    tool["helix"] = [
        text(angle, "deg")
        for angle in middle + _HELIX_SPREAD * rng.uniform(-1.0, 1.0, tool["teeth"])
    ]


def with_runout(rng: np.random.Generator, tool: Document) -> None:
    """Move the axis of the teeth off the spindle axis by 0.5 to 60 um."""
    most = min(60.0, 10.0 * number_of(tool["diameter"]))
    tool["runout"] = {
        "offset": text(log_uniform(rng, 0.5, most), "um"),
        "angle": text(rng.uniform(0.0, 360.0), "deg"),
    }


def with_setting_errors(rng: np.random.Generator, tool: Document) -> None:
    """Set each tooth off radially or axially by up to 30 um."""
    most = min(30.0, 10.0 * number_of(tool["diameter"]))
    for key in ("radial_error", "axial_error"):
        if happens(rng, 0.6):
            errors = most * rng.uniform(-1.0, 1.0, tool["teeth"])
            tool[key] = [text(error, "um") for error in errors]


def with_serration(rng: np.random.Generator, tool: Document) -> None:
    """Let the edge have waves of 0.02 to 0.4 mm."""
    most = min(0.4, 0.04 * number_of(tool["diameter"]))
    tool["serration"] = {
        "depth": text(log_uniform(rng, 0.1 * most, most), "mm"),
        "wavelength": text(log_uniform(rng, 0.8, 4.0), "mm"),
    }


def radius_of(tool: Document) -> float:
    """Half the diameter, m."""
    return 0.5e-3 * number_of(tool["diameter"])


def lag_of(tool: Document, depth: float) -> float:
    """Largest lag of an edge over a depth, m: rad."""
    helix = tool["helix"] if isinstance(tool["helix"], list) else [tool["helix"]]
    steepest = max(abs(number_of(angle)) for angle in helix)
    return depth * math.tan(math.radians(steepest)) / radius_of(tool)
