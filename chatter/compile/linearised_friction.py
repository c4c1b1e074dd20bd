"""Motion of a machine without strain, its frictions linearised about it, and FRFs with them."""

from collections.abc import Mapping, Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.machine.description import Machine
from dynamics.machine.harmonic import Linearised, at_amplitude, at_rest, at_velocity, receptance
from dynamics.reduction.modal_truncation import undamped_modes

#: of all that a drive can turn: what free motions turn it by where rounding alone does
_HELD = 1e-7
#: velocity of a friction, m/s or rad/s, below which it rests
RESTING = 1e-12


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


def closed_backlashes(machine: Machine) -> tuple[str, ...]:
    """Note on how a linear analysis takes the backlashes of a machine; empty without any."""
    if not machine.backlashes:
        return ()
    listed = ", ".join(f"{one.name} {one.law.gap * 1e6:.3g} um" for one in machine.backlashes)
    return (
        f"backlash ({listed}) is taken as closed, pressed on one flank by a steady load; a drive "
        "whose load reverses is softer than that (chatter move, chatter simulate)",
    )


def clamping_frictions(machine: Machine, taken: Mapping[str, Linearised]) -> tuple[str, ...]:
    """Note on dry frictions at rest, which hold without giving way; empty without any."""
    dry = [one.name for one in machine.frictions if isinstance(one.law, CoulombStribeck)]
    holding = ", ".join(name for name in dry if taken[name] is at_rest)
    if not holding:
        return ()
    return (
        f'dry friction at rest ({holding}) holds like a clamp in what is linearised; law = "lugre" '
        "has the spring of presliding, and a stated amplitude lets it slide",
    )


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
        if abs(one.row @ moving) > RESTING
        else _resting(one.name, amplitude)
        for one in machine.frictions
    }


def _resting(name: str, amplitude: float | Mapping[str, float] | None) -> Linearised:
    here = amplitude.get(name) if isinstance(amplitude, Mapping) else amplitude
    return at_rest if here is None else at_amplitude(here)


def rigid_motion(machine: Machine, axes: Mapping[str, float]) -> NDArray[np.float64]:
    """Motion (n,) of the structure, free of strain, in which axes move by given lengths.

    Travel (or velocity) of controlled axes, m; the others stay. InputError if an axis is not under
    control, or cannot move without strain.
    """
    return rigid_motions(machine, [axes])[0]


def rigid_motions(
    machine: Machine, several: Sequence[Mapping[str, float]]
) -> list[NDArray[np.float64]]:
    """Motions as `rigid_motion` gives each, by one modal analysis of the machine."""
    known = {drive.axis for drive in machine.drives}
    for name in chain(*several):
        if name not in known:
            there = ", ".join(f'"{one}"' for one in sorted(known)) or "none"
            raise InputError(
                f'axis "{name}" cannot be moved: it is not under control; there are {there}'
            )
    if not machine.drives:
        return [np.zeros(machine.structure.size) for _ in several]
    modes = undamped_modes(machine.structure)
    rows = np.array([drive.row for drive in machine.drives])
    turned = rows @ modes.shapes
    free = modes.frequency == 0.0
    # a drive that no free motion turns, but for rounding, is held
    held = np.linalg.norm(turned[:, free], axis=1) < _HELD * np.linalg.norm(turned, axis=1)
    rigid = np.where(held[:, None], 0.0, turned[:, free])
    return [modes.shapes[:, free] @ _shares(machine, rigid, axes) for axes in several]


def _shares(
    machine: Machine, rigid: NDArray[np.float64], axes: Mapping[str, float]
) -> NDArray[np.float64]:
    """Shares (k,) of the free motions, which turn the drives by (d, k), that move axes so far."""
    wanted = np.array(
        [
            axes.get(drive.axis, 0.0) / drive.controller.measuring.transmission
            for drive in machine.drives
        ]
    )
    share, *_ = np.linalg.lstsq(rigid, wanted, rcond=None)
    reached = rigid @ share
    if np.max(np.abs(reached - wanted)) > 1e-6 * np.max(np.abs(wanted), initial=1e-300):
        moved = ", ".join(axes)
        raise InputError(f"axes {moved} cannot move freely: something holds them besides the drive")
    return share
