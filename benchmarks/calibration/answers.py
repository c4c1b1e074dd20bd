"""What `chatter explain` says of sets drawn at random, beside the truth."""

from __future__ import annotations

import importlib
import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from benchmarks.blind_sets.__main__ import FIRST, KINDS

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
        "seconds": round(time.process_time() - begun, 2),
    }


def _named(effect: Answer) -> Answer:
    return {key: effect[key] for key in ("name", "probability", "confounded_with")}


def read_answers(file: Path) -> list[Answer]:
    """Answers that are kept in a file; none where there is no such file."""
    if not file.exists():
        return []
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line]


def surveyed(out: Path, kinds: Sequence[str], count: int, seed: int) -> Iterator[Answer]:
    """Answer what is not answered yet: the kinds by turns, `count` sets in all."""
    out.mkdir(parents=True, exist_ok=True)
    file = out / "answers.jsonl"
    known = {(one["kind"], one["number"], one["seed"]) for one in read_answers(file)}
    for place in range(count):
        kind, number = kinds[place % len(kinds)], place // len(kinds) + 1
        if (kind, number, seed) in known:
            continue
        answer = answer_of(kind, number, seed)
        with file.open("a", encoding="utf-8") as lines:
            lines.write(json.dumps(answer) + "\n")
        yield answer
