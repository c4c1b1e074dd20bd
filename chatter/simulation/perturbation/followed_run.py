"""Runs that are followed turn by turn: from rest, or as the cut takes hold of the structure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.engine.loop import COLUMNS, Record, run
from chatter.simulation.setup import delayed, set_up
from chatter.simulation.spindle import prescribed
from cutting.chip.tool_point import tool_point
from dynamics.modal.modal_steps import modal_steps
from dynamics.modal.modes import Mode


def share_held(done: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of the cutting force that the structure feels when a share of the time is over.

    It begins and ends with no slope and no curvature, so that the tool keeps to its forced
    motion: what a jump in the slope would shake loose is all that later grows.
    """
    over = np.clip(done, 0.0, 1.0)
    return over**3 * (10.0 - 15.0 * over + 6.0 * over**2)


class FollowedRun:
    """Run with the delayed chip that goes on by a turn of the mean speed at a time.

    Parameters
    ----------
    case : Case
    modes : tuple of Mode
        Of its structure.
    taking_hold : int
        Turns in which the cut takes hold of the structure; 0 for at once.
    """

    def __init__(self, case: Case, modes: tuple[Mode, ...], taking_hold: int) -> None:
        self.setup = set_up(delayed(case), modes)
        self.bins = self.setup.resolution.steps_a_turn
        self.modes = modal_steps(self.setup.modes, self.setup.step)
        self._point = tool_point()
        self._scratch = np.zeros((len(self.setup.modes), 2))
        self._hold = taking_hold * self.bins
        self._done = -1
        state = (self.modes.state, self.modes.force)
        self._state = _arrays((self.setup.groups, state, self.setup.frictions, self._point))

    def turn(self) -> NDArray[np.float64] | None:
        """Go on by a turn; displacement (bins, 3), m, or None where the model is left."""
        setup, bins, done = self.setup, self.bins, self._done
        way = prescribed(setup.spindle, setup.path, bins, setup.step, done, bins)
        if self._hold:
            numbers = np.arange(done, done + bins + 1)
            way = way._replace(grip=share_held(numbers / self._hold))
        # the record of a turn begins anew; only the very first step is another one than all others
        first = min(done, 0)
        record = Record(1, np.zeros((bins + 1, len(COLUMNS))))
        did = run(
            setup.groups,
            self.modes,
            setup.frictions,
            self._point,
            way,
            record,
            self._scratch,
            first,
            setup.furthest,
            bins,
        )
        self._done += did
        return record.rows[first + 1 : first + 1 + bins, 3:6] if did == bins else None

    def come_closer(self, leader: FollowedRun, factor: float) -> None:
        """Scale the difference of the whole state from that of a leading run by a factor."""
        for own, led in zip(self._state, leader._state, strict=True):
            apart = own != led
            if own.dtype.kind != "f":
                own[...] = led
            elif apart.any():
                closer = led[apart] + factor * (own[apart] - led[apart])
                own[apart] = np.where(np.isfinite(closer), closer, led[apart])

    def push(self, size: float) -> None:
        """Displace every mode, m."""
        self.modes.state[:, 0] += size


def _arrays(held: object) -> list[NDArray]:
    """Arrays within nested tuples that a run may change, in their order, each once."""
    found: dict[int, NDArray] = {}

    def collect(part: object) -> None:
        if isinstance(part, np.ndarray) and part.flags.writeable:
            found.setdefault(id(part), part)
        elif isinstance(part, tuple):
            for inner in part:
                collect(inner)

    collect(held)
    return list(found.values())
