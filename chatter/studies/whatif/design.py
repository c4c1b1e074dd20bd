"""Points of a study: one after the other, a grid of two paths, or one path at a time."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from chatter.description.errors import InputError
from chatter.studies.whatif.variation import Variation

Layout = Literal["overlay", "heat map", "tornado"]
_MOST_POINTS = 20_000
#: what the case as it stands is called
AS_GIVEN = "as given"


@dataclass(frozen=True)
class DesignPoint:
    """Values of one point."""

    labels: tuple[str, ...]  # for each variation; "as given" where it is not changed
    indices: tuple[int | None, ...]  # index of its value; None where it is not changed
    patch: Mapping[str, Any]


def chosen_layout(variations: Sequence[Variation], tornado: bool) -> Layout:
    """Picture that suits the variations.

    InputError if there are none, a path comes twice, or there are too many for a picture.
    """
    if not variations:
        raise InputError("nothing varies; give --vary PATH=VALUES or --study NAME")
    paths = [one.path for one in variations]
    twice = sorted({path for path in paths if paths.count(path) > 1})
    if twice:
        raise InputError(f"--vary {twice[0]}: is given twice; give all its values in one list")
    if tornado:
        alone = [one.path for one in variations if len(one.values) < 2]
        if alone:
            raise InputError(f"--vary {alone[0]}: a tornado needs a low and a high value")
        return "tornado"
    if len(variations) > 2:
        raise InputError(
            f"{len(variations)} paths vary; a heat map takes two: leave some out, or compare "
            "all of them one at a time with --tornado"
        )
    return "heat map" if len(variations) == 2 else "overlay"


def points_of(variations: Sequence[Variation], layout: Layout) -> tuple[DesignPoint, ...]:
    """Points in the order in which they are computed; InputError if there are too many."""
    if layout == "tornado":
        none = (None,) * len(variations)
        points = [_point(variations, none)]
        for index, one in enumerate(variations):
            for end in (0, len(one.values) - 1):
                points.append(_point(variations, (*none[:index], end, *none[index + 1 :])))
        return tuple(points)
    ranges = [range(len(one.values)) for one in variations]
    total = 1
    for each in ranges:
        total *= len(each)
    if total > _MOST_POINTS:
        raise InputError(f"{total} points; at most {_MOST_POINTS} are allowed: give fewer values")
    return tuple(_point(variations, combination) for combination in itertools.product(*ranges))


def _point(variations: Sequence[Variation], indices: tuple[int | None, ...]) -> DesignPoint:
    labels, patch = [], {}
    for one, index in zip(variations, indices, strict=True):
        labels.append(AS_GIVEN if index is None else one.values[index].label)
        if index is not None:
            patch.update(one.values[index].patch)
    return DesignPoint(tuple(labels), indices, patch)
