"""The registry of file formats, and the format of a file."""

from pathlib import Path

from chatter.description.kinds_of_files import kind_of_file
from chatter.description.registry import Registry
from chatter.io.files import read_content
from chatter.io.formats.abaqus import ABAQUS_INPUT, ABAQUS_MATRIX
from chatter.io.formats.ansys import ANSYS_ARCHIVE, ANSYS_FULL
from chatter.io.formats.compressed_sound import COMPRESSED_SOUND
from chatter.io.formats.csv import CSV
from chatter.io.formats.cutpro import CUTPRO
from chatter.io.formats.format import CONTENTS, Content, Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.formats.lvm import LVM
from chatter.io.formats.matlab import MATLAB
from chatter.io.formats.matrix_market import MATRIX_MARKET
from chatter.io.formats.mr_configurator import MR_CONFIGURATOR
from chatter.io.formats.nastran_bulk import NASTRAN_BULK
from chatter.io.formats.nastran_output import NASTRAN_OUTPUT
from chatter.io.formats.npz import NPZ
from chatter.io.formats.parquet import PARQUET
from chatter.io.formats.records import record_of, stated_record
from chatter.io.formats.sinumerik_trace import SINUMERIK_TRACE
from chatter.io.formats.tdms import TDMS
from chatter.io.formats.tncscope import TNCSCOPE
from chatter.io.formats.uff58 import UFF58
from chatter.io.formats.wav import WAV
from chatter.io.formats.xlsx import XLSX
from dynamics.frf.container import Frf, MeasurementError

FORMATS: Registry[Format] = Registry(
    group="chatter.formats",
    what="file format",
    built_in=(
        *(UFF58, CUTPRO, LVM, SINUMERIK_TRACE, TNCSCOPE, CSV, MR_CONFIGURATOR, NPZ),
        *(MATLAB, XLSX, PARQUET, TDMS, WAV, COMPRESSED_SOUND),
        *(NASTRAN_BULK, NASTRAN_OUTPUT, ABAQUS_MATRIX, ABAQUS_INPUT),
        *(ANSYS_FULL, ANSYS_ARCHIVE, MATRIX_MARKET),
    ),
)
#: enough of a file to recognise its format
_HEAD_BYTES = 65536


def formats_of(content: Content) -> list[Format]:
    """Formats that can hold FRFs, signals, matrices or nodes."""
    return [one for one in FORMATS if content in one.holds]


def listed(formats: list[Format]) -> str:
    """Formats with their extensions, as in messages."""
    return "; ".join(f"{one.label} ({', '.join(one.extensions)})" for one in formats)


def format_of(path: Path, content: Content) -> Format:
    """Tell the format of a file by its content where that is possible, else by its extension.

    `content` is what is to be read of it; the path may name one of its records. MeasurementError if
    the file is missing, a folder, empty, too large, or of no known format.
    """
    path, _ = stated_record(path)
    head = read_content(path, _HEAD_BYTES)
    candidates = formats_of(content)
    for one in candidates:
        if one.recognises(head):
            return one
    for one in candidates:
        if path.suffix.lower() in one.extensions:
            return one
    if kind := kind_of_file(path, "record"):
        raise MeasurementError(f"{path}: {kind}")
    raise MeasurementError(
        f"{path}: the extension {path.suffix!r} is of no known format; formats of {content} that "
        f"are read: {listed(candidates)}"
    )


def read_frfs(path: str | Path) -> list[Frf]:
    """Read every FRF of a measured file, whatever its format.

    At least one, in SI units, in the order of the file, or those of the record that the path names,
    as FILE#RECORD. MeasurementError if the file is missing, a
    folder, empty, of no known format, or malformed; the message names file, line and reason.
    """
    path = Path(path)
    one, (file, record) = format_of(path, "FRFs"), stated_record(path)
    if record and one.read_records is not None:
        return frfs_of_table(record_of(file, one.read_records(file), record))
    return one.read_frfs(file)


def documentation() -> str:
    """Table of all formats for the documentation, in Markdown."""
    rows = [
        f"| format | extensions | {' | '.join(CONTENTS)} | remarks |",
        "|---" * (3 + len(CONTENTS)) + "|",
    ]
    for one in FORMATS:
        marks = " | ".join("yes" if content in one.holds else "" for content in CONTENTS)
        extensions = ", ".join(f"`{extension}`" for extension in one.extensions)
        rows.append(f"| {one.label} | {extensions} | {marks} | {one.help} |")
    return "\n".join(rows) + "\n"
