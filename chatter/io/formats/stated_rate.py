"""Sampling rate that the lines above a table state: ``Sampling rate [Hz]: 10000``."""

from __future__ import annotations

import re
from collections.abc import Sequence

from chatter.io.table import split_heading

_RATE = (
    r"(?:sampl(?:e|ing)[ _-]*(?:rate|freq(?:uency|\.)?)|abtast(?:rate|frequenz)"
    r"|(?:scan|acquisition)[ _-]*rate|fs|f_s)"
)
_STEP = (
    r"(?:delta[ _-]*t|dt|Δt|sampl(?:e|ing)[ _-]*(?:interval|period)|abtast(?:intervall|periode)"
    r"|time[ _-]*(?:step|interval|increment))"
)
#: a name, a unit before or behind the number
_LINE = re.compile(
    rf"\W*(?:(?P<rate>{_RATE})|(?P<step>{_STEP}))\s*(?:[\[(](?P<before>[^\])]*)[\])])?\"?"
    r"\s*[:=;,\t ]+\s*\"?(?P<number>[0-9]*[.,]?[0-9]+(?:[eE][+-]?[0-9]+)?)\"?"
    r"[\s,;\[(]*(?P<behind>[^\s,;\])\"]*)[\s,;\])\"]*",
    re.IGNORECASE,
)
#: a number with its thousands in groups, or with a decimal comma
_GROUPS = re.compile(r"[1-9][0-9]{0,2},[0-9]{3}")
#: Hz of a unit of a rate, and s of one of a step, in lower case
_RATES = {
    **dict.fromkeys(("", "hz", "s/s", "sa/s", "1/s", "samples/s", "samples/sec", "sps"), 1.0),
    **dict.fromkeys(("khz", "ks/s", "ksa/s", "ksps"), 1e3),
    **dict.fromkeys(("mhz", "ms/s", "msa/s", "msps"), 1e6),
}
_STEPS = {
    **dict.fromkeys(("s", "sec", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec"), 1e-3),
    **dict.fromkeys(("us", "µs", "μs"), 1e-6),
    "ns": 1e-9,
}
_TIME = re.compile(r"(t|time|zeit|x[_ ]?value|timestamp|date|datum|freq|frequenz)\b", re.IGNORECASE)
_OF_TIME = ("s", "ms", "us", "Hz", "kHz", "min", "h")


def stated_step(lines: Sequence[str]) -> float | None:
    """Step of time, s, that lines state; None where none does, or they differ."""
    found = {_step_of(line) for line in lines} - {None}
    return found.pop() if len(found) == 1 else None


def _step_of(line: str) -> float | None:
    match = _LINE.fullmatch(line.strip())
    if match is None or _GROUPS.fullmatch(match["number"]):
        return None
    unit = (match["before"] or match["behind"] or "").strip().lower()
    factor = (_RATES if match["rate"] else _STEPS).get(unit)
    value = float(match["number"].replace(",", "."))
    if factor is None or not value > 0.0:
        return None
    return 1.0 / (factor * value) if match["rate"] else factor * value


def is_over_time_or_frequency(heading: str) -> bool:
    """Whether a column, by its name or unit, is what the others are over."""
    name, unit = split_heading(heading)
    return bool(_TIME.match(name)) or unit in _OF_TIME
