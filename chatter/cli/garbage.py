"""The garbage collector is off while a command starts, and has nothing to look for when it ends.

It would look ten times through all that the imports have made, in which nothing is garbage: an
eighth of the time of a short command.
"""

import gc


def start_without_collection() -> None:
    """Switch the collector off, until there is work of some length."""
    gc.disable()


def collect_from_here() -> None:
    """Switch the collector on for what is made from here on, where it is off."""
    if not gc.isenabled():
        gc.freeze()
        gc.enable()


def end_without_collection() -> None:
    """Let the process end without a last look at all that it has."""
    gc.freeze()
    gc.enable()
