"""A first case file from five answers: tool, material, cut, engagement, dynamics."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import tomlkit

from chatter.description.case import Case, loads
from chatter.description.errors import InputError
from chatter.description.formatting import to_digits
from chatter.description.units import rpm


class Question(NamedTuple):
    """One question: what is asked, an example of an answer, and its parts."""

    text: str
    example: str
    parts: str


QUESTIONS = {
    "tool": Question("Tool: diameter, teeth", "12 mm, 4", "a diameter and a number of teeth"),
    "material": Question(
        "Material: name of `chatter materials`, or Ktc and Krc",
        "Al7075-T6",
        "a name, or two coefficients such as 700 MPa, 210 MPa",
    ),
    "cut": Question(
        "Cut: spindle speed, feed per tooth, axial depth",
        "8000 rpm, 0.05 mm, 1 mm",
        "a speed, a feed and a depth",
    ),
    "engagement": Question(
        'Engagement: "slot", or "up" or "down" and the radial depth',
        "down, 6 mm",
        'slot, or "up" or "down" and a radial depth',
    ),
    "dynamics": Question(
        "Dynamics: FRF files along x and y, or frequency, damping ratio and stiffness",
        "900 Hz, 0.03, 15 N/um",
        "files, or three quantities of one mode, taken alike in x and y",
    ),
}


#: "4", "4 flutes", "z4", "Z = 4"
_TEETH = re.compile(r"(?:z\s*=?\s*)?(\d+)(?:\s*(?:teeth|tooth|flutes?|inserts?|edges?))?", re.I)
#: what may stand before a diameter
_DIAMETER_SIGN = re.compile(r"^(?:[Øø⌀]|D(?:ia(?:meter|\.)?)?(?![a-z]))\s*=?\s*", re.I)
#: "slot", "up, 9 mm", "down-milling 2,5 mm"
_ENGAGEMENT = re.compile(r"\s*([a-z]+)(?:[\s-]*milling\b)?[\s,;]*(.*?)\s*", re.I)
#: words of the shop, "climb milling, 6 mm"
_MODES = {"slotting": "slot", "climb": "down", "conventional": "up"}


def first_case(answers: dict[str, str], folder: str | Path = ".") -> str:
    """Text of a case file from an answer to each of `QUESTIONS`.

    Parameters
    ----------
    answers : dict of str to str
        By the name of the question; parts apart by commas.
    folder : path
        Where the case is to lie: files of FRFs are named as seen from there.

    Raises
    ------
    InputError
        If an answer lacks a part, or makes no case; the question is named.
    """
    document = tomlkit.document()
    tool = _tool(answers["tool"])
    document.add("title", _title(tool, answers["material"]))
    document.add("tool", tool)
    document.add("material", _material(answers["material"]))
    document.add("cut", _cut(answers["cut"], answers["engagement"]))
    document.add("structure", _structure(answers["dynamics"]))
    text = tomlkit.dumps(document)
    case = loads(text, "the new case", folder)
    _refuse_unusable(case)
    return f"{text}\n{_range_of_diagram(case)}"


def _title(tool: tomlkit.items.Table, material: str) -> str:
    """Title such as "End mill 12 mm, 4 teeth, Al7075-T6"."""
    teeth = f"{tool['teeth']} {'tooth' if tool['teeth'] == 1 else 'teeth'}"
    worked = f"Ktc and Krc {material}" if "Pa" in material else material
    return f"End mill {tool['diameter']}, {teeth}, {worked}"


def _range_of_diagram(case: Case) -> str:
    """Comment with the range of speeds of a diagram, from half the speed of the cut to twice it."""
    speed = float(rpm(case.cut.spindle_speed))
    low, high = (to_digits(share * speed, 4) for share in (0.5, 2.0))
    return (
        "# speeds of the stability diagram, where it is not to choose them itself:\n"
        f'# [lobes]\n# speeds = "{low}..{high} rpm:400"\n'
    )


def check_answer(name: str, answer: str) -> None:
    """Refuse an answer that lacks a part; InputError names the question."""
    makers = {"tool": _tool, "material": _material, "dynamics": _structure}
    if name in makers:
        makers[name](answer)
    elif name == "cut":
        _parts("cut", answer, (3,))
    else:
        _engagement(answer)


def _parts(name: str, answer: str, counts: Sequence[int]) -> list[str]:
    # between semicolons a comma is that of a number
    split = answer.replace(",", ".").split(";") if ";" in answer else answer.split(",")
    parts = [part.strip() for part in split if part.strip()]
    if len(parts) not in counts:
        question = QUESTIONS[name]
        raise InputError(
            f'{name}: "{answer}" is given, {question.parts} are required, such as "'
            f'{question.example}"'
        )
    return parts


def _table(**values: object) -> tomlkit.items.Table:
    table = tomlkit.table()
    for key, value in values.items():
        table.add(key, value)
    return table


def _tool(answer: str) -> tomlkit.items.Table:
    diameter, teeth = _parts("tool", answer, (2,))
    if _TEETH.fullmatch(diameter):
        diameter, teeth = teeth, diameter
    counted = _TEETH.fullmatch(teeth)
    if counted is None:
        raise InputError(f'tool: "{teeth}" is no number of teeth, such as "12 mm, 4"')
    return _table(kind="end mill", teeth=int(counted[1]), diameter=_DIAMETER_SIGN.sub("", diameter))


def _material(answer: str) -> tomlkit.items.Table:
    if "Pa" not in answer:
        if not answer.strip():
            _parts("material", answer, (2,))
        return _table(name=answer.strip())
    tangential, radial = _parts("material", answer, (2,))
    return _table(law="linear", Ktc=tangential, Krc=radial)


def _engagement(answer: str) -> dict[str, str]:
    found = _ENGAGEMENT.fullmatch(answer)
    word, depth = ("", "") if found is None else found.groups()
    mode = _MODES.get(word.lower(), word.lower())
    if (mode == "slot") != (not depth) or mode not in ("slot", "up", "down"):
        _parts("engagement", answer, ())
    return {"mode": mode, **({"radial_depth": depth.replace(",", ".")} if depth else {})}


def _cut(answer: str, engagement: str) -> tomlkit.items.Table:
    speed, feed, depth = _parts("cut", answer, (3,))
    return _table(
        **_engagement(engagement), spindle_speed=speed, feed_per_tooth=feed, axial_depth=depth
    )


def _structure(answer: str) -> tomlkit.items.Table:
    parts = _parts("dynamics", answer, (1, 2, 3))
    if not parts[0].endswith("Hz"):
        if len(parts) == 1:
            return _table(frf=parts[0])
        return _table(frf=parts)
    frequency, damping, stiffness = _parts("dynamics", answer, (3,))
    try:
        ratio = float(damping.removesuffix("%")) / (100.0 if damping.endswith("%") else 1.0)
    except ValueError:
        raise InputError(f'dynamics: "{damping}" is no damping ratio, such as 0.03') from None
    modes = tomlkit.aot()
    for direction in ([1, 0, 0], [0, 1, 0]):
        modes.append(
            _table(frequency=frequency, damping=ratio, stiffness=stiffness, direction=direction)
        )
    return _table(mode=modes)


def _refuse_unusable(case: Case) -> None:
    case.require("tool", "material", "cut", "structure")
