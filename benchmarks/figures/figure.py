"""A figure that was asked for, and how it is measured."""

import time
from collections.abc import Callable
from typing import NamedTuple


class Reached(NamedTuple):
    """What was measured in one run."""

    value: float  # in the unit of the figure
    bound: str = ""  # that this processor or this Python sets, and the share reached
    peer: str = ""  # another way to the same answer


class Figure(NamedTuple):
    """A figure."""

    name: str
    work: str
    wanted: float
    unit: str
    measured: Callable[[], Reached]
    more_is_better: bool = False

    def is_met(self, reached: Reached) -> bool:
        """Whether what was measured is what is wanted."""
        if self.more_is_better:
            return reached.value >= self.wanted
        return reached.value <= self.wanted


def shortest(call: Callable[[], object], repeats: int = 3) -> float:
    """Wall time (s) of the shortest of some runs, after one that is not counted."""
    call()
    taken = []
    for _ in range(repeats):
        begun = time.perf_counter()
        call()
        taken.append(time.perf_counter() - begun)
    return min(taken)
