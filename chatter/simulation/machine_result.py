"""Result of a cut on a machine: signals of its drives beside those of the cut."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from chatter.description.units import rpm
from chatter.simulation.result import SimulationResult

#: port of the rotation of the tool
_TURNING = "tool turn"


@dataclass(frozen=True)
class MachineResult(SimulationResult):
    """Signals of a cut on a machine.

    Parameters
    ----------
    ports : mapping of str to int
        Column of each port of the machine in the following.
    moved, moving, driven : (n, p) array of float
        Displacement, m (rad), velocity, m/s, and force, N (N m), of the machine's ports: drives
        ("drive Y"), scales ("scale Y"), frictions ("friction guide"), the tool ("tool x").
    start_angle : float
        Of the spindle where the cut begins, rad.
    """

    ports: Mapping[str, int] = None
    moved: NDArray[np.float64] = None
    moving: NDArray[np.float64] = None
    driven: NDArray[np.float64] = None
    start_angle: float = 0.0

    @cached_property
    def spindle_angle(self) -> NDArray[np.float64]:
        """Angle (n,) turned by the spindle since the cut began, rad."""
        if not self.setup.turned_by_port:
            return super().spindle_angle
        return self.moved[:, self.ports[_TURNING]] - self.start_angle

    @cached_property
    def spindle_speed(self) -> NDArray[np.float64]:
        """Speed (n,) of the spindle, rad/s."""
        if not self.setup.turned_by_port:
            return super().spindle_speed
        return self.moving[:, self.ports[_TURNING]]

    def torque_of(self, drive: str) -> NDArray[np.float64]:
        """Torque (n,) of a drive by its name, N m (N of a linear one)."""
        return self.driven[:, self.ports[f"drive {drive}"]]

    def position_of(self, drive: str) -> NDArray[np.float64]:
        """Position (n,) at the scale of a drive's axis, m."""
        return self.moved[:, self.ports[f"scale {drive}"]]

    def summary(self) -> dict:
        """Return the content of summary.json."""
        told = super().summary()
        machine = self.setup.on_machine.machine
        told["machine"] = {
            "file": self.setup.on_machine.file.name,
            "drives": {
                drive.name: {
                    "peak_effort": float(np.abs(self.torque_of(drive.name)).max(initial=0.0)),
                    "mean_effort": float(self.torque_of(drive.name)[self.settled].mean()),
                }
                for drive in machine.drives
            },
            "spindle_speed_rpm": {
                "least": float(rpm(self.spindle_speed.min())),
                "mean": float(rpm(self.spindle_speed[self.settled].mean())),
            },
        }
        return told
