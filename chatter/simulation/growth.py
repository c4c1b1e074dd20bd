"""Growth of small vibration from period to period, measured in a simulated cut.

The cut takes hold of the structure slowly, so that the tool comes close to its periodic motion
without being thrown out of the chip; what is left of the start then dies out or grows. Its
multiplier follows from how the differences between successive periods follow each other: they are
free of the periodic motion.

Full chatter has a multiplier of 1 too, and so has a forced motion about to lose its stability. They
are told apart by a cut that takes hold more slowly: what is left of the start is then smaller in
the same measure, chatter is as large as before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.simulation.engine import COLUMNS, Record, run
from chatter.simulation.setup import Setup, delayed, set_up
from chatter.simulation.spindle import prescribed
from cutting.tool_point import tool_point
from dynamics.modal import Mode
from dynamics.modal_steps import modal_steps

#: periods in which the cut takes hold, and periods that are watched after that, at the least
_RAMP_PERIODS = 40
_WATCHED_PERIODS = 120
#: time constants of the slowest mode in both together, and the most periods
_TIME_CONSTANTS = 5.0
_MOST_PERIODS = 1200
#: differences above this share of the feed leave the chip, below this one they are rounding
_LARGEST_DIFFERENCE = 0.1
_SMALLEST_DIFFERENCE = 1e-7
#: periods that a fit needs at the least
_LEAST_FITTED = 10
#: moments of a difference, shapes that differences are made of, the weakest of them that counts,
#: and the share in the last difference that a multiplier must have
_FEATURES = 32
_MOST_SHAPES = 8
_WEAKEST_SHAPE = 1e-3
_LEAST_SHARE = 0.02
#: a multiplier below 1 by no more than this may be that of full chatter; such a cut takes hold
#: again, slower by a factor, and what is left of the start is less than this share of what it was.
#: Chatter on the way that dies out in the full cut is not in proportion: where it is mistaken, the
#: limit is wrong by this at the most, over the growth per relative depth
_NEARLY_NEUTRAL = 0.001
_SLOWER = 4
_LEFT_OF_START = 0.5


@dataclass(frozen=True)
class Growth:
    """Dominant multiplier of a simulated cut.

    Parameters
    ----------
    multiplier : complex
        Over a period; of magnitude inf where the tool leaves the chip at once, and where chatter
        is full: how small vibration grew before that is not known.
    period : float
        s.
    frequency : float
        Of the vibration that grows or dies out slowest, Hz; nan where it is not known.
    """

    multiplier: complex
    period: float
    frequency: float

    @property
    def radius(self) -> float:
        """Magnitude of the multiplier over a period."""
        return abs(self.multiplier)


def periods_a_turn(setup: Setup) -> int:
    """Periods in which the cut repeats within a turn: teeth where they are all alike, else one."""
    slices = setup.slices
    turned = slices.angle - slices.angle[:, :1]
    alike = np.allclose(turned, turned[0], atol=1e-9) and np.allclose(
        slices.normal_offset, slices.normal_offset[0], atol=1e-12
    )
    equal = np.allclose(setup.cutter.pitch, 2.0 * math.pi / setup.cutter.teeth, atol=1e-9)
    return setup.cutter.teeth if alike and equal else 1


def growth_of(case: Case, modes: tuple[Mode, ...]) -> Growth:
    """Simulate a cut that takes hold slowly, and measure how vibration grows.

    Parameters
    ----------
    case : Case
    modes : tuple of Mode
        Of its structure.

    Raises
    ------
    InputError
        If the case cannot be simulated.
    """
    setup = set_up(delayed(case), modes)
    period = setup.resolution.steps_a_turn // periods_a_turn(setup) * setup.step
    slowest = max(1.0 / (mode.damping * mode.natural_frequency) for mode in setup.modes)
    wanted = max(_RAMP_PERIODS + _WATCHED_PERIODS, math.ceil(_TIME_CONSTANTS * slowest / period))
    count = min(wanted, _MOST_PERIODS)
    ramp = count // 4
    periods = _watched(setup, ramp, count - ramp)
    if len(periods) < _LEAST_FITTED:
        return Growth(complex(math.inf), period, math.nan)
    found = _fitted(periods, period, case.cut.feed_per_tooth)
    if not 1.0 - _NEARLY_NEUTRAL < found.radius < 1.0:
        return found
    slower = _watched(set_up(delayed(case), modes), _SLOWER * ramp, count - ramp)
    if _as_large(slower, periods):
        return Growth(complex(math.inf), period, found.frequency)
    return found


def _watched(setup: Setup, ramp: int, count: int) -> NDArray[np.float64]:
    """Motion (k, n, 3), m, over `count` periods after those in which the cut takes hold.

    There are fewer where the tool leaves the range of the model.
    """
    samples = setup.resolution.steps_a_turn // periods_a_turn(setup)
    motion, done = motion_of(setup, (ramp + count) * samples, ramp * samples)
    whole = max(done // samples, ramp)
    return motion[ramp * samples : whole * samples].reshape(whole - ramp, samples, 3)


def _as_large(slower: NDArray[np.float64], periods: NDArray[np.float64]) -> bool:
    """Tell full chatter, which is as large (k, n, 3) in a cut that takes hold more slowly.

    Vibration along the cycle of full chatter neither grows nor dies out, so that the multiplier is
    1 but for an error, which may put it below 1. A stable forced motion nearly as neutral is
    disturbed by the cut taking hold alone, in inverse proportion to the time that this takes.
    """
    if len(slower) < len(periods):
        return True
    size, before = (float(np.linalg.norm(np.diff(part, axis=0))) for part in (slower, periods))
    return size > _LEFT_OF_START * before


def motion_of(
    setup: Setup, steps: int, ramp: int = 0, push: float = 0.0
) -> tuple[NDArray[np.float64], int]:
    """Displacement (steps + 1, 3) of the tool, m, and the steps that were done.

    Parameters
    ----------
    setup : Setup
        With a delayed chip, for one run.
    steps, ramp : int
        Steps of the run, and of them those in which the cut takes hold.
    push : float
        Displacement of every mode at the start, m.
    """
    modes = modal_steps(setup.modes, setup.step)
    modes.state[:, 0] = push
    record = Record(1, np.zeros((steps + 1, len(COLUMNS))))
    bins = setup.resolution.steps_a_turn
    turns = prescribed(setup.spindle, setup.path, bins, setup.step, -1, steps + 1, ramp)
    scratch = np.zeros((len(setup.modes), 2))
    done = run(
        setup.groups,
        modes,
        setup.frictions,
        tool_point(),
        turns,
        record,
        scratch,
        -1,
        setup.furthest,
        bins,
    )
    return record.rows[:, 3:6], done


def _fitted(periods: NDArray[np.float64], period: float, feed: float) -> Growth:
    """Dominant multiplier from motion (k, n, 3) over k periods of n samples."""
    difference = np.diff(periods, axis=0)
    flat = difference.reshape(len(difference), -1)
    size = np.sqrt(np.mean(flat**2, axis=1) * 3.0)
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
            return Growth(complex(math.inf), period, math.nan)
    if end - first < _LEAST_FITTED:
        return Growth(0j, period, math.nan)
    # what other modes have left of the start dies out first
    begin = first + min((end - first) // 3, end - first - _LEAST_FITTED)
    multiplier = _dominant(difference[begin:end])
    frequency = _frequency(difference[begin:end], multiplier, period)
    return Growth(multiplier, period, frequency)


def _dominant(differences: NDArray[np.float64]) -> complex:
    """Largest multiplier that takes the differences (k, n, 3) of periods from each to the next.

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
    present = share > _LEAST_SHARE * share.max()
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
