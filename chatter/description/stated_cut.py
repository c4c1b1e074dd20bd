"""A cut as a shop states it: m/min at the edge, mm/min of the table, a width in % of the tool.

cutting_speed = pi D n, feed_rate = f_z z n (ISO 3002-1; n in revolutions per time).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from chatter.description.errors import InputError
from chatter.description.path import Step, field_at
from chatter.description.sections.cut import Cut
from chatter.description.sections.tool import Tool
from chatter.description.unit_system import units_of_content
from chatter.description.units import NUMBER, QuantityError, parse, rpm

#: key as a shop states it -> key that it stands for
STATED = {"cutting_speed": "spindle_speed", "feed_rate": "feed_per_tooth"}
#: keys of [cut] of which one takes the other away
ALTERNATIVES = {**STATED, **{own: stated for stated, own in STATED.items()}}
#: keys of [cut] that may be a share of the diameter of the tool, such as "8 %"
_SHARES_OF_DIAMETER = ("radial_depth", "stepover")


def with_stated_cut(data: Any) -> Any:
    """Content of a case with spindle speed, feed per tooth and widths where [cut] states others.

    What cannot be read is left for the sections to tell. ValueError with a sentence where both of
    a pair are given.
    """
    if not isinstance(data, Mapping) or not isinstance(data.get("cut"), Mapping):
        return data
    cut, tool = dict(data["cut"]), data.get("tool")
    for stated, own in STATED.items():
        if cut.get(stated) is None:
            continue
        if cut.get(own) is not None:
            raise ValueError(f"cut.{stated}: cut.{own} is given as well; give one of the two")
        value = _SOLVED[stated](cut, tool)
        if value is not None:
            cut[own] = value
    diameter = _read(Tool, tool, "diameter")
    for key in _SHARES_OF_DIAMETER:
        share = _share(cut.get(key))
        if share is not None and diameter is not None:
            cut[key] = share * diameter
    return {**data, "cut": cut}


#: what the keys of a shop are turned into the others by
_NEEDED = {
    "cutting_speed": "[tool] with a diameter",
    "feed_rate": "[tool] with teeth, and a spindle speed",
}


def unsolved(data: Mapping[str, Any]) -> dict[tuple[Step, ...], str]:
    """Paths of spindle speed and feed per tooth where [cut] states others, and what those need."""
    cut = data.get("cut")
    given = cut if isinstance(cut, Mapping) else {}
    return {
        ("cut", own): f"follows from cut.{stated}, which needs {_NEEDED[stated]}"
        for stated, own in STATED.items()
        if given.get(stated) is not None
    }


def share_in_length(path: str, text: str, diameter: float | None) -> str:
    """Values or a range with shares of the diameter, m, of a key that may be one, as lengths.

    "2..50 %" is meant as 2 %..50 %. Anything else stays as it is.
    """
    key = path.removeprefix("cut.")
    if key not in _SHARES_OF_DIAMETER or key == path or "%" not in text or diameter is None:
        return text
    ends = text.split("..", 1)
    if len(ends) == 2 and re.fullmatch(rf"\s*{NUMBER}\s*", ends[0]):
        ends[0] += " %"

    def length(found: re.Match[str]) -> str:
        return f"{float(found[1]) * 10.0 * diameter:.12g} mm"

    return "..".join(re.sub(rf"({NUMBER})\s*%", length, end) for end in ends)


def refuse_both_of_a_pair(values: Mapping[str, Any]) -> None:
    """Raise InputError where assignments give a spindle speed and a cutting speed, or such."""
    for stated, own in STATED.items():
        if values.get(f"cut.{stated}") is not None and values.get(f"cut.{own}") is not None:
            raise InputError(
                f"--set: cut.{stated}: cut.{own} is given as well; give one of the two"
            )


def _share(given: Any) -> float | None:
    """Read a text such as "8 %"; None for anything else, which the section itself tells."""
    if not isinstance(given, str) or not given.rstrip().endswith("%"):
        return None
    try:
        share = parse(given, "number")
    except QuantityError:
        return None
    return share.value if share.value > 0.0 and not share.deviation else None


def _spindle_speed(cut: Mapping[str, Any], tool: Any) -> float | None:
    speed, diameter = _read(Cut, cut, "cutting_speed"), _read(Tool, tool, "diameter")
    return None if speed is None or not diameter else 2.0 * speed / diameter


def _feed_per_tooth(cut: Mapping[str, Any], tool: Any) -> float | None:
    feed, speed = _read(Cut, cut, "feed_rate"), _read(Cut, cut, "spindle_speed")
    teeth = tool.get("teeth") if isinstance(tool, Mapping) else getattr(tool, "teeth", None)
    if feed is None or not speed or not isinstance(teeth, int) or teeth < 1:
        return None
    chip, most = feed * 2.0 * math.pi / (speed * teeth), field_at(Cut, ("feed_per_tooth",)).at_most
    if chip > most:
        units = units_of_content({"cut": cut, "tool": tool})
        length = units.length
        raise ValueError(
            f"cut.feed_rate: {units.feed_rate.text(feed)} at {rpm(speed):.4g} rpm is "
            f"{length.text(chip)} for each of {teeth} teeth; at most {length.text(most, 'g')} is "
            "allowed; a unit may be wrong, that of the speed too"
        )
    return chip


_SOLVED: dict[str, Callable[[Mapping[str, Any], Any], float | None]] = {
    "cutting_speed": _spindle_speed,
    "feed_rate": _feed_per_tooth,
}


def _read(section: type, table: Any, key: str) -> float | None:
    given = table.get(key) if isinstance(table, Mapping) else getattr(table, key, None)
    field = field_at(section, (key,))
    if given is None or field is None:
        return None
    try:
        return field.read(given)
    except ValueError:
        # told by the section itself
        return None
