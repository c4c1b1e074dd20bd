"""Units as shops and control panels spell them, and what to write where one is not taken."""

from __future__ import annotations

import re
import unicodedata
from fractions import Fraction

#: words for a turn: Umdrehung, tour, giro, vuelta, obrót, otáčka
_TURN = (
    r"(?:U(?:mdr(?:ehungen)?)?\.?|tours?|tr|t|giri|vueltas?|obr|ot|r|revs?|revolutions?"
    r"|rotations?|turns?|1)?"
)
_SPEEDS = (
    (
        re.compile(
            rf"{_TURN}\s*/\s*(?:min|mn|minute)\.?|r\.?\s?p\.?\s?m\.?|u\.?\s?p\.?\s?m\.?"
            r"|(?:U\s*)?min\s*(?:\^|\*\*)?\s*(?:\(-1\)|-1|⁻¹)",
            re.IGNORECASE,
        ),
        "rpm",
    ),
    (
        re.compile(
            rf"{_TURN}\s*/\s*(?:s|sec|second)\.?|r\.?p\.?s\.?|s\s*(?:\^|\*\*)?\s*(?:\(-1\)|-1|⁻¹)",
            re.IGNORECASE,
        ),
        "rev/s",
    ),
)
#: the same where the quantity may be any: what is nothing else in the units library
_SPEED_OF_ANY = re.compile(r"U/min|tr/min|r/min|RPM|Rpm|U/s|min-1", re.ASCII)

#: words of a unit -> as the units library has them; those that it would misread or does not know
WORDS = {
    "Ns": "(N*s)", "mil": "thou", "ips": "(inch/s)", "Nm": "(N*m)", "Nmm": "(N*mm)",
    "Ncm": "(N*cm)", "kNm": "(kN*m)", "MM": "mm", "KW": "kW", "KN": "kN", "hz": "Hz", "HZ": "Hz",
    "KHz": "kHz", "khz": "kHz", "Mpa": "MPa", "PS": "metric_horsepower", "CV": "metric_horsepower",
    "ipm": "(inch/min)", "IPM": "(inch/min)", "sfm": "(foot/min)", "SFM": "(foot/min)",
    "sfpm": "(foot/min)", "SFPM": "(foot/min)", "ipt": "inch", "IPT": "inch",
}  # fmt: skip

_OF_TOOTH = re.compile(r"(?P<length>\w+)\s*/\s*(?:tooth|teeth|z|Z|flute|Zahn|dent)")
_OF_TURN = re.compile(r"(?P<length>\w+)\s*/\s*(?:rev|r|U|tr|turn)")
_GROUPED = re.compile(r"[+-]?[0-9]{1,3}(?:[' \u2019\u00a0\u202f][0-9]{3})+(?![0-9])")
_COMMA_OF_THREE = re.compile(r"\s*([+-]?[1-9][0-9]{0,2}),([0-9]{3})\s*([^0-9,.]*)")
#: "1/2", "1 1/4", "1-1/4", before a unit
_FRACTION = re.compile(
    r"(?<![0-9,/*^A-Za-z])(?<!(?<!\.)\.)(?<![eE][+-])"  # behind "..", not within a number or unit
    r"(?P<sign>[+-]?)(?:(?P<whole>[0-9]+)(?:\s+|\s*-\s*))?(?P<top>[0-9]+)\s*/\s*(?P<bottom>[0-9]+)"
    r"(?=\s*(?:[A-Za-zµμ\"″”]|\+-|\+/-|±|\.\.|$))"
)
#: one character with a fraction: ½, ¼, ⅜, with the whole number before it
_VULGAR = re.compile(r"([0-9]?)\s*([¼½¾⅐-⅞])")
_FRACTION_SLASH = "\u2044"
#: marks of an inch behind a number
_INCH_MARK = re.compile(r"(?:(?<=[0-9])|(?<=[0-9]\.))\s*(?:\"|″|”|'')")
_LENGTHS = ("mm", "um", "m", "in", "inch")


def speed_of_shop(unit: str) -> str | None:
    """Unit of a spindle speed, "rpm" or "rev/s", of one as a shop spells it; None of others."""
    return next((own for spelt, own in _SPEEDS if spelt.fullmatch(unit.strip())), None)


def speed_of_any(unit: str) -> str | None:
    """As `speed_of_shop`, of a unit that may be of any quantity: a ton a minute is no speed."""
    return speed_of_shop(unit) if _SPEED_OF_ANY.fullmatch(unit.strip()) else None


def advice(number: str, unit: str, dimension: str) -> str | None:
    """What to write in place of a number and a unit that is known to be meant otherwise."""
    per_tooth, per_turn = _OF_TOOTH.fullmatch(unit), _OF_TURN.fullmatch(unit)
    if dimension == "length" and per_tooth and per_tooth["length"] in _LENGTHS:
        return f'is a feed per tooth; a length is required: write "{number} {per_tooth["length"]}"'
    if dimension in ("length", "velocity") and per_turn and per_turn["length"] in _LENGTHS:
        return (
            "is per angle or turn; a length is required: cut.feed_per_tooth is the feed of a "
            f'revolution over the number of teeth, such as "0.05 {per_turn["length"]}"'
        )
    if dimension == "angle" and unit in ("Grad", "grad", "grade", "grads"):
        return f'may be degrees or gon; write "{number} deg", or "{number} gon"'
    return None


def advice_on_number(given: str) -> str | None:
    """What to write in place of a text whose number is not written as numbers are here."""
    grouped = _GROUPED.match(given.strip())
    if grouped:
        digits = re.sub(r"[^0-9+-]", "", grouped[0])
        return f'has digits in groups; write "{digits}{given.strip()[grouped.end() :]}"'
    comma = _COMMA_OF_THREE.fullmatch(given)
    if comma:
        whole, part, unit = comma.groups()
        return f'has a comma; write "{whole}{part} {unit}", or "{whole}.{part} {unit}"'
    return None


def with_decimals(text: str) -> str:
    """Text whose fractions are decimal numbers: ``1 1/4 in`` is ``1.25 in``, ``½"`` ``0.5 in``.

    A fraction needs a unit behind it, or another end of a range; whatever else stands there stays.
    """
    if "/" not in text and not _INCH_MARK.search(text) and not _VULGAR.search(text):
        return text
    text = _INCH_MARK.sub(" in", _VULGAR.sub(_spelt_out, text))
    return _FRACTION.sub(_decimal, text)


def _spelt_out(found: re.Match[str]) -> str:
    whole, part = found.groups()
    return f"{whole} {unicodedata.normalize('NFKC', part).replace(_FRACTION_SLASH, '/')}".strip()


def _decimal(found: re.Match[str]) -> str:
    bottom = int(found["bottom"])
    if not bottom:
        return found[0]
    value = int(found["whole"] or 0) + Fraction(int(found["top"]), bottom)
    return f"{found['sign']}{float(value):.15g}"
