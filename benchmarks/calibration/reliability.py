"""Whether stated probabilities are the shares that come true."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchmarks.calibration.answers import Answer

#: edges of the bins of stated probabilities: most are near one
EDGES = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.97, 1.0)
#: effects that data of one direction of motion cannot tell apart
_TWINS = ({"asymmetry", "offset"},)


class Bin(NamedTuple):
    """Statements of nearly the same probability."""

    count: int
    stated: float  # mean probability
    true: float  # share that is true


class Summary(NamedTuple):
    """What a survey of n sets found."""

    sets: int
    named: int  # effects that were reported as found
    wrong: int  # of them, those that the truth does not hold
    statements: int  # probabilities that were stated, of effects found and of those that may help
    bins: tuple[Bin, ...]
    error: float  # expected calibration error (Naeini, Cooper and Hauskrecht 2015)
    nothing: tuple[int, int]  # sets without effect that were told so, of how many
    right: tuple[int, int]  # sets whose verdict and names are right, of how many


def is_true(effect: Answer, answer: Answer) -> bool:
    """Whether an effect is in the data, or a twin that it says it cannot be told from."""
    truth = set(answer["truth"])
    if effect["name"] in truth:
        return True
    beside = truth & set(effect["confounded_with"])
    return any(effect["name"] in twins and bool(twins & beside) for twins in _TWINS)


def bins_of(stated: np.ndarray, true: np.ndarray) -> tuple[Bin, ...]:
    """Bins of stated probabilities (n,) and whether each came true (n,)."""
    index = np.clip(np.searchsorted(EDGES, stated, side="right") - 1, 0, len(EDGES) - 2)
    found = []
    for k in range(len(EDGES) - 1):
        own = index == k
        if own.any():
            found.append(Bin(int(own.sum()), float(stated[own].mean()), float(true[own].mean())))
    return tuple(found)


def summary_of(answers: Sequence[Answer]) -> Summary:
    """Summary of a survey."""
    statements = [
        (effect["probability"], is_true(effect, one))
        for one in answers
        for effect in (*one["effects"], *one["partial"])
    ]
    stated, true = np.array(statements, dtype=float).reshape(-1, 2).T
    bins = bins_of(stated, true)
    error = sum(one.count * abs(one.stated - one.true) for one in bins) / max(stated.size, 1)
    named = [is_true(effect, one) for one in answers for effect in one["effects"]]
    nothing = [one["verdict"] == "nothing-missing" for one in answers if _is_nothing(one)]
    right = [_is_right(one) for one in answers]
    return Summary(
        len(answers), len(named), named.count(False), stated.size, bins, float(error),
        (sum(nothing), len(nothing)), (sum(right), len(right)),
    )  # fmt: skip


def _is_nothing(answer: Answer) -> bool:
    return answer["true_verdict"] == "nothing-missing"


def _is_right(answer: Answer) -> bool:
    """Whether the verdict is the true one, and no name is wrong or lacks where it is explained."""
    names = answer["effects"]
    if answer["verdict"] != answer["true_verdict"] or not all(is_true(n, answer) for n in names):
        return False
    return answer["verdict"] != "explained" or len(names) == len(answer["truth"])


def in_words(answers: Sequence[Answer]) -> str:
    """Table of a survey, by kind and in all."""
    kinds = sorted({one["kind"] for one in answers})
    parts = [(kind, [one for one in answers if one["kind"] == kind]) for kind in kinds]
    lines = [
        f"{'kind':10} {'sets':>5} {'right':>9} {'nothing':>9} {'named':>6} {'wrong':>6} "
        f"{'statements':>10} {'ECE':>6} {'s a set':>8}"
    ]
    for name, some in [*parts, ("all", list(answers))]:
        one = summary_of(some)
        seconds = float(np.median([answer["seconds"] for answer in some]))
        lines.append(
            f"{name:10} {one.sets:5d} {f'{one.right[0]}/{one.right[1]}':>9} "
            f"{f'{one.nothing[0]}/{one.nothing[1]}':>9} {one.named:6d} {one.wrong:6d} "
            f"{one.statements:10d} {one.error:6.1%} {seconds:8.1f}"
        )
    lines.append("stated -> true (statements)")
    lines += [
        f"  {one.stated:.3f} -> {one.true:.3f} ({one.count})" for one in summary_of(answers).bins
    ]
    return "\n".join(lines)
