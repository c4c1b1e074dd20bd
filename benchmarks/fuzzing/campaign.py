"""Batches of inputs, each with its seed and a line of the journal, so that an ended run goes on."""

from __future__ import annotations

import collections
import contextlib
import json
import os
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

import hypothesis
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st

from benchmarks.fuzzing.answers import Source
from benchmarks.fuzzing.isolated import AS_IT_SHOULD, Worker, in_words, late

BATCH = 50
_JOURNAL = "journal.jsonl"


def _named(source: Source) -> tuple[str, ...]:
    """Names of which a refusal holds one: the file, its folder, what lies beside it."""
    beside = (one.name for one in source.path.parent.iterdir())
    return source.path.name, source.path.parent.name, *beside


def answer_in_words(sources: Sequence[Source], source: int, answer: int) -> str:
    """How an answer of a source to what lies in its file ends."""
    one = sources[source]
    return in_words(partial(one.answers[answer], one.path), _named(one))


def ended(worker: Worker, numbers: tuple[int, int]) -> str:
    """How the answer to what lies in the file ends.

    What is late is asked again after the same in a process with time to compile.
    """
    words = worker.ask(*numbers)
    if late(words):
        worker.ask(*numbers, seconds=120)
        words = worker.ask(*numbers)
    return words


def batch(
    worker: Worker,
    sources: Sequence[Source],
    number: int,
    seed: int,
    count: int,
    report: Callable[[str, bytes], None],
) -> dict:
    """Ask about some inputs; counts of how they ended. `report` takes each defect."""
    counts: collections.Counter[str] = collections.Counter()
    source = sources[number]

    @hypothesis.seed(seed)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @hypothesis.given(source.inputs, st.integers(0, len(source.answers) - 1))
    def ask(content: bytes, answer: int) -> None:
        source.path.write_bytes(content)
        words = ended(worker, (number, answer))
        counts[words if words in AS_IT_SHOULD else "defect"] += 1
        if words not in AS_IT_SHOULD:
            report(f"{source.answers[answer].__name__}: {words}", content)

    try:
        ask()
    finally:
        source.path.write_bytes(source.whole)
    return dict(counts)


def warmed(sources: Iterable[Source]) -> None:
    """Answer what is not damaged, so that forked processes find everything compiled."""
    for source in sources:
        source.path.write_bytes(source.whole)
        for answer in source.answers:
            with contextlib.suppress(Exception):
                answer(source.path)


def read_journal(out: Path) -> list[dict]:
    """Batches that a folder holds; a line that was cut off counts as not done."""
    path = out / _JOURNAL
    found = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        with contextlib.suppress(json.JSONDecodeError):
            found.append(json.loads(line))
    return found


def campaign(out: Path, sources: Sequence[Source], count: int, seed: int) -> list[dict]:
    """Ask about `count` inputs over the sources in turns, those of the journal left out."""
    out.mkdir(parents=True, exist_ok=True)
    done = {(one["source"], one["seed"]) for one in read_journal(out)}
    worker = Worker(partial(answer_in_words, sources))
    for number in range(-(-count // BATCH)):
        source = sources[number % len(sources)]
        own = seed * 1_000_000 + number
        if (f"{source.kind} {source.name}", own) in done:
            continue
        found: list[str] = []

        def report(words: str, content: bytes, source=source, own=own, found=found) -> None:
            found.append(words)
            folder = out / "findings" / f"{source.kind}-{own}-{len(found)}"
            folder.mkdir(parents=True, exist_ok=True)
            (folder / source.path.name).write_bytes(content)
            (folder / "words.txt").write_text(f"{source.name}\n{words}\n", encoding="utf-8")
            print(f"{source.kind} {source.name} {own}-{len(found)}\n    {words[:300]}", flush=True)

        size = min(BATCH, count - number * BATCH)
        counts = batch(worker, sources, number % len(sources), own, size, report)
        line = {"source": f"{source.kind} {source.name}", "seed": own, **counts}
        with (out / _JOURNAL).open("a", encoding="utf-8") as journal:
            journal.write(json.dumps(line) + "\n")
            journal.flush()
            os.fsync(journal.fileno())
    worker.end()
    return read_journal(out)


def table(journal: Sequence[dict]) -> str:
    """Counts by kind, as a table in Markdown."""
    columns = (*AS_IT_SHOULD, "defect")
    rows = [f"| kind | inputs | {' | '.join(columns)} |", "|---" * (len(columns) + 2) + "|"]
    kinds = dict.fromkeys(one["source"].split(" ")[0] for one in journal)
    for kind in (*kinds, "all"):
        own = [one for one in journal if kind in ("all", one["source"].split(" ")[0])]
        counts = [sum(one.get(name, 0) for one in own) for name in columns]
        rows.append(f"| {kind} | {sum(counts)} | {' | '.join(map(str, counts))} |")
    return "\n".join(rows) + "\n"
