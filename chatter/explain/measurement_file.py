"""Measurement folders: measurement.toml, the declared case, and the signals of every run."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomlkit

from chatter.description.case import Case, load
from chatter.description.errors import InputError
from chatter.description.file_name import is_file_name, outside
from chatter.description.formatting import formatted, printable
from chatter.description.units import QuantityError, parse
from chatter.description.wording import first_of
from chatter.explain.kinds.kind_list import KINDS, OF_PARTS, ON_MACHINE
from chatter.explain.kinds.set_up import SetUp
from chatter.explain.measurement import Measurement, Run
from chatter.explain.next_measurement.limits import limits_of
from chatter.explain.records.description import RecordDescription, record_of
from chatter.io.formats.records import stated_record
from chatter.io.signals import Signals, read_signals

#: keys of [[run]] that are no override of the case
OWN_KEYS = (
    "file",
    "columns",
    "from",
    "to",
    "condition",
    "direction",
    "excite",
    "read",
    "axis",
    "title",
)
KEYS = (
    "title",
    "kind",
    "case",
    "points",
    "run",
    "tolerance",
    "idle_power",
    "record",
    "channels",
    "next_measurement",
    "part",
)
#: those of one kind, of a [[part]], and of a set-up of several
_ONE_KIND_KEYS = tuple(key for key in KEYS if key != "part")
PART_KEYS = ("title", "kind", "points", "run", "idle_power", "record", "channels")
SET_UP_KEYS = ("title", "kind", "case", "part", "tolerance", "next_measurement")
_DESCRIPTION = "measurement.toml"
#: samples that a record, and a part of one, has at the least
_LEAST_SAMPLES = 2
#: sections of a case that a short key of a run may mean
SECTIONS = ("cut", "tool", "material", "axis")


def read_measurement(folder: str | Path, case: str | Path | Case | None = None) -> Measurement:
    """Read a measurement folder, which holds measurement.toml, or that file, or one run of it.

    The file of a run is that run alone, with what measurement.toml beside it says. The case given
    stands for the one that it names. InputError if a file is missing or cannot be read, a key is
    unknown, or runs lack a channel.
    """
    path = Path(folder)
    if stated_record(path)[0].is_file() and path.suffix.lower() != ".toml":
        return _only_run(path, case)
    if path.is_dir() and not (path / _DESCRIPTION).exists():
        raise InputError(_without_description(path))
    path = path if path.is_file() else path / _DESCRIPTION
    content = _content(path)
    name = content.get("kind")
    if not isinstance(name, str) or name not in KINDS:
        raise InputError(f"{path}: kind: {formatted(name)} is none of {', '.join(KINDS)}")
    _refuse_unknown(path, "", content, SET_UP_KEYS if name == SetUp.name else _ONE_KIND_KEYS)
    declared = case if isinstance(case, Case) else load(case or _file(path, content, "case"))
    if declared.on_machine:
        # read once, not at every prediction
        declared = declared.with_machine(declared.machine_file())
    name = _kind_on(declared, name)
    title = str(content.get("title", path.parent.resolve().name))
    whole = Measurement(name, title, path.parent, declared, ())
    tolerances = _tolerances(path, content.get("tolerance", {}), declared)
    limits = limits_of(path, content.get("next_measurement", {}), declared)
    whole = replace(whole, tolerances=tolerances, limits=limits)
    if name == SetUp.name:
        return _set_up(path, whole, content)
    return _of_one_kind(path, "", whole, content)


def _without_description(folder: Path) -> str:
    """Say that a folder has no measurement.toml, and where there is one, or what it holds."""
    inside = sorted(one.parent for one in folder.glob(f"*/{_DESCRIPTION}"))
    if inside:
        return (
            f"{folder}: has no {_DESCRIPTION}; there is one in {' and in '.join(map(str, inside))}"
        )
    return (
        f"{folder}: has no {_DESCRIPTION}, which says what the files are of: kind (one of "
        f'{", ".join(KINDS)}), case, and a [[run]] with file = "..." for each'
    )


def _kind_on(declared: Case, kind: str) -> str:
    """Kind of a measurement of a case: an axis without [axis] is one of its machine."""
    if declared.on_machine and declared.axis is None:
        return ON_MACHINE.get(kind, kind)
    return kind


def _only_run(path: Path, case: str | Path | Case | None) -> Measurement:
    """One run of the measurement whose measurement.toml is beside its file."""
    beside = path.parent / "measurement.toml"
    if not beside.is_file():
        raise InputError(
            f"{path}: is a record, and there is no measurement.toml beside it, which says what it "
            f"is of: kind (one of {', '.join(KINDS)}), case, and a [[run]] with "
            f'file = "{path.name}"'
        )
    whole = read_measurement(beside, case)
    runs = tuple(run for run in whole.runs if run.name.partition(", ")[0] == path.name)
    if whole.kind == SetUp.name or not runs:
        names = ", ".join(run.name for run in whole.runs)
        raise InputError(f"{beside}: {path.name} is the file of no run; there are {names}")
    return replace(whole, runs=runs)


def _refuse_unknown(
    path: Path, where: str, content: Mapping[str, Any], keys: Sequence[str]
) -> None:
    unknown = [key for key in content if key not in keys]
    if unknown:
        known = ", ".join(keys)
        texts = [
            f"{path}: {where}{printable(key)} is not a key; there are {known}" for key in unknown
        ]
        raise InputError(first_of(texts, str(path)))


def _set_up(path: Path, whole: Measurement, content: Mapping[str, Any]) -> Measurement:
    """Set-up of several parts, each of a kind of its own."""
    entries = content.get("part", [])
    if not isinstance(entries, list) or any(not isinstance(one, dict) for one in entries):
        raise InputError(f"{path}: part: parts are tables [[part]] with a kind each")
    parts = []
    for number, entry in enumerate(entries, start=1):
        where = f"part {number}: "
        _refuse_unknown(path, where, entry, PART_KEYS)
        kind = entry.get("kind")
        if kind not in OF_PARTS:
            raise InputError(
                f"{path}: {where}kind: {formatted(kind)} is none of {', '.join(OF_PARTS)}"
            )
        title = str(entry.get("title", kind))
        kind = _kind_on(whole.case, kind)
        own = replace(whole, kind=kind, title=title)
        parts.append(_of_one_kind(path, where, own, entry))
    if not parts:
        raise InputError(f"{path}: there is no [[part]]")
    found = whole.with_parts(parts)
    _refuse_names_twice(path, found.runs)
    return found


def _of_one_kind(
    path: Path, where: str, whole: Measurement, content: Mapping[str, Any]
) -> Measurement:
    """Measurement, or part of a set-up, with its runs."""
    table = KINDS[whole.kind].table_key
    if table:
        file = _file(path, content, table)
        runs = (Run(file.name, {}, read_signals(file)),)
    else:
        entries = content.get("run", [])
        if not isinstance(entries, list) or any(not isinstance(one, dict) for one in entries):
            raise InputError(f"{path}: {where}run: runs are tables [[run]] with a file each")
        runs = tuple(
            _run(path, whole.kind, number, entry, whole.case)
            for number, entry in enumerate(entries, start=1)
        )
        runs = _distinguished(runs, [Path(entry["file"]) for entry in entries])
    if not runs:
        raise InputError(f"{path}: {where}there is no [[run]]")
    _refuse_names_twice(path, runs)
    record = record_of(path, content)
    if record is not None:
        runs = tuple(_described(path, run, record) for run in runs)
    return replace(whole, runs=runs, idle_power=_idle_power(path, content), record=record)


def _described(path: Path, run: Run, record: RecordDescription) -> Run:
    """Run of the channels that are used, and names those described; InputError where one lacks."""
    missing = [name for name in record.channels if name not in run.signals]
    if missing:
        raise InputError(
            f"{path}: channels.{missing[0]}: {run.name} has no such column; there are "
            f"{', '.join(run.signals)}"
        )
    vectors = tuple(name for name, one in record.channels.items() if one.is_vector)
    signals = {name: one for name, one in run.signals.items() if name not in record.unused}
    return replace(run, signals=signals, described=vectors)


def _content(path: Path) -> dict[str, Any]:
    try:
        return tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, tomlkit.exceptions.TOMLKitError) as error:
        raise InputError(f"{path}: is no TOML file: {error}") from error


def _distinguished(runs: tuple[Run, ...], files: Sequence[Path]) -> tuple[Run, ...]:
    """Runs of files of one name in several folders, with the folders in their names."""
    return tuple(
        replace(run, name=f"{file.as_posix()}{run.name.removeprefix(file.name)}")
        if any(other != file and other.name == file.name for other in files)
        else run
        for run, file in zip(runs, files, strict=True)
    )


def _refuse_names_twice(path: Path, runs: Sequence[Run]) -> None:
    names = [run.name for run in runs]
    for name in sorted(set(names)):
        if names.count(name) > 1:
            raise InputError(f"{path}: {name} is the file of {names.count(name)} runs")


def _tolerances(path: Path, given: Any, declared: Case) -> dict[str, float]:
    """Shares by last key of a path, or by whole path; InputError where there is no such number."""
    if not isinstance(given, dict):
        raise InputError(f"{path}: tolerance: {formatted(given)} is not a table of keys and shares")
    shares = dict(_flat(given))
    for key, value in shares.items():
        if not _is_number(value) or not 0.0 <= value < 10.0:
            raise InputError(
                f"{path}: tolerance.{key}: {formatted(value)} is not a share such as 0.05"
            )
        if "." in key and not _is_number(_declared_value(path, key, declared)):
            raise InputError(
                f"{path}: tolerance.{key}: the case declares no number there to be uncertain"
            )
    return {key: float(value) for key, value in shares.items()}


def _flat(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Values by dotted path, of keys with or without quotation marks."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _declared_value(path: Path, key: str, declared: Case) -> Any:
    try:
        return declared.get(key)
    except InputError as error:
        raise InputError(f"{path}: tolerance.{key}: {error}") from error


def _idle_power(path: Path, content: Mapping[str, Any]) -> float | None:
    if "idle_power" not in content:
        return None
    try:
        value = parse(content["idle_power"], "power").value
    except QuantityError as error:
        raise InputError(f"{path}: idle_power: {error}") from error
    if not 0.0 <= value < math.inf:
        given = formatted(content["idle_power"])
        raise InputError(f"{path}: idle_power: {given} is out of range; it is 0 W or more")
    return value


def _file(path: Path, content: Mapping[str, Any], key: str) -> Path:
    name = content.get(key)
    if name is None:
        raise InputError(f"{path}: {key} is missing; a file name is required")
    if not is_file_name(name):
        raise InputError(f"{path}: {key}: {formatted(name)} is not a file name")
    if said := outside(path.parent, name):
        raise InputError(f"{path}: {key}: {said}")
    return path.parent / name


def _run(path: Path, kind: str, number: int, entry: Mapping[str, Any], declared: Case) -> Run:
    where = f"{path}: run {number}"
    if "file" not in entry:
        raise InputError(f'{where}: file is missing; a run names its signals, such as "run01.csv"')
    if not is_file_name(entry["file"]):
        raise InputError(f"{where}: file: {formatted(entry.get('file'))} is not a file name")
    if said := outside(path.parent, entry["file"]):
        raise InputError(f"{where}: file: {said}")
    file = path.parent / entry["file"]
    where = f"{where} ({file.name})"
    overrides, cut_time = overrides_of_run(where, entry, declared)
    direction = _direction(where, entry)
    condition = str(entry.get("condition", ""))
    signals = read_signals(file, kind, direction, _columns(where, entry))
    name = file.name
    if (count := next(iter(signals.values())).size) < _LEAST_SAMPLES:
        raise InputError(
            f"{where}: holds {count} samples a channel; {_LEAST_SAMPLES} are needed at the least"
        )
    if "from" in entry or "to" in entry:
        name, signals = _window(where, name, entry, signals)
    axis = _axis(where, entry, declared)
    return Run(name, overrides, signals, cut_time, condition, direction, axis)


def _columns(where: str, entry: Mapping[str, Any]) -> str | None:
    """Names and units of all columns of a file, where a run states them."""
    stated = entry.get("columns")
    if stated is not None and not (isinstance(stated, str) and stated.strip()):
        raise InputError(
            f"{where}: columns: {formatted(stated)} is given; names and units of all columns are "
            'required, in one text such as "time [s], Fx [N], Fy [N]"'
        )
    return stated


def overrides_of_run(
    where: str, entry: Mapping[str, Any], declared: Case
) -> tuple[dict[str, Any], float]:
    """Paths of the case and their values in a run, and the time that the tool had cut before, s.

    InputError, which begins with what is given as `where`, for what the case cannot take.
    """
    overrides = {
        _path_of(where, key, declared): value for key, value in entry.items() if key not in OWN_KEYS
    }
    try:
        declared.patch(overrides)
        cut_time = parse(entry.get("cut_time", 0.0), "time").value
    except InputError as error:
        raise InputError([f"{where}: {message}" for message in error.messages]) from error
    except QuantityError as error:
        raise InputError(f"{where}: cut_time: {error}") from error
    return overrides, cut_time


def _window(
    where: str, name: str, entry: Mapping[str, Any], signals: Signals
) -> tuple[str, Signals]:
    """Part of a record, by the times since its first sample, and its name."""
    time = signals.get("time")
    if time is None:
        raise InputError(f"{where}: from and to are of records over time, and there is no time")
    since = time - time[0]
    begin, end = 0.0, float(since[-1])
    try:
        if "from" in entry:
            begin = parse(entry["from"], "time").value
        if "to" in entry:
            end = parse(entry["to"], "time").value
    except QuantityError as error:
        raise InputError(f"{where}: from, to: {error}") from error
    chosen = (since >= begin) & (since <= end)
    if chosen.sum() < _LEAST_SAMPLES:
        raise InputError(
            f"{where}: from {begin:g} s to {end:g} s holds {chosen.sum()} samples of a record of "
            f"{since[-1]:.4g} s"
        )
    part = {key: values[chosen] for key, values in signals.items()}
    return f"{name}, {begin:g} s to {end:g} s", part


def _direction(where: str, entry: Mapping[str, Any]) -> str:
    """Direction of an FRF at the tool point, or two places of a machine, such as "table:y, tool:x".

    The first is read, the second excited.
    """
    excite, read = entry.get("excite"), entry.get("read")
    if excite is None and read is None:
        return str(entry.get("direction", ""))
    if "direction" in entry:
        raise InputError(f"{where}: direction and excite are given; one of the two is enough")
    if excite is None:
        raise InputError(f'{where}: excite is missing; read = "{read}" needs it')
    return f"{excite if read is None else read}, {excite}"


def _axis(where: str, entry: Mapping[str, Any], declared: Case) -> str:
    """Axis of the machine that a run moves; InputError if there is none of that name."""
    if "axis" not in entry:
        return ""
    known = list(declared.machine_file().axis) if declared.on_machine else []
    if entry["axis"] not in known:
        there = ", ".join(known) or "none, as the case is on no machine"
        raise InputError(f"{where}: axis: {formatted(entry['axis'])} is none; there are {there}")
    return str(entry["axis"])


def _path_of(where: str, key: str, declared: Case) -> str:
    """Path of a key of a run: itself, or that of the section it belongs to."""
    if "." in key:
        return key
    if key == "name":
        raise InputError(f"{where}: name: a run has the name of its file; title is free text")
    for section in SECTIONS:
        fields = type(declared).model_fields[section].annotation
        for kind in getattr(fields, "__args__", (fields,)):
            if key in getattr(kind, "model_fields", {}):
                return f"{section}.{key}"
    raise InputError(f"{where}: {key} is not a key of a run, nor of cut, tool, material or axis")
