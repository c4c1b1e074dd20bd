"""Trace sessions of SINUMERIK Operate in XML: signals of a drive, each recorded as it changes.

The layout is that of saved sessions: a dataFrame holds a dataSignal for each channel and a rec for
each instant, with the values that changed. Units are not in the file, only classes of them.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np

from chatter.io.files import read_content
from chatter.io.formats.format import Format
from chatter.io.table import Column, Table, table_of
from dynamics.frf.container import MeasurementError

_NO_BRACKETS = str.maketrans("[]()", "    ")
_TRUTH = {"true": 1.0, "false": 0.0}


def read_trace(path: Path) -> Table:
    """Time and signals of a saved trace session.

    A value that is not repeated holds. Headings are the descriptions of the signals, and their
    names behind them where two are alike.

    MeasurementError if the file is no XML, has no data, more than one frame, or a value that is no
    number; the message names file and signal.
    """
    frame = _frame(path)
    signals = frame.findall("dataSignal")
    records = frame.findall("rec")
    if not signals or not records:
        raise MeasurementError(f"{path}: the trace holds no samples; record it before saving")
    time = np.array([_number(path, "time", one.get("time")) for one in records])
    columns = [Column("time [s]", time)]
    descriptions = [_label(one) for one in signals]
    for signal, label in zip(signals, descriptions, strict=True):
        name = (signal.get("name") or "").translate(_NO_BRACKETS).strip()
        heading = f"{label} {name}".strip() if descriptions.count(label) > 1 else label
        columns.append(Column(heading, _held(path, heading, signal.get("id") or "", records)))
    return table_of(path, columns, "signals")


def _frame(path: Path) -> ElementTree.Element:
    raw = read_content(path)

    def refuse(*_: Any) -> None:
        raise MeasurementError(f"{path}: declares entities, which no trace does; it is not read")

    # in whatever encoding: the parser that meets a declaration sees it decoded
    scan = expat.ParserCreate()
    scan.StartDoctypeDeclHandler = refuse
    try:
        scan.Parse(raw, True)
        root = ElementTree.fromstring(raw)
    except (ElementTree.ParseError, expat.ExpatError) as error:
        raise MeasurementError(f"{path}: is no whole XML file ({error})") from None
    frames = root.findall("./traceData/dataFrame")
    if len(frames) != 1:
        raise MeasurementError(
            f"{path}: holds {len(frames)} frames of data (traceData/dataFrame); save one a file"
        )
    return frames[0]


def _label(signal: ElementTree.Element) -> str:
    text = signal.get("description") or signal.get("name") or signal.get("id") or ""
    # what stands in brackets of a heading is a unit, which a description has not
    return " ".join(text.translate(_NO_BRACKETS).split())


def _held(path: Path, heading: str, key: str, records: list[ElementTree.Element]) -> np.ndarray:
    """Values at all instants; what is not written is as it was before."""
    values = np.empty(len(records))
    last = None
    for row, record in enumerate(records):
        text = record.get(key)
        if text is not None:
            last = _number(path, heading, text)
        if last is None:
            raise MeasurementError(f'{path}: "{heading}" has no value at the start of the trace')
        values[row] = last
    return values


def _number(path: Path, heading: str, text: str | None) -> float:
    text = (text or "").strip()
    if text.lower() in _TRUTH:
        return _TRUTH[text.lower()]
    try:
        return float(text)
    except ValueError:
        raise MeasurementError(f'{path}: "{heading}": {text[:40]!r} is not a number') from None


SINUMERIK_TRACE = Format(
    name="sinumerik-trace",
    label="trace of SINUMERIK Operate",
    help="signals by their description, without units; a value that is not repeated holds",
    extensions=(".xml",),
    read_signals=read_trace,
    recognises=lambda head: b"<trace" in head and b"<?xml" in head[:200],
)
