"""`learn`: what cutting tests leave possible of a case, and the next cut to make."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case, load
from chatter.description.described_or_path import described_or_read
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.given_values import share_given, whole_number_given
from chatter.description.unit_system import UnitSystem, units_of
from chatter.description.units import rpm
from chatter.explain.kinds.stability import Stability, likely_stable
from chatter.explain.measurement import Measurement
from chatter.explain.new_values import in_declared_unit, in_usual_units
from chatter.explain.prediction import Predictions, kept_predictions
from chatter.explain.selection.problem import Problem
from chatter.io.presentation import presentation
from chatter.io.result_files import (
    NotebookResult,
    as_json,
    finite_or_none,
    short_repr,
    write_results,
)
from chatter.io.result_tables import Column, csv_text
from chatter.learning.contradictions import contradictions, one_sided, surprises
from chatter.learning.cuts import read_cuts
from chatter.learning.diagram import ParticleDiagram, diagram_of
from chatter.learning.likelihood import Likelihood
from chatter.learning.next_cut import AIMS, INFORMATION, LEAST_INFORMATION, NextCut, next_cut
from chatter.learning.posterior import Particles, Progress, prior_particles, updated
from chatter.learning.prior import SCATTER_OF_LIMITS, of_a_turning_tool, prior_of, with_wear
from chatter.stability.search_range import spindle_speeds
from chatter.studies.optimisation.operating_point import with_feed_per_tooth

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DEFAULT_PARTICLES, DEFAULT_RISK = 128, 0.5
#: points of the diagram, and particles at the most that it is of
_SPEEDS, _DEPTHS, _OF_DIAGRAM = 49, 28, 64
#: deepest cut of the diagram, over the deepest test and the deepest limit that half the particles
#: exceed
_DEEPER, _ABOVE_MEDIAN = 1.4, 1.25
#: first depth of the diagram over the lowest limit, where equal steps would be too coarse
_BELOW_LOWEST = 0.4
_LEVELS = (0.05, 0.5, 0.95)
#: relative scatter of limits that no machine has from one test to the next
_WIDE_SCATTER = 0.3


@dataclass(frozen=True, eq=False, repr=False)
class Learnt(NotebookResult):
    """What tests leave possible.

    Parameters
    ----------
    case : Case
        As declared.
    measurement : Measurement
        The tests, a run a reading.
    problem : Problem
        Of the case and the effects that were learnt beside it.
    before, after : Particles
        Of the prior and of the posterior.
    diagram, first : ParticleDiagram
        Of the tool as it is after the last test, and as it was at the first.
    aim, risk : str, float
        What the next cut is for; largest probability of chatter that it may have.
    """

    case: Case
    measurement: Measurement
    problem: Problem
    before: Particles
    after: Particles
    diagram: ParticleDiagram
    first: ParticleDiagram
    aim: str
    risk: float

    @property
    def units(self) -> UnitSystem:
        """Units that the words and the picture are in: those of the case."""
        return units_of(self.case)

    @property
    def next_cut(self) -> NextCut | None:
        """The cut to make next; None where none is within the risk."""
        return next_cut(self.diagram, self.aim, self.risk)

    @property
    def largest_information(self) -> float:
        """Information that the best cut of all is expected to give, bit."""
        return next_cut(self.diagram, INFORMATION, 1.0).information

    @property
    def is_learnt_out(self) -> bool:
        """Whether no cut is expected to say more."""
        return self.largest_information < LEAST_INFORMATION

    @property
    def updated(self) -> Case:
        """Declared case with the medians of what was learnt."""
        names = [one.name for one in self.problem.parameters()]
        columns = self.after.columns()
        return self.problem.case({name: float(np.median(columns[name])) for name in names})

    def probability_of_tests(self) -> tuple[Array, Array]:
        """Probability (n,) that each judged test is stable, and its verdict (n,), 1 for stable."""
        runs = [run for run in self.measurement.runs if run.record == "stable"]
        if not runs:
            return np.empty(0), np.empty(0)
        judged = replace(self.problem, measurement=self.measurement.with_runs(runs))
        likelihood = Likelihood(judged, self.after.prior)
        margins = likelihood.predictions(self.after.counted)
        scatter = likelihood.scatter(self.after.counted)
        return likely_stable(margins, scatter[:, None]).mean(axis=0), runs[0].signals["stable"]

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """Tests that contradict each other or what was learnt, or that bound limits on one side."""
        probability, _ = self.probability_of_tests()
        notes = [
            *contradictions(self.measurement),
            *surprises(self.measurement, probability),
            *one_sided(self.measurement),
        ]
        scatter = float(np.median(self.after.columns()[SCATTER_OF_LIMITS]))
        if scatter > _WIDE_SCATTER:
            notes.append(
                f"limits scatter by {scatter:.0%} from test to test, where some percent are usual: "
                "the tests contradict each other, or the case lacks what they show"
            )
        return tuple(notes)

    def __repr__(self) -> str:
        """What the result is of: its arrays would fill the screen."""
        return short_repr(self)

    def summary(self) -> dict[str, Any]:
        """Content of posterior.json."""
        chosen = self.next_cut
        return {
            "tests": self.after.tests,
            "parameters": self._parameters(),
            "verdicts": self._verdicts(),
            "limits": self._limits(),
            "next_cut": None
            if chosen is None
            else {
                "spindle_speed_rpm": float(rpm(chosen.spindle_speed)),
                "axial_depth_mm": 1e3 * chosen.axial_depth,
                "probability_of_stability": chosen.probability,
                "expected_information_bit": chosen.information,
                "aim": self.aim,
                "risk": self.risk,
            },
            "largest_expected_information_bit": self.largest_information,
            "nothing_left_to_learn": self.is_learnt_out,
            "notes": list(self.notes),
        }

    def _parameters(self) -> list[dict[str, Any]]:
        before, after = self.before.columns(), self.after.columns()
        return [
            {
                "path": one.name,
                "unit": one.unit,
                "declared": {
                    "value": float(one.start),
                    "standard_deviation": float(before[one.name].std()),
                },
                "learnt": {
                    "median": float(np.median(after[one.name])),
                    "standard_deviation": float(after[one.name].std()),
                    "ci95": np.quantile(after[one.name], (0.025, 0.975)).tolist(),
                },
            }
            for one in self.after.prior.parameters
        ]

    def _verdicts(self) -> dict[str, Any]:
        probability, stable = self.probability_of_tests()
        if not stable.size:
            return {"judged": 0, "right": 0, "brier_score": None}
        return {
            "judged": int(stable.size),
            "right": int(np.sum((probability > 0.5) == (stable > 0.5))),
            "brier_score": float(np.mean((probability - stable) ** 2)),
        }

    def _limits(self) -> dict[str, Any]:
        """Limits over speed: 5 %, median, 95 %, of the tool at the first and at the last test."""
        return {
            "spindle_speed_rpm": rpm(self.diagram.speeds).tolist(),
            "levels": list(_LEVELS),
            "critical_depth_mm": {
                name: [[finite_or_none(1e3 * value) for value in row] for row in quantiles(one)]
                for name, one in (("first", self.first), ("last", self.diagram))
            },
        }

    def _table(self) -> str:
        speeds, depths = np.meshgrid(self.diagram.speeds, self.diagram.depths, indexing="ij")
        return csv_text(
            {
                "spindle_speed [rpm]": Column(rpm(speeds.ravel()), ".6g"),
                "axial_depth [mm]": Column(1e3 * depths.ravel(), ".5g"),
                "probability_of_stability": Column(self.diagram.probability.ravel(), ".4f"),
            }
        )

    def plot(self) -> Figure:
        """Picture of the probability of stability, the tests and the next cut."""
        return presentation("plots.learning").plot_learning(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write posterior.json, learn.csv, learn.png, case-updated.toml and next-cut.toml.

        next-cut.toml is the updated case with the next cut; it is left out where there is none.
        """
        texts = {"posterior.json": as_json(self.summary()), "learn.csv": self._table()}
        written = write_results(folder, texts, {"learn.png": self.plot()})
        updated = in_usual_units(self.updated, self.measurement.case)
        cases = {"case-updated.toml": updated}
        chosen = self.next_cut
        if chosen is not None:
            at = updated.patch(
                {
                    "cut.spindle_speed": f"{rpm(chosen.spindle_speed):.6g} rpm",
                    "cut.axial_depth": in_declared_unit(
                        self.measurement.case, "cut.axial_depth", chosen.axial_depth
                    ),
                }
            )
            # a case that states the rate of the feed has another chip at another speed
            cases["next-cut.toml"] = with_feed_per_tooth(at, updated.cut.feed_per_tooth)
        for name, case in cases.items():
            case.save(Path(folder) / name)
        self.problem.predictions.kept.discard()
        return [*written, *(Path(folder) / name for name in cases)]


def quantiles(diagram: ParticleDiagram) -> Array:
    """Quantiles (levels, s) of the limits of a diagram, m; inf where there is none."""
    limits = np.sort(diagram.limits, axis=0)
    rows = np.round(np.array(_LEVELS) * (len(limits) - 1)).astype(np.intp)
    return limits[rows]


def learn(
    case: str | Path | Case,
    cuts: str | Path | Measurement,
    *,
    aim: str = INFORMATION,
    risk: float = DEFAULT_RISK,
    particles: int = DEFAULT_PARTICLES,
    seed: int = 1,
    progress: Progress = lambda *_: None,
    folder: str | Path | None = None,
) -> Learnt:
    """Learn from cutting tests what a case leaves open, and propose the next cut.

    Parameters
    ----------
    case : path or Case
        Its uncertain values, such as "765 +- 80 Hz", are what is known before; values without a
        standard deviation have that of a usual measurement. [lobes] is the range of the diagram.
    cuts : path or Measurement
        CSV table of tests, or a measurement folder of kind "stability".
    aim : {"information", "metal"}
        What the next cut is for.
    risk : float
        Largest probability of chatter that the next cut may have, 0 to 1.
    particles, seed : int
        Number of equally likely particles, at least 32; of the random numbers.
    progress : callable, optional
        Called with (what is being done, share done).
    folder : path, optional
        Keeps predictions below the result cache there until `Learnt.save` has written the results,
        and goes on from those of an earlier run that was ended.

    Raises
    ------
    InputError
        If the case or the tests cannot be used, or an option is out of range.
    RunError
        If it is interrupted while predictions are kept.
    OSError
        If they cannot be kept.
    """
    declared = described_or_read(case, Case, load)
    _check(aim, risk, particles, seed)
    measurement = cuts if isinstance(cuts, Measurement) else read_cuts(cuts, declared)
    problem = problem_of(measurement, folder)
    prior = prior_of(problem)
    generator = np.random.default_rng(seed)
    before = prior_particles(prior, particles, generator)
    with problem.predictions.kept.going_on():
        after = updated(before, Likelihood(problem, prior), generator, progress)
        progress("stability of all particles", 1.0)
        speeds, depths = _ranges(measurement, problem, after)
        last = _diagram(problem, after, speeds, depths, None)
        first = last if not problem.effects else _diagram(problem, after, speeds, depths, 0.0)
    return Learnt(declared, measurement, problem, before, after, last, first, aim, risk)


def _check(aim: str, risk: float, particles: int, seed: int) -> None:
    if not isinstance(aim, str) or aim not in AIMS:
        raise InputError(f"--aim {formatted(aim)} is none of {', '.join(AIMS)}")
    share_given(risk, "--risk")
    whole_number_given(particles, "--particles", 32, 100_000)
    whole_number_given(seed, "--seed", 0, 2**31)


def problem_of(measurement: Measurement, folder: str | Path | None = None) -> Problem:
    """Problem of tests, with wear where they show when they were made.

    Predictions are kept below a folder of results, where one is given.
    """
    kind, measurement = Stability(), of_a_turning_tool(measurement)
    measurement.case.require(*kind.sections)
    noise = {run.name: kind.first_noise(run) for run in measurement.runs}
    predictions = Predictions(kind, kept_predictions(folder, "learn", measurement))
    return with_wear(Problem(measurement, predictions, noise))


def _diagram(
    problem: Problem, particles: Particles, speeds: Array, depths: Array, cut_time: float | None
) -> ParticleDiagram:
    some = particles.some(_OF_DIAGRAM)
    cases = cases_of(problem, some)
    if cut_time is not None:
        cases = [case.patch({"cut.cut_time": cut_time}) for case in cases]
    return diagram_of(cases, some.columns()[SCATTER_OF_LIMITS], speeds, depths)


def cases_of(problem: Problem, particles: Particles) -> list[Case]:
    """Cases of particles, of the tool as it is after the last test."""
    names = [one.name for one in problem.parameters()]
    return [problem.case({name: row[name] for name in names}) for row in particles.values()]


def _ranges(
    measurement: Measurement, problem: Problem, particles: Particles
) -> tuple[Array, Array]:
    """Speeds and depths of the diagram: of [lobes], else over the tests and the limits."""
    case = measurement.case
    tested = [
        np.concatenate([run.signals[name] for run in measurement.runs])
        for name in ("spindle_speed", "axial_depth")
    ]
    wide = spindle_speeds(case) if case.lobes and case.lobes.speeds else tested[0]
    speeds = _speeds(float(wide.min()), float(wide.max()))
    given = case.lobes.depths if case.lobes else None
    deepest = _DEEPER * float(tested[1].max())
    rough = np.geomspace(0.3 * float(tested[1].min()), 4.0 * deepest, 16)
    limits = _diagram(problem, particles, speeds[::4], rough, None).limits
    median = np.median(limits, axis=0)
    finite = median[np.isfinite(median)]
    most = max(deepest, _ABOVE_MEDIAN * float(finite.max())) if finite.size else deepest
    return speeds, _depths(given.to if given is not None else most, finite)


def _speeds(least: float, most: float) -> Array:
    """Speeds of the diagram, rad/s, in equal ratios: lobes are the narrower, the slower the tool.

    About one speed where all tests are at it.
    """
    if least == most:
        least, most = 0.7 * least, 1.3 * most
    return np.geomspace(least, most, _SPEEDS)


def _depths(most: float, limits: Array) -> Array:
    """Depths of the diagram down to one, m, in equal steps or ratios, as limits (n,), m, ask."""
    # a limit below all depths that were looked at is not known: it is zero there
    known = limits[limits > 0.0]
    lowest = _BELOW_LOWEST * float(known.min()) if known.size else most
    if most / _DEPTHS > lowest:
        return np.geomspace(lowest, most, _DEPTHS)
    return np.linspace(0.0, most, _DEPTHS + 1)[1:]
