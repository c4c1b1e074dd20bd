"""FRFs and time records of universal files: dataset 58 (text) and 58b (binary).

The package pyuff (2.5.8) is no substitute. Of a dataset 58b with eight-byte values at uneven
abscissae, which the standard stores in four bytes each, it returns wrong numbers without a word; of
a file that is cut short or has a stray line of -1 it returns nothing; exponents written with D, and
datasets of another kind that it cannot parse, end the reading of the whole file. The tests write
files with it.
"""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array, ComplexArray
from chatter.description.units import measured_unit
from chatter.io.formats.format import Format
from chatter.io.formats.records import Tables, of_file, only_record
from chatter.io.formats.units import Channel, channel_unit, frf_unit
from chatter.io.formats.universal import (
    Dataset,
    FileUnits,
    file_units,
    is_universal,
    read_datasets,
    with_e_and_points,
)
from chatter.io.table import Column, Table
from dynamics.frf.container import QUANTITY_OF_MOTION, Frf, MeasurementError, Point, Quantity

#: names of function types met in measured files (record 6, field 1)
_FUNCTION_TYPES = {
    0: "general function",
    1: "time response",
    2: "auto spectrum",
    3: "cross spectrum",
    4: "frequency response",
    5: "transmissibility",
    6: "coherence",
    9: "power spectral density",
    12: "spectrum",
}
_FREQUENCY_RESPONSE, _COHERENCE = 4, 6
#: general functions are taken for time records too, where their abscissa is time
_TIME_RECORD = (0, 1)
#: specific data types (records 8 to 11, field 1)
_CONTENT: dict[int, Channel] = {
    8: "displacement",
    9: "force",
    11: "velocity",
    12: "acceleration",
    13: "force",
    17: "time",
    18: "frequency",
}
_DIRECTIONS = {0: "", 1: "x", 2: "y", 3: "z"}
#: numbers a value takes by ordinate data type (record 7, field 1), and bytes a number
_ORDINATE = {2: (1, 4), 4: (1, 8), 5: (2, 4), 6: (2, 8)}
_HEADING_LINES = 11
#: columns of a record of a single channel
_TIME_AND_CHANNEL = 2
_NUMBER = re.compile(r"[+-]?\d+\.?\d*(?:[Ee][+-]?\d+)?")


@dataclass(frozen=True)
class Axis:
    """Records 8 to 10: what an axis holds."""

    code: int
    unit: str


@dataclass(frozen=True)
class Heading:
    """The eleven text records of a dataset 58."""

    title: str
    function_type: int
    response: tuple[int, int]  # node, direction code
    reference: tuple[int, int]
    ordinate_type: int
    count: int
    is_even: bool
    first: float
    step: float
    abscissa: Axis
    numerator: Axis
    denominator: Axis


@dataclass(frozen=True)
class _Function:
    """One dataset 58 with the units that hold for it."""

    dataset: Dataset
    heading: Heading
    first_byte: int
    units: FileUnits
    where: str

    def values(self) -> tuple[Array, ComplexArray]:
        """Abscissa and ordinate, as stored."""
        return _values(self.dataset, self.heading, self.first_byte, self.where)

    @property
    def title(self) -> str:
        """Title; empty where there is none."""
        return "" if self.heading.title.upper() == "NONE" else self.heading.title


def _functions(path: Path, others: Counter[str]) -> Iterator[_Function]:
    """Functions of a file in order; other datasets are counted, save 164 (units)."""
    units = FileUnits()
    for dataset in read_datasets(path):
        if dataset.number == 164:
            units = file_units(dataset, path)
        if dataset.number != 58:
            others[f"dataset {dataset.number}"] += 1
            continue
        where = f"{path}: dataset {dataset.order}"
        yield _Function(dataset, *_heading(dataset, where), units, where)


def read_frfs(path: Path) -> list[Frf]:
    """Read every FRF between translations of a universal file, text or binary, to SI units.

    In the order of the file. Datasets other than 58 are passed over, save 164 (units). A coherence
    function between the same points is joined to its FRF. Unit labels of the axes hold where
    present; else the data type (displacement, velocity, acceleration, force) in the units of
    dataset 164, SI by default.

    MeasurementError if the file is cut short, malformed, or holds no FRF; the message says where
    and why. Layout: SDRC universal dataset 58, "Function at Nodal DOF", and its binary form 58b by
    UC-SDRL.
    """
    frfs: list[Frf] = []
    coherences: list[tuple[Heading, Array]] = []
    held: Counter[str] = Counter()
    for function in _functions(path, held):
        heading = function.heading
        held[_described(heading)] += 1
        if heading.function_type == _FREQUENCY_RESPONSE and _is_translation(heading):
            frfs.append(_frf(function))
        elif heading.function_type == _COHERENCE:
            coherences.append((heading, function.values()[1].real))
    if not frfs:
        raise MeasurementError(
            f"{path}: holds no frequency response function between translations; it holds "
            + _counted(held)
        )
    return [_with_coherence(frf, coherences) for frf in frfs]


def read_time_records(path: Path) -> Tables:
    """Read every time record of a universal file: a column of time, then one a record.

    Where a quantity of a point comes again, another record begins; they are numbered.
    MeasurementError if the file is cut short, malformed, or holds no time record, or channels of a
    record differ in time.
    """
    found: list[list[Column]] = []
    held: Counter[str] = Counter()
    for function in _functions(path, held):
        heading, where = function.heading, function.where
        abscissa, factor = _content(heading.abscissa, function.units, where)
        is_record = heading.function_type in _TIME_RECORD and abscissa in (None, "time")
        if not is_record or not _is_translation(heading):
            held[_described(heading)] += 1
            continue
        time, values = function.values()
        time, column = time * factor, _record_column(function, values.real)
        if not found or any(_is_again(one, column) for one in found[-1]):
            found.append([Column("time [s]", time)])
        first = np.asarray(found[-1][0].cells)
        if time.size != first.size or not np.allclose(time, first, rtol=1e-6, atol=1e-9):
            raise MeasurementError(f"{where}: has other times than the first record")
        found[-1].append(column)
    if not found:
        raise MeasurementError(f"{path}: holds no time record; it holds {_counted(held)}")
    if len({len(columns) for columns in found}) > 1 or len(found[0]) == _TIME_AND_CHANNEL:
        found = [_merged(path, found)]
    tables = {str(k + 1): Table(path, tuple(columns)) for k, columns in enumerate(found)}
    return of_file(path, tables)


def _merged(path: Path, parts: list[list[Column]]) -> list[Column]:
    """Channels of one record, some of which are of one quantity at one point."""
    time = np.asarray(parts[0][0].cells)
    for columns in parts[1:]:
        other = np.asarray(columns[0].cells)
        if other.size != time.size or not np.allclose(other, time, rtol=1e-6, atol=1e-9):
            raise MeasurementError(
                f"{path}: its time records differ in time and in their channels; "
                "save one record a file"
            )
    return [*parts[0], *(column for columns in parts[1:] for column in columns[1:])]


def _is_again(column: Column, other: Column) -> bool:
    """Whether two columns are of one quantity at one point."""
    same = column.content is not None and column.content == other.content
    return same and column.point == other.point


def _record_column(function: _Function, values: Array) -> Column:
    """Column of a time record: in SI where it is a motion or a force, else in the unit of its axis.

    A microphone's Pa and an amplifier's V are such; who reads the record judges them.
    """
    axis, point = function.heading.numerator, _point(function.heading.response)
    name = function.title or f"record {function.dataset.order}"
    try:
        content, factor = _content(axis, function.units, function.where)
    except MeasurementError:
        if axis.code in _CONTENT or measured_unit(axis.unit) is None:
            raise
        plain = re.sub(r"[\[\]]", " ", name).strip()
        return Column(f"{plain} [{axis.unit}]", values, point=point)
    return Column(name, values * factor, content, point)


def _counted(held: Counter[str]) -> str:
    return ", ".join(f"{count} x {name}" for name, count in held.items()) or "no dataset"


def _described(heading: Heading) -> str:
    name = _FUNCTION_TYPES.get(heading.function_type, f"function type {heading.function_type}")
    return name if _is_translation(heading) else f"{name} of a rotation"


def _is_translation(heading: Heading) -> bool:
    return max(abs(heading.response[1]), abs(heading.reference[1])) <= 3


def _heading_text(raw: bytes) -> str:
    """Text of the heading: the standard has ASCII; others write UTF-8 or Latin-1 for m/s²."""
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _heading(dataset: Dataset, where: str) -> tuple[Heading, int]:
    """Parse the eleven text records; also return where in the body the numbers begin."""
    end = 0
    for _ in range(_HEADING_LINES):
        end = dataset.body.find(b"\n", end) + 1
        if end == 0:
            raise MeasurementError(f"{where}: fewer than {_HEADING_LINES} heading lines")
    lines = _heading_text(dataset.body[:end]).split("\n")
    try:
        return _parsed_heading([line.rstrip("\r") for line in lines]), end
    except (ValueError, IndexError):
        raise MeasurementError(
            f"{where}: records 6 to 11 (lines {dataset.line + 5} to {dataset.line + 10}) are not "
            "those of a dataset 58"
        ) from None


def _parsed_heading(lines: list[str]) -> Heading:
    points, form = lines[5], lines[6]
    return Heading(
        title=lines[0].strip(),
        function_type=int(points[0:5]),
        response=(int(points[41:51] or 0), int(points[51:55] or 0)),
        reference=(int(points[66:76].strip() or 0), int(points[76:80].strip() or 0)),
        ordinate_type=int(form[0:10]),
        count=int(form[10:20]),
        is_even=int(form[20:30]) == 1,
        first=_real(form[30:43]),
        step=_real(form[43:56]),
        abscissa=_axis(lines[7]),
        numerator=_axis(lines[8]),
        denominator=_axis(lines[9]),
    )


def _real(field: str) -> float:
    return float(with_e_and_points(field))


def _axis(line: str) -> Axis:
    unit = line[47:67].strip()
    return Axis(code=int(line[0:10]), unit="" if unit.upper() == "NONE" else unit)


def _values(
    dataset: Dataset, heading: Heading, first_byte: int, where: str
) -> tuple[Array, ComplexArray]:
    """Abscissa and ordinate of a function, as stored."""
    if heading.ordinate_type not in _ORDINATE:
        raise MeasurementError(
            f"{where}: ordinate data type {heading.ordinate_type}; allowed are 2, 4, 5 and 6"
        )
    parts, _ = _ORDINATE[heading.ordinate_type]
    columns = parts + (0 if heading.is_even else 1)
    payload = dataset.body[first_byte:]
    if dataset.is_binary:
        table = _binary_table(dataset, payload, heading, columns, where)
    else:
        table = _text_table(payload, heading, columns, where)
    if not np.all(np.isfinite(table)):
        row = int(np.argmin(np.all(np.isfinite(table), axis=1)))
        raise MeasurementError(f"{where}: value {row + 1} is not a finite number")
    if heading.is_even:
        abscissa = heading.first + heading.step * np.arange(heading.count)
    else:
        abscissa, table = table[:, 0], table[:, 1:]
    imaginary = table[:, 1] if parts == 2 else 0.0
    return abscissa, table[:, 0] + 1j * imaginary


def _text_table(payload: bytes, heading: Heading, columns: int, where: str) -> Array:
    text = with_e_and_points(payload.decode("latin-1"))
    words = text.split()
    if len(words) != heading.count * columns:
        # fields of fixed width, whose signs leave no blanks between them
        words = [number for word in words for number in _separated(word)]
    if len(words) != heading.count * columns:
        raise MeasurementError(
            f"{where}: {len(words)} numbers where its heading promises {heading.count * columns}"
        )
    try:
        return np.array(words, dtype=np.float64).reshape(heading.count, columns)
    except ValueError as error:
        raise MeasurementError(f"{where}: {error}") from None


def _separated(word: str) -> list[str]:
    """Numbers of a word; the word itself where there is more in it than numbers."""
    numbers = _NUMBER.findall(word)
    return numbers if "".join(numbers) == word else [word]


def _binary_table(
    dataset: Dataset, payload: bytes, heading: Heading, columns: int, where: str
) -> Array:
    """Numbers of a dataset 58b.

    The abscissa is single precision by the standard, but some writers store all in double: the
    length of what stands there tells which.
    """
    fields = dataset.identifier.split()
    byte_order = {"1": "<", "2": ">"}.get(fields[1] if len(fields) > 1 else "", "")
    if not byte_order or fields[2:3] != ["2"]:
        raise MeasurementError(
            f"{where}: binary layout {dataset.identifier!r}; allowed are IEEE numbers (2) with "
            "byte order 1 or 2"
        )
    _, size = _ORDINATE[heading.ordinate_type]
    first = [] if heading.is_even else [4]
    layouts = [first + [size] * (columns - len(first)), [size] * columns, [8] * columns]
    for layout in layouts:
        if heading.count > 0 and len(payload) == heading.count * sum(layout):
            row = np.dtype([(f"c{i}", f"{byte_order}f{n}") for i, n in enumerate(layout)])
            rows = np.frombuffer(payload, dtype=row)
            return np.stack([rows[name].astype(np.float64) for name in row.names or ()], axis=1)
    raise MeasurementError(
        f"{where}: {len(payload)} bytes of numbers where its heading promises "
        f"{heading.count * sum(layouts[0])}"
    )


def _frf(function: _Function) -> Frf:
    heading, units, where = function.heading, function.units, function.where
    abscissa, values = function.values()
    if heading.ordinate_type in (2, 4):
        raise MeasurementError(
            f"{where}: the frequency response is stored as real numbers; its phase is missing"
        )
    quantity, factor = _quantity_and_factor(heading, units, where)
    content, frequency_factor = _content(heading.abscissa, units, where)
    if content not in (None, "frequency"):
        raise MeasurementError(f"{where}: the abscissa is a {content}, not a frequency")
    return Frf(
        frequency=abscissa * frequency_factor,
        values=values * factor,
        quantity=quantity,
        response=_point(heading.response),
        reference=_point(heading.reference),
        source=f"{where} ({function.title})" if function.title else where,
    )


def _quantity_and_factor(heading: Heading, units: FileUnits, where: str) -> tuple[Quantity, float]:
    """Quantity of the FRF and factor to SI, from labels and data types of the ordinate."""
    if heading.numerator.unit and not heading.denominator.unit:
        try:
            return frf_unit(heading.numerator.unit)  # the label holds the whole ratio
        except MeasurementError:
            pass
    response, response_factor = _content(heading.numerator, units, where)
    force, force_factor = _content(heading.denominator, units, where)
    if response not in QUANTITY_OF_MOTION or force != "force":
        raise MeasurementError(
            f"{where}: neither unit labels nor data types ({heading.numerator.code} over "
            f"{heading.denominator.code}) say that it is a displacement (8), velocity (11) or "
            "acceleration (12) per force (13)"
        )
    return QUANTITY_OF_MOTION[response], response_factor / force_factor


def _content(axis: Axis, units: FileUnits, where: str) -> tuple[Channel | None, float]:
    """What an axis holds and its factor to SI; None where nothing tells."""
    by_code = _CONTENT.get(axis.code)
    if axis.unit:
        try:
            by_label, factor = channel_unit(axis.unit)
        except MeasurementError as error:
            raise MeasurementError(f"{where}: axis label: {error}") from None
        if by_code not in (None, by_label):
            raise MeasurementError(
                f"{where}: an axis is marked as {by_code} but its unit is {axis.unit!r}"
            )
        return by_label, factor
    if by_code == "force":
        return by_code, 1.0 / units.force
    if by_code in QUANTITY_OF_MOTION:
        return by_code, 1.0 / units.length
    return by_code, 1.0


def _point(node_and_direction: tuple[int, int]) -> Point:
    """Point of a node number and a direction code of a dataset 58."""
    node, code = node_and_direction
    return Point(
        node=str(node) if node else "", direction=_DIRECTIONS[abs(code)], sign=-1 if code < 0 else 1
    )


def _with_coherence(frf: Frf, coherences: list[tuple[Heading, Array]]) -> Frf:
    for heading, values in coherences:
        points = (_point(heading.response), _point(heading.reference))
        if points == (frf.response, frf.reference) and values.shape == frf.frequency.shape:
            return replace(frf, coherence=values)
    return frf


UFF58 = Format(
    name="uff58",
    label="universal file",
    help="datasets 58 and 58b (functions: text, or binary of either byte order) in the units of "
    "dataset 164; others are passed over",
    extensions=(".uff", ".unv", ".uf"),
    read_frfs=read_frfs,
    read_signals=only_record(read_time_records),
    read_records=read_time_records,
    recognises=is_universal,
)
