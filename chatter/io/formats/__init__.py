"""Files of measured FRFs into the container.

========== ============================================================ ====================
module     responsibility                                               layout
========== ============================================================ ====================
uff58      universal files, text and binary                             SDRC dataset 58, 58b
universal  datasets of a universal file, its units                      SDRC dataset 164
csv    tables with names and units in the heading
cutpro     ``.frf`` text of CutPro
text       opening text, tables of numbers
units      units in measured files, by the units library
========== ============================================================ ====================

A further format is one module with a function ``Path -> list[Frf]`` and one entry in `READERS`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from chatter.io.formats.csv import read_csv
from chatter.io.formats.cutpro import read_cutpro
from chatter.io.formats.uff58 import read_uff58
from chatter.io.formats.universal import LARGEST_UNIVERSAL_FILE, looks_universal
from chatter.io.text_files import read_head, require_readable
from dynamics.frf.container import Frf, MeasurementError

__all__ = ["READERS", "Reader", "read_frfs"]


@dataclass(frozen=True)
class Reader:
    """One readable format.

    Parameters
    ----------
    name : str
        As shown to the user.
    suffixes : tuple of str
        Lower case, with the dot.
    read : callable
        Path -> list of Frf.
    recognises : callable, optional
        First bytes of the file -> True where the content is of this format whatever its suffix.
    """

    name: str
    suffixes: tuple[str, ...]
    read: Callable[[Path], list[Frf]]
    recognises: Callable[[bytes], bool] = lambda head: False  # noqa: ARG005


READERS: tuple[Reader, ...] = (
    Reader("universal file, dataset 58", (".uff", ".unv", ".uf"), read_uff58, looks_universal),
    Reader("CutPro", (".frf",), read_cutpro),
    Reader("table", (".csv", ".txt", ".tsv", ".dat", ".asc"), read_csv),
)


def read_frfs(path: str | Path) -> list[Frf]:
    """Read every FRF of a measured file, whatever its format.

    The format is told by the content where that is possible, else by the suffix.

    Parameters
    ----------
    path : str or Path
        UFF-58 (``.uff``, ``.unv``, text or binary), CutPro (``.frf``) or a table (``.csv``,
        ``.txt``, ``.tsv``, ``.dat``, ``.asc``).

    Returns
    -------
    list of Frf
        At least one, in SI units, in the order of the file.

    Raises
    ------
    MeasurementError
        If the file is missing, a folder, empty, of no known format, or malformed; the message
        names file, line and reason.
    """
    path = Path(path)
    require_readable(path, LARGEST_UNIVERSAL_FILE)
    head = read_head(path)
    for reader in READERS:
        if reader.recognises(head):
            return reader.read(path)
    for reader in READERS:
        if path.suffix.lower() in reader.suffixes:
            return reader.read(path)
    known = "; ".join(f"{reader.name} ({', '.join(reader.suffixes)})" for reader in READERS)
    raise MeasurementError(
        f"{path}: no format is known for the suffix {path.suffix!r}; known are: {known}"
    )
