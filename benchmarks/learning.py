"""How many cutting tests `chatter learn` needs: the cuts it asks for, a grid, and chance.

Verdicts come from integration in time (`benchmarks.blind_sets.stability_physics`) of machines that
differ from what is declared by the standard deviations that the case states; a limit scatters by
5 % from test to test. Of every way to choose the cuts, the error of the median limit over the
speeds is printed after some cuts, as the median over the machines:

    python -m benchmarks.learning --machines 8 --cuts 20
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

import chatter
from benchmarks.cutting_tests import Mill, limit, machine, speeds_of, write
from chatter.explain.measurement import Measurement, Run
from chatter.learning.cuts import with_one_run_a_reading
from chatter.learning.diagram import ParticleDiagram, diagram_of
from chatter.learning.learn import cases_of, problem_of
from chatter.learning.likelihood import Likelihood
from chatter.learning.next_cut import INFORMATION, next_cut
from chatter.learning.posterior import Particles, prior_particles, updated
from chatter.learning.prior import SCATTER_OF_LIMITS, prior_of

#: standard deviations of what is declared
_FREQUENCY, _DAMPING, _MASS, _FORCE = 0.04, 0.25, 0.1, 0.12
_SCATTER = 0.05
_SPEEDS, _DEPTHS, _GRID = 25, 22, 5
_PARTICLES = 64

Choice = Callable[[ParticleDiagram, int, np.random.Generator], tuple[float, float]]


def as_declared(mill: Mill, random: np.random.Generator) -> Mill:
    """The machine as it is declared: off by the standard deviations."""

    def off(share: float) -> float:
        return float(1.0 + share * random.normal())

    modes = tuple(
        (f * off(_FREQUENCY), z * max(off(_DAMPING), 0.4), m * off(_MASS), a)
        for f, z, m, a in mill.modes
    )
    return replace(mill, kt=mill.kt * off(_FORCE), kr=mill.kr * off(_FORCE), modes=modes)


def declared_case(mill: Mill, folder: Path) -> chatter.Case:
    """Case of a machine with the standard deviations of its values."""
    write(
        folder,
        "machine",
        mill,
        [(speeds_of(mill, False)[0], 1e-3, 1e-4, 0.0, True, 0.0, 0.0)],
        "few",
    )
    case = chatter.load(folder / "case.toml")
    given = {
        "material.Ktc": f"{mill.kt / 1e6:.6g} +- {_FORCE * mill.kt / 1e6:.6g} MPa",
        "material.Krc": f"{mill.kr / 1e6:.6g} +- {_FORCE * mill.kr / 1e6:.6g} MPa",
    }
    for k, (f, z, m, _) in enumerate(mill.modes):
        given[f"structure.mode[{k}].frequency"] = f"{f:.6g} +- {_FREQUENCY * f:.6g} Hz"
        given[f"structure.mode[{k}].damping"] = f"{z:.6g} +- {_DAMPING * z:.6g}"
        given[f"structure.mode[{k}].mass"] = f"{m:.6g} +- {_MASS * m:.6g} kg"
    return case.patch(given)


def asked_for(diagram: ParticleDiagram, number: int, random: np.random.Generator):  # noqa: ARG001
    """The cut of most information."""
    chosen = next_cut(diagram, INFORMATION, 1.0)
    return chosen.spindle_speed, chosen.axial_depth


def by_grid(diagram: ParticleDiagram, number: int, random: np.random.Generator):  # noqa: ARG001
    """The next point of a grid over the diagram, of which neighbours follow late."""
    order = np.random.default_rng(7).permutation(_GRID * _GRID)[number % (_GRID * _GRID)]
    share = (np.array(divmod(int(order), _GRID)) + 0.5) / _GRID
    speeds, depths = diagram.speeds, diagram.depths
    return (
        float(speeds[0] + share[0] * np.ptp(speeds)),
        float(depths[0] + share[1] * np.ptp(depths)),
    )


def by_chance(diagram: ParticleDiagram, number: int, random: np.random.Generator):  # noqa: ARG001
    """Any cut of the diagram."""
    return float(random.choice(diagram.speeds)), float(random.choice(diagram.depths))


WAYS: dict[str, Choice] = {"asked for": asked_for, "grid": by_grid, "chance": by_chance}


def measurement_of(case: chatter.Case, rows: list[tuple[float, float, float]]) -> Measurement:
    """Measurement of tests: speed, depth, verdict."""
    columns = dict(zip(("spindle_speed", "axial_depth", "stable"), np.array(rows).T, strict=True))
    run = Run("cuts", {}, columns)
    return with_one_run_a_reading(Measurement("stability", "", Path(), case, (run,)))


def errors(true: np.ndarray, diagram: ParticleDiagram) -> float:
    """Median error of the median limit over the speeds, of limits within the diagram."""
    learnt = np.sort(diagram.limits, axis=0)[len(diagram.limits) // 2]
    deepest = float(diagram.depths[-1])
    return float(np.median(np.abs(np.minimum(learnt, deepest) / np.minimum(true, deepest) - 1.0)))


def course(mill: Mill, case: chatter.Case, choose: Choice, cuts: int, seed: int) -> list[float]:
    """Error after every cut, from none on."""
    random = np.random.default_rng(seed)
    low, high = speeds_of(mill, False)
    speeds = np.linspace(low, high, _SPEEDS)
    true = np.array([limit(mill, float(speed), 0.06) for speed in speeds])
    finite = true[np.isfinite(true)]
    depths = np.linspace(
        0.0, min(5.0 * float(finite.min()), 1.2 * float(finite.max())), _DEPTHS + 1
    )
    rows: list[tuple[float, float, float]] = [(low, 1e-6, 1.0)]
    prior = prior_of(problem_of(measurement_of(case, rows)))
    particles, found = prior_particles(prior, _PARTICLES, random), []
    for number in range(cuts + 1):
        diagram = seen(case, rows, particles, speeds, depths[1:])
        found.append(errors(true, diagram))
        speed, depth = choose(diagram, number, random)
        wet = depth * math.exp(_SCATTER * random.normal())
        rows.append((speed, depth, float(wet < limit(mill, speed, 0.06))))
        problem = problem_of(measurement_of(case, rows))
        particles = updated(particles, Likelihood(problem, prior), random)
    return found


def seen(case, rows, particles: Particles, speeds, depths) -> ParticleDiagram:
    """Diagram of the particles."""
    problem = problem_of(measurement_of(case, rows))
    scatter = particles.columns()[SCATTER_OF_LIMITS]
    return diagram_of(cases_of(problem, particles), scatter, speeds, depths)


def main() -> None:
    """Print errors over the number of cuts."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--machines", type=int, default=8)
    options.add_argument("--cuts", type=int, default=20)
    options.add_argument("--seed", type=int, default=1)
    given = options.parse_args()
    found: dict[str, list[list[float]]] = {name: [] for name in WAYS}
    for number in range(given.machines):
        random = np.random.default_rng([given.seed, number])
        mill = machine(random, False)
        with tempfile.TemporaryDirectory() as folder:
            case = declared_case(as_declared(mill, random), Path(folder))
            for name, choose in WAYS.items():
                found[name].append(course(mill, case, choose, given.cuts, given.seed + number))
                last = found[name][-1]
                print(f"machine {number + 1}, {name}: {last[0]:.1%} to {last[-1]:.1%}", flush=True)
    print("median error of limits after cuts " + " ".join(f"{k:6d}" for k in range(given.cuts + 1)))
    for name, rows in found.items():
        print(f"{name:33s} " + " ".join(f"{x:6.1%}" for x in np.median(rows, axis=0)))


if __name__ == "__main__":
    main()
