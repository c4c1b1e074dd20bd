"""The hunt: cases drawn over all confrontations, judged, kept, and those that disagree written."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import tomlkit

from benchmarks.contradictions.confrontation import Confrontation
from benchmarks.contradictions.confrontation_list import by_name
from benchmarks.contradictions.one_case import OUTCOMES, Judged, drawn
from benchmarks.contradictions.workers import Task, all_judged

_RESULTS = "results.jsonl"


def tasks_of(confrontations: Sequence[Confrontation], seed: int, count: int) -> Iterator[Task]:
    """Some tasks over confrontations by their weights, taken in turns."""
    whole = sum(one.weight for one in confrontations)
    numbers = {one.name: 0 for one in confrontations}
    for place in range(1, count + 1):
        # whoever is farthest behind its share
        behind = max(confrontations, key=lambda one: place * one.weight / whole - numbers[one.name])
        yield behind.name, seed, numbers[behind.name]
        numbers[behind.name] += 1


def hunt(
    out: Path,
    tasks: Iterator[Task],
    workers: int,
    time_limit: float,
    report: Callable[[Judged], None],
) -> list[Judged]:
    """Judge the tasks that the folder does not hold yet, and return all that it holds then.

    Every result is a line of results.jsonl; a case of a finding with its numbers lies in findings.
    """
    out.mkdir(parents=True, exist_ok=True)
    kept = read_results(out)
    known = {one.key for one in kept}
    missing = (task for task in tasks if task not in known)
    with (out / _RESULTS).open("a", encoding="utf-8") as file:
        for found in all_judged(missing, workers, time_limit):
            file.write(json.dumps(found.as_dict()) + "\n")
            file.flush()
            if found.is_finding:
                write_finding(out, found)
            kept.append(found)
            report(found)
    return kept


def read_results(out: Path) -> list[Judged]:
    """Results that a folder holds; the last of each case."""
    path = out / _RESULTS
    if not path.exists():
        return []
    lines = path.read_text(encoding="utf-8").splitlines()
    found = [Judged(**json.loads(line)) for line in lines if line]
    return list({one.key: one for one in found}.values())


def write_finding(out: Path, found: Judged) -> Path:
    """Write the case of a finding, its numbers above it as comments."""
    confrontation = by_name(found.confrontation)
    document = tomlkit.document()
    lines = [f"{confrontation.name}: {confrontation.ways}", f"allowed: {confrontation.stated}"]
    lines += [found.reason] if found.reason else []
    lines += [
        f"{one['quantity']}: {one['one']:.9g} and {one['other']:.9g}, {one['excess']:.3g} times "
        "what is allowed"
        for one in found.compared
        if one["excess"] > 1.0
    ]
    for line in lines:
        document.add(tomlkit.comment(" ".join(line.split())))
    for key, section in drawn(confrontation, found.seed, found.number).items():
        document.add(key, section)
    folder = out / "findings"
    folder.mkdir(exist_ok=True)
    name = found.confrontation.replace(" ", "-")
    path = folder / f"{name}-{found.seed}-{found.number}.toml"
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
    return path


def table(results: Sequence[Judged]) -> str:
    """Counts of every confrontation, as a table in Markdown."""
    rows = [
        f"| confrontation | cases | {' | '.join(OUTCOMES)} | worst that agrees | s a case |",
        "|---" * (len(OUTCOMES) + 4) + "|",
    ]
    names = list(dict.fromkeys(one.confrontation for one in results))
    for name in names:
        own = [one for one in results if one.confrontation == name]
        counts = [sum(one.outcome == outcome for one in own) for outcome in OUTCOMES]
        agreeing = [
            each["excess"] for one in own if one.outcome == "agrees" for each in one.compared
        ]
        worst = f"{max(agreeing):.2g}" if agreeing else ""
        seconds = math.fsum(one.seconds for one in own) / len(own)
        cells = (name, len(own), *counts, worst, f"{seconds:.2g}")
        rows.append("| " + " | ".join(map(str, cells)) + " |")
    total = [sum(one.outcome == outcome for one in results) for outcome in OUTCOMES]
    rows.append(f"| all | {len(results)} | {' | '.join(map(str, total))} | | |")
    return "\n".join(rows) + "\n"
