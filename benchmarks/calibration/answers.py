"""What `chatter explain` says of sets drawn at random, beside the truth."""

from __future__ import annotations

import importlib
import json
import multiprocessing
import os
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import suppress
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from benchmarks.blind_sets.__main__ import FIRST, KINDS
from benchmarks.blind_sets.milling import CannotDrawError

Answer = dict[str, Any]


def answer_of(kind: str, number: int, seed: int) -> Answer:
    """Draw a set of a kind, explain it, and return what was said and what is true."""
    module = importlib.import_module(f"benchmarks.blind_sets.{kind}")
    rng = np.random.default_rng([seed, KINDS.index(kind), number])
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        module.write_set(out, FIRST[kind] + number - 1, rng, None)
        (truth_file,) = out.glob("truth/*/truth.toml")
        truth = tomlkit.parse(truth_file.read_text(encoding="utf-8")).unwrap()
        return {
            "kind": kind,
            "number": number,
            "seed": seed,
            "truth": truth["effects"],
            "true_verdict": truth["verdict"],
            "expected": truth.get("expected", {}),
            **_said(out / truth_file.parent.name),
        }


def _said(place: Path) -> Answer:
    """Verdict, effects with their probabilities, and seconds."""
    import chatter

    begun = time.process_time()
    found = chatter.explain(place).summary()
    return {
        "verdict": found["verdict"],
        "effects": [_named(one) for one in found["effects"]],
        "partial": [_named(one) for one in found["partial"]],
        "error": found["error"],
        "seconds": round(time.process_time() - begun, 2),
    }


def _named(effect: Answer) -> Answer:
    parameters = {name: one["value"] for name, one in effect.get("parameters", {}).items()}
    named = {key: effect[key] for key in ("name", "probability", "confounded_with")}
    return {**named, "parameters": parameters}


def read_answers(file: Path) -> list[Answer]:
    """Answers that are kept in a file; none where there is no such file."""
    if not file.exists():
        return []
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line]


def surveyed(
    out: Path, kinds: Sequence[str], count: int, seed: int, processes: int = 1
) -> Iterator[Answer]:
    """Answer what is not answered yet: the kinds by turns, `count` sets in all."""
    out.mkdir(parents=True, exist_ok=True)
    file = out / "answers.jsonl"
    known = {(one["kind"], one["number"], one["seed"]) for one in read_answers(file)}
    asked = [(kinds[place % len(kinds)], place // len(kinds) + 1, seed) for place in range(count)]
    asked = [one for one in asked if one not in known]
    for answer in _answers(asked, processes):
        with file.open("a", encoding="utf-8") as lines:
            lines.write(json.dumps(answer) + "\n")
        yield answer


def _answers(asked: Sequence[tuple[str, int, int]], processes: int) -> Iterator[Answer]:
    """Answers as they come, of several sets at once where there are several processes.

    Sets that cannot be drawn are passed over.
    """
    if processes == 1:
        for one in asked:
            with suppress(CannotDrawError):
                yield answer_of(*one)
        return
    context = multiprocessing.get_context("spawn")
    started = context.Value("i", 0)
    pool = ProcessPoolExecutor(processes, context, _on_own_core, (started,))
    try:
        for done in as_completed([pool.submit(answer_of, *one) for one in asked]):
            if not isinstance(done.exception(), CannotDrawError):
                yield done.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _on_own_core(started: Synchronized) -> None:
    """Keep a process to one of the cores, so that its threads do not crowd the others."""
    with started.get_lock():
        number, started.value = started.value, started.value + 1
    if hasattr(os, "sched_setaffinity"):
        cores = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, {cores[number % len(cores)]})
