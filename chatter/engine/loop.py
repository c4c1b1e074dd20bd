"""The time loop, compiled: laws on the ports of a structure.

A cut on modes, a cut on a machine and a machine alone are the same loop; what differs is the laws
and the structure behind the ports. A step is predicted with the forces at its beginning held and
corrected once with the change of those that depend on the motion at its end; frictions are solved
last, together with the motion.
"""

from typing import NamedTuple

from numba import njit

from chatter.engine.bus import Clock
from chatter.engine.dispatch import all_commit, all_forces
from chatter.engine.presets import TIME_LOOP
from dynamics.machine.ports import correct, predict
from dynamics.machine.steps import begin_step, end_step


class Laws(NamedTuple):
    """Law groups by when in a step their forces are known."""

    explicit: tuple = ()  # at its beginning: drives, constant forces, loads
    interacting: tuple = ()  # at its end, by the predicted motion: the cut
    implicit: tuple = ()  # together with the motion: frictions
    observers: tuple = ()  # never: records


@njit(**TIME_LOOP)
def run(laws, bus, first, before, count):
    """Run a chunk of steps.

    Parameters
    ----------
    laws : Laws
    bus : StructureSteps
    first : int
        Number of the first step. Before step 0 the structure stays where it is; the last of those
        steps sets the forces with which it starts.
    before : int
        Steps that controllers have run before step 0.
    count : int
        Steps to do.

    Returns
    -------
    int
        Steps done; fewer than asked where a law has left its range.
    """
    bus.halted[0] = 0
    for i in range(count):
        clock = Clock(before + first + i, first + i, i)
        moves = clock.step >= 0
        if moves:
            begin_step(bus)
            all_forces(laws.explicit, bus, clock)
            predict(bus)
        all_forces(laws.interacting, bus, clock)
        if moves:
            correct(bus)
            all_forces(laws.implicit, bus, clock)
            all_commit(laws.implicit, bus, clock)
        all_commit(laws.interacting, bus, clock)
        if bus.halted[0] != 0:
            return i
        all_commit(laws.observers, bus, clock)
        if moves:
            end_step(bus)
    return count
