"""Ranges of the conditions within which the next measurement may be made."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.explain.kinds.kind import Trial

#: path -> least and largest value, SI
Limits = Mapping[str, tuple[float, float]]

#: column of a table of cutting tests -> path that it stands for
_PATH_OF_COLUMN = {"spindle_speed": "cut.spindle_speed", "axial_depth": "cut.axial_depth"}


def limits_of(path: Path, given: Any, declared: Case) -> dict[str, tuple[float, float]]:
    """Section [next_measurement] of measurement.toml: path of the case = [least, largest].

    InputError where a path is none of the case, or a range none.
    """
    where = f"{path}: next_measurement"
    if not isinstance(given, Mapping):
        raise InputError(
            f'{where}: {formatted(given)} is not a table such as "cut.axial_depth" = '
            '["0.5 mm", "3 mm"]'
        )
    found = {}
    for key, ends in given.items():
        if not isinstance(ends, list) or len(ends) != 2:
            raise InputError(
                f'{where}."{key}": {formatted(ends)} is not a range such as ["0.5 mm", "3 mm"]'
            )
        low, high = (_value(f'{where}."{key}"', key, end, declared) for end in ends)
        if not low < high:
            raise InputError(f'{where}."{key}": {formatted(ends)} does not rise')
        found[key] = (low, high)
    return found


def _value(where: str, key: str, given: Any, declared: Case) -> float:
    try:
        value = declared.patch({key: given}).get(key)
    except InputError as error:
        raise InputError([f"{where}: {message}" for message in error.messages]) from error
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise InputError(f"{where}: {formatted(given)} is no number of the case")
    return float(value)


def is_within(trial: Trial, limits: Limits, declared: Case) -> bool:
    """Whether a measurement keeps to the limits."""
    case = trial.run.of(declared)
    columns = {
        path: trial.run.signals[name]
        for name, path in _PATH_OF_COLUMN.items()
        if name in trial.run.signals
    }
    for path, (low, high) in limits.items():
        values = columns.get(path)
        least, most = (
            (case.get(path), case.get(path)) if values is None else (values.min(), values.max())
        )
        if least is not None and not low <= least <= most <= high:
            return False
    return True
