"""JSON schema of measurement.toml, from the lists that its readers check keys by."""

from typing import Any

from chatter.explain import measurement_file
from chatter.explain.kinds.kind_list import KINDS, OF_PARTS
from chatter.explain.records import description
from chatter.stability.case_schema import schema as case_schema

_TEXT = {"type": "string"}
_SHARE = {"type": "number", "minimum": 0.0, "exclusiveMaximum": 10.0}
_VALUE = {"anyOf": [{"type": "number"}, {"type": "string"}]}


def measurement_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of measurement.toml."""
    case = case_schema()
    properties = {
        "title": _TEXT,
        "kind": {"enum": list(KINDS), "description": "what was measured"},
        "case": {**_TEXT, "description": "file of the case as declared"},
        "points": {**_TEXT, "description": "table of cutting tests"},
        "run": {"type": "array", "items": {"$ref": "#/$defs/Run"}},
        "tolerance": {
            "type": "object",
            "description": "shares by key or path within which declared values are uncertain",
            "additionalProperties": {
                "anyOf": [_SHARE, {"type": "object", "additionalProperties": _SHARE}]
            },
        },
        "idle_power": {**_quantity("1 kW"), "description": "power of the spindle in air"},
        "record": {"$ref": "#/$defs/Record"},
        "channels": {"type": "object", "additionalProperties": {"$ref": "#/$defs/Channel"}},
        "next_measurement": {
            "type": "object",
            "description": "path of the case = least and largest value that may be tried",
            "additionalProperties": {
                "type": "array",
                "items": _VALUE,
                "minItems": 2,
                "maxItems": 2,
            },
        },
    }
    properties["part"] = {"type": "array", "items": {"$ref": "#/$defs/Part"}}
    part = {
        "type": "object",
        "description": "What was measured of one kind, where the kind of the whole is set-up.",
        "properties": {key: properties[key] for key in measurement_file.PART_KEYS},
        "required": ["kind"],
        "additionalProperties": False,
    }
    part["properties"]["kind"] = {"enum": list(OF_PARTS), "description": "what was measured"}
    sections = {"Run": _run(case), "Record": _record(), "Channel": _channel(), "Part": part}
    return {
        "$schema": case["$schema"],
        "$defs": {**case["$defs"], **sections},
        "type": "object",
        "properties": {key: properties.get(key, {}) for key in measurement_file.KEYS},
        "required": ["kind", "case"],
        "additionalProperties": False,
        "title": "chatter measurement file",
        "description": "What was measured, the declared case, and the runs.",
    }


def _quantity(example: str) -> dict[str, Any]:
    return {"anyOf": [{"type": "string", "examples": [example]}, {"type": "number"}]}


def _run(case: dict[str, Any]) -> dict[str, Any]:
    """Own keys of a run, short keys of sections of the case, and dotted paths."""
    own = dict.fromkeys(measurement_file.OWN_KEYS, _TEXT)
    short: dict[str, Any] = {}
    for section in reversed(measurement_file.SECTIONS):
        name = case["properties"][section]["$ref"].rpartition("/")[2]
        short.update(case["$defs"][name]["properties"])
    return {
        "type": "object",
        "description": "Signals of a run, and what differs from the case.",
        "properties": {**short, "cut_time": _quantity("90 s"), **own},
        "patternProperties": {r"\.": {}},
        "required": ["file"],
        "additionalProperties": False,
    }


def _record() -> dict[str, Any]:
    return {
        "type": "object",
        "description": "How the runs were recorded.",
        "properties": {
            "begins": {"enum": [description.REST, description.AIR, description.CUT]},
            "spindle_angle": {**_TEXT, "examples": [description.UNKNOWN]},
            "speed_tolerance": _quantity("0.5 %"),
        },
        "additionalProperties": False,
    }


def _channel() -> dict[str, Any]:
    vector = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
    return {
        "type": "object",
        "description": "What a channel of the files measures.",
        "properties": {
            "quantity": {"enum": list(description.QUANTITIES)},
            "on": {"enum": list(description.SIDES)},
            "direction": {"anyOf": [{"enum": [description.UNKNOWN]}, vector]},
            "sign": {"enum": [description.UNKNOWN]},
            "axis": _TEXT,
        },
        "required": ["quantity"],
        "additionalProperties": False,
    }
