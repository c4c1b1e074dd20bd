"""What measurement.toml tells of records: [record] and [channels]."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.units import QuantityError, parse

FORCE, DISPLACEMENT, VELOCITY, ACCELERATION = "force", "displacement", "velocity", "acceleration"
#: quantities with a direction
VECTORS = (FORCE, DISPLACEMENT, VELOCITY, ACCELERATION)
TACHO, SPINDLE_POWER = "once per revolution", "spindle power"
DRIVE_TORQUE = "drive torque"
#: of a channel that is left out, whatever its name would tell
UNUSED = "unused"
QUANTITIES = (*VECTORS, TACHO, SPINDLE_POWER, DRIVE_TORQUE, "sound pressure")
SIDES = ("tool", "workpiece")
REST, AIR, CUT = "rest", "air", "cut"
UNKNOWN = "unknown"

RECORD_KEYS = ("begins", "spindle_angle", "speed_tolerance")
CHANNEL_KEYS = ("quantity", "on", "direction", "sign", "axis")
#: largest tolerance of a spindle speed that can be meant
_MOST_TOLERANCE = 0.2


@dataclass(frozen=True)
class Channel:
    """What a channel measures."""

    quantity: str
    on: str = "tool"  # side that a force acts on, or that moves
    direction: tuple[float, float, float] | None = (
        None  # unit vector in the case's axes, or unknown
    )
    has_sign: bool = True  # whether the sense of the direction is known
    axis: str = ""  # of a drive

    @property
    def is_vector(self) -> bool:
        """Whether the quantity has a direction."""
        return self.quantity in VECTORS


@dataclass(frozen=True)
class RecordDescription:
    """How the runs of a measurement were recorded."""

    begins: str = REST  # "rest", "air" or "cut"
    spindle_angle: str = ""  # "unknown", a channel, or empty: the usual column or zero at the start
    speed_tolerance: float = 0.0  # share of the declared spindle speed
    channels: Mapping[str, Channel] = field(default_factory=dict)
    unused: tuple[str, ...] = ()  # channels that are left out

    @property
    def is_settled_only(self) -> bool:
        """Whether runs can only be judged where they are settled."""
        return self.begins != REST or self.spindle_angle == UNKNOWN


def record_of(path: Path, content: Mapping[str, Any]) -> RecordDescription | None:
    """Read [record] and [channels] of the content of measurement.toml; None where there is neither.

    InputError with everything that is wrong.
    """
    if "record" not in content and "channels" not in content:
        return None
    problems: list[str] = []
    channels = _channels(path, content.get("channels", {}), problems)
    table = content.get("record", {})
    if not isinstance(table, dict):
        raise InputError(f"{path}: record: {formatted(table)} is not a table")
    for key in table:
        if key not in RECORD_KEYS:
            problems.append(
                f"{path}: record.{key} is not a key; there are {', '.join(RECORD_KEYS)}"
            )
    begins = table.get("begins", REST)
    if begins not in (REST, AIR, CUT):
        problems.append(
            f'{path}: record.begins: {formatted(begins)} is none of "rest", "air", "cut"'
        )
    angle = table.get("spindle_angle", "")
    if not isinstance(angle, str):
        problems.append(
            f'{path}: record.spindle_angle: {formatted(angle)} is neither "unknown" nor a channel'
        )
    tolerance = _tolerance(path, table.get("speed_tolerance", 0.0), problems)
    if problems:
        raise InputError(problems)
    unused = tuple(name for name, one in channels.items() if one.quantity == UNUSED)
    used = {name: one for name, one in channels.items() if name not in unused}
    return RecordDescription(begins, angle, tolerance, used, unused)


def _tolerance(path: Path, given: Any, problems: list[str]) -> float:
    try:
        value = parse(given, "number").value
    except QuantityError as error:
        problems.append(f"{path}: record.speed_tolerance: {error}")
        return 0.0
    if not 0.0 <= value <= _MOST_TOLERANCE:
        problems.append(
            f"{path}: record.speed_tolerance: {formatted(given)} is not a share from 0 to "
            f'{100.0 * _MOST_TOLERANCE:g} %, such as "0.5 %"'
        )
        return 0.0
    return float(value)


def _channels(path: Path, given: Any, problems: list[str]) -> dict[str, Channel]:
    if not isinstance(given, dict):
        problems.append(f"{path}: channels: {formatted(given)} is not a table of channels")
        return {}
    found = {}
    for name, entry in given.items():
        where = f"{path}: channels.{name}"
        if not isinstance(entry, dict):
            problems.append(
                f'{where}: {formatted(entry)} is not a table such as {{ quantity = "force" }}'
            )
            continue
        problems += [
            f"{where}.{key} is not a key; there are {', '.join(CHANNEL_KEYS)}"
            for key in entry
            if key not in CHANNEL_KEYS
        ]
        found[name] = _channel(where, entry, problems)
    return found


def _channel(where: str, entry: Mapping[str, Any], problems: list[str]) -> Channel:
    quantity, side = entry.get("quantity"), entry.get("on", "tool")
    sign = entry.get("sign")
    for key, value, allowed in (("quantity", quantity, (*QUANTITIES, UNUSED)), ("on", side, SIDES)):
        if value not in allowed:
            problems.append(f"{where}.{key}: {formatted(value)} is none of {', '.join(allowed)}")
    if sign not in (None, UNKNOWN):
        problems.append(f'{where}.sign: {formatted(sign)} is not "unknown"')
    direction = None
    if quantity in VECTORS:
        direction = _direction(where, entry.get("direction"), problems)
    axis = str(entry.get("axis", ""))
    return Channel(str(quantity), str(side), direction, sign != UNKNOWN, axis)


def _direction(where: str, given: Any, problems: list[str]) -> tuple[float, float, float] | None:
    if given == UNKNOWN:
        return None
    is_vector = (
        isinstance(given, Sequence)
        and len(given) == 3
        and all(isinstance(v, (int, float)) and math.isfinite(v) for v in given)
        and any(given)
    )
    if not is_vector:
        problems.append(
            f"{where}.direction: {formatted(given)} is neither a vector such as [1, 0, 0] in the "
            'axes of the case nor "unknown"'
        )
        return None
    length = math.hypot(*given)
    return given[0] / length, given[1] / length, given[2] / length
