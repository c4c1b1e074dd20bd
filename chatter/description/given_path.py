"""Paths that a call of Python is given, and what is said of other things in their place."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from chatter.description.errors import InputError
from chatter.description.formatting import formatted


def path_given(given: Any, what: str) -> Path:
    """Return a path; InputError where what is given is none, with what is required."""
    if isinstance(given, (str, os.PathLike)) and "\0" not in str(given):
        return Path(given)
    raise InputError(f"the path of {what} is required; {formatted(given)} is given")


def paths_given(given: Any, what: str) -> list[Path]:
    """Return one path or several as a list; InputError where what is given is neither."""
    if isinstance(given, (str, os.PathLike)) or not isinstance(given, Iterable):
        return [path_given(given, what)]
    return [path_given(one, what) for one in given]
