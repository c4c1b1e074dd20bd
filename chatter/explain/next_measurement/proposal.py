"""The measurement of most expected information within the limits that the user gives."""

from __future__ import annotations

from typing import Any

import numpy as np

from chatter.description.errors import InputError, RunError
from chatter.explain.kinds.kind import Trial
from chatter.explain.measurement import Run
from chatter.explain.next_measurement.alternatives import Alternative, alternatives
from chatter.explain.next_measurement.limits import is_within
from chatter.explain.selection.search import Search

#: information, bit, below which a measurement is not worth making
LEAST_INFORMATION = 0.05


def next_measurement(found: Search) -> dict[str, Any]:
    """Entry of explanation.json: what would decide between the models that are left.

    "between" are the models with their probabilities; "description", "channel" and
    "expected_information_bit" are of the best measurement, absent where none can be made; "about"
    says whether it is about which model holds or about the values of the only one that is left.
    """
    models = alternatives(found)
    entry: dict[str, Any] = {
        "between": [
            {"model": one.label, "probability": round(one.probability, 4)} for one in models
        ],
        "about": "model" if len(models) > 1 else "values",
    }
    best = _best(found, models)
    if best is not None:
        trial, channel, information = best
        entry["description"], entry["channel"] = trial.description, channel
        entry["expected_information_bit"] = round(information, 4)
        entry["worth_making"] = information >= LEAST_INFORMATION
    return entry


def _best(found: Search, models: list[Alternative]) -> tuple[Trial, str, float] | None:
    measurement, kind = found.measurement, found.problem.kind
    best: tuple[Trial, str, float] | None = None
    cases = [(one.probability / len(one.cases), case) for one in models for case in one.cases]
    if not cases:
        return None
    weights = np.array([weight for weight, _ in cases])
    weights /= weights.sum()
    for trial in kind.trials(measurement, found.problem.noise):
        if not is_within(trial, measurement.limits, measurement.case):
            continue
        run = _coarse(trial.run, found)
        try:
            predicted = [found.problem.kind.predict(run.of(case), run) for _, case in cases]
        except (InputError, RunError):
            # what cannot be cut cannot be measured
            continue
        for channel in trial.noise:
            own = [one[channel] for one in predicted]
            information = kind.information(trial, channel, weights, own)
            if best is None or information > best[2]:
                best = trial, channel, information
    return best


def _coarse(run: Run, found: Search) -> Run:
    """Run as it is predicted at less cost by a machine: what counts is how far models differ."""
    declared = found.measurement.case
    if not declared.on_machine:
        return run
    return run.with_overrides(found.problem.kind.coarse(declared, run))


def in_words(entry: dict[str, Any]) -> str:
    """Sentence on what to measure next."""
    models = " and ".join(one["model"] for one in entry["between"])
    question = f"decides between {models}" if entry["about"] == "model" else "narrows the values"
    if "description" not in entry:
        return "no measurement within the limits is known that would say more"
    if not entry["worth_making"]:
        return (
            "no measurement within the limits is expected to say more "
            f"(expected information at most {entry['expected_information_bit']:.2g} bit)"
        )
    return (
        f"measure next: {entry['description']}, {entry['channel'].replace('_', ' ')}: it "
        f"{question} (expected information {entry['expected_information_bit']:.2g} bit)"
    )
