"""Measurement folders: measurement.toml, the declared case, and the signals of every run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from numpy.typing import NDArray

from chatter.description.case import Case, load
from chatter.description.errors import InputError
from chatter.description.formatting import shown
from chatter.io.signals import read_signals

KINDS = ("milling", "axis", "stability", "frf")
#: keys of [[run]] that are no override of the case
_OWN_KEYS = ("file", "condition", "direction", "title")
_KEYS = ("title", "kind", "case", "points", "run", "tolerance")
#: runs of which some can be kept back, and parts that fewer are cut into
_ENOUGH_RUNS, _PARTS = 3, 6
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

    def part(self, number: int, parts: int, columns: Sequence[str]) -> Run:
        """Return a run of which only one of some equal parts in time is judged.

        Parameters
        ----------
        number, parts : int
            0 <= number < parts.
        columns : sequence of str
            Signals that are cut; "part" says where, so that predictions can be of the whole.
        """
        size = self.signals[columns[0]].size
        begin, end = number * size // parts, (number + 1) * size // parts
        cut = {name: self.signals[name][begin:end] for name in columns if name in self.signals}
        name = f"{self.name}, part {number + 1} of {parts}"
        signals = {**self.signals, **cut, "part": np.array([begin, end])}
        return replace(self, name=name, signals=signals)

    def of(self, case: Case) -> Case:
        """Return a case with the overrides of the run."""
        return case.patch(dict(self.overrides)) if self.overrides else case


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

    def in_parts(self, columns: Sequence[str]) -> Measurement:
        """Return the measurement with its runs cut in time where there are too few to judge by."""
        if len(self.runs) >= _ENOUGH_RUNS:
            return self
        parts = -(-_PARTS // len(self.runs))
        runs = [run.part(k, parts, columns) for run in self.runs for k in range(parts)]
        return replace(self, runs=tuple(runs))

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
    unknown = [key for key in content if key not in _KEYS]
    if unknown:
        raise InputError(
            [f"{path}: {key} is no key; there are {', '.join(_KEYS)}" for key in unknown]
        )
    kind = content.get("kind")
    if kind not in KINDS:
        raise InputError(f"{path}: kind: {shown(kind)} is none of {', '.join(KINDS)}")
    declared = case if isinstance(case, Case) else load(case or _file(path, content, "case"))
    if kind == "stability":
        points = _file(path, content, "points")
        runs = (Run(points.name, {}, read_signals(points)),)
    else:
        entries = content.get("run", [])
        if not isinstance(entries, list) or any(not isinstance(one, dict) for one in entries):
            raise InputError(f"{path}: run: runs are tables [[run]] with a file each")
        runs = tuple(
            _run(path, kind, place, entry, declared) for place, entry in enumerate(entries)
        )
    if not runs:
        raise InputError(f"{path}: there is no [[run]]")
    _refuse_names_twice(path, runs)
    tolerances = _tolerances(path, content.get("tolerance", {}))
    title = str(content.get("title", path.parent.name))
    return Measurement(kind, title, path.parent, declared, runs, tolerances)


def _content(path: Path) -> dict[str, Any]:
    try:
        return tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, tomlkit.exceptions.TOMLKitError) as error:
        raise InputError(f"{path}: is no TOML file: {error}") from error


def _refuse_names_twice(path: Path, runs: Sequence[Run]) -> None:
    names = [run.name for run in runs]
    for name in sorted(set(names)):
        if names.count(name) > 1:
            raise InputError(f"{path}: {name} is the file of {names.count(name)} runs")


def _tolerances(path: Path, given: Any) -> dict[str, float]:
    if not isinstance(given, dict):
        raise InputError(f"{path}: tolerance: {shown(given)} is no table of keys and shares")
    for key, value in given.items():
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not is_number or not 0.0 <= value < 10.0:
            raise InputError(f"{path}: tolerance.{key}: {shown(value)} is no share such as 0.05")
    return {key: float(value) for key, value in given.items()}


def _file(path: Path, content: Mapping[str, Any], key: str) -> Path:
    name = content.get(key)
    if not isinstance(name, str):
        raise InputError(f"{path}: {key}: {shown(name)} is no file name")
    return path.parent / name


def _run(path: Path, kind: str, place: int, entry: Mapping[str, Any], declared: Case) -> Run:
    where = f"{path}: run {place + 1}"
    if not isinstance(entry.get("file"), str):
        raise InputError(f"{where}: file: {shown(entry.get('file'))} is no file name")
    file = _file(path, entry, "file")
    where = f"{path}: run {place + 1} ({file.name})"
    overrides = {
        _path_of(where, key, declared): value
        for key, value in entry.items()
        if key not in _OWN_KEYS
    }
    _refuse_overrides(where, declared, overrides)
    direction = entry.get("direction", "")
    return Run(
        file.name,
        overrides,
        read_signals(file, kind, str(direction)),
        _seconds(where, entry.get("cut_time", 0.0)),
        str(entry.get("condition", "")),
        str(direction),
    )


def _refuse_overrides(where: str, declared: Case, overrides: Mapping[str, Any]) -> None:
    """Raise InputError naming the run where its values are none that the case can take."""
    if not overrides:
        return
    try:
        declared.patch(dict(overrides))
    except InputError as error:
        raise InputError([f"{where}: {message}" for message in error.messages]) from error


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
    from chatter.description.units import QuantityError, parse

    try:
        return parse(given, "time").value
    except QuantityError as error:
        raise InputError(f"{where}: cut_time: {error}") from error
