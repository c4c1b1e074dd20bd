"""Measurement folders: measurement.toml, the declared case, and the signals of every run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from numpy.typing import NDArray

from chatter.case import Case, load
from chatter.errors import InputError
from chatter.explain.tables import read_signals
from chatter.shown import shown

KINDS = ("milling", "axis", "stability", "frf")
#: keys of [[run]] that are no override of the case
_OWN_KEYS = ("file", "condition", "direction", "title")
#: sections of a case that a short key of a run may mean
_SECTIONS = ("cut", "tool", "material", "axis")
#: column of a run that is 0 where samples are no good, and else 1
USABLE = "usable"


@dataclass(frozen=True, eq=False)
class Run:
    """One recorded run.

    Parameters
    ----------
    name : str
        Of its file.
    overrides : mapping of str to str
        Paths of the case -> values that hold in this run.
    signals : mapping of str to (n,) array of float
        SI, by the name in the heading: "time", "Fx", "x", "velocity", ...
    cut_time : float
        Time that the tool had cut before the run, s.
    condition, direction : str
        Of FRFs.
    """

    name: str
    overrides: Mapping[str, Any]
    signals: Mapping[str, NDArray[np.float64]]
    cut_time: float = 0.0
    condition: str = ""
    direction: str = ""

    def usable(self, size: int) -> NDArray[np.float64]:
        """Weights (size,) of samples: 0 where they were found to be no good, else 1."""
        weights = self.signals.get(USABLE)
        return weights if weights is not None and weights.size == size else np.ones(size)


@dataclass(frozen=True, eq=False)
class Measurement:
    """What was measured, and the case that was declared about it.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    title : str
    folder : Path
    case : Case
    runs : tuple of Run
    tolerances : mapping of str to float
        Relative standard deviation of declared values by path, where given.
    notes : tuple of str
        What was found out on reading.
    """

    kind: str
    title: str
    folder: Path
    case: Case
    runs: tuple[Run, ...]
    tolerances: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def with_case(self, case: Case) -> Measurement:
        """Same measurement with another case declared."""
        return replace(self, case=case)


def read_measurement(folder: str | Path, case: str | Path | Case | None = None) -> Measurement:
    """Read a measurement folder.

    Parameters
    ----------
    folder : path
        Holds measurement.toml, or is that file.
    case : path or Case, optional
        Instead of the case that it names.

    Raises
    ------
    InputError
        If a file is missing or cannot be read, a key is unknown, or runs lack a channel.
    """
    path = Path(folder)
    path = path if path.is_file() else path / "measurement.toml"
    content = _content(path)
    kind = content.get("kind")
    if kind not in KINDS:
        raise InputError(f"{path}: kind: {shown(kind)} is none of {', '.join(KINDS)}")
    declared = case if isinstance(case, Case) else load(case or _file(path, content, "case"))
    if kind == "stability":
        points = _file(path, content, "points")
        runs = (Run(points.name, {}, read_signals(points)),)
    else:
        runs = tuple(
            _run(path, place, entry, declared) for place, entry in enumerate(content.get("run", ()))
        )
    if not runs:
        raise InputError(f"{path}: there is no [[run]]")
    tolerances = {key: float(value) for key, value in content.get("tolerance", {}).items()}
    title = str(content.get("title", path.parent.name))
    return Measurement(kind, title, path.parent, declared, runs, tolerances)


def _content(path: Path) -> dict[str, Any]:
    try:
        return tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, tomlkit.exceptions.TOMLKitError) as error:
        raise InputError(f"{path}: is no TOML file: {error}") from error


def _file(path: Path, content: Mapping[str, Any], key: str) -> Path:
    name = content.get(key)
    if not isinstance(name, str):
        raise InputError(f"{path}: {key}: {shown(name)} is no file name")
    return path.parent / name


def _run(path: Path, place: int, entry: Mapping[str, Any], declared: Case) -> Run:
    where = f"{path}: run {place + 1}"
    file = _file(path, entry, "file")
    overrides = {
        _path_of(where, key, declared): value
        for key, value in entry.items()
        if key not in _OWN_KEYS
    }
    return Run(
        file.name,
        overrides,
        read_signals(file),
        _seconds(where, entry.get("cut_time", 0.0)),
        str(entry.get("condition", "")),
        str(entry.get("direction", "")),
    )


def _path_of(where: str, key: str, declared: Case) -> str:
    """Path of a key of a run: itself, or that of the section it belongs to."""
    if "." in key:
        return key
    for section in _SECTIONS:
        fields = type(declared).model_fields[section].annotation
        for kind in getattr(fields, "__args__", (fields,)):
            if key in getattr(kind, "model_fields", {}):
                return f"{section}.{key}"
    raise InputError(f"{where}: {key} is no key of a run, nor of cut, tool, material or axis")


def _seconds(where: str, given: Any) -> float:
    from chatter.units import QuantityError, parse

    try:
        return parse(given, "time").value
    except QuantityError as error:
        raise InputError(f"{where}: cut_time: {error}") from error
