"""Terms that may be learnt from a kind of measurement, from coarse to fine."""

from __future__ import annotations

import numpy as np

from chatter.explain.empirical.term import (
    EmpiricalTerm,
    Harmonic,
    OverPosition,
    OverSpeed,
    OverVelocity,
    PeriodicTravel,
)
from chatter.explain.residuals.regression import best_period
from chatter.explain.residuals.residual import Residual

#: orders of the spindle, and of a period along the feed
_ORDERS, _ORDERS_OF_TRAVEL = (1, 2, 4), (1, 2)
#: speeds from which on a dependence on them can be held against holdout runs, and its powers
_FEWEST_SPEEDS, _POWERS = 4, (1, 2)
#: knots of a table of an axis
_KNOTS = (5, 9, 17)


def terms_of(residual: Residual) -> list[EmpiricalTerm]:
    """Terms to try on a residual."""
    residual = residual.kind.leading(residual)
    make = {"milling": _of_cuts, "axis": _of_moves}.get(residual.kind.name)
    found = [] if make is None else make(residual)
    return [term for term in found if term.applies(residual.measurement)]


def _of_cuts(residual: Residual) -> list[EmpiricalTerm]:
    terms: list[EmpiricalTerm] = [Harmonic(orders) for orders in _ORDERS]
    from_rest = all(run.record is None for run in residual.measurement.runs)
    channels = [one for one in residual.above_noise if one in residual.kind.sources]
    if from_rest and channels:
        period = best_period(residual, residual.kind.variable("feed distance"), channels)
        if period is not None and period.found.significant:
            length = float(period.found.length)
            terms += [PeriodicTravel(orders, length) for orders in _ORDERS_OF_TRAVEL]
    cases = [run.of(residual.case) for run in residual.measurement.runs]
    speeds = np.array([0.5 * one.tool.diameter * one.cut.spindle_speed for one in cases])
    if np.unique(speeds).size >= _FEWEST_SPEEDS:
        terms += [OverSpeed(powers, speeds) for powers in _POWERS]
    return terms


def _of_moves(residual: Residual) -> list[EmpiricalTerm]:
    runs = residual.measurement.runs
    force = float(np.sqrt(np.mean([np.mean(run.signals["force"] ** 2) for run in runs])))
    terms: list[EmpiricalTerm] = []
    for table in (OverPosition, OverVelocity):
        values = np.concatenate([run.signals[table.over] for run in runs])
        lowest, highest = float(values.min()), float(values.max())
        if highest > lowest:
            terms += [table(np.linspace(lowest, highest, n), force) for n in _KNOTS]
    return terms
