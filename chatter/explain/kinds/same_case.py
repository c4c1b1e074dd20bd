"""What follows from a case, made once for as long as that very case is asked for.

To compare cases by their content writes a machine as text, which takes longer than its FRF.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class OfSameCase(Generic[T]):
    """What follows from the last few cases, each told by its identity, and from something else.

    Parameters
    ----------
    most : int
        Answers kept.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._kept: OrderedDict[tuple[int, Hashable], tuple[Any, T]] = OrderedDict()
        self._lock = Lock()

    def of(self, case: Any, other: Hashable, make: Callable[[], T]) -> T:
        """Answer for a case and something else, made where it is not kept."""
        key = id(case), other
        with self._lock:
            kept = self._kept.get(key)
        if kept is not None:
            return kept[1]
        made = make()
        with self._lock:
            # with the case, whose identity no other has as long as it is kept
            self._kept[key] = case, made
            while len(self._kept) > self._most:
                self._kept.popitem(last=False)
        return made
