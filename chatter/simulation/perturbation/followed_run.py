"""Runs that are followed revolution by revolution: from rest, or through a force ramp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.simulation.cut_run import CutRun
from chatter.simulation.setup import Setup, set_up_on_modes
from dynamics.modal.modes import Mode


def displace_modes(setup: Setup, size: float) -> None:
    """Displace every mode of a cut on modes, m; frictions on them do not see that as motion."""
    bus = setup.structure.tables.bus
    bus.state[0::2] += size
    rubbing = len("xyz")
    bus.u[rubbing:] += size


def force_share(done: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of the cutting force that the structure feels when a share of the force ramp is over.

    It begins and ends with no slope and no curvature, so that the tool keeps to its forced
    motion: what a jump in the slope would shake loose is all that later grows.
    """
    over = np.clip(done, 0.0, 1.0)
    return over**3 * (10.0 - 15.0 * over + 6.0 * over**2)


class FollowedRun:
    """Run with the delayed chip that goes on by a revolution of the mean speed at a time.

    The modes are those of the structure of the case; the force ramp takes `ramp` revolutions, 0 for
    none.
    """

    def __init__(self, case: Case, modes: tuple[Mode, ...], ramp: int) -> None:
        self.setup = set_up_on_modes(case, modes)
        self.bins = self.setup.resolution.steps_per_revolution
        self._ramp = ramp * self.bins
        self._run = CutRun(self.setup, 1, self.bins)
        tables = self.setup.structure.tables
        state = (self.setup.groups, tables.bus, tables.implicit[1:], self._run.point)
        self._state = _arrays(state)

    def revolve(self) -> NDArray[np.float64] | None:
        """Go on by a revolution; displacement (bins, 3), m, or None where the model is left."""
        begin = self._run.done
        share = None if not self._ramp else lambda number: force_share(number / self._ramp)
        # the record of a revolution begins anew
        self._run.record(1, begin + 1, self.bins - 1)
        done = self._run.steps(begin + self.bins, share)
        return self._run.rows[:, 3:6] if done == begin + self.bins else None

    def come_closer(self, leader: FollowedRun, factor: float) -> None:
        """Scale the difference of the whole state from that of a leading run by a factor."""
        for own, led in zip(self._state, leader._state, strict=True):
            apart = own != led
            if own.dtype.kind != "f":
                own[...] = led
            elif apart.any():
                closer = led[apart] + factor * (own[apart] - led[apart])
                own[apart] = np.where(np.isfinite(closer), closer, led[apart])

    def displace(self, size: float) -> None:
        """Displace every mode, m."""
        displace_modes(self.setup, size)


def _arrays(held: object) -> list[NDArray]:
    """Arrays within nested tuples that a run may change, in their order, each once.

    An array that is the beginning of an earlier one, as the motion of a tool point on modes is that
    of the first ports, is the same memory.
    """
    found: dict[int, NDArray] = {}

    def collect(part: object) -> None:
        if isinstance(part, np.ndarray) and part.flags.writeable:
            found.setdefault(part.ctypes.data, part)
        elif isinstance(part, tuple):
            for inner in part:
                collect(inner)

    collect(held)
    return list(found.values())
