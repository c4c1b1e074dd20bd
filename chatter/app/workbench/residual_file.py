"""Residuals of a comparison or an explanation, as the page draws them: written and read again."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chatter.app.workbench.session import read_object
from chatter.description.arrays import Array, IntegerArray
from chatter.io.result_files import write_results
from chatter.plots.explanation import abscissa, channel_unit

if TYPE_CHECKING:
    from chatter.explain.residuals.finding import Finding
    from chatter.explain.residuals.residual import Residual
    from chatter.explain.residuals.signature import Signature

RESIDUALS = "residuals.json"
#: parts of a record, of each of which every curve shows its highest and lowest point
_PARTS = 400
_DIGITS = 5


def write_residuals(result: Any, folder: Path) -> None:
    """Write the residuals of a result of `compare` or `explain`, where it has any."""
    signatures = _signatures(result)
    if not signatures:
        return
    content = {
        "records": _records({name: one.residual for name, one in signatures.items()}),
        "diagnostics": [
            {"model": name, **_diagnostic(finding)}
            for name, one in signatures.items()
            for finding in one.findings
            if finding.panel is not None
        ],
    }
    text = json.dumps(content, ensure_ascii=False, allow_nan=False)
    write_results(folder, {RESIDUALS: text}, {})


def read_residuals(folder: Path) -> dict[str, Any]:
    """Return what `write_residuals` has left in a folder; empty where it has left nothing."""
    return read_object(folder / RESIDUALS)


def _signatures(result: Any) -> dict[str, Signature]:
    """Signatures by what is predicted with: declared, or refitted and repaired."""
    if hasattr(result, "refitted_signature"):
        found = {"refitted": result.refitted_signature}
        if result.repaired_signature is not None:
            found["repaired"] = result.repaired_signature
        return found
    declared = getattr(result, "signature", None)
    return {} if declared is None else {"declared": declared}


def _records(residuals: dict[str, Residual]) -> list[dict[str, Any]]:
    """One entry a run and channel: what was measured, and the residual of each model."""
    records: dict[tuple[str, str], dict[str, Any]] = {}
    for model, residual in residuals.items():
        # verdicts of cuts are no curve
        for part in residual.parts if residual.kind.is_sampled else ():
            key = part.run.name, part.channel
            unit, scale = channel_unit(part.channel)
            if key not in records:
                x, label = abscissa(part.run.signals, part.measured.size)
                order = np.argsort(x, kind="stable")
                shown = order[_shown(part.measured[order], part.values[order])]
                records[key] = {
                    "run": key[0], "channel": key[1], "unit": unit, "x_label": label,
                    "x": _numbers(x[shown]), "measured": _numbers(scale * part.measured[shown]),
                    "residuals": {}, "over_noise": {}, "points": shown,
                }  # fmt: skip
            entry = records[key]
            entry["residuals"][model] = _numbers(scale * part.values[entry["points"]])
            entry["over_noise"][model] = _number(part.over_noise)
    return [
        {name: value for name, value in one.items() if name != "points"} for one in records.values()
    ]


def _shown(*curves: Array) -> IntegerArray:
    """Places of the points to draw: of each part of a record the ends of every curve."""
    count = len(curves[0])
    if count <= 2 * _PARTS:
        return np.arange(count)
    parts = np.array_split(np.arange(count), _PARTS)
    ends = [
        part[place(curve[part])] for part in parts for curve in curves
        for place in (np.argmin, np.argmax)
    ]  # fmt: skip
    return np.unique(ends)


def _diagnostic(finding: Finding) -> dict[str, Any]:
    return {
        "name": finding.name,
        "description": finding.description,
        "significant": bool(finding.significant),
        "panel": {"kind": type(finding.panel).__name__, **dict(_plain(asdict(finding.panel)))},
    }


def _plain(content: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in content.items():
        yield name, _as_json(value)


def _as_json(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _as_json(one) for key, one in value.items()}
    if isinstance(value, np.ndarray):
        return [_as_json(one) for one in value] if value.ndim > 1 else _numbers(value)
    if isinstance(value, (list, tuple)):
        return [_as_json(one) for one in value]
    if isinstance(value, (float, np.floating)):
        return _number(float(value))
    return value


def _numbers(values: Any) -> list[float | None]:
    return [_number(float(one)) for one in np.asarray(values, dtype=np.float64)]


def _number(value: float) -> float | None:
    return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None
