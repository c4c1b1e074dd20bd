"""Harmonic response of a linearised machine, its control loops closed."""

from collections.abc import Callable, Mapping
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.control.response import controller_response
from dynamics.control.sampling import zero_order_hold_response
from dynamics.friction.laws import FrictionLaw
from dynamics.machine.description import Friction, Machine
from dynamics.reduction.modal_truncation import undamped_modes

#: cycles of a friction at an amplitude that stand for those at all frequencies
_CYCLES_GONE_THROUGH = 20
#: cycles of frictions kept
_KEPT_CYCLES = 4096
#: dynamic stiffness, N/m, of a friction at frequencies, Hz
Linearised = Callable[[FrictionLaw, NDArray[np.float64]], NDArray[np.complex128]]


def at_rest(law: FrictionLaw, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Friction under vanishing motion: its presliding stiffness; a dry one holds."""
    return np.asarray(law.stiffness_at_rest(frequency), dtype=np.complex128)


def at_velocity(velocity: float) -> Linearised:
    """Friction about a steady velocity, m/s (rad/s)."""

    def in_motion(law: FrictionLaw, frequency: NDArray) -> NDArray[np.complex128]:
        return np.asarray(law.stiffness_in_motion(frequency, velocity), dtype=np.complex128)

    return in_motion


def at_amplitude(amplitude: float) -> Linearised:
    """Friction under harmonic motion of an amplitude, m (rad), about rest.

    Its cycle is gone through at a few frequencies; in between the dynamic stiffness, which changes
    with speed alone, is interpolated over the logarithm of the frequency, keeping its trend.
    """

    def at(law: FrictionLaw, frequency: NDArray) -> NDArray[np.complex128]:
        pairs = [_gone_through(law, amplitude, float(line)) for line in frequency]
        return np.array(
            [k + 2j * np.pi * f * c for (k, c), f in zip(pairs, frequency, strict=True)]
        )

    def describing(law: FrictionLaw, frequency: NDArray) -> NDArray[np.complex128]:
        lines = np.asarray(frequency, dtype=np.float64)
        if lines.size <= _CYCLES_GONE_THROUGH:
            return at(law, lines)
        nodes = np.geomspace(lines.min(), lines.max(), _CYCLES_GONE_THROUGH)
        found = at(law, nodes)
        return sum(
            factor * scipy.interpolate.PchipInterpolator(np.log(nodes), part)(np.log(lines))
            for factor, part in ((1.0, found.real), (1j, found.imag))
        )

    return describing


@lru_cache(_KEPT_CYCLES)
def _gone_through(law: FrictionLaw, amplitude: float, line: float) -> tuple[float, float]:
    """Stiffness and damping of a law over a cycle; the same for all that ask."""
    return law.describing_function(amplitude, line)


def receptance(
    machine: Machine,
    frequency: ArrayLike,
    ports: NDArray[np.float64],
    step: float,
    frictions: Mapping[str, Linearised] | None = None,
    excited_axis: str | None = None,
) -> NDArray[np.complex128]:
    """Receptance between ports with drives under control and frictions linearised.

    Parameters
    ----------
    machine : Machine
    frequency : (m,) array of float
        Hz, above 0.
    ports : (p, n) array of float
        Rows of the structure.
    step : float
        Step of the simulation that the controllers are sampled on, s.
    frictions : mapping of str to callable, optional
        How each friction is linearised, by its name; those not named are left out.
    excited_axis : str, optional
        Axis whose motors together push with what the ports say, and no more: of their loops the
        differences between the motors are left, which turn against yaw.

    Returns
    -------
    (m, p, p) array of complex
        m/N and kin: motion of the first port per force on the second.

    Notes
    -----
    The loops are exact for the component at the frequency itself: z-domain controllers, dead
    times, and the hold of the torque over the step (`controller_response`); images of the
    sampling are left out, as a real analyser does.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    asked = np.atleast_2d(np.asarray(ports, dtype=np.float64))
    chosen = [one for one in machine.frictions if frictions and one.name in frictions]
    drives = machine.drives
    rows = np.vstack(
        [
            asked,
            *(drive.row for drive in drives),
            *(drive.scale for drive in drives),
            *(one.row for one in chosen),
        ]
    )
    free = structure_receptance(machine, lines, rows)
    count = len(asked)
    feedback = _feedback(machine, lines, step, chosen, frictions or {})
    excited = [index for index, drive in enumerate(drives) if drive.axis == excited_axis]
    if excited:
        feedback[:, excited] -= feedback[:, excited].mean(axis=1, keepdims=True)
    inner = slice(count, None)
    # u = R f + R_i F u_i: the loops see only their own ports
    loop = np.eye(feedback.shape[1]) - free[:, inner, inner] @ feedback
    closed = np.linalg.solve(loop, free[:, inner, :count])
    return free[:, :count, :count] + free[:, :count, inner] @ feedback @ closed


def structure_receptance(
    machine: Machine, frequency: NDArray[np.float64], rows: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Receptance (m, p, p) of the structure alone, through its undamped modes.

    Damping may couple the modes; it is then solved in full.
    """
    modes = undamped_modes(machine.structure)
    omega = 2.0 * np.pi * modes.frequency
    seen = rows @ modes.shapes
    damping = modes.shapes.T @ (machine.structure.damping @ modes.shapes)
    result = np.empty((len(frequency), len(rows), len(rows)), dtype=np.complex128)
    undamped = ~damping.any(axis=0)
    for index, line in enumerate(2.0 * np.pi * frequency):
        stiffness = omega**2 - line**2
        # infinite there: the least number that can be told from none
        stiffness[undamped & (stiffness == 0.0)] = np.spacing(line**2)
        dynamic = np.diag(stiffness) + 1j * line * damping
        result[index] = seen @ np.linalg.solve(dynamic, seen.T)
    return result


def _feedback(
    machine: Machine,
    lines: NDArray[np.float64],
    step: float,
    chosen: list[Friction],
    frictions: Mapping[str, Linearised],
) -> NDArray[np.complex128]:
    """Force on each inner port per motion of each, (m, q, q): drives, scales, frictions."""
    k = len(machine.drives)
    size = 2 * k + len(chosen)
    feedback = np.zeros((lines.size, size, size), dtype=np.complex128)
    hold = zero_order_hold_response(lines, step)
    for index, drive in enumerate(machine.drives):
        answer = controller_response(drive.controller, step, lines)
        feedback[:, index, index] = hold * answer.per_motor_angle(lines)
        feedback[:, index, k + index] = hold * answer.x_scale
    for index, one in enumerate(chosen, start=2 * k):
        feedback[:, index, index] = -frictions[one.name](one.law, lines)
    return feedback
