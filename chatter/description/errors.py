"""Errors for people: which file, which key, what was given, what is allowed."""

from collections.abc import Sequence


class InputError(Exception):
    """Input that is wrong: a case, a measurement, an option. The command line returns 2 for it.

    Parameters
    ----------
    messages : str or sequence of str
        One sentence each; all problems found are reported together.
    """

    def __init__(self, messages: str | Sequence[str]) -> None:
        self.messages = (messages,) if isinstance(messages, str) else tuple(messages)
        super().__init__("\n".join(self.messages))


class RunError(Exception):
    """A run that failed on valid input. The command line returns 1 for it."""
