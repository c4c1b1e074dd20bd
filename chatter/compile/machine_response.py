"""FRFs of the machine of a case, linearised: at rest, moving at the feed of the cut, in the cut."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.compile.linearised_friction import linearised_frictions
from chatter.compile.linearised_machine import friction_amplitudes, moving_axes
from chatter.compile.machine_cut import MachineCut, cut_directions, machine_cut
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.machine.frequency_response import parse_tested_point
from dynamics.machine.harmonic import receptance
from dynamics.structure.linear_structure import StructureError

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_AXES = "xyz"
_ROTATIONS = ("x", "y", "z", "rx", "ry", "rz")
#: machines kept assembled, and receptances kept: FRFs of one state are asked for one by one
_KEPT_MACHINES, _KEPT_RESPONSES = 4, 8


class MachineState(NamedTuple):
    """State in which an FRF is measured."""

    moving: bool  # axes at the feed of [cut], or at rest
    in_cut: bool  # tool and workpiece touch


#: condition of an FRF in a measurement -> state
STATES = {
    "": MachineState(False, False),
    "idle": MachineState(False, False),
    "at_rest": MachineState(False, False),
    "moving": MachineState(True, False),
    "in_cut": MachineState(True, True),
    "in_cut_at_rest": MachineState(False, True),
}


def machine_response(
    case: Case, condition: str, read: str, excite: str, frequency: Array
) -> ComplexArray:
    """Receptance (m,) between two places of the machine of a case.

    Parameters
    ----------
    case : Case
        On a machine; its contact, or that of the machine file, holds in the cut.
    condition : str
        One of `STATES`.
    read, excite : str
        ``"x"``, ``"y"``, ``"z"``: tool against workpiece in the axes of the cut; else a place of
        the machine such as ``"table:y"`` or ``"motor:Y"``.
    frequency : (m,) array of float
        Hz, above 0.

    Returns
    -------
    (m,) array of complex
        m/N; rotations and torques in rad and N m.

    Raises
    ------
    InputError
        If there is no such place or condition, or the machine has no contact to be in the cut with.
    """
    if condition not in STATES:
        known = ", ".join(f'"{name}"' for name in STATES if name)
        raise InputError(f'condition: "{condition}" is none of a machine; there are {known}')
    state = STATES[condition]
    if state.moving:
        case.require("tool", "cut")
    places = tuple(dict.fromkeys(place for place in (read, excite) if place not in _AXES))
    # the contact is joined to what is free of it
    bare = case.model_copy(update={"contact": None})
    free = _responses(bare, state.moving, places, np.ascontiguousarray(frequency).tobytes())
    names = [*_AXES, *places]
    response = free
    if state.in_cut:
        response = joined(free, _contact(case, frequency, len(names)))
    return response[:, names.index(read), names.index(excite)]


def joined(free: ComplexArray, joint: ComplexArray) -> ComplexArray:
    """Receptance (m, p, p) of ports that a dynamic stiffness (m, p, p) joins."""
    return np.linalg.solve(np.eye(free.shape[1]) + free @ joint, free)


def _contact(case: Case, frequency: Array, ports: int) -> ComplexArray:
    """Dynamic stiffness (m, p, p) of tool and workpiece that touch; the first ports are x, y, z."""
    joint = np.zeros((frequency.size, ports, ports), dtype=np.complex128)
    along, contact = np.diag([1.0, 1.0, 0.0]), case.contact
    if contact is None:
        contact = case.machine_file().contact
        if contact is None:
            # a contact that is not there yet
            return joint
        rows = cut_directions(case)[:, [_AXES.index(axis) for axis in contact.directions]]
        along = rows @ rows.T
    stiffness = contact.stiffness + 2j * np.pi * frequency * contact.damping
    joint[:, :3, :3] = stiffness[:, None, None] * along
    return joint


@lru_cache(_KEPT_MACHINES)
def _machine_cut(case: Case) -> MachineCut:
    return machine_cut(case)


@lru_cache(_KEPT_RESPONSES)
def _responses(case: Case, moving: bool, places: tuple[str, ...], lines: bytes) -> ComplexArray:
    """Receptance (m, p, p) of the tool in x, y, z and of other places."""
    # the machine is the same whatever it cuts, and at rest
    cut = _machine_cut(case.model_copy(update={"tool": None, "cut": None, "material": None}))
    velocity = moving_axes(case, cut) if moving else {}
    # the vibration of a blow is small: frictions stick unless an amplitude is stated
    stated = None if case.structure.friction_amplitude is None else friction_amplitudes(case, cut)
    frictions = linearised_frictions(cut.machine, velocity, stated)
    ports = np.array([*cut.tool, *(_row(case, cut, place) for place in places)])
    return receptance(cut.machine, np.frombuffer(lines), ports, cut.file.step, frictions)


def _row(case: Case, cut: MachineCut, text: str) -> Array:
    """Row (n,) of a place of a machine."""
    try:
        place = parse_tested_point(text)
        if place.motor is None:
            direction = np.eye(6)[_ROTATIONS.index(place.direction)]
            return cut.machine.structure.port(place.point, direction, place.against)
    except (ValueError, StructureError) as error:
        raise InputError(f"{cut.file.name}: {error}") from error
    rows: Sequence[Array] = [one.row for one in cut.machine.drives if one.axis == place.motor]
    if not rows:
        raise InputError(f'{case.name}: axis "{place.motor}" of {cut.file.name} has no control')
    return np.mean(rows, axis=0)
