"""Limits of ploughing flanks and of contacts against growth of small vibration in the time domain.

At 0.97 of a limit of the linear methods vibration has to die out in the simulated cut, at 1.03 it
has to grow: the 3 % that ploughing states, more than the 0.1 % of a limit and the 0.1 % of a
measured growth together. A growth within 0.1 % of none is not judged. Where the product notes that
the limit in the time domain may differ, the premise does not hold.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.contradictions.confrontation import (
    Comparison,
    Confrontation,
    Document,
    PremiseFailsError,
)
from benchmarks.contradictions.confrontations.multipliers import draw_vibrating
from benchmarks.contradictions.drawing import structure
from benchmarks.contradictions.drawing.quantities import happens, log_uniform, number_of, text
from benchmarks.contradictions.drawing.tool import radius_of
from benchmarks.contradictions.numbers import critical_depths
from chatter.description.case import Case
from chatter.stability.forced_vibration import neglected_in_steady_cut
from chatter.stability.methods.time_domain.critical_depths import growths
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS

_SHARES = (0.97, 1.03)
#: limits are searched to three times the depth of the cut, and then farther
_SEARCHED = (1.0, 6.0)
#: growth of a period that is none, as a logarithm
_NO_GROWTH = 1e-3
#: contact lengths of flanks, of the wave that the first mode leaves: longer ones are no dashpots
_LAND = (0.003, 0.045)
#: least radial depth over the diameter
_WIDTH = 0.15
#: stiffness of contacts over that of the first mode
_CONTACT = (0.003, 0.3)


def draw_wide(rng: np.random.Generator) -> Document:
    """A vibrating cut of some width: at less there is seldom a limit within reach of the tool."""
    while True:
        sections = draw_vibrating(rng)
        width = sections["cut"].get("radial_depth")
        if width is None or number_of(width) > _WIDTH * 2e3 * radius_of(sections["tool"]):
            return sections


def draw_ploughing(rng: np.random.Generator) -> Document:
    """A vibrating cut whose flank is worn, or its edge rounded, and ploughs."""
    sections = draw_wide(rng)
    viscous = structure.viscous_damping(rng, sections)
    mode = sections["structure"]["mode"][0]
    mode["damping"] = max(mode["damping"], 0.012)
    speed = number_of(sections["cut"]["spindle_speed"]) * math.pi / 30.0
    wave = speed * radius_of(sections["tool"]) / number_of(mode["frequency"])
    length = wave * log_uniform(rng, *_LAND)
    tool = {**sections["tool"], "clearance_angle": text(rng.uniform(3.0, 12.0), "deg")}
    if happens(rng, 0.8):
        tool["flank_wear"] = text(1e6 * length, "um")
    else:
        tool["edge_radius"] = text(1e6 * length, "um")
    # such that K l^2/4 is of the size of the viscous form, or a part of it
    indentation = 4.0 * log_uniform(rng, 0.1, 1.0) * number_of(viscous["coefficient"]) / length**2
    sections["process_damping"] = {
        "indentation_force": text(indentation, "N/m^3"),
        "friction": viscous["friction"],
    }
    return {**sections, "tool": tool}


def draw_in_contact(rng: np.random.Generator) -> Document:
    """A vibrating cut whose tool and work have a contact while they cut."""
    sections = draw_wide(rng)
    mode = sections["structure"]["mode"][0]
    stiffness = number_of(mode["stiffness"]) * log_uniform(rng, *_CONTACT)
    natural = 2.0 * math.pi * number_of(mode["frequency"])
    damping = stiffness / natural * rng.uniform(0.0, 0.2)
    return {
        **sections,
        "contact": {"stiffness": text(stiffness, "N/m"), "damping": text(damping, "N*s/m")},
    }


def compare_ploughing(document: Document) -> list[Comparison]:
    """Growth beside the limit by collocation."""
    return compare_growth(document, "collocation")


def compare_contact(document: Document) -> list[Comparison]:
    """Growth beside the limit by the matrix-free method, which alone of the linear ones has it."""
    return compare_growth(document, "matrix-free")


def compare_growth(document: Document, method: str) -> list[Comparison]:
    """Whether small vibration grows in cuts a little below and above a limit."""
    case = Case.from_dict(document)
    model = milling_model(case)
    limit = math.inf
    for times in _SEARCHED:
        if not math.isfinite(limit):
            deeper = case.patch({"cut.axial_depth": times * case.cut.axial_depth})
            limit, _ = critical_depths(milling_model(deeper), [method])[method]
    if not math.isfinite(limit):
        raise PremiseFailsError("there is no limit down to the maximum axial depth searched")
    at_limit = milling_model(case.patch({"cut.axial_depth": limit}))
    for effect in neglected_in_steady_cut(at_limit, METHODS[method]):
        raise PremiseFailsError(effect.note or effect.because)
    depths = limit * np.array(_SHARES)
    speeds = np.full(len(_SHARES), case.cut.spindle_speed)
    found = []
    for share, growth in zip(
        _SHARES, growths(case, model.structure.modes, speeds, depths), strict=True
    ):
        if abs(growth.radius - 1.0) > _NO_GROWTH:
            grows = float(growth.radius > 1.0)
            found.append(Comparison(f"growth at {share} of the limit", grows, share > 1.0, 0.5))
    return found


PLOUGHING = Confrontation(
    name="ploughing",
    ways="limit by collocation; growth of small vibration in the time domain at 0.97 and 1.03 of "
    "it",
    stated="dies out below, grows above, where the product does not note that the limit in the "
    "time domain may differ",
    weight=0.4,
    draw=draw_ploughing,
    compare=compare_ploughing,
)

CONTACT = Confrontation(
    name="contact",
    ways="limit by the matrix-free method; growth of small vibration in the time domain at 0.97 "
    "and 1.03 of it",
    stated="dies out below, grows above, where the product does not note that the limit in the "
    "time domain may differ",
    weight=0.4,
    draw=draw_in_contact,
    compare=compare_contact,
)
