"""The friction laws: one module and one line here each, and their tables for the time loops."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.friction.coulomb_stribeck import COULOMB_STRIBECK
from dynamics.friction.law import FrictionLaw, FrictionLawEntry, FrictionTable
from dynamics.friction.lugre import LUGRE
from dynamics.friction.smooth_coulomb import SMOOTH_COULOMB
from dynamics.friction.tanh_hysteresis import TANH_HYSTERESIS
from dynamics.leaves import by_table

#: the laws of this package, in the order in which they are listed
LAWS: tuple[FrictionLawEntry, ...] = (LUGRE, TANH_HYSTERESIS, COULOMB_STRIBECK, SMOOTH_COULOMB)

#: specification -> law, of this package and of others that were included
BY_SPEC: dict[type, FrictionLawEntry] = {}
_STEP: dict[type, object] = {}
_ADVANCE: dict[type, object] = {}


def include(law: FrictionLawEntry) -> None:
    """Make a law known to the time loops."""
    BY_SPEC[law.spec] = law
    _STEP[law.table] = law.step
    _ADVANCE[law.table] = law.advance


for _law in LAWS:
    include(_law)

#: held force, N, and motion of a law, m; see `implicit.implicit_force`
friction_step = by_table(_STEP)
#: moves the state of a law by a motion, m, in a time, s
friction_advance = by_table(_ADVANCE)


class Frictions(NamedTuple):
    """Frictions of one law, with what the time loop remembers of each."""

    law: FrictionTable
    force: NDArray[np.float64]  # held over the last step, N, (n,)
    beyond: NDArray[np.float64]  # by which the law moves further than its port, m, (n,)


def friction_groups(laws: Sequence[FrictionLaw], ports: Sequence[int]) -> tuple[Frictions, ...]:
    """Tables of frictions at rest, one a law that occurs, in the order of `LAWS`."""
    groups = []
    for kind, entry in BY_SPEC.items():
        chosen = [index for index, law in enumerate(laws) if isinstance(law, kind)]
        if chosen:
            columns = entry.columns([laws[i] for i in chosen], [ports[i] for i in chosen])
            force, beyond = np.zeros(len(chosen)), np.zeros(len(chosen))
            groups.append(Frictions(columns, force, beyond))
    return tuple(groups)
