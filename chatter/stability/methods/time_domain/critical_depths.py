"""Limits of stability in the time domain: growth measured in simulated cuts."""

import math

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.case import Case
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import each
from chatter.simulation.perturbation.multiplier import SimulatedMultiplier, simulated_multiplier
from chatter.stability.crossings import find_crossings
from chatter.stability.limit_curve import LimitCurve, limits_at
from dynamics.modal.modes import Mode

#: depths evaluated, at the most; limits are refined to this share of their depth
_MOST_DEPTHS = 32
_DEPTH_TOLERANCE = 5e-4
#: growth that is out of the chip at once, as a logarithm a period
_LARGEST_GROWTH = 1.0
#: growth that stands for that with no cut, where nothing is to be simulated
_AT_REST = -0.01
#: cuts that finding a limit between two depths of the grid takes, about
_CUTS_PER_LIMIT = 8
#: the frequency is measured this far beyond the limit
_BEYOND = 1.005


class _SimulatedCuts:
    """Progress over batches of simulated cuts whose number is known as they come.

    The total is what is known, and `expected` cuts more until the last batch.
    """

    def __init__(self, progress: Progress, expected: int) -> None:
        self._progress, self._known, self._expected = progress, 0, max(expected, 1)

    def more(self, count: int) -> Progress:
        """Progress of a batch after which others follow."""
        before, self._known = self._known, self._known + count
        if before:
            self._expected = max(self._expected - count, 1)
        total = self._known + self._expected
        return lambda done, _: self._progress(before + done, total)

    def last(self, count: int) -> Progress:
        """Progress of the batch that ends the work."""
        before = self._known
        return lambda done, _: self._progress(before + done, before + count)


def case_at(case: Case, speed: float, depth: float) -> Case:
    """Case at another spindle speed (rad/s) and axial depth (m), checked already."""
    cut = case.cut.model_copy(update={"spindle_speed": speed, "axial_depth": depth})
    return case.model_copy(update={"cut": cut})


def growths(
    case: Case,
    modes: tuple[Mode, ...],
    speeds: Array,
    depths: Array,
    progress: Progress = no_progress,
) -> list[SimulatedMultiplier]:
    """Growth at n points of speed (rad/s) and depth (m), in parallel threads."""

    def at(i: int) -> SimulatedMultiplier:
        return simulated_multiplier(case_at(case, float(speeds[i]), float(depths[i])), modes)

    return each(at, len(speeds), progress)


def time_limit_curve(
    case: Case,
    modes: tuple[Mode, ...],
    speeds: Array,
    depths: Array,
    progress: Progress = no_progress,
) -> LimitCurve:
    """Limits in depth at every speed (rad/s); the grid of depths (m) is thinned to at most 32.

    `modes` are those of the structure; `progress` is called with (done, total) simulated cuts.
    """
    cuts = _SimulatedCuts(progress, _CUTS_PER_LIMIT * len(speeds))
    grid_depths = depths[:: -(-len(depths) // _MOST_DEPTHS)]
    if grid_depths[-1] != depths[-1]:
        grid_depths = np.append(grid_depths, depths[-1])
    speed, depth = (part.ravel() for part in np.meshgrid(speeds, grid_depths, indexing="ij"))
    grid = _logarithms(growths(case, modes, speed, depth, cuts.more(len(speed))))

    def refined(index: IntegerArray, at: Array) -> Array:
        found = np.full(len(index), _AT_REST)
        cut = at > 0.0
        near = speeds[index[cut]]
        found[cut] = _logarithms(growths(case, modes, near, at[cut], cuts.more(len(near))))
        return found

    def at_limits(index: IntegerArray, at: Array) -> tuple[list[str], Array]:
        beyond = _BEYOND * at
        found = growths(case, modes, speeds[index], beyond, cuts.last(len(beyond)))
        return [one.bifurcation for one in found], np.array([one.frequency for one in found])

    crossings = find_crossings(
        grid.reshape(len(speeds), -1), grid_depths, refined, _DEPTH_TOLERANCE
    )
    return limits_at(at_limits, speeds, crossings, np.zeros(len(speeds), dtype=np.int64))


def _logarithms(found: list[SimulatedMultiplier]) -> Array:
    """Logarithm of the spectral radius, within bounds that a root search can use."""
    radius = np.array([growth.radius for growth in found])
    bounded = np.clip(radius, math.exp(-_LARGEST_GROWTH), math.exp(_LARGEST_GROWTH))
    return np.log(bounded)
