"""The force laws: one module and one line here each, and their leaves for the kernels."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from cutting.force.exponential import EXPONENTIAL
from cutting.force.law import ForceLaw, ForceLawEntry
from cutting.force.linear import LINEAR
from cutting.force.oblique import OBLIQUE
from cutting.leaves import by_table

#: the laws of this package, in the order in which they are listed
LAWS: tuple[ForceLawEntry, ...] = (LINEAR, EXPONENTIAL, OBLIQUE)

_LEAVES: dict[type, Callable] = {}


def include(law: ForceLawEntry) -> None:
    """Make a law known to the kernels."""
    _LEAVES[law.table] = law.spec.leaf


for _law in LAWS:
    include(_law)

#: tangential, radial and axial force per length of edge, N/m, by the law of a table
edge_force = by_table(_LEAVES)


def edge_law_table(laws: Sequence[ForceLaw]) -> NamedTuple:
    """Table of a force law, given for each tooth (the helix may differ among them)."""
    return laws[0].table(laws)
