"""Motion of a machine's ports when its axes move and nothing is strained."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError
from dynamics.machine.description import Machine
from dynamics.reduction.modal_truncation import undamped_modes


def rigid_motion(machine: Machine, axes: Mapping[str, float]) -> NDArray[np.float64]:
    """Motion (n,) of the structure, free of strain, in which axes move by given lengths.

    Parameters
    ----------
    machine : Machine
    axes : mapping of str to float
        Travel (or velocity) of controlled axes, m; the others stay.

    Raises
    ------
    InputError
        If an axis is not under control, or cannot move without strain.
    """
    known = {drive.axis for drive in machine.drives}
    for name in axes:
        if name not in known:
            there = ", ".join(f'"{one}"' for one in sorted(known)) or "none"
            raise InputError(
                f'axis "{name}" cannot be moved: it is not under control; there are {there}'
            )
    modes = undamped_modes(machine.structure)
    free = modes.shapes[:, modes.frequency == 0.0]
    if not machine.drives:
        return np.zeros(machine.structure.size)
    rows = np.array([drive.row for drive in machine.drives])
    wanted = np.array(
        [
            axes.get(drive.axis, 0.0) / drive.controller.measuring.transmission
            for drive in machine.drives
        ]
    )
    share, *_ = np.linalg.lstsq(rows @ free, wanted, rcond=None)
    reached = rows @ free @ share
    if np.max(np.abs(reached - wanted)) > 1e-6 * np.max(np.abs(wanted), initial=1e-300):
        moved = ", ".join(axes)
        raise InputError(f"axes {moved} cannot move freely: something holds them besides the drive")
    return free @ share
