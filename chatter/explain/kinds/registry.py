"""Kinds of measurement by name: where a new one joins."""

from __future__ import annotations

from chatter.explain.kinds.axis import Axis
from chatter.explain.kinds.frf import FrequencyResponse
from chatter.explain.kinds.kind import Kind
from chatter.explain.kinds.milling import Milling
from chatter.explain.kinds.stability import Stability
from chatter.explain.measurement import Measurement

KINDS: dict[str, type] = {
    "milling": Milling,
    "axis": Axis,
    "stability": Stability,
    "frf": FrequencyResponse,
}


def kind_of(measurement: Measurement) -> tuple[Kind, Measurement]:
    """Kind of a measurement, and the measurement prepared for it.

    Raises
    ------
    InputError
        If the measurement or its case lacks what the kind needs.
    """
    kind = KINDS[measurement.kind]()
    require_sections(measurement)
    prepared = getattr(kind, "prepared", None)
    return kind, prepared(measurement) if prepared else measurement


def require_sections(measurement: Measurement) -> None:
    """Raise InputError where the case lacks a section that the kind of measurement needs."""
    needed = {"axis": ("axis",), "frf": ("structure",)}
    measurement.case.require(
        *needed.get(measurement.kind, ("tool", "material", "cut", "structure"))
    )
