"""Forces of a rigid tool: the time loop against quadrature along the edge."""

from __future__ import annotations

import numpy as np

from benchmarks.contradictions.confrontation import Comparison, Confrontation, Document, relative
from benchmarks.contradictions.drawing.cut import any_cut
from benchmarks.contradictions.drawing.material import any_material
from benchmarks.contradictions.drawing.tool import any_tool
from benchmarks.contradictions.edge_quadrature import RigidCut
from chatter.description.case import Case
from chatter.simulation.simulate import simulate

_COMPONENTS = ("Fx, N", "Fy, N", "Fz, N", "torque, N m")
#: shares of the mean resultant and of the peak resultant; torque of its own mean and peak
_MEAN, _PEAK = 0.005, 0.01
#: of the peak, where an edge enters or leaves all at once between two samples of the quadrature
_SAMPLING = 0.015
#: angles at which whole courses are compared, besides those of the peaks
_ANGLES = 160


def draw_rigid(rng: np.random.Generator) -> Document:
    """Any rigid tool in any cut, with the delayed chip."""
    tool = any_tool(rng)
    return {
        "tool": tool,
        "material": any_material(rng),
        "cut": any_cut(rng, tool),
        "simulation": {"revolutions": 2},
    }


def compare_forces(document: Document) -> list[Comparison]:
    """Mean and peak forces and torque of the simulation against the quadrature."""
    case = Case.from_dict(document)
    result = simulate(case)
    settled = result.settled
    simulated = np.column_stack([result.force, result.torque])[settled].T
    angles = result.spindle_angle[settled]
    rigid = RigidCut(case)
    mean = rigid.mean()
    scale = [float(np.linalg.norm(mean[:3]))] * 3 + [float(mean[3])]
    means = np.append(result.mean_force, result.mean_torque)
    found = [
        relative(f"mean {name}", means[k], mean[k], _MEAN, scale[k])
        for k, name in enumerate(_COMPONENTS)
    ]
    # angles of the peaks, their neighbours, and others spread over the revolution
    peaks = np.argmax(np.abs(simulated), axis=1)
    spread = np.linspace(0, angles.size - 1, _ANGLES).astype(int)
    near = (peaks[:, None] + np.arange(-2, 3)).ravel()
    at = np.unique(np.mod(np.concatenate([near, spread]), angles.size))
    course = rigid.at(angles[at])
    shifted = rigid.at(angles[at] + 0.37 * (angles[1] - angles[0]))
    highest = np.linalg.norm(course[:3], axis=0).max()
    scale = [highest, highest, highest, float(np.abs(course[3]).max())]
    highest = np.append(result.peak_force, np.abs(result.torque).max())
    for k, name in enumerate(_COMPONENTS):
        jumps = _SAMPLING * scale[k] if rigid.jumps else 0.0
        one, aligned = float(highest[k]), float(np.abs(course[k]).max())
        # an extreme shorter than a step is met by samples at its very angle alone
        beside = float(np.abs(shifted[k]).max())
        other = float(np.clip(one, *sorted((aligned, beside))))
        found.append(Comparison(f"peak {name}", one, other, _PEAK * scale[k] + jumps))
    if not rigid.jumps:
        for k, name in enumerate(_COMPONENTS):
            off = float(np.sqrt(np.mean((simulated[k][at] - course[k]) ** 2)))
            found.append(relative(f"rms difference of {name}", off, 0.0, _PEAK, scale[k]))
    return found


RIGID_FORCES = Confrontation(
    name="rigid forces",
    ways="time loop with the delayed chip; quadrature along the edge from the definitions",
    stated="0.5 % of the mean and 1 % of the peak resultant: what the slices are chosen for; "
    "1.5 % more of the peak where the quadrature samples an edge that jumps",
    weight=4.0,
    draw=draw_rigid,
    compare=compare_forces,
)
