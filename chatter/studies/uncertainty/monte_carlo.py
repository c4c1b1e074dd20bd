"""Uncertainty of the limits of stability: band of lobes, probability of a stable cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from chatter.description.arrays import Array, BooleanArray, IntegerArray
from chatter.description.case import Case
from chatter.description.case_or_path import takes_case_or_path
from chatter.description.errors import InputError
from chatter.description.unit_system import UnitSystem, units_of
from chatter.description.units import rpm
from chatter.io.result_files import SavedResult, finite_or_none
from chatter.io.result_tables import Column, Columns
from chatter.stability.forced_vibration import neglected_in_steady_cut
from chatter.stability.model import milling_model
from chatter.stability.neglected_effects import NeglectedEffect, lowest_factor, reasons_of
from chatter.stability.registry import chosen_method
from chatter.stability.resting_friction import neglected_resting_friction
from chatter.studies.executor import ThreadExecutor
from chatter.studies.model import fingerprint, patched
from chatter.studies.result_cache import Execution, ResultCache
from chatter.studies.uncertainty.latin_hypercube import samples
from chatter.studies.uncertainty.sample_limits import (
    Grid,
    SampleLimits,
    check_counts,
    confidence_interval,
    sample_limits,
    shared_grid,
)
from chatter.studies.uncertainty.shares_of_variance import shares_of_variance
from chatter.studies.uncertainty.uncertain_parameters import (
    UncertainParameter,
    correlation_of,
    parameters_of,
)

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: probabilities of the band
LEVELS = (0.05, 0.5, 0.95)
DEFAULT_SAMPLES, DEFAULT_SPEEDS, DEFAULT_SEED = 200, 121, 1
_CONVERGENCE_ROWS = 12


@dataclass(frozen=True, eq=False, repr=False)
class Uncertainty(SavedResult):
    """Limits of all samples.

    Parameters
    ----------
    case : Case
    parameters : tuple of p UncertainParameter
    values : (n, p) array of float
        Of each sample, SI.
    speeds : (m,) array of float
        rad/s.
    limits : (n, m) array of float
        m; inf where none was found.
    operating : (n,) array of float
        Limit at the speed of the cut, m.
    stable : (n,) array of bool
        Whether the cut is.
    max_depth : float
        Deepest that was searched, m.
    seed : int
    neglected : tuple of NeglectedEffect
        What linear limits leave out in the cut with its mean values.
    """

    drawn_by: ClassVar[str] = "plots.uncertainty.plot_uncertainty"
    picture: ClassVar[str] = "uncertainty.png"

    case: Case
    parameters: tuple[UncertainParameter, ...]
    values: Array
    speeds: Array
    limits: Array
    operating: Array
    stable: BooleanArray
    max_depth: float
    seed: int
    neglected: tuple[NeglectedEffect, ...] = ()

    @property
    def probability(self) -> float:
        """Probability that the cut is stable."""
        return float(self.stable.mean())

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of that probability, from the number of samples."""
        return confidence_interval(int(self.stable.sum()), len(self.stable))

    def quantiles(self, levels: Sequence[float] = LEVELS) -> Array:
        """Quantiles (levels, m) of the limit at every speed, m."""
        return _quantiles(self.limits, levels)

    def operating_quantiles(self, levels: Sequence[float] = LEVELS) -> Array:
        """Quantiles (levels,) of the limit at the speed of the cut, m."""
        return _quantiles(self.operating[:, None], levels)[:, 0]

    def probability_at(self, depth: float) -> Array:
        """Probability (m,) that the first limit lies above a depth (m), at every speed."""
        return np.mean(self.limits > depth, axis=0)

    def convergence(self, counts: IntegerArray) -> tuple[Array, Array]:
        """Probability (n,) from the first samples, of each of some counts, and interval (n, 2)."""
        stable = np.cumsum(self.stable)[counts - 1]
        pairs = zip(stable.tolist(), counts.tolist(), strict=True)
        return stable / counts, np.array([confidence_interval(*pair) for pair in pairs])

    @property
    def least_probability(self) -> float:
        """Probability that the cut is stable whatever the linear limits leave out; 0 if unknown."""
        kept = lowest_factor(self.neglected)
        certain = self.stable & (self.operating * kept > self.case.cut.axial_depth)
        return float(np.mean(certain)) if kept > 0.0 else 0.0

    @property
    def units(self) -> UnitSystem:
        """Units that the words and the picture are in: those of the case."""
        return units_of(self.case)

    def for_certain_in_words(self) -> str:
        """What is left of the probability by what linear limits leave out; empty where all is."""
        lowering = [effect for effect in self.neglected if effect.lowest < 1.0]
        least = self.least_probability
        if not lowering or least == self.probability:
            return ""
        reasons = "; ".join(reasons_of(lowering, stable=True))
        return f"for certain with {least:.1%} alone: {reasons}; `chatter simulate` decides"

    def shares(self) -> dict[str, float | None]:
        """Share of each parameter in the variance of the limit of the cut, to first order.

        They add up to less than 1; what is missing is curvature and joint influence.
        """
        known = np.isfinite(self.operating)
        limit = self.operating[known]
        if known.sum() < 3 or np.ptp(limit) == 0.0:
            return {one.path: None for one in self.parameters}
        shares = shares_of_variance(self.values[known], limit)
        return {one.path: float(s) for one, s in zip(self.parameters, shares, strict=True)}

    def summary(self) -> dict:
        """Return the content of summary.json."""
        cut, known = self.case.cut, np.isfinite(self.operating)
        limit = self.operating[known] * 1e3
        names = [f"{100.0 * level:.0f}_percent" for level in LEVELS]
        counts = np.unique(np.geomspace(1, len(self.stable), _CONVERGENCE_ROWS).round().astype(int))
        shares, intervals = self.convergence(counts)
        return {
            "title": self.case.title,
            "samples": len(self.stable),
            "seed": self.seed,
            "parameters": [
                {
                    "path": one.path,
                    "mean": one.mean,
                    "standard_deviation": one.deviation,
                    "share_of_variance": self.shares()[one.path],
                }
                for one in self.parameters
            ],
            "operating_point": {
                "spindle_speed_rpm": rpm(cut.spindle_speed),
                "axial_depth_mm": cut.axial_depth * 1e3,
                "probability_of_stability": self.probability,
                "confidence_interval_95": list(self.interval),
                "least_probability_of_stability": self.least_probability,
                "neglected_effects": [effect.summary() for effect in self.neglected],
            },
            "limit_at_operating_speed_mm": {
                **{
                    name: finite_or_none(value * 1e3)
                    for name, value in zip(names, self.operating_quantiles(), strict=True)
                },
                "mean": float(limit.mean()) if limit.size else None,
                "standard_deviation": float(limit.std(ddof=1)) if limit.size > 1 else None,
                "samples_without_limit": int((~known).sum()),
            },
            "max_axial_depth_mm": self.max_depth * 1e3,
            "convergence": [
                {
                    "samples": int(count),
                    "probability": float(share),
                    "confidence_interval_95": interval.tolist(),
                }
                for count, share, interval in zip(counts, shares, intervals, strict=True)
            ],
        }

    def tables(self) -> dict[str, Columns]:
        """Columns of the tables "uncertainty" and "samples"."""
        limits = {
            f"limit_{100.0 * level:.0f}_percent [mm]": Column(row * 1e3, ".7g")
            for level, row in zip(LEVELS, self.quantiles(), strict=True)
        }
        probability = self.probability_at(self.case.cut.axial_depth)
        band = {
            "spindle_speed [rpm]": Column(rpm(self.speeds), ".4f"),
            **limits,
            "probability_of_stability": Column(probability, ".6g"),
        }
        drawn = {
            **{
                f"{one.path} [SI]": Column(column, ".9g")
                for one, column in zip(self.parameters, self.values.T, strict=True)
            },
            "limit [mm]": Column(self.operating * 1e3, ".7g"),
            "stable": Column(self.stable),
        }
        return {"uncertainty": band, "samples": drawn}


def _quantiles(limits: Array, levels: Sequence[float]) -> Array:
    """Quantiles along the samples; between a finite and an infinite limit lies an infinite one."""
    ordered = np.sort(limits, axis=0)
    index = np.asarray(levels) * (len(limits) - 1)
    below, above = np.floor(index).astype(int), np.ceil(index).astype(int)
    share = (index - below)[:, None]
    low, high = ordered[below], ordered[above]
    between = np.full(low.shape, np.inf)
    known = np.isfinite(high)
    between[known] = (low + share * np.subtract(high, low, out=np.zeros_like(low), where=known))[
        known
    ]
    return np.where(share == 0.0, low, between)


@takes_case_or_path
def uncertainty(
    case: Case,
    count: int = DEFAULT_SAMPLES,
    seed: int = DEFAULT_SEED,
    *,
    speeds: int = DEFAULT_SPEEDS,
    method: str | None = None,
    **execution: Unpack[Execution],
) -> Uncertainty:
    """Propagate the standard deviations of a case, and of its machine, to its limits.

    Parameters
    ----------
    case : Case
        With values such as "1650 +- 80 MPa".
    count : int
        Samples.
    seed : int
    speeds : int
        At which limits are computed.
    method : str, optional
        Of stability, as for `chatter.lobes`.
    **execution
        Folder, progress, resumed and cluster, as `chatter.studies.result_cache.Execution`.

    Returns
    -------
    Uncertainty

    Raises
    ------
    InputError
        If nothing is uncertain, or a sample describes no cut.
    RunError
        If it is interrupted; finished samples are in the folder.
    """
    check_counts(count, speeds, seed)
    parameters = parameters_of(case)
    correlation = correlation_of(case, parameters)
    grid = shared_grid(case, speeds)
    values = samples(parameters, count, seed, correlation)
    paths = tuple(one.path for one in parameters)
    limits_of_sample = partial(_sample_record, case, paths, grid, method)
    numbered = [(number, row.tolist()) for number, row in enumerate(values, start=1)]
    if execution.get("cluster") is None:
        # sweeps of a sample leave threads idle between them
        execution["cluster"] = ThreadExecutor()
    inputs = (method or "", repr(grid.speeds.tolist()), repr(grid.depths[-1]))
    with ResultCache(execution.get("folder"), "uncertainty", fingerprint(case), *inputs) as cache:
        keys = [cache.key(repr(row)) for _, row in numbered]
        records = cache.evaluate(limits_of_sample, numbered, keys, "samples", **execution)
    found = [SampleLimits(**record) for record in records]
    return Uncertainty(
        case=case,
        parameters=parameters,
        values=values,
        speeds=grid.speeds,
        limits=np.array([one.limits for one in found]),
        operating=np.array([one.operating for one in found]),
        stable=np.array([one.stable for one in found]),
        max_depth=float(grid.depths[-1]),
        seed=seed,
        neglected=_neglected(case, method, np.array([one.operating for one in found])),
    )


def _neglected(case: Case, method: str | None, limits: Array) -> tuple[NeglectedEffect, ...]:
    """What linear limits, m, leave out in the cut with its mean values."""
    model, chosen = milling_model(case), chosen_method(case, method)
    return (*neglected_resting_friction(model), *neglected_in_steady_cut(model, chosen, limits))


def _sample_record(
    case: Case,
    paths: tuple[str, ...],
    grid: Grid,
    method: str | None,
    sample: tuple[int, list[float]],
) -> dict:
    """Record of a sample, given by its number and its values."""
    number, values = sample
    patch = dict(zip(paths, values, strict=True))
    try:
        return asdict(sample_limits(patched(case, patch), grid, method))
    except InputError as error:
        raise InputError([f"sample {number}: {text}" for text in error.messages]) from None
