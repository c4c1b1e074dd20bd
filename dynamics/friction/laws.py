"""Friction laws by name, by specification and by table: where a new one joins.

A law joins by its module and one entry in the table here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.compiled import by_table
from dynamics.friction.coulomb_stribeck import (
    CoulombStribeck,
    CoulombStribeckTable,
    coulomb_stribeck_advance,
    coulomb_stribeck_force,
    coulomb_stribeck_step,
    coulomb_stribeck_table,
)
from dynamics.friction.lugre import (
    LuGre,
    LuGreTable,
    lugre_advance,
    lugre_force,
    lugre_step,
    lugre_table,
)
from dynamics.friction.smooth_coulomb import (
    SmoothCoulomb,
    SmoothCoulombTable,
    smooth_coulomb_advance,
    smooth_coulomb_force,
    smooth_coulomb_step,
    smooth_coulomb_table,
)
from dynamics.friction.tanh_hysteresis import (
    TanhHysteresis,
    TanhTable,
    tanh_advance,
    tanh_force,
    tanh_step,
    tanh_table,
)

FrictionLaw = LuGre | TanhHysteresis | CoulombStribeck | SmoothCoulomb


class LawEntry(NamedTuple):
    """A law: its specification, its table, and its leaves."""

    spec: type
    table: type
    columns: Callable[[Sequence[FrictionLaw], Sequence[int]], NamedTuple]
    step: Callable  # force held over a step
    force: Callable  # mean force over a motion at constant velocity
    advance: Callable  # moves the state on


#: name in machine files -> law; where a new one joins
ENTRIES = {
    "LuGre": LawEntry(LuGre, LuGreTable, lugre_table, lugre_step, lugre_force, lugre_advance),
    "tanh hysteresis": LawEntry(
        TanhHysteresis, TanhTable, tanh_table, tanh_step, tanh_force, tanh_advance
    ),
    "Coulomb-Stribeck": LawEntry(
        CoulombStribeck,
        CoulombStribeckTable,
        coulomb_stribeck_table,
        coulomb_stribeck_step,
        coulomb_stribeck_force,
        coulomb_stribeck_advance,
    ),
    "smooth Coulomb": LawEntry(
        SmoothCoulomb,
        SmoothCoulombTable,
        smooth_coulomb_table,
        smooth_coulomb_step,
        smooth_coulomb_force,
        smooth_coulomb_advance,
    ),
}
#: name -> specification
LAWS = {name: entry.spec for name, entry in ENTRIES.items()}
#: specification -> the law
BY_SPEC = {entry.spec: entry for entry in ENTRIES.values()}
#: held force, N, and motion of a law, m; see `implicit.held_force`
friction_step = by_table({entry.table: entry.step for entry in ENTRIES.values()})
#: moves the state of a law by a motion, m, in a time, s
friction_advance = by_table({entry.table: entry.advance for entry in ENTRIES.values()})


class Frictions(NamedTuple):
    """Frictions of one law, with what the time loop remembers of each."""

    law: NamedTuple  # table of the law; its column `port` says where each acts
    force: NDArray[np.float64]  # held over the last step, N, (n,)
    beyond: NDArray[np.float64]  # by which the law moves further than its port, m, (n,)
    sweeps: NDArray[np.int64]  # over all of them in this step, (1,)


def friction_groups(laws: Sequence[FrictionLaw], ports: Sequence[int]) -> tuple[Frictions, ...]:
    """Tables of frictions at rest, one a law that occurs, in the order of `ENTRIES`."""
    groups = []
    for kind, entry in BY_SPEC.items():
        chosen = [place for place, law in enumerate(laws) if isinstance(law, kind)]
        if chosen:
            columns = entry.columns([laws[i] for i in chosen], [ports[i] for i in chosen])
            force, beyond = np.zeros(len(chosen)), np.zeros(len(chosen))
            groups.append(Frictions(columns, force, beyond, np.zeros(1, dtype=np.int64)))
    return tuple(groups)
