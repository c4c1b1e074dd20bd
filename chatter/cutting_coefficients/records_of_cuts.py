"""Records of a series of cuts: a measurement folder, one run of it, or one file and its case."""

from __future__ import annotations

from pathlib import Path

from chatter.description.case import Case, load
from chatter.description.errors import InputError
from chatter.description.given_path import path_given
from chatter.description.kinds_of_files import refuse_other_file
from chatter.explain.measurement import Measurement, Run
from chatter.explain.measurement_file import read_measurement
from chatter.io.formats.records import stated_record
from chatter.io.signals import read_signals

#: files of a folder that are named where it tells nothing of them
_NAMED = 4


def read_records(
    records: str | Path, case: str | Path | Case | None = None, columns: str | None = None
) -> Measurement:
    """Read a measurement folder, or one file of forces with the case that it is of.

    Raises
    ------
    InputError
        If it cannot be read, or nothing tells which cut it is of.
    """
    path = path_given(records, "a measurement folder or a record")
    refuse_other_file(path, "measurement")
    if path.is_dir() and not (path / "measurement.toml").is_file():
        raise InputError(_what_to_write(path))
    is_record = stated_record(path)[0].is_file() and path.suffix.lower() != ".toml"
    if not is_record:
        if columns is not None:
            raise InputError(f"{path}: --columns states the columns of one file of forces")
        return read_measurement(path, case)
    if (path.parent / "measurement.toml").is_file() and columns is None:
        return read_measurement(path, case)
    if case is None:
        raise InputError(
            f"{path}: nothing tells which tool and cut it is of; give them by --case FILE, or "
            "write measurement.toml beside it"
        )
    declared = case if isinstance(case, Case) else load(case)
    run = Run(path.name, {}, read_signals(path, "milling", columns=columns))
    return Measurement("milling", path.stem, path.parent, declared, (run,))


def _what_to_write(folder: Path) -> str:
    files = sorted(one.name for one in folder.iterdir() if one.is_file())
    named = ", ".join(files[:_NAMED]) + (", ..." if len(files) > _NAMED else "")
    return (
        f"{folder}: there is no measurement.toml, which tells of {named or 'its records'}: "
        'kind = "milling", case = "case.toml", and for each record [[run]] with file and '
        "feed_per_tooth"
    )
