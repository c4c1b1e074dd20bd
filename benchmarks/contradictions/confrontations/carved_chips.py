"""Rigid forces of carved workpieces: dexels and voxels against quadrature along trochoids.

Dexels keep to ``simulation.force_tolerance``: 0.5 % of the mean resultant, 1 % of the peak one.
Voxels state their own error of mean forces in a note of the run; nothing is stated of their peaks.
"""

from __future__ import annotations

import re

import numpy as np

from benchmarks.contradictions.confrontation import (
    Comparison,
    Confrontation,
    Document,
    PremiseFailsError,
    relative,
)
from benchmarks.contradictions.drawing import cut, material, tool
from benchmarks.contradictions.drawing.quantities import chosen, happens, log_uniform, text
from benchmarks.contradictions.trochoid_cut import TrochoidCut
from chatter.description.case import Case
from chatter.simulation.result import SimulationResult
from chatter.simulation.simulate import simulate

_COMPONENTS = ("Fx, N", "Fy, N", "Fz, N", "torque, N m")
#: shares of the mean and of the peak resultant; torque of its own mean and peak
_MEAN, _PEAK = 0.005, 0.01
#: of the peak, where an edge enters or leaves all at once between two samples of the quadrature
_SAMPLING = 0.015
#: the tool carves its way before the start; the last turns are compared
_TURNS = 4
#: angles of a turn at which peaks of the quadrature are looked for
_ANGLES = 720
#: deeper cuts have more layers than are quick
_DEEPEST_SHARE = 0.6
_NARROW = "not thin against the radius"
_STATED = re.compile(r"mean forces are read to about ([\d.]+) %")


def draw_carved(rng: np.random.Generator) -> Document:
    """Rigid tool of up to four teeth, without setting errors along the axis, in a carved stock."""
    kind = chosen(rng, (tool.end_mill, tool.end_mill, tool.ball, tool.bull_nose, tool.taper))
    tool_ = kind(rng)
    tool_["teeth"] = min(tool_["teeth"], 4)
    tool_["diameter"] = text(log_uniform(rng, 3.0, 32.0), "mm")
    if "corner_radius" in tool_:
        share = log_uniform(rng, 0.05, 0.9)
        tool_["corner_radius"] = text(1e3 * share * tool.radius_of(tool_), "mm")
    for deviation, probability in (
        (tool.with_unequal_pitch, 0.3),
        (tool.with_helix_by_flute, 0.1),
        (tool.with_runout, 0.3),
    ):
        if happens(rng, probability):
            deviation(rng, tool_)
    cut_ = cut.any_cut(rng, tool_)
    depth = 2.0 * tool.radius_of(tool_) * log_uniform(rng, 0.01, _DEEPEST_SHARE)
    cut_ = cut.reaching(tool_, {**cut_, "axial_depth": text(1e3 * depth, "mm")})
    chip = "voxel" if happens(rng, 0.15) else "dexel"
    return {
        "tool": tool_,
        "material": material.any_material(rng),
        "cut": cut_,
        "simulation": {"chip": chip, "revolutions": _TURNS},
    }


def compare_carved(document: Document) -> list[Comparison]:
    """Mean forces and torque, and peaks of dexels, against the quadrature."""
    case = Case.from_dict(document)
    result = simulate(case)
    narrow = [note for note in result.notes if _NARROW in note]
    if narrow:
        raise PremiseFailsError(narrow[0])
    rigid = TrochoidCut(case)
    mean = rigid.mean()
    scale = [float(np.linalg.norm(mean[:3]))] * 3 + [float(mean[3])]
    means = np.append(result.mean_force, result.mean_torque)
    share = _MEAN + _stated_error(result)
    found = [
        relative(f"mean {name}", means[k], mean[k], share, scale[k])
        for k, name in enumerate(_COMPONENTS)
    ]
    if case.simulation.chip == "dexel":
        found += _peaks(result, rigid)
    return found


def _stated_error(result: SimulationResult) -> float:
    """Error of mean forces that a note of the run states, relative."""
    stated = [match for note in result.notes if (match := _STATED.search(note))]
    return 0.01 * float(stated[0].group(1)) if stated else 0.0


def _peaks(result: SimulationResult, rigid: TrochoidCut) -> list[Comparison]:
    """Largest of the rows of the last turns beside those of the quadrature at the same angles."""
    settled = result.settled
    simulated = np.abs(np.column_stack([result.force, result.torque])[settled].T)
    angles = result.spindle_angle[settled]
    near = (np.argmax(simulated, axis=1)[:, None] + np.arange(-2, 3)).ravel()
    spread = np.linspace(0, angles.size - 1, _ANGLES).astype(int)
    at = np.unique(np.mod(np.concatenate([near, spread]), angles.size))
    course = np.abs(rigid.at(angles[at]))
    resultant = float(np.linalg.norm(course[:3], axis=0).max())
    scale = (resultant, resultant, resultant, float(course[3].max()))
    share = _PEAK + (_SAMPLING if rigid.jumps else 0.0)
    return [
        relative(f"peak {name}", simulated[k].max(), course[k].max(), share, scale[k])
        for k, name in enumerate(_COMPONENTS)
    ]


CARVED_CHIPS = Confrontation(
    name="carved chips",
    ways="time loop with dexels or voxels; quadrature along the edge on true trochoids",
    stated="dexels 0.5 % of the mean and 1 % of the peak resultant, the tolerance that they keep "
    "to, 1.5 % more of the peak where an edge jumps; voxels 0.5 % and the error of their note, of "
    "the mean alone",
    weight=1.0,
    draw=draw_carved,
    compare=compare_carved,
)
