"""Growth of small vibration from period to period, measured in a simulated cut.

The cut takes hold of the structure slowly, so that the tool comes close to its periodic motion
without being thrown out of the chip. The multiplier follows from how the differences between
successive periods, free of the periodic motion, follow each other. Full chatter has multipliers of
1 or less of its own: docs/time-domain.md tells where small perturbations are asked instead.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.detection.bifurcation_type import bifurcation_of, bifurcation_of_multiplier
from chatter.detection.chatter_frequency import strongest_line
from chatter.simulation.cut_run import CutRun
from chatter.simulation.perturbation.followed_run import displace_modes
from chatter.simulation.perturbation.lyapunov_verdict import LARGE_SWING, lyapunov_verdict
from chatter.simulation.setup import Setup, set_up_on_modes
from cutting.edge_segments.segments import period_angle
from dynamics.modal.modes import Mode

#: periods of the force ramp, and periods that are watched after that, at the least
_RAMP_PERIODS = 40
_WATCHED_PERIODS = 120
#: time constants of the slowest mode in both together, and the most periods
_TIME_CONSTANTS = 5.0
_MOST_PERIODS = 1200
#: differences above this share of the feed leave the chip, below this one they are rounding
_LARGEST_DIFFERENCE = 0.1
_SMALLEST_DIFFERENCE = 1e-7
#: times of this that rounding reaches at the most
_ROUNDING = 10.0
#: periods that a fit needs at the least
_LEAST_FITTED = 10
#: moments of a difference, shapes that differences are made of, the weakest of them that counts,
#: and the share in the last difference that a multiplier must have
_FEATURES = 32
_MOST_SHAPES = 8
_WEAKEST_SHAPE = 1e-3
_LEAST_SHARE = 0.02
#: what is left of the first difference where it has died out for certain
_DIED_OUT = 0.05
#: a cut takes hold slower by a factor; what is left of the start is then less than this share
_SLOWER = 4
_LEFT_OF_START = 0.5
#: periods of full chatter that show its kind, at the most and at the least
_MOST_SHOWN, _LEAST_SHOWN = 60, 6
#: periods before the tool is thrown out, in which it is little else than what grows
_LAST_BEFORE_LEFT = 12


@dataclass(frozen=True)
class SimulatedMultiplier:
    """Dominant multiplier of a simulated cut."""

    #: over a period; of magnitude inf where the tool leaves the chip at once, and where chatter is
    #: full: how small vibration grew before that is not known
    multiplier: complex
    period: float  # s
    #: of the vibration that grows or dies out slowest, Hz; nan where it is not known
    frequency: float
    bifurcation: str  # "flip" where vibration doubles the period, else "hopf"

    @property
    def radius(self) -> float:
        """Magnitude of the multiplier over a period."""
        return abs(self.multiplier)


def periods_per_revolution(setup: Setup) -> int:
    """Periods in which the cut repeats within a turn: teeth where they are all alike."""
    return round(2.0 * math.pi / period_angle(setup.cutter))


def simulated_multiplier(case: Case, modes: tuple[Mode, ...]) -> SimulatedMultiplier:
    """Simulate a cut that takes hold slowly, and measure how vibration grows.

    Modes are those of its structure. InputError if the case cannot be simulated.
    """
    setup = set_up_on_modes(case, modes)
    period = setup.resolution.steps_per_revolution // periods_per_revolution(setup) * setup.step
    slowest = max(1.0 / (mode.damping * mode.natural_frequency) for mode in setup.modes)
    wanted = max(_RAMP_PERIODS + _WATCHED_PERIODS, math.ceil(_TIME_CONSTANTS * slowest / period))
    count = min(wanted, _MOST_PERIODS)
    ramp, feed = count // 4, case.cut.feed_per_tooth
    periods = _periods(setup, ramp, count)
    watched = periods[ramp:]
    if len(watched) < _LEAST_FITTED:
        return _full_chatter(periods[-_LAST_BEFORE_LEFT:], period)
    fitted = _fit_of(watched, feed)
    if fitted is None:
        return _full_chatter(watched, period)
    differences = np.diff(watched, axis=0)
    difference = differences[fitted]
    # none grows of what has died out for good
    largest = 1.0 if _rests(differences[fitted.stop :], feed) else math.inf
    found = _fitted(difference, period, largest)
    swing = 0.5 * float(np.ptp(watched[len(watched) // 2 :], axis=(0, 1)).max())
    if found.radius >= 1.0 or swing <= LARGE_SWING * feed:
        return found
    a_turn = periods_per_revolution(setup)
    if a_turn == setup.cutter.teeth and _dies_out(difference):
        return found
    apart = lyapunov_verdict(case, modes)
    if apart.verdict != "chatter" or apart.from_rest_alone:
        return found
    if apart.rate <= 0.0:
        # neither grows nor dies out for certain
        slower = _periods(set_up_on_modes(case, modes), _SLOWER * ramp, _SLOWER * ramp + count)
        if not _as_large(slower[_SLOWER * ramp :], watched):
            return found
    return replace(_full_chatter(watched, period), frequency=apart.frequency)


def _periods(setup: Setup, ramp: int, count: int) -> NDArray[np.float64]:
    """Motion (k, n, 3), m, over `count` periods; the first of them is the force ramp.

    There are fewer where the tool leaves the range of the model.
    """
    samples = setup.resolution.steps_per_revolution // periods_per_revolution(setup)
    motion, done = motion_of(setup, count * samples, ramp * samples)
    whole = done // samples
    return motion[: whole * samples].reshape(whole, samples, 3)


def _as_large(slower: NDArray[np.float64], periods: NDArray[np.float64]) -> bool:
    """Tell full chatter, which is as large (k, n, 3) in a cut that takes hold more slowly.

    Vibration along the cycle of full chatter neither grows nor dies out. A stable forced motion
    nearly as neutral is disturbed by the cut taking hold alone, in inverse proportion to the time
    that this takes.
    """
    if len(slower) < len(periods):
        return True
    size, before = (float(np.linalg.norm(np.diff(part, axis=0))) for part in (slower, periods))
    return size > _LEFT_OF_START * before


def _full_chatter(periods: NDArray[np.float64], period: float) -> SimulatedMultiplier:
    """Kind and frequency of chatter that is full, or throws the tool out, from its motion."""
    # second differences: free of forced vibration that grows evenly as the cut takes hold
    shown = np.diff(periods[-_MOST_SHOWN:], 2, axis=0)
    size = np.linalg.norm(shown, axis=(1, 2))
    if len(shown) < _LEAST_SHOWN or not size.all():
        return SimulatedMultiplier(complex(math.inf), period, math.nan, "hopf")
    growth = max(float(np.polyfit(np.arange(len(size)), np.log(size), 1)[0]), 0.0)
    line = strongest_line(shown, growth)
    kind, _ = bifurcation_of(shown, line, growth, 0.0)
    flip = "flip" if kind == "flip" else "hopf"
    return SimulatedMultiplier(complex(math.inf), period, line.cycles / period, flip)


def motion_of(
    setup: Setup, steps: int, ramp: int = 0, perturbation: float = 0.0
) -> tuple[NDArray[np.float64], int]:
    """Displacement (steps + 1, 3) of the tool, m, and the steps that were done.

    Of a set-up with a delayed chip, for one run. The force ramp takes `ramp` steps; every mode
    is displaced by the perturbation, m, at the start.
    """
    displace_modes(setup, perturbation)
    run = CutRun(setup, 1, steps)
    done = run.steps(steps, linear_ramp(ramp) if ramp else None)
    return run.rows[:, 3:6], done + 1


def linear_ramp(steps: int) -> Callable[[NDArray[np.int64]], NDArray[np.float64]]:
    """Force ramp that ends after a number of steps."""
    return lambda number: np.clip(number / steps, 0.0, 1.0)


def _fit_of(periods: NDArray[np.float64], feed: float) -> slice | None:
    """Differences between periods that are small vibration; None where it is full chatter."""
    difference = np.diff(periods, axis=0)
    size = _sizes(difference)
    large = np.flatnonzero(size > _LARGEST_DIFFERENCE * feed)
    gone = np.flatnonzero(size < _SMALLEST_DIFFERENCE * feed)
    first = 0
    end = min(large[0] if large.size else len(size), gone[0] if gone.size else len(size))
    if end < _LEAST_FITTED and large.size and (not gone.size or large[0] < gone[0]):
        # out of the chip from the beginning: it stays there, or comes back to be looked at
        first = int(large[-1]) + 1
        later = gone[gone > first]
        end = int(later[0]) if later.size else len(size)
        if end - first < _LEAST_FITTED:
            return None
    if end - first < _LEAST_FITTED:
        return slice(0, 0)
    # what other modes have left of the start dies out first
    return slice(first + min((end - first) // 3, end - first - _LEAST_FITTED), end)


def _sizes(differences: NDArray[np.float64]) -> NDArray[np.float64]:
    """Size (k,), m, of the differences (k, n, 3) of periods."""
    return np.sqrt(np.mean(differences**2, axis=(1, 2)) * 3.0)


def _rests(later: NDArray[np.float64], feed: float) -> bool:
    """Whether what follows differences that were fitted is rounding, to the end of the run."""
    if len(later) < _LEAST_FITTED:
        return False
    return bool(np.all(_sizes(later) < _ROUNDING * _SMALLEST_DIFFERENCE * feed))


def _dies_out(difference: NDArray[np.float64]) -> bool:
    """Whether the differences (k, n, 3) of periods do die out as they are followed."""
    if len(difference) == 0:
        return True
    first, last = np.linalg.norm(difference[[0, -1]], axis=(1, 2))
    return bool(last < _DIED_OUT * first)


def _fitted(
    difference: NDArray[np.float64], period: float, largest: float = math.inf
) -> SimulatedMultiplier:
    """Dominant multiplier from differences (k, n, 3) of periods; 0 where there are none.

    Below `largest` in magnitude, see `_dominant`.
    """
    if len(difference) == 0:
        return SimulatedMultiplier(0j, period, math.nan, "hopf")
    multiplier = _dominant(difference, largest)
    kind = bifurcation_of_multiplier(multiplier)
    return SimulatedMultiplier(multiplier, period, _frequency(difference, multiplier, period), kind)


def _dominant(differences: NDArray[np.float64], largest: float = math.inf) -> complex:
    """Largest multiplier that takes the differences (k, n, 3) of periods from each to the next.

    Those of `largest` or more are none of the cut: where few differences die out within a few
    periods, as in resonance with the teeth, shapes that are hardly there give any multiplier.

    Dynamic mode decomposition (Schmid 2010, J. Fluid Mech. 656): the map from row to row is
    fitted within the few shapes that the rows are made of; several multipliers of nearly the same
    size, as of like modes in x and y, are so told apart.
    """
    # in time, so that no direction of the motion is left out
    samples = differences[:, :: max(1, differences.shape[1] // _FEATURES)]
    samples = samples.reshape(len(samples), -1)
    weight = 1.0 / np.linalg.norm(samples[:-1], axis=1)[:, None]
    before, after = samples[:-1] * weight, samples[1:] * weight
    left, size, right = np.linalg.svd(before, full_matrices=False)
    rank = min(_MOST_SHAPES, int(np.sum(size > _WEAKEST_SHAPE * size[0])))
    left, size, right = left[:, :rank], size[:rank], right[:rank]
    step = (left.T @ after @ right.T) / size[:, None]
    values, shapes = np.linalg.eig(step.T)
    share = np.abs(np.linalg.solve(shapes, (after[-1] @ right.T).astype(complex)))
    present = (share > _LEAST_SHARE * share.max()) & (np.abs(values) < largest)
    if not present.any():
        size_of = np.linalg.norm(samples, axis=1)
        return complex((size_of[-1] / size_of[0]) ** (1.0 / (len(size_of) - 1)))
    return complex(values[present][np.argmax(np.abs(values[present]))])


def _frequency(difference: NDArray[np.float64], multiplier: complex, period: float) -> float:
    """Strongest line among those that the angle of the multiplier allows, Hz."""
    count, samples, _ = difference.shape
    growth = np.abs(multiplier) ** np.arange(count)
    settled = difference / np.maximum(growth, 1e-300)[:, None, None]
    angle = abs(float(np.angle(multiplier)))
    time = np.arange(count * samples).reshape(count, samples, 1) / samples
    # all allowed lines lie whole periods apart: they are the Fourier lines of what is left when
    # the angle is taken out; the difference over a period weakens them alike
    shape = np.mean(settled * np.exp(-1j * angle * time), axis=0)
    size = np.linalg.norm(np.fft.fft(shape, axis=0), axis=1)
    order = np.fft.fftfreq(samples, 1.0 / samples)
    return float(abs(angle / (2.0 * math.pi) + order[int(np.argmax(size))])) / period
