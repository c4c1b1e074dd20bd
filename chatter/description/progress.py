"""Type of the callable by which a computation reports its progress."""

from collections.abc import Callable

#: called with (done, total) parts of the work; may raise to give it up
Progress = Callable[[int, int], None]


def no_progress(done: int, total: int) -> None:
    """Report nothing."""


def begin(progress: Progress, description: str) -> None:
    """Announce another part of the work, which counts anew, to what can show its description."""
    announced = getattr(progress, "begin", None)
    if announced is not None:
        announced(description)
