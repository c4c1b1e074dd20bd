"""What a linear limit leaves out, and between which bounds the true limit then lies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from chatter.description.arrays import Array
from chatter.io.result_files import finite_or_none

#: verdicts on a cut
STABLE, CHATTER, NOT_CERTAIN = "stable", "chatter", "not certain"
#: name of the effect whose bound holds at every speed
EDGE_FORCES = "edge forces"


class NeglectedEffect(NamedTuple):
    """An effect that the limit of a linear method leaves out, and what it may do to that limit."""

    name: str
    share: float  # the number that decides, see `because`; nan where there is none
    lowest: float  # the true limit is at least this factor times the linear one; 0 where unknown
    highest: float  # and at most this factor; inf where unknown
    because: str  # clause that goes behind a verdict
    note: str  # empty where the model says it already
    because_higher: str = ""  # clause behind one of chatter; as `because` where empty

    def summary(self) -> dict:
        """Return the effect as JSON knows it."""
        return {
            "effect": self.name,
            "share": finite_or_none(self.share),
            "limit_at_least": self.lowest,
            "limit_at_most": finite_or_none(self.highest),
            "because": self.because,
        }


def notes_of(effects: Sequence[NeglectedEffect]) -> tuple[str, ...]:
    """Return the notes of effects."""
    return tuple(effect.note for effect in effects if effect.note)


def lowest_factor(effects: Sequence[NeglectedEffect]) -> float:
    """Factor of a linear limit that all effects together leave of it at least."""
    return math.prod(effect.lowest for effect in effects)


def highest_factor(effects: Sequence[NeglectedEffect]) -> float:
    """Factor of a linear limit to which all effects together may raise it; inf where unknown."""
    return math.prod(effect.highest for effect in effects)


def reasons_of(effects: Sequence[NeglectedEffect], *, stable: bool) -> list[str]:
    """Clauses on effects that may turn a linear verdict: of stable or of chatter."""
    if stable:
        return [effect.because for effect in effects if effect.lowest < 1.0]
    return [effect.because_higher or effect.because for effect in effects if effect.highest > 1.0]


def deciding(
    effects: Sequence[NeglectedEffect],
    depth: float,
    crossings: Array,
    known: float,
    *,
    stable: bool,
) -> tuple[NeglectedEffect, ...]:
    """Effects that could turn the linear verdict on a cut; none where it stands.

    Parameters
    ----------
    effects : sequence of NeglectedEffect
    depth : float
        Axial depth of the cut, m.
    crossings : (n,) array of float
        Linear limits at its speed, m, rising.
    known : float
        Depth, m, above which a limit lies that was not found.
    stable : bool
        The linear verdict.
    """
    if stable:
        above = [limit for limit in crossings if limit > depth]
        limit = above[0] if above else max(known, depth)
        if depth < limit * lowest_factor(effects):
            return ()
        return tuple(effect for effect in effects if effect.lowest < 1.0)
    below = [limit for limit in crossings if limit <= depth]
    if not (below and depth < below[-1] * highest_factor(effects)):
        return ()
    return tuple(effect for effect in effects if effect.highest > 1.0)
