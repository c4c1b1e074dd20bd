"""JSON schema of measurement.toml, from the lists that its readers check keys by."""

from typing import Any

from chatter.explain import measurement_file
from chatter.explain.kinds.kind_list import KINDS, OF_PARTS
from chatter.explain.records import description
from chatter.stability.case_schema import schema as case_schema

_TEXT = {"type": "string"}
_SHARE = {"type": "number", "minimum": 0.0, "exclusiveMaximum": 10.0}
_VALUE = {"anyOf": [{"type": "number"}, {"type": "string"}]}

#: own keys of a run -> what they are
_OWN: dict[str, dict[str, Any]] = {
    "file": {"examples": ["run01.csv"], "description": "signals of the run"},
    "columns": {
        "examples": ["time [s], Fx [N], Fy [N]"],
        "description": "names and units of all columns of the file, instead of its own",
    },
    "from": {"examples": ["1.5 s"], "description": "part of the record: since its first sample"},
    "to": {"examples": ["4 s"], "description": "end of that part"},
    "condition": {"examples": ["idle"], "description": "of FRFs: idle, in the cut, ..."},
    "direction": {"examples": ["x"], "description": "of an FRF at the tool point"},
    "excite": {
        "examples": ["tool:x"],
        "description": "of an FRF of a machine: point and direction of the force",
    },
    "axis": {"examples": ["Y"], "description": "of a move: axis of the machine"},
    "read": {"description": "the same of the response; by default where it is excited"},
    "title": {"description": "free text"},
}


def measurement_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of measurement.toml."""
    case = case_schema()
    properties = {
        "title": {**_TEXT, "description": "free text; by default the name of the folder"},
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
    own = {key: {**_TEXT, **_OWN.get(key, {})} for key in measurement_file.OWN_KEYS}
    cut_time = {**_quantity("90 s"), "description": "that the tool had cut before the run"}
    short: dict[str, Any] = {}
    for section in reversed(measurement_file.SECTIONS):
        name = case["properties"][section]["$ref"].rpartition("/")[2]
        short.update(case["$defs"][name]["properties"])
    return {
        "type": "object",
        "description": "Signals of a run, and what differs from the case.",
        "properties": {**short, "cut_time": cut_time, **own},
        "patternProperties": {r"\.": {}},
        "required": ["file"],
        "additionalProperties": False,
    }


def _record() -> dict[str, Any]:
    return {
        "type": "object",
        "description": "How the runs were recorded.",
        "properties": {
            "begins": {
                "enum": [description.REST, description.AIR, description.CUT],
                "default": description.REST,
                "description": "from rest at full immersion, before the front edge of the block, "
                "or in the middle of the cut",
            },
            "spindle_angle": {
                **_TEXT,
                "examples": [description.UNKNOWN],
                "description": "unknown, or the channel that holds it; by default the column "
                "spindle_angle, or zero at the start",
            },
            "speed_tolerance": {
                **_quantity("0.5 %"),
                "description": "share by which the declared spindle speed may be off",
            },
        },
        "additionalProperties": False,
    }


def _channel() -> dict[str, Any]:
    vector = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
    return {
        "type": "object",
        "description": "What a channel of the files measures.",
        "properties": {
            "quantity": {
                "enum": [*description.QUANTITIES, description.UNUSED],
                "description": "what it holds; an unused one is left out, whatever its name tells",
            },
            "on": {
                "enum": list(description.SIDES),
                "default": description.SIDES[0],
                "description": "side that a force acts on, or that moves",
            },
            "direction": {
                "anyOf": [{"enum": [description.UNKNOWN]}, vector],
                "description": "in the axes of the case, of a force or a motion; it is found where "
                "it is unknown",
            },
            "sign": {
                "enum": [description.UNKNOWN],
                "description": "where the sense of the direction is not known",
            },
            "axis": {**_TEXT, "examples": ["X"], "description": "of a drive torque"},
        },
        "required": ["quantity"],
        "additionalProperties": False,
    }
