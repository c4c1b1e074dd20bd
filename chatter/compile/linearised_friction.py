"""Frictions of a machine linearised about its motion, and its FRFs with them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from chatter.compile.rigid_motion import rigid_motion
from dynamics.machine.description import Machine
from dynamics.machine.harmonic import Linearised, at_amplitude, at_rest, at_velocity, receptance

#: velocity of a friction, m/s or rad/s, below which it rests
_RESTING = 1e-12


def linearised_frf(
    machine: Machine,
    step: float,
    frequency: NDArray[np.float64],
    excited: NDArray[np.float64],
    read: NDArray[np.float64],
    velocity: Mapping[str, float] | None = None,
    amplitude: float | None = None,
) -> NDArray[np.complex128]:
    """Receptance (m,) of the linearised machine, its loops closed.

    Parameters
    ----------
    machine : Machine
    step : float
        On which the controllers are sampled, s.
    frequency : (m,) array of float
        Hz.
    excited, read : (n,) array of float
        Rows of the structure.
    velocity : mapping of str to float, optional
        Of axes that move, m/s; frictions that move with them slide, others stick.
    amplitude : float, optional
        Of the motion at every friction that does not slide, m (rad): their describing functions
        instead of their stiffness at rest.
    """
    frictions = linearised_frictions(machine, velocity or {}, amplitude)
    rows = np.array([read, excited])
    return receptance(machine, frequency, rows, step, frictions)[:, 0, 1]


def linearised_frictions(
    machine: Machine,
    velocity: Mapping[str, float],
    amplitude: float | Mapping[str, float] | None = None,
) -> dict[str, Linearised]:
    """How each friction is linearised in a state of motion, by its name.

    Parameters
    ----------
    machine : Machine
    velocity : mapping of str to float
        Of axes that move, m/s.
    amplitude : float or mapping of str to float, optional
        Of the motion at frictions that do not slide, m (rad): at all, or by their names; at those
        without one it vanishes.
    """
    moving = rigid_motion(machine, velocity) if velocity else np.zeros(machine.structure.size)
    return {
        one.name: at_velocity(float(one.row @ moving))
        if abs(one.row @ moving) > _RESTING
        else _resting(one.name, amplitude)
        for one in machine.frictions
    }


def _resting(name: str, amplitude: float | Mapping[str, float] | None) -> Linearised:
    here = amplitude.get(name) if isinstance(amplitude, Mapping) else amplitude
    return at_rest if here is None else at_amplitude(here)
