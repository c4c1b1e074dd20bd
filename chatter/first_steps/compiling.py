"""Whether compiled code is being made at the moment: what is used for the first time takes long."""

from numba.core import event


class _Compilations(event.Listener):
    """Counts compilations under way."""

    def __init__(self) -> None:
        self.under_way = 0

    def on_start(self, event: event.Event) -> None:  # noqa: ARG002
        """Count a compilation that begins."""
        self.under_way += 1

    def on_end(self, event: event.Event) -> None:  # noqa: ARG002
        """Count a compilation that has ended."""
        self.under_way -= 1


_COMPILATIONS = _Compilations()
event.register("numba:compile", _COMPILATIONS)


def is_compiling() -> bool:
    """Whether something is being compiled in this process."""
    return _COMPILATIONS.under_way > 0
