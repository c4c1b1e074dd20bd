"""Limits of stability of one sample."""

from dataclasses import dataclass

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.given_values import whole_number_given
from chatter.description.progress import no_progress
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model
from chatter.stability.registry import chosen_method, fixed_steps
from chatter.stability.search_range import beyond_the_cut, maximum_depth, spindle_speeds

#: depths of the grid on which limits are bracketed
_DEPTHS = 32


@dataclass(frozen=True)
class Grid:
    """Speeds and depths that all samples share."""

    speeds: Array  # rad/s (n,)
    depths: Array  # m, ascending (m,)


@dataclass(frozen=True)
class SampleLimits:
    """Limits of a sample."""

    limits: list[float]  # at every speed, m; inf where none was found
    operating: float  # at the speed of the cut, m
    stable: bool  # whether the cut is


def shared_grid(case: Case, speed_count: int) -> Grid:
    """Speeds and depths from the case with its mean values."""
    model = milling_model(case)
    wide = spindle_speeds(case)
    speeds = np.linspace(float(wide[0]), float(wide[-1]), speed_count)
    max_depth = maximum_depth(case, zero_order_of(model, wide))
    return Grid(speeds, np.linspace(0.0, max_depth, _DEPTHS + 1)[1:])


def sample_limits(case: Case, grid: Grid, method: str | None) -> SampleLimits:
    """Limits of one sample at the shared speeds and at the speed of its cut.

    Raises InputError if the sample describes no cut.
    """
    chosen = chosen_method(case, method)
    model = milling_model(case)
    steps = fixed_steps(case)
    curve = chosen.limits(model, grid.speeds, grid.depths, steps, no_progress)
    cut = case.cut
    depths = grid.depths
    if cut.axial_depth > 0.98 * depths[-1]:
        depths = np.linspace(0.0, beyond_the_cut(case, 0.0), _DEPTHS + 1)[1:]
    operating = chosen.limits(model, np.array([cut.spindle_speed]), depths, steps, no_progress)
    below = operating.crossings[0] < cut.axial_depth
    return SampleLimits(
        [float(depth) for depth in curve.critical_depth],
        float(operating.critical_depth[0]),
        int(below.sum()) % 2 == 0,
    )


def check_counts(samples: int, speeds: int, seed: int) -> None:
    """Raise InputError for counts that give no result."""
    limits = (("--samples", samples, 2, 1_000_000), ("--speeds", speeds, 2, 20_000))
    for name, given, low, high in (*limits, ("--seed", seed, 0, 2**31)):
        whole_number_given(given, name, low, high)


def confidence_interval(successes: int, count: int) -> tuple[float, float]:
    """95 % confidence interval of a probability (Wilson 1927), from independent trials.

    Samples of a Latin hypercube spread less.
    """
    from scipy.stats import binomtest

    low, high = binomtest(successes, count).proportion_ci(method="wilson")
    return float(low), float(high)
