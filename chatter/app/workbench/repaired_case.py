"""Whether an explanation has left a repaired case that can be accepted, and if not, why."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from chatter.app.workbench.session import Session, read_object
from chatter.description.case import Case, load
from chatter.explain.data_checks.finding import FATAL
from chatter.explain.verdict import NOTHING_MISSING

UPDATED, _EXPLANATION = "case-updated.toml", "explanation.json"
_NONE_YET = "Explain makes one, where it finds what the case lacks."


def why_no_repaired_case(results: Path) -> str:
    """Say why there is no repaired case among the results of `explain`; empty where there is one.

    `case-updated.toml` is written whatever was found: without an effect or a learnt term it is the
    declared case, or the declared case refitted.
    """
    found = read_object(results / _EXPLANATION)
    if not found or not (results / UPDATED).is_file():
        return f"There is no repaired case yet. {_NONE_YET}"
    if found.get("effects") or found.get("empirical"):
        return ""
    return f"There is no repaired case: {_reason(found)}."


def take_repaired_case(session: Session, results: Path, name: str) -> Path:
    """Save the repaired case under a name of the folder; returns where.

    A machine that was repaired with it stands among the results, where the next explanation writes
    its own: it is saved beside the case. InputError if one of the names is taken, or is none.
    """
    target, case = session.new_path(name), load(results / UPDATED)
    if _has_machine_in(case, results):
        machine = session.new_path(f"{target.stem}-machine.toml")
        case.machine_file().save(machine)
        # relative to the case as it lies now; saving it elsewhere keeps what is meant
        case = case.patch({"structure.machine": os.path.relpath(machine, results)})
    case.save(target)
    return target


def _has_machine_in(case: Case, results: Path) -> bool:
    if not case.on_machine:
        return False
    return Path(case.structure.machine).resolve().parent == results.resolve()


def _reason(found: Mapping[str, Any]) -> str:
    fatal = [one for one in found.get("checks", ()) if one.get("severity") == FATAL]
    if fatal:
        first = str(fatal[0].get("description", "")).rstrip(".")
        return f"the data contradict themselves or their case, and nothing was looked for ({first})"
    if found.get("verdict") == NOTHING_MISSING:
        return "the case lacks nothing; the residual is the noise of the measurement"
    if found.get("partial"):
        return "the effects that may explain a part are not certain, and none was added"
    return "no known effect explains the residual"
