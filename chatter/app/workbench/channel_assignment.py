"""Channels and runs of dropped records described by hand, as text of measurement.toml."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn
import tomlkit

from chatter.app.workbench.page_words import in_words_of_the_page
from chatter.app.workbench.wrapped_text import wrapped_text
from chatter.description.assignments import parse_assignments
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement_file import overrides_of_run
from chatter.explain.records.case_axes import USUAL
from chatter.explain.records.description import QUANTITIES, REST, SIDES, UNKNOWN, UNUSED, VECTORS
from chatter.io.signals import read_signals

_BEGINS = (REST, "air", "cut")
#: key of a run -> heading, and the unit of a bare number
_OF_A_RUN = {
    "spindle_speed": ("spindle speed", "rpm"),
    "feed_per_tooth": ("feed per tooth", "mm"),
    "axial_depth": ("axial depth", "mm"),
    "radial_depth": ("radial depth", "mm"),
}
_ORIENTED = {f"{sign}{axis}": [factor * (one == axis) for one in "xyz"]
             for sign, factor in (("", 1), ("+", 1), ("-", -1)) for axis in "xyz"}  # fmt: skip


class ChannelAssignment:
    """What each channel of the records is, by hand, and what each run differs in from the case.

    Parameters
    ----------
    changed : callable
        Called when an assignment has changed.
    declared : callable
        Returns the case that runs differ from, or None where there is none yet.
    """

    def __init__(
        self, changed: Callable[[], None], declared: Callable[[], Case | None] = lambda: None
    ) -> None:
        self._changed, self._declared = changed, declared
        self.kind = pn.widgets.Select(label="Kind", options=list(KINDS), width=130)
        self.begins = pn.widgets.Select(label="Record begins", options=list(_BEGINS), width=130)
        self.angle = pn.widgets.Checkbox(label="spindle angle unknown", value=True)
        self.channels: dict[str, tuple[Any, ...]] = {}
        self.runs: dict[str, RunFields] = {}
        self._rows = pn.Column(pn.pane.Str("Drop records without a measurement.toml to assign "
                                           "their channels here."))  # fmt: skip
        for widget in (self.kind, self.begins, self.angle):
            widget.param.watch(lambda _: self._changed(), "value")
        self.kind.param.watch(lambda _: self._show_rows(), "value")

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the form for the page."""
        return pn.Column(pn.Row(self.kind, self.begins), self.angle, self._rows, width=720)

    def begin(self) -> None:
        """Forget what was assigned in the measurement before."""
        self.channels, self.runs = {}, {}
        self.kind.value = next(iter(KINDS))

    def offer(self, records: list[Path]) -> None:
        """Make a row for every channel of the records and for every run."""
        names: dict[str, None] = {}
        for path in records:
            names |= dict.fromkeys(read_signals(path))
        # what was assigned stays: records come one by one
        self.channels = {name: self.channels.get(name) or self._watched(_assignment(name))
                         for name in names if not _is_time(name)}  # fmt: skip
        self.runs = {path.name: self.runs.get(path.name)
                     or RunFields(path.name, self._changed, self._declared)
                     for path in records}  # fmt: skip
        self._show_rows()

    def _show_rows(self) -> None:
        if not self.runs or KINDS[self.kind.value].table_key:
            told = "One table of the kind; no channel is to be assigned." if self.runs else ""
            self._rows.objects = [pn.pane.Str(told)]
            return
        rows = [
            pn.Row(pn.pane.Str(name, width=110), *widgets)
            for name, widgets in self.channels.items()
        ]
        self._rows.objects = [
            pn.pane.Markdown(
                "What each channel measures, on which side, and along which direction of the case: "
                "`x` (feed), `-y`, `0.7, 0.7, 0`, or `unknown`. A channel that measures nothing "
                "here is left out:"
            ),
            *rows,
            pn.pane.Markdown("What each run differs in from the case, with units of your choice:"),
            *self.runs.values(),
        ]

    def _watched(self, widgets: tuple[Any, ...]) -> tuple[Any, ...]:
        for widget in widgets:
            widget.param.watch(lambda _: self._changed(), "value")
        return widgets

    def toml(self, case: str) -> str:
        """Text of measurement.toml; InputError if a run is no list of assignments."""
        document = tomlkit.document()
        document["kind"], document["case"] = self.kind.value, case
        table = KINDS[self.kind.value].table_key
        if table:
            # one table holds all of them
            document[table] = next(iter(self.runs), "")
            return tomlkit.dumps(document)
        given = {
            name: (quantity.value, side.value, direction.value.strip())
            for name, (quantity, side, direction) in self.channels.items()
        }
        # what a usual name tells needs no words, what it would tell wrongly does
        assigned = {name: one for name, one in given.items() if one[0] and one != _usual(name)}
        left_out = [name for name, one in given.items() if name in USUAL and not one[0]]
        if assigned or self.begins.value != REST:
            record = {"begins": self.begins.value}
            if self.angle.value:
                record["spindle_angle"] = UNKNOWN
            document["record"] = record
        if assigned or left_out:
            channels = tomlkit.table()
            for name, (quantity, side, direction) in assigned.items():
                channels[name] = _entry(name, quantity, side, direction)
            for name in left_out:
                channels[name] = _entry(name, UNUSED, "", "")
            document["channels"] = channels
        runs = tomlkit.aot()
        for name, fields in self.runs.items():
            runs.append(tomlkit.item({"file": name, **fields.values()}))
        document["run"] = runs
        return tomlkit.dumps(document)


class RunFields:
    """What a run differs in from the case: fields of what shops change, and a line of others.

    Parameters
    ----------
    name : str
        File of the run.
    changed : callable
        Called when a field has changed.
    declared : callable
        Returns the case that the run differs from, or None where there is none yet.
    """

    def __init__(
        self,
        name: str,
        changed: Callable[[], None],
        declared: Callable[[], Case | None] = lambda: None,
    ) -> None:
        self._name, self._declared = name, declared
        #: what is wrong with a field, below it
        self.fault = wrapped_text(width=640, styles={"color": "#c62828"})
        self.fields = {
            key: pn.widgets.TextInput(label=heading, placeholder=unit, width=105)
            for key, (heading, unit) in _OF_A_RUN.items()
        }
        self.others = pn.widgets.TextInput(
            label="others", placeholder="mode=up; cut_time=10 s", width=170
        )
        for widget in (*self.fields.values(), self.others):
            widget.param.watch(lambda _: self._check(), "value")
            widget.param.watch(lambda _: changed(), "value")

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the fields for the page."""
        row = pn.Row(*self.fields.values(), self.others)
        return pn.Column(pn.pane.Str(self._name), row, self.fault)

    def _check(self) -> None:
        """Say what the case cannot take; the fields are all right where there is no case yet."""
        declared, told = self._declared(), ""
        try:
            values = self.values()
            if declared is not None:
                overrides_of_run(self._name, values, declared)
        except InputError as error:
            told = in_words_of_the_page(str(error))
        self.fault.object = told

    def values(self) -> dict[str, Any]:
        """Return what differs by key, as a file states it; InputError for what is no assignment."""
        found: dict[str, Any] = {}
        for key, widget in self.fields.items():
            text = widget.value.strip()
            if text:
                found[key] = f"{text} {_OF_A_RUN[key][1]}" if _is_number(text) else text
        given = [one.strip() for one in self.others.value.split(";") if one.strip()]
        for one in given:
            if not all(part.strip() for part in one.partition("=")):
                raise InputError(
                    f'{self._name}: others: "{one}": NAME=VALUE is required, such as '
                    "cut_time=10 s, with ; between two of them"
                )
        return {**found, **parse_assignments(given)}


def _assignment(name: str) -> tuple[Any, Any, Any]:
    """Quantity, side and direction of a channel: at first what its name tells."""
    quantity, side, direction = _usual(name)
    return (
        pn.widgets.Select(options=["", *QUANTITIES], value=quantity, width=160),
        pn.widgets.Select(options=list(SIDES), value=side, width=115),
        pn.widgets.TextInput(placeholder="direction", value=direction, width=150),
    )


def _usual(name: str) -> tuple[str, str, str]:
    """Quantity, side and direction that a name tells; no quantity where it tells none."""
    found = USUAL.get(name)
    if found is None:
        return "", SIDES[0], ""
    return found.quantity, SIDES[0], "xyz"[found.direction.index(1.0)]


def _entry(name: str, quantity: str, side: str, direction: str) -> Any:
    entry: dict[str, Any] = {"quantity": quantity}
    if quantity in VECTORS:
        entry["on"] = side
        entry["direction"] = _direction(name, direction)
    found = tomlkit.inline_table()
    found.update(entry)
    return found


def _direction(name: str, text: str) -> Any:
    """Direction as a file states it: an axis with its sign, three numbers, or unknown."""
    given = text.lower().replace(" ", "")
    if given in ("", UNKNOWN):
        return UNKNOWN
    if given in _ORIENTED:
        return _ORIENTED[given]
    parts = given.strip("[]()").split(",")
    if len(parts) == len("xyz") and all(map(_is_number, parts)):
        return [float(one) for one in parts]
    raise InputError(
        f'channel {name}: direction: "{text}" is not an axis such as -y, three numbers such as '
        "0.7, 0.7, 0, or unknown"
    )


def _is_number(text: str) -> bool:
    return re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", text.strip().lower()) is not None


def _is_time(name: str) -> bool:
    return name.strip().lower() in ("time", "t")
