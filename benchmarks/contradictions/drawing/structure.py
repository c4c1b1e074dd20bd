"""Random structures: modes on either side and along any direction; process damping."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.contradictions.confrontation import Document
from benchmarks.contradictions.drawing.cut import reaching
from benchmarks.contradictions.drawing.material import tangential_coefficient
from benchmarks.contradictions.drawing.quantities import (
    chosen,
    happens,
    log_uniform,
    number_of,
    text,
)
from benchmarks.contradictions.drawing.tool import radius_of

_AXES = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
#: limits lie at this share of the diameter, about
_LIMIT_SHARE = (0.01, 0.3)
#: vibrations within a revolution, of the first mode: more are slow, fewer are beyond any lobe
_WAVES_A_REVOLUTION = (0.3, 40.0)
#: force along a mode over the force on an edge, times chip along a mode over its motion, about
_MEAN_PROJECTION = 0.25


def modes(rng: np.random.Generator, sections: Document) -> list[Document]:
    """One to four modes whose limits lie within the reach of the tool."""
    tool, cut = sections["tool"], sections["cut"]
    limit = 2.0 * radius_of(tool) * log_uniform(rng, *_LIMIT_SHARE)
    a_second = number_of(cut["spindle_speed"]) / 60.0
    first = a_second * log_uniform(rng, *_WAVES_A_REVOLUTION)
    first = min(max(first, 40.0), 6000.0)
    found = []
    for index in range(int(rng.integers(1, 5))):
        damping = log_uniform(rng, 0.006, 0.08)
        stiffness = limit * cutting_stiffness(sections) / (2.0 * damping)
        direction = _AXES[index % 2] if happens(rng, 0.6) else _any_direction(rng)
        found.append(
            {
                "frequency": text(first * log_uniform(rng, 0.7, 2.5) ** min(index, 1), "Hz"),
                "damping": round(damping, 5),
                "stiffness": text(stiffness * log_uniform(rng, 0.5, 3.0), "N/m"),
                "direction": direction,
                "side": "tool" if happens(rng, 0.75) else "workpiece",
            }
        )
    return found


def cutting_stiffness(sections: Document) -> float:
    """Rough change of the cutting force over chip and depth, N/m^2, averaged over a revolution."""
    tool, cut = sections["tool"], sections["cut"]
    share = 1.0
    if cut["mode"] != "slot":
        within = 1.0 - 1e-3 * number_of(cut["radial_depth"]) / radius_of(tool)
        share = math.acos(max(within, -1.0)) / math.pi
    return tangential_coefficient(sections["material"]) * tool["teeth"] * _MEAN_PROJECTION * share


def _any_direction(rng: np.random.Generator) -> list[float]:
    vector = rng.normal(size=3)
    vector /= np.linalg.norm(vector)
    return [round(float(part), 9) for part in vector]


def at_depth_of_limits(rng: np.random.Generator, sections: Document) -> Document:
    """The case with an axial depth near the limits of its modes."""
    stiffness = [number_of(mode["stiffness"]) for mode in sections["structure"]["mode"]]
    damping = [mode["damping"] for mode in sections["structure"]["mode"]]
    softest = min(2.0 * k * d for k, d in zip(stiffness, damping, strict=True))
    depth = softest / cutting_stiffness(sections) * log_uniform(rng, 0.3, 3.0)
    depth = min(depth, 3.0 * radius_of(sections["tool"]))
    cut = {**sections["cut"], "axial_depth": text(1e3 * depth, "mm")}
    return {**sections, "cut": reaching(sections["tool"], cut)}


def viscous_damping(rng: np.random.Generator, sections: Document) -> Document:
    """Process damping in its viscous form, that matters: a share of that of the modes."""
    mode = sections["structure"]["mode"][0]
    stiffness, natural = number_of(mode["stiffness"]), number_of(mode["frequency"])
    natural *= 2.0 * math.pi
    dashpot = 2.0 * mode["damping"] * stiffness / natural
    depth = 1e-3 * number_of(sections["cut"]["axial_depth"])
    speed = number_of(sections["cut"]["spindle_speed"]) * math.pi / 30.0
    speed *= radius_of(sections["tool"])
    coefficient = dashpot * speed / depth * log_uniform(rng, 0.05, 2.0)
    return {
        "coefficient": text(coefficient, "N/m"),
        "friction": chosen(rng, (0.0, 0.3, round(rng.uniform(0.0, 0.6), 2))),
    }
