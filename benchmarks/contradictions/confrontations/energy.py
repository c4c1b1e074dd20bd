"""Work of the cutting force: its account in the time loop against the record."""

from __future__ import annotations

import numpy as np

from benchmarks.contradictions.confrontation import Comparison, Confrontation, Document, relative
from benchmarks.contradictions.confrontations.multipliers import draw_any_speed
from chatter.description.case import Case
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup

#: of the largest of work, loss and store; straight edges jump within a step of the record
_BALANCE, _RECORD = 1e-3, 0.02


def draw_vibrating(rng: np.random.Generator) -> Document:
    """Any vibrating cut, for four revolutions."""
    return {**draw_any_speed(rng), "simulation": {"revolutions": 4}}


def compare_energy(document: Document) -> list[Comparison]:
    """Balance of work, dissipation and store, and the work by the record."""
    result, _ = run_setup(set_up(Case.from_dict(document)))
    energy = result.energy
    scale = max(abs(value) for value in energy.values())
    ends = energy["dissipated"] + energy["stored"]
    found = [relative("work on the structure, J", energy["work"], ends, _BALANCE, scale)]
    middle = 0.5 * (result.force[1:] + result.force[:-1])
    way = np.diff(result.displacement, axis=0)
    turnover = float(np.abs(middle * way).sum())
    work = float((middle * way).sum())
    if result.setup.resolution.stride == 1:
        found.append(relative("work by the record, J", work, energy["work"], _RECORD, turnover))
    # a straight edge jumps between samples: the mean keeps its impulse, the samples do not
    power = float((result.torque * result.spindle_speed)[result.settled].mean())
    scale = float(np.abs(result.power).max())
    found.append(relative("mean power, W", result.mean_power, power, _RECORD, scale))
    return found


ENERGY = Confrontation(
    name="energy",
    ways="work as the time loop accounts it; dissipated and stored energy; force times "
    "displacement of the record; power; torque times speed",
    stated="0.1 % of the larger; 2 % of the turnover by the record, whose forces jump in a step",
    weight=2.0,
    draw=draw_vibrating,
    compare=compare_energy,
)
