"""A simulated cut against itself with twice the steps and slices.

Steps and slices are chosen for ``simulation.force_tolerance``: 0.5 % of mean forces, 1 % of peaks,
of the resultant. Displacements are stated to be within 0.6 %. Twice the steps of a method of second
order have a quarter of the error, so that a move by the whole tolerance is more than is stated.
"""

from __future__ import annotations

import numpy as np

from benchmarks.contradictions.confrontation import (
    Comparison,
    Confrontation,
    Document,
    PremiseFailsError,
    relative,
)
from benchmarks.contradictions.confrontations.multipliers import draw_any_speed
from benchmarks.contradictions.numbers import spectral_radius
from chatter.description.case import Case
from chatter.simulation.result import SimulationResult
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup

_MEAN, _PEAK, _DISPLACEMENT = 0.005, 0.01, 0.006
#: vibration that dies out more slowly magnifies what rounding of a step leaves
_LARGEST_RADIUS = 0.97


def draw_resolved(rng: np.random.Generator) -> Document:
    """Any vibrating cut, for eight turns."""
    return {**draw_any_speed(rng), "simulation": {"revolutions": 8}}


def compare_resolutions(document: Document) -> list[Comparison]:
    """Numbers of the summary at the chosen steps and slices, and at twice as many."""
    case = Case.from_dict(document)
    if spectral_radius(case)[0] > _LARGEST_RADIUS:
        raise PremiseFailsError("vibration grows, or hardly dies out")
    setup = set_up(case)
    finer = case.patch(
        {
            "simulation.steps": 2 * setup.resolution.steps_per_revolution,
            "simulation.slices": 2 * len(setup.slices.height),
        }
    )
    return summaries_compared(run_setup(setup)[0], run_setup(set_up(finer))[0])


def summaries_compared(one: SimulationResult, other: SimulationResult) -> list[Comparison]:
    """Mean and peak forces, mean torque, largest displacement."""
    mean, peak = (float(np.linalg.norm(each)) for each in (other.mean_force, other.peak_force))
    found = [
        relative(f"mean {name}, N", one.mean_force[k], other.mean_force[k], _MEAN, mean)
        for k, name in enumerate(("Fx", "Fy", "Fz"))
    ]
    found += [
        relative(f"peak {name}, N", one.peak_force[k], other.peak_force[k], _PEAK, peak)
        for k, name in enumerate(("Fx", "Fy", "Fz"))
    ]
    found.append(relative("mean torque, N m", one.mean_torque, other.mean_torque, _MEAN))
    farthest = [float(np.linalg.norm(each.displacement, axis=1).max()) for each in (one, other)]
    found.append(relative("peak displacement, m", *farthest, _DISPLACEMENT))
    return found


RESOLUTION = Confrontation(
    name="resolution doubled",
    ways="summary of a simulated cut at the chosen steps and slices; at twice as many",
    stated="0.5 % of the mean and 1 % of the peak resultant, 0.5 % of the mean torque, 0.6 % of "
    "the peak displacement",
    weight=1.0,
    draw=draw_resolved,
    compare=compare_resolutions,
)
