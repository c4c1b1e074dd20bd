"""Pieces of a search as JSON knows them, and back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from chatter.io.result_files import finite_or_none
from chatter.stability.model import MillingModel
from chatter.studies.optimisation.candidate import Candidate, Probability, TimeCheck
from chatter.studies.optimisation.limits import Limits
from chatter.studies.optimisation.search import Place
from chatter.studies.optimisation.speed_depth_slice import Sheet, settled_at, sheet_with
from chatter.studies.optimisation.stable_depths import StableDepths
from chatter.studies.optimisation.steady_cut import SteadyCuts
from chatter.studies.optimisation.width_and_feed import model_at


def record_of_sheets(sheets: Sequence[Sheet]) -> list[dict[str, Any]]:
    """Record of the sheets of one width."""
    return [_of_sheet(sheet) for sheet in sheets]


def _of_sheet(sheet: Sheet) -> dict[str, Any]:
    settled = settled_at(sheet.model, sheet.speeds, sheet.depths, sheet.stable)
    return {
        "crossings": [found.tolist() for found in sheet.stable.crossings],
        "deepest": sheet.stable.deepest,
        "cuts": {
            name: [finite_or_none(value) for value in values[settled]]
            for name, values in zip(SteadyCuts._fields, sheet.cuts, strict=True)
        },
    }


def sheets_from(
    record: Sequence[dict[str, Any]], model: MillingModel, limits: Limits, width: float
) -> list[Sheet]:
    """Sheets of the coarse net at one width, m, of their record."""
    looked_at, sheets = limits.looked_at_beyond(), []
    speeds, depths = limits.speeds, limits.depths
    for one, feed in zip(record, limits.feeds, strict=True):
        here = model_at(model, width, float(feed))
        crossings = [np.array(found, dtype=np.float64) for found in one["crossings"]]
        stable = StableDepths(looked_at, crossings, one["deepest"])
        settled = settled_at(here, speeds, depths, stable)
        columns = {name: np.full(settled.shape, np.nan) for name in SteadyCuts._fields}
        for name, values in columns.items():
            values[settled] = np.array(one["cuts"][name], dtype=np.float64)
        sheets.append(sheet_with(here, limits, speeds, depths, stable, SteadyCuts(**columns)))
    return sheets


def record_of_candidate(one: Candidate | None) -> dict[str, Any] | None:
    """Record of a candidate; None of none."""
    if one is None:
        return None
    known, time = one.probability, one.time
    return {
        "place": list(one.place),
        **_numbers(one),
        "limit_depth": finite_or_none(one.limit_depth),
        "usage": {key: finite_or_none(value) for key, value in one.usage.items()},
        "active": list(one.active),
        "probability": None
        if known is None
        else {
            "stable": known.stable,
            "value": known.value,
            "interval": list(known.interval),
            "quantiles": {key: finite_or_none(value) for key, value in known.quantiles.items()},
        },
        "time": None
        if time is None
        else {"verdict": time.verdict, "held": time.held, **_numbers(time)},
    }


def candidate_from(record: dict[str, Any] | None) -> Candidate | None:
    """Candidate of its record."""
    if record is None:
        return None
    known, time = record["probability"], record["time"]
    return Candidate(
        place=Place(*record["place"]),
        **{name: _or_nan(record[name]) for name in SteadyCuts._fields},
        limit_depth=math.inf if record["limit_depth"] is None else record["limit_depth"],
        usage={key: _or_nan(value) for key, value in record["usage"].items()},
        active=tuple(record["active"]),
        probability=None
        if known is None
        else Probability(
            known["stable"],
            known["value"],
            tuple(known["interval"]),
            {key: _or_nan(value) for key, value in known["quantiles"].items()},
        ),
        time=None
        if time is None
        else TimeCheck(
            time["verdict"],
            **{name: _or_nan(time[name]) for name in SteadyCuts._fields},
            held=time["held"],
        ),
    )


def _numbers(one: Candidate | TimeCheck) -> dict[str, float | None]:
    return {name: finite_or_none(getattr(one, name)) for name in SteadyCuts._fields}


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value
