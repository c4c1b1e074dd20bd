"""Pairs of effects that may pay together though neither does alone, by linearised models."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from chatter.explain.effects.effect import Effect
from chatter.explain.fitting import Fit
from chatter.explain.parameters import Parameter
from chatter.explain.selection.linearised_step import WEAK_PRIOR, LinearisedStep

#: pairs that are proposed at the most
_PROPOSED = 2
#: rows of all columns that are multiplied at once
_ROWS = 16384


class JointStep(NamedTuple):
    """Where a linearised step of two effects leads."""

    effects: tuple[Effect, Effect]
    values: dict[str, float]  # of the nuisance parameters and both effects
    gain: float  # fall of the sum of squares that is promised, over that of no effect
    alone: float  # the most that one of them promises


def joint_steps(
    now: Fit, steps: Sequence[tuple[Effect, LinearisedStep]], least: float
) -> list[JointStep]:
    """Pairs of effects of different names that promise most more than each of them alone.

    At the least a fall of the sum of squares of `least` more. Each effect is linearised where its
    best step began; what both change there adds up.
    """
    model = _Model(now, [step for _, step in steps])
    alone = [model.solved((index,))[0] for index in range(len(steps))]
    found = []
    for i, j in itertools.combinations(range(len(steps)), 2):
        one, other = steps[i][0], steps[j][0]
        if one.name == other.name:
            continue
        gain, values = model.solved((i, j))
        single = max(alone[i], alone[j])
        if gain - single > least:
            found.append(JointStep((one, other), values, gain, single))
    found.sort(key=lambda step: -step.gain)
    kept: dict[frozenset[str], JointStep] = {}
    for step in found:
        kept.setdefault(frozenset(effect.name for effect in step.effects), step)
    return list(kept.values())[:_PROPOSED]


class _Model:
    """Products of the columns of all steps, from which any two of them are solved."""

    def __init__(self, now: Fit, steps: Sequence[LinearisedStep]) -> None:
        self.now, self.steps = now, steps
        nuisance = len(now.parameters)
        columns, self.own = [now.jacobian], []
        begin = nuisance
        for step in steps:
            # columns of the parameters, then the change where the step begins
            columns += [step.own, step.offset[:, None]]
            count = step.own.shape[1]
            self.own.append((slice(begin, begin + count), begin + count))
            begin += count + 1
        columns.append(now.residuals[:, None])
        # a part of the rows at a time: all columns of all effects would take a gigabyte
        self.products = np.zeros((begin + 1, begin + 1))
        for first in range(0, now.residuals.size, _ROWS):
            part = np.column_stack([one[first : first + _ROWS] for one in columns])
            self.products += part.T @ part

    def solved(self, chosen: tuple[int, ...]) -> tuple[float, dict[str, float]]:
        """Fall of the sum of squares with some steps together, and the values there."""
        nuisance = len(self.now.parameters)
        used = np.concatenate(
            [np.arange(nuisance), *(np.r_[self.own[index][0]] for index in chosen)]
        )
        residual = [-1, *(self.own[index][1] for index in chosen)]
        normal = self.products[np.ix_(used, used)]
        added: list[Parameter] = [p for index in chosen for p in self.steps[index].added]
        parameters = [*self.now.parameters, *added]
        weights = [1.0] * nuisance + [1.0 if one.prior else WEAK_PRIOR for one in added]
        right = self.products[np.ix_(used, residual)].sum(axis=1)
        step = -np.linalg.solve(normal + np.diag(weights), right)
        begun = float(self.products[np.ix_(residual, residual)].sum())
        left = begun + float(right @ step)
        values = dict(self.now.by_name)
        for index in chosen:
            values |= {
                one.name: self.steps[index].begin[one.name] for one in self.steps[index].added
            }
        for one, change in zip(parameters, step, strict=True):
            values[one.name] = one.moved(values[one.name], float(change))
        return self.now.cost - left, values
