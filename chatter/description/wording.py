"""Say what is wrong with a case: which file, which key, what was given, what is allowed."""

import difflib
from collections.abc import Mapping, Sequence
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, ValidationError

from chatter.description.formatting import formatted, printable
from chatter.description.path import Step, field_at, info_at, join_path, keys_of, model_at
from chatter.description.section import Section, SectionError

#: more messages than this tell nobody anything
_MOST_SENTENCES = 20
_IS_MISSING = "is missing"
_LONGEST_KEY = 60


def sentences(
    error: ValidationError,
    model: type[BaseModel],
    name: str,
    consequences: Mapping[tuple[Step, ...], str] | None = None,
) -> list[str]:
    """Turn the errors of a validation into one sentence each.

    Parameters
    ----------
    error : ValidationError
    model : type
        Class that was validated.
    name : str
        File, for the beginning of each sentence.
    consequences : mapping, optional
        Of keys that come from others: what to say where they are missing and nothing else is wrong.
    """
    problems = [
        ((*item["loc"], key) if key else tuple(item["loc"]), text)
        for item in error.errors(include_url=False)
        for key, text in _problems(item, model)
    ]
    consequences = consequences or {}
    others = [one for one in problems if not _is_consequence(one, consequences)]
    problems = others or [(steps, consequences.get(steps, text)) for steps, text in problems]
    misspelt = {
        (*steps[:-1], _nearest_key(model, steps))
        for steps, text in problems
        if text.startswith("unknown key")
    }
    texts = [
        f"{name}: {printable(join_path(steps))}: {text}" if steps else f"{name}: {text}"
        for steps, text in problems
        # the misspelt key says it already
        if not (text.startswith(_IS_MISSING) and steps in misspelt)
    ]
    return first_of(texts, name)


def first_of(texts: list[str], name: str) -> list[str]:
    """As many sentences as somebody reads, and how many more there are."""
    if len(texts) <= _MOST_SENTENCES:
        return texts
    more = len(texts) - _MOST_SENTENCES
    return [*texts[:_MOST_SENTENCES], f"{name}: and {more} more of this kind"]


def _is_consequence(
    problem: tuple[tuple[Step, ...], str], consequences: Mapping[tuple[Step, ...], str]
) -> bool:
    steps, text = problem
    return steps in consequences and text.startswith(_IS_MISSING)


def _problems(item: Any, model: type[BaseModel]) -> list[tuple[str, str]]:
    """Key (empty for the place itself) and sentence of each problem in one item."""
    kind, steps = item["type"], tuple(item["loc"])
    original = item.get("ctx", {}).get("error")
    if isinstance(original, SectionError):
        return list(original.problems)
    if kind == "value_error":
        return [("", str(original))]
    if kind == "extra_forbidden":
        return [("", unknown_key(model, steps))]
    if kind == "missing":
        return [("", _missing(model, steps))]
    if kind == "literal_error":
        return [("", _not_allowed(item))]
    return [("", _wrong_type(item, steps))]


def _wrong_type(item: Any, steps: tuple[Step, ...]) -> str:
    kind, given = item["type"], item["input"]
    key = printable(str(steps[-1])) if steps else ""
    if kind.startswith(("model", "dict")):
        tables = isinstance(given, list) and given and all(isinstance(e, dict) for e in given)
        hint = f"; write [{key}], not [[{key}]]" if tables else ""
        return f"{formatted(given)} is given, a table is required{hint}"
    if kind.startswith(("tuple", "list")):
        table = join_path(steps)
        hint = f"; write [[{table}]], not [{table}]" if isinstance(given, dict) else ""
        return f"{formatted(given)} is given, a list is required{hint}"
    if kind.startswith("string"):
        return f"{formatted(given)} is given, text in quotes is required"
    if kind.startswith("bool"):
        return f"{formatted(given)} is given, true or false is required"
    return f"{formatted(given)} is not allowed here"


def nearest(word: str, known: Sequence[str]) -> str:
    """Return a hint at the nearest known word, or the list of all."""
    near = _nearest(word, known)
    return f'did you mean "{near}"?' if near else "known are " + ", ".join(known)


def _nearest(word: str, known: Sequence[str]) -> str | None:
    folded = {key.lower(): key for key in known}
    near = difflib.get_close_matches(word[:_LONGEST_KEY].lower(), folded, n=1, cutoff=0.6)
    return folded[near[0]] if near else None


def _nearest_key(model: type[BaseModel], steps: tuple[Step, ...]) -> str | None:
    section = model_at(model, steps[:-1])
    return _nearest(str(steps[-1]), keys_of(section)) if section else None


def unknown_key(model: type[BaseModel], steps: tuple[Step, ...]) -> str:
    """Say that the last step is not a key of its section, with the nearest that is."""
    section = model_at(model, steps[:-1])
    return f"unknown key; {nearest(str(steps[-1]), keys_of(section))}" if section else "unknown key"


def _missing(model: type[BaseModel], steps: tuple[Step, ...]) -> str:
    quantity, info = field_at(model, steps), info_at(model, steps)
    if quantity is not None:
        return f"{_IS_MISSING}; {quantity.noun} is required, such as {quantity.example}"
    if info is not None and get_origin(info.annotation) is Literal:
        allowed = ", ".join(formatted(value) for value in get_args(info.annotation))
        return f"{_IS_MISSING}; allowed are {allowed}"
    if info is not None and info.examples:
        return f"{_IS_MISSING}; give, for example, {formatted(info.examples[0])}"
    return _IS_MISSING


#: other words of the shop for kinds of tools and of milling -> that of a case file
_SHOP_WORDS = {
    "endmill": "end mill", "square": "end mill", "flat": "end mill",
    "ball end": "ball", "ball nose": "ball", "ball mill": "ball", "ball end mill": "ball",
    "bullnose": "bull nose", "torus": "bull nose", "toroidal": "bull nose", "corner": "bull nose",
    "tapered": "taper", "cone": "taper", "conical": "taper",
    "face mill": "inserted", "facemill": "inserted", "indexable": "inserted",
    "shoulder mill": "inserted", "high feed": "inserted", "high-feed": "inserted",
    "t-slot": "end mill", "t-slot cutter": "end mill", "side mill": "end mill",
    "slitting saw": "end mill", "saw": "end mill", "disc": "end mill",
    "chamfer": "taper", "chamfer mill": "taper",
    "climb": "down", "conventional": "up", "slotting": "slot", "face milling": "face",
    "facing": "face",
}  # fmt: skip


#: work that no kind of tool or of milling states, and what there is to say of it
_OTHER_WORK = {
    ("drill", "drilling", "boring", "boring bar", "bore", "turning", "reamer", "reaming", "tap",
     "tapping"): "that is no milling: of other processes nothing is computed here",
    ("trochoidal", "trochoid", "adaptive", "dynamic"):
        'state its widest engagement by "down" or "up" and that radial_depth; its feed there is '
        "that of the program",
    ("thread mill", "thread milling", "thread"):
        'there is no kind for its profile; "end mill", with the length of thread in the cut as '
        "axial_depth, takes its flanks as one straight edge",
}  # fmt: skip


#: words for a way of milling that no mode is alone, and what there is to say of it
_OTHER_MODES = {
    ("plunge", "plunging", "plunge milling"):
        "that feeds along the tool axis, of which nothing is computed: the feed is across it here",
    ("ramp", "ramping", "helical", "helical interpolation", "pocket", "pocketing"):
        'state the passes that it is made of: "slot", or "up" or "down" beside another pass',
    ("side", "shoulder", "peripheral", "contour", "profile", "finishing", "roughing",
     "half immersion"):
        'the wall is on the side that "down" (climb) or "up" (conventional) says, the width of the '
        "cut is radial_depth",
}  # fmt: skip


def _on_other_work(given: str, allowed: str) -> str:
    """What is to be said of a word for a tool or a process that has no kind here."""
    known = {} if '"end mill"' not in allowed and '"slot"' not in allowed else dict(_OTHER_WORK)
    if '"slot"' in allowed:
        known |= _OTHER_MODES
    said = (text for words, text in known.items() if given.lower() in words)
    return "".join(f"{text}; " for text in said)


def _not_allowed(item: Any) -> str:
    allowed, given = item["ctx"]["expected"].replace("'", '"'), item["input"]
    word = _SHOP_WORDS.get(given.lower()) if isinstance(given, str) else None
    here = f'it is "{word}" here; ' if word and f'"{word}"' in allowed else ""
    if isinstance(given, str):
        here += _on_other_work(given, allowed)
    return f"{formatted(given)} is not allowed; {here}allowed are {allowed}"


def key_problems(
    section: Section, choosing: str, keys: Mapping[str, bool], always: tuple[str, ...] = ()
) -> list[tuple[str, str]]:
    """Tell keys that do not belong to the kind that a section is of, and needed ones missing.

    `keys` of the kind say whether each is needed; `choosing` is the key that chooses the kind, and
    `always` are keys of every kind.
    """
    kind = f'{choosing} = "{getattr(section, choosing)}"'
    problems = []
    for name in type(section).model_fields:
        if name in (choosing, *always):
            continue
        given = name in section.model_fields_set and getattr(section, name) not in (None, ())
        if given and name not in keys:
            problems.append((name, f"does not belong to {kind}; {nearest(name, list(keys))}"))
        if not given and keys.get(name, False):
            field = field_at(type(section), (name,))
            wanted = "" if field is None else f"; {field.noun}, such as {field.example}"
            problems.append((name, f"is missing; {kind} needs it{wanted}"))
    return problems
