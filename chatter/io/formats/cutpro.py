"""FRFs from the plain-text ``.frf`` files of CutPro: frequency, real, imaginary, then words."""

from __future__ import annotations

from array import array
from pathlib import Path

import numpy as np

from chatter.io.files import read_lines
from chatter.io.formats.format import Format
from chatter.io.formats.units import channel_unit, frf_unit
from chatter.io.table import is_number
from dynamics.frf.container import Frf, MeasurementError, Quantity

_EXAMPLE = "10.0  1.2e-8  -3.4e-10  Freq  Hz  Real  m/N  Imag"


def read_cutpro(path: Path) -> list[Frf]:
    """Read one FRF, to SI units, from lines of frequency, real and imaginary part.

    Lines are such as ``10.0 1.2e-8 -3.4e-10 Freq Hz Real m/N Imag``. Words may stand after the
    numbers of any line (CutPro writes them behind the first one), above the numbers or below them;
    the unit of the response per force is taken from these words, and the unit of the frequency too
    (Hz where they name none).

    MeasurementError if no word names the unit, if words name different units, or if a row is
    incomplete, out of order or not finite; the message names file and line.
    """
    numbers = array("d")
    words: list[str] = []
    for index, line in enumerate(read_lines(path)):
        row, rest = _numbers_then_words(line)
        words += rest
        if len(row) == 3:
            numbers.extend(_finite_rising(row, numbers, f"{path}: line {index + 1}"))
        elif row and (numbers or len(row) > 3) and not rest:
            raise MeasurementError(
                f"{path}: line {index + 1} has {len(row)} numbers; frequency, real and imaginary "
                "are needed"
            )
    if len(numbers) < 6:
        raise MeasurementError(
            f"{path}: {len(numbers) // 3} lines of frequency, real and imaginary; at least 2 needed"
        )
    quantity, factor = _response_unit(path, words)
    rows = np.frombuffer(numbers, dtype=np.float64).reshape(-1, 3)
    return [
        Frf(
            frequency=rows[:, 0] * _frequency_factor(words),
            values=(rows[:, 1] + 1j * rows[:, 2]) * factor,
            quantity=quantity,
            source=str(path),
        )
    ]


def _numbers_then_words(line: str) -> tuple[list[float], list[str]]:
    """Leading numbers of a line and the words behind them; between tabs a comma is a decimal."""
    if "\t" in line or ";" in line:
        cells = line.replace(";", " ").split()
        plain = [cell.replace(",", ".") for cell in cells]
    else:
        cells = plain = line.replace(",", " ").split()
    count = next((i for i, cell in enumerate(plain) if not is_number(cell)), len(plain))
    return [float(cell) for cell in plain[:count]], cells[count:]


def _finite_rising(row: list[float], before: array[float], where: str) -> list[float]:
    if not np.all(np.isfinite(row)):
        raise MeasurementError(f"{where} holds a number that is not finite")
    if before and row[0] <= before[-3]:
        raise MeasurementError(
            f"{where}: frequency {row[0]:g} after {before[-3]:g}; frequencies must rise"
        )
    return row


def _response_unit(path: Path, words: list[str]) -> tuple[Quantity, float]:
    found: dict[str, tuple[Quantity, float]] = {}
    for word in dict.fromkeys(words):
        try:
            found[word] = frf_unit(word.strip("[],:"))
        except MeasurementError:
            continue
    if not found:
        raise MeasurementError(
            f"{path}: no word in the file names the unit of the FRF; "
            f"the first line must be like: {_EXAMPLE}"
        )
    if len(set(found.values())) > 1:
        raise MeasurementError(f"{path}: names several units: {', '.join(found)}; one is needed")
    return next(iter(found.values()))


def _frequency_factor(words: list[str]) -> float:
    for word in dict.fromkeys(words):
        try:
            channel, factor = channel_unit(word.strip("[],:()"))
        except MeasurementError:
            continue
        if channel == "frequency":
            return factor
    return 1.0


CUTPRO = Format(
    name="cutpro",
    label="CutPro",
    help="lines of frequency, real and imaginary part; words behind them name the units",
    extensions=(".frf",),
    read_frfs=read_cutpro,
)
