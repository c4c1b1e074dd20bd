"""Summary of a what-if study in sentences: what changed, and by how much."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from chatter.description.case import Case
from chatter.description.formatting import to_digits
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.stability.neglected_effects import NOT_CERTAIN
from chatter.studies.whatif.measures import Curve, Outcome, Quantity

if TYPE_CHECKING:
    from chatter.studies.whatif.whatif_study import WhatIf

#: a relative change smaller than this is none
_NO_CHANGE = 5e-4
#: quantities beside the main one are reported where they change by more than this
_NOTABLE = 0.01
#: from this relative change on the ratio is reported instead
_MANY_TIMES = 2.0
_PEAK_FREQUENCY = "peak_frequency_Hz"
#: peaks whose frequencies differ by less may be the same
_NEAR = 0.15
#: points that a sentence names
_MOST_NAMED = 3
#: of measures that are simulated: what in their numbers is that of chatter, where the cut chatters
_OF_THE_CUT = {"forces": "forces, power and motion", "surface": "motion and surface"}


def title_of(study: WhatIf, quantity: Quantity) -> str:
    """Title of a quantity, with the speed where that is the same at all points."""
    case = study.model
    speed = "the speed of the cut"
    varied = any(one.path == "cut.spindle_speed" for one in study.variations)
    if isinstance(case, Case) and case.cut is not None and not varied:
        speed = f"{rpm(case.cut.spindle_speed):.0f} rpm"
    return quantity.title.format(speed=speed)


def unit_of(study: WhatIf, quantity: Quantity, outcome: Outcome, key: str) -> UsualUnit:
    """Unit that a quantity at a point is read in, and its number in one of the numbers."""
    unit = outcome.units.get(key, quantity.unit)
    return study.units.instead_of(unit, quantity.read_as)


def value_text(study: WhatIf, quantity: Quantity, outcome: Outcome, key: str) -> str:
    """Value with its unit, or why there is none."""
    value = outcome.numbers.get(key)
    unit, factor = unit_of(study, quantity, outcome, key)
    if value == 0.0 and quantity.at_zero:
        return quantity.at_zero
    if value is not None and value > quantity.most:
        return f"more than {quantity.most * factor:.6g} {unit}".strip()
    if value is not None:
        return f"{to_digits(value * factor, 4)} {unit}".strip()
    beyond = outcome.numbers.get(quantity.beyond)
    if beyond is not None:
        return f"above {to_digits(beyond * factor, 4)} {unit}"
    return "none"


def change_text(before: float | None, after: float | None) -> str:
    """Relative change in brackets; empty where it has no meaning."""
    if before is None or after is None or before == 0.0 or before * after < 0.0:
        return ""
    share = after / before - 1.0
    if share > _MANY_TIMES:
        return f" ({to_digits(1.0 + share, 3)} times)"
    return " (no change)" if abs(share) < _NO_CHANGE else f" ({100.0 * share:+.3g} %)"


def sentences(study: WhatIf) -> list[str]:
    """One sentence for each thing that changed."""
    if study.layout == "tornado":
        return _tornado(study)
    found = _alone(study)
    for index, one in enumerate(study.variations):
        first, last = _ends(study, index)
        if first is last:
            continue
        others = _others(study, index)
        why = f" as {one.path} goes from {one.values[0].label} to {one.values[-1].label}{others}"
        found += _changes(study, study.outcomes[first], study.outcomes[last], why)
    return [
        *found, *_extremes(study), *_uncertain(study), *_chattering(study),
        *_without_effect(study), *failures(study),
    ]  # fmt: skip


def _alone(study: WhatIf) -> list[str]:
    """Sentence on the only point of a study: there is nothing that it could be compared with."""
    if len(study.outcomes) != 1 or study.outcomes[0].failure:
        return []
    quantity = study.measure.quantities[study.quantity]
    value = value_text(study, quantity, study.outcomes[0], study.quantity)
    return [f"{title_of(study, quantity)}: {value} at {_where(study, 0)}"]


def _uncertain(study: WhatIf) -> list[str]:
    """Sentence on points whose verdict is not certain."""
    found = [k for k, one in enumerate(study.outcomes) if one.words.get("verdict") == NOT_CERTAIN]
    if not found:
        return []
    more = f" and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
    where = "; ".join(_where(study, k) for k in found[:_MOST_NAMED])
    return [
        f"the verdict is not certain at {where}{more}: `chatter check` with that --set says what "
        "decides there"
    ]


def _chattering(study: WhatIf) -> list[str]:
    """Sentence on points whose numbers are those of chatter, of no settled cut."""
    numbers = _OF_THE_CUT.get(study.measure.name)
    if numbers is None:
        return []
    found = [k for k, one in enumerate(study.outcomes) if one.words.get("verdict") == "chatter"]
    if not found:
        return []
    if len(found) == len(study.outcomes):
        return [f"the cut chatters at every point: {numbers} are those of chatter"]
    where = "; ".join(_where(study, k) for k in found[:_MOST_NAMED])
    more = f" and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
    return [f"the cut chatters at {where}{more}: {numbers} there are those of chatter"]


def _without_effect(study: WhatIf) -> list[str]:
    """Sentences on paths whose values change no number that is computed."""
    found = []
    for index, one in enumerate(study.variations):
        groups: dict[tuple[int | None, ...], list[Outcome]] = {}
        for point, outcome in zip(study.points, study.outcomes, strict=True):
            held = (*point.indices[:index], *point.indices[index + 1 :])
            groups.setdefault(held, []).append(outcome)
        if len(one.values) > 1 and all(_are_alike(group) for group in groups.values()):
            found.append(
                f"{one.path} has no effect on what is computed here ({study.measure.name})"
            )
    return found


def _are_alike(outcomes: Sequence[Outcome]) -> bool:
    """Whether outcomes have the same numbers and words."""
    first = outcomes[0]
    return all(
        not one.failure and one.words == first.words and one.numbers == first.numbers
        for one in outcomes
    )


def failures(study: WhatIf) -> list[str]:
    """Sentences for the points without a result."""
    return [
        f"no result at {_where(study, index)}: {outcome.failure}"
        for index, outcome in enumerate(study.outcomes)
        if outcome.failure
    ]


def _where(study: WhatIf, index: int) -> str:
    labels = study.points[index].labels
    return ", ".join(
        f"{one.path} = {label}" for one, label in zip(study.variations, labels, strict=True)
    )


def _ends(study: WhatIf, index: int) -> tuple[int, int]:
    """Points at both ends of a variation, others at their first value."""
    number = {point.indices: k for k, point in enumerate(study.points)}
    start = [0] * len(study.variations)
    end = list(start)
    end[index] = len(study.variations[index].values) - 1
    return number[tuple(start)], number[tuple(end)]


def _others(study: WhatIf, index: int) -> str:
    held = [
        f"{one.path} = {one.values[0].label}"
        for k, one in enumerate(study.variations)
        if k != index
    ]
    return f", with {' and '.join(held)}" if held else ""


def _changes(study: WhatIf, before: Outcome, after: Outcome, why: str) -> list[str]:
    if before.failure or after.failure:
        return []
    found = []
    for key, quantity in _changed_quantities(study, before, after).items():
        pair = value_text(study, quantity, before, key), value_text(study, quantity, after, key)
        share = change_text(before.numbers.get(key), after.numbers.get(key))
        told_as_words = quantity.at_zero in pair or any(one.startswith("more than") for one in pair)
        if told_as_words:
            share = ""
        if key == _PEAK_FREQUENCY and _is_another_peak(before, after):
            share = ", which is another peak,"
        found.append(f"{title_of(study, quantity)}: {pair[0]} -> {pair[1]}{share}{why}")
    for key in before.words:
        if before.words[key] != after.words.get(key):
            found.append(f"{key}: {before.words[key]} -> {after.words.get(key)}{why}")
    return found


def _is_another_peak(before: Outcome, after: Outcome) -> bool:
    """Whether the highest peak of FRFs is another one: both are there before and after."""
    places = [one.numbers[_PEAK_FREQUENCY] for one in (before, after)]
    if None in places or _is_near(*places) or before.words != after.words:
        return False
    name = before.words.get("highest")
    return all(
        _has_peak(curve, place)
        for one in (before, after)
        for curve in one.curves
        if curve.name == name
        for place in places
    )


def _has_peak(curve: Curve, frequency: float) -> bool:
    """Whether a curve has a maximum near a frequency."""
    y = [-math.inf if value is None else value for value in curve.y]
    return any(
        y[k - 1] < y[k] >= y[k + 1] and _is_near(curve.x[k], frequency)
        for k in range(1, len(y) - 1)
        if curve.x[k] is not None
    )


def _is_near(one: float, other: float) -> bool:
    return abs(one - other) <= _NEAR * max(abs(one), abs(other))


def _changed_quantities(study: WhatIf, before: Outcome, after: Outcome) -> Mapping[str, Quantity]:
    """Main quantity, and others that change."""
    chosen = {study.quantity: study.measure.quantities[study.quantity]}
    for key, quantity in study.measure.quantities.items():
        pair = before.numbers.get(key), after.numbers.get(key)
        bounded = before.numbers.get(quantity.bounds), after.numbers.get(quantity.bounds)
        if key != study.quantity and pair != bounded and _is_notable(*pair):
            chosen[key] = quantity
    return chosen


def _is_notable(before: float | None, after: float | None) -> bool:
    if before is None or after is None:
        return before is not after
    return abs(after - before) > _NOTABLE * max(abs(before), abs(after))


def _extremes(study: WhatIf) -> list[str]:
    """Where the main quantity is smallest and largest, where that is not at an end."""
    values = study.values()
    known = [k for k, value in enumerate(values) if value is not None]
    if len(known) < 3:
        return []
    low, high = min(known, key=values.__getitem__), max(known, key=values.__getitem__)
    ends = {known[0], known[-1]} if study.layout == "overlay" else set()
    spread = _is_notable(values[low], values[high])
    if not spread or {low, high} <= ends:
        return []
    quantity = study.measure.quantities[study.quantity]
    found = [
        f"{value_text(study, quantity, study.outcomes[k], study.quantity)} at {_where(study, k)}"
        for k in (low, high)
    ]
    return [f"{title_of(study, quantity)}: from {found[0]} to {found[1]}"]


def _tornado(study: WhatIf) -> list[str]:
    quantity = study.measure.quantities[study.quantity]
    base = study.outcomes[0]
    found = [
        f"{title_of(study, quantity)}: {value_text(study, quantity, base, study.quantity)} as given"
    ]
    for index in ranked(study):
        one = study.variations[index]
        low, high = study.outcomes[1 + 2 * index], study.outcomes[2 + 2 * index]
        shares = [
            change_text(base.numbers.get(study.quantity), end.numbers.get(study.quantity))
            for end in (low, high)
        ]
        found.append(
            f"{one.path} from {one.values[0].label} to {one.values[-1].label}: "
            f"{value_text(study, quantity, low, study.quantity)}{shares[0]} to "
            f"{value_text(study, quantity, high, study.quantity)}{shares[1]}"
        )
    return found + failures(study)


def ranked(study: WhatIf) -> Sequence[int]:
    """Variations of a tornado, the one with the greatest effect first."""

    def swing(index: int) -> float:
        base = study.outcomes[0].numbers.get(study.quantity)
        ends = [
            study.outcomes[k].numbers.get(study.quantity) for k in (1 + 2 * index, 2 + 2 * index)
        ]
        known = [value for value in (base, *ends) if value is not None]
        return max(known) - min(known) if known else 0.0

    return sorted(range(len(study.variations)), key=swing, reverse=True)
