"""Real cutting tests by folds: Brier scores of `chatter learn`, the declared case, a logistic fit.

Tests of tests/data/stability-hajdu-2020 are dealt out to folds; each is predicted from the others.
The logistic fit is over speed, depth and their products up to the third order, with a ridge.

    python -m benchmarks.learning_real [--folds 5] [--declared-deviations]
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy

import chatter
from chatter.explain.kinds.stability import SCATTER, likely_stable
from chatter.explain.measurement import Measurement
from chatter.explain.stability_margin import response_of_tests, tests_of
from chatter.learning.cuts import TEST, read_cuts
from chatter.learning.learn import problem_of
from chatter.learning.likelihood import Likelihood
from chatter.learning.posterior import prior_particles, updated
from chatter.learning.prior import prior_of

_FOLDER = Path(__file__).parents[1] / "tests" / "data" / "stability-hajdu-2020"
#: standard deviations that the paper states
STATED = {
    "material.Ktc": "1095 +- 150 MPa",
    "material.Krc": "176 +- 50 MPa",
    "structure.mode[0].frequency": "782.7 +- 80 Hz",
    "structure.mode[1].frequency": "752.8 +- 80 Hz",
    "structure.mode[0].damping": "0.0184 +- 0.008",
    "structure.mode[1].damping": "0.0186 +- 0.008",
    "structure.mode[0].stiffness": "6.5616e6 +- 2e6 N/m",
    "structure.mode[1].stiffness": "4.8852e6 +- 2e6 N/m",
}
_PARTICLES, _RIDGE = 128, 1.0


def part_of(measurement: Measurement, chosen: np.ndarray) -> Measurement:
    """Some of the tests, numbered anew."""
    (run,) = measurement.runs
    signals = {name: values[chosen] for name, values in run.signals.items()}
    signals[TEST] = np.arange(int(chosen.sum()), dtype=float)
    return measurement.with_runs([replace(run, signals=signals)])


def learnt(known: Measurement, asked: Measurement, seed: int) -> np.ndarray:
    """Probability (n,) of a stable verdict of tests, learnt from others."""
    problem, generator = problem_of(known), np.random.default_rng(seed)
    prior = prior_of(problem)
    before = prior_particles(prior, _PARTICLES, generator)
    after = updated(before, Likelihood(problem, prior), generator)
    other = Likelihood(replace(problem, measurement=asked), prior)
    margins, scatter = other.predictions(after.counted), other.scatter(after.counted)
    return likely_stable(margins, scatter[:, None]).mean(axis=0)


def logistic(known: Measurement, asked: Measurement) -> np.ndarray:
    """Probability (n,) by a logistic regression over speed and depth."""

    def rows(measurement: Measurement) -> np.ndarray:
        signals = measurement.runs[0].signals
        speed = (signals["spindle_speed"] / (2.0 * np.pi) - 150.0) / 40.0
        depth = np.log(signals["axial_depth"] / 1e-3)
        terms = [speed**i * depth**j for i in range(4) for j in range(4 - i)]
        return np.stack(terms, axis=1)

    x, y = rows(known), known.runs[0].signals["stable"]

    def lost(weights: np.ndarray) -> float:
        likely = np.logaddexp(0.0, np.where(y > 0.5, -1.0, 1.0) * (x @ weights))
        return float(likely.sum() + 0.5 * _RIDGE * weights[1:] @ weights[1:])

    weights = scipy.optimize.minimize(lost, np.zeros(x.shape[1])).x
    return scipy.special.expit(rows(asked) @ weights)


def declared(case: chatter.Case, asked: Measurement) -> np.ndarray:
    """Probability (n,) by the declared case and the usual scatter of limits."""
    margin = response_of_tests(case, tests_of(case, asked.runs[0].signals)).margin
    return likely_stable(margin, SCATTER)


def main() -> None:
    """Print Brier scores and verdicts that are right."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--folds", type=int, default=5)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--declared-deviations", action="store_true", help="those of the paper")
    given = options.parse_args()
    case = chatter.load(_FOLDER / "case.toml")
    if given.declared_deviations:
        case = case.patch(STATED)
    every = read_cuts(_FOLDER / "points.csv", case)
    every = every.with_runs([run for run in every.runs if run.record == "stable"])
    stable = every.runs[0].signals["stable"]
    fold = np.random.default_rng(given.seed).permutation(stable.size) % given.folds
    found = {name: np.empty(stable.size) for name in ("learn", "logistic", "declared")}
    for k in range(given.folds):
        known, asked = part_of(every, fold != k), part_of(every, fold == k)
        found["learn"][fold == k] = learnt(known, asked, given.seed)
        found["logistic"][fold == k] = logistic(known, asked)
        found["declared"][fold == k] = declared(case, asked)
    for name, probability in found.items():
        right = int(np.sum((probability > 0.5) == (stable > 0.5)))
        brier = float(np.mean((probability - stable) ** 2))
        print(f"{name:9} Brier score {brier:.4f}, {right} of {stable.size} verdicts right")


if __name__ == "__main__":
    main()
