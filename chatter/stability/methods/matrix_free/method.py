"""Matrix-free method: multipliers of any cut from initial functions that are propagated in time.

An initial function is the state of the modes and the motion over the longest delay. It is run
through one period step by step (see `matrix_free_plan`), and the functions that follow one from
the other span the space in which the dominant multiplier is looked for: Arnoldi iteration (Arnoldi
1951) on the solution operator, which never is a matrix, as in the implicit subspace iteration of
Zatarain and Dombovari 2014, Int. J. Dynam. Control 2. The steps are those of an integration in
time, of order four; nothing is shared with collocation but the couplings of the edge.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import sweep
from chatter.engine.presets import DRIVER
from chatter.stability.floquet_multiplier import Multiplier
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.limit_search import PointMethod, growth, limit_curve_by
from chatter.stability.methods.collocation.cut_arrays import CutArrays
from chatter.stability.methods.matrix_free.solution_operator import extend_space, first_function
from chatter.stability.methods.matrix_free.step_assembly import StepPlan, step_plan
from chatter.stability.methods.matrix_free.steps import SteppedCut, period_steps
from chatter.stability.spindle_rotation import spindle_turn

#: steps in a wave of the fastest vibration
STEPS_A_WAVE = 12.0
#: refinements of the steps: plain, or nested ones from which the value is extrapolated
_PLAIN = (1,)
_EXTRAPOLATED = (1, 2)
#: of the error that is left as the steps are halved
_ORDER = 4
#: a correction beyond this share means that two multipliers have changed places
_LARGEST_CORRECTION = 0.05
_MOST_STEPS, _FINEST, _FINEST_PIECES = 100_000, 16, 8
#: residual of the dominant eigenpair, relative to its magnitude, at which the iteration stops
_RESIDUAL = 1e-9
#: functions beyond the states at the first look, growth from look to look, and the most
_FIRST_LOOK, _GROWTH, _MOST_FUNCTIONS = 6, 1.3, 320
#: limits whose error is estimated
_CHECKED = 12
#: harmonics looked at for the chatter frequency reach this far beyond the highest mode
_HIGHEST = 2.0


#: a cut at a fineness of its edges
CutAt = Callable[[float], SteppedCut]


class _Dominant(NamedTuple):
    value: complex
    motion: NDArray[np.complex128]  # of the tool point at the nodes of a period (2 N, r)
    time: NDArray[np.float64]  # of the nodes (2 N,)
    period: float


def stepped_cut(
    cut: CutArrays, contact: tuple[float, float, float] = (0.0, 0.0, 1.0)
) -> SteppedCut:
    """What the steps need of a cut.

    Parameters
    ----------
    cut : CutArrays
    contact : (float, float, float)
        Stiffness (N/m) and damping (N s/m) of the contact of tool and work, and the engaged share
        of the depth from which on it acts whole; see `cutting.process_damping.contact`.
    """
    stiffness, _, full_engagement_share = contact
    reach = np.linalg.norm(cut.shape, axis=1) * np.linalg.norm(cut.force_gain, axis=1)
    # the stiffest that the contact can make a mode
    fastest = math.hypot(cut.resolution.fastest, math.sqrt(stiffness * float(reach.max())))
    return SteppedCut(cut, fastest, np.array([*contact[:2], max(full_engagement_share, 1e-12)]))


def _dominant(plan: StepPlan) -> _Dominant:
    """Multiplier of largest magnitude and the motion that belongs to it."""
    modes, rank = plan.shape.shape
    nodes = 2 * plan.kind.size
    dimension = 2 * modes + 2 * rank * nodes
    most = min(dimension, _MOST_FUNCTIONS)
    basis, hessenberg = np.zeros((most + 1, dimension)), np.zeros((most + 1, most))
    first_function(plan, basis)
    known, look = 0, min(most, 2 * modes + _FIRST_LOOK)
    while True:
        wanted = look
        known = extend_space(plan, basis, hessenberg, known, wanted)
        values, vectors = np.linalg.eig(hessenberg[:known, :known])
        best = int(np.argmax(np.abs(values)))
        value, vector = complex(values[best]), vectors[:, best]
        residual = hessenberg[known, known - 1] * abs(vector[-1])
        if known < wanted or known == most or residual <= _RESIDUAL * abs(value):
            break
        look = min(most, math.ceil(look * _GROWTH))
    if value.imag < 0.0:
        value, vector = value.conjugate(), vector.conj()
    function = vector @ basis[:known]
    motion = function[2 * modes :].reshape(nodes, 2, rank)[:, 0]
    return _Dominant(value, motion, plan.time[:-1], float(plan.time[-1] - plan.time[0]))


def multipliers(
    cut: SteppedCut,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress = no_progress,
    refinements: tuple[int, ...] = _EXTRAPOLATED,
) -> NDArray[np.complex128]:
    """Dominant multiplier over one period at every point.

    Parameters
    ----------
    cut : SteppedCut
    speeds, depths : (n,) array of float
        rad/s and m, point by point.
    progress : callable, optional
        Called with (done, total).
    refinements : tuple of int
        Divisions of the steps; from two the error of fourth order is removed (Richardson).

    Returns
    -------
    (n,) array of complex
        Imaginary part >= 0.

    Raises
    ------
    RunError
        If a period holds too many vibrations.
    """
    if len(speeds) == 0:
        return np.empty(0, dtype=np.complex128)

    def at(index: NDArray[np.int64]) -> NDArray[np.complex128]:
        found = np.empty((len(refinements), len(index)), dtype=np.complex128)
        for row, refinement in enumerate(refinements):
            for column, i in enumerate(index):
                plan = _plan(cut, float(speeds[i]), float(depths[i]), refinement)
                found[row, column] = _dominant(plan).value
        return found[0] if len(refinements) == 1 else _extrapolated(found, refinements)

    return np.concatenate(sweep(at, len(speeds), progress, points_a_chunk=8))


def _steps_a_turn(cut: SteppedCut, speed: float, refinement: int) -> float:
    return cut.fastest / speed * STEPS_A_WAVE * refinement


def _plan(cut: SteppedCut, speed: float, depth: float, refinement: int) -> StepPlan:
    if _steps_a_turn(cut, speed, refinement) > _MOST_STEPS:
        waves = cut.fastest / speed
        raise RunError(
            f"at {rpm(speed):.4g} rpm a turn holds {waves:.3g} vibrations, more than "
            "the matrix-free method can step through; raise the lowest spindle speed"
        )
    return step_plan(cut, speed, depth, STEPS_A_WAVE, refinement)


def _extrapolated(
    found: NDArray[np.complex128], refinements: tuple[int, ...]
) -> NDArray[np.complex128]:
    coarse, fine = found
    ratio = (refinements[1] / refinements[0]) ** _ORDER
    correction = (fine - coarse) / (ratio - 1.0)
    correction[np.abs(correction) > _LARGEST_CORRECTION * np.abs(fine)] = 0.0
    value = fine + correction
    return value.real + 1j * np.abs(value.imag)


def converged_multiplier(
    cut_at: CutAt, speed: float, depth: float, tolerance: float = 2e-5
) -> Multiplier:
    """Dominant multiplier at one point, its steps halved until the estimated error is small.

    With the steps the pieces of the edge are halved. The estimate is what the extrapolation adds to
    the finer steps, and a third of what the finer pieces change: chords of an edge are of second
    order.

    Parameters
    ----------
    cut_at : callable
        The cut at a fineness: factor on the pieces of its edges, see
        `cutting.edge_segments.segments`.
    speed, depth : float
        rad/s, m.
    tolerance : float
        On |mu|, relative to max(1, |mu|).
    """

    def plain(cut: SteppedCut, refinement: int) -> NDArray[np.complex128]:
        return np.array([_dominant(_plan(cut, speed, depth, refinement)).value])

    refinement, cut = 1, cut_at(1.0)
    coarse = plain(cut, refinement)
    while True:
        before = cut
        if refinement < _FINEST_PIECES:
            cut = cut_at(0.5 / refinement)
        resolved = coarse if _same_pieces(cut, before) else plain(cut, refinement)
        refinement *= 2
        plan = _plan(cut, speed, depth, refinement)
        fine = np.array([_dominant(plan).value])
        value = _extrapolated(np.array([resolved, fine]), (1, 2))[0]
        error = abs(abs(value) - abs(fine[0])) + abs(abs(resolved[0]) - abs(coarse[0])) / 3.0
        finest = refinement >= _FINEST or _steps_a_turn(cut, speed, 2 * refinement) > _MOST_STEPS
        if error <= tolerance * max(1.0, abs(value)) or finest:
            return Multiplier(complex(value), plan.kind.size, float(error))
        coarse = fine


def chatter_frequency(cut: SteppedCut, speed: float, depth: float) -> float:
    """Frequency (Hz) at which the motion of the dominant multiplier is largest.

    A multiplier mu fixes (arg mu + 2 pi l)/T; the motion of the dominant function, taken apart
    into these frequencies, tells which of them is heard.
    """
    found = _dominant(_plan(cut, speed, depth, 1))
    base = np.log(complex(found.value) if found.value != 0.0 else 1e-300) / found.period
    line = 2.0 * np.pi / found.period
    highest = _HIGHEST * float(cut.arrays.natural_frequency.max())
    harmonic = np.arange(-math.ceil(highest / line) - 1, math.ceil(highest / line) + 2)
    s = base + 1j * line * harmonic
    time = np.append(found.time, found.time[0] + found.period)
    span = np.diff(time)
    weight = 0.5 * (span + np.roll(span, 1))
    # the history belongs to a multiplier mu: from one period to the next it grows by it
    wave = np.exp(-np.outer(s, found.time - found.time[0])) * weight
    amplitude = np.linalg.norm(wave @ found.motion, axis=1)
    return float(abs(s[np.argmax(amplitude)].imag)) / (2.0 * np.pi)


def limit_curve(
    cut_at: CutAt,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    progress: Progress = no_progress,
) -> LimitCurve:
    """Limits of stability at every spindle speed; see `limit_search`.

    `cut_at` gives the cut at a fineness of its edges; the finer one only judges the error.
    """
    cut = cut_at(1.0)

    def plain(
        points: NDArray[np.int64], depth: NDArray[np.float64], report: Progress
    ) -> NDArray[np.complex128]:
        return multipliers(cut, speeds[points], depth, report, _PLAIN)

    def refined(
        points: NDArray[np.int64], depth: NDArray[np.float64], report: Progress
    ) -> NDArray[np.complex128]:
        return multipliers(cut, speeds[points], depth, report, _EXTRAPOLATED)

    def heard(
        points: NDArray[np.int64], depth: NDArray[np.float64]
    ) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
        def some(index: NDArray[np.int64]) -> list[float]:
            return [
                chatter_frequency(cut, float(speeds[points[i]]), float(depth[i])) for i in index
            ]

        found = sweep(some, len(points), points_a_chunk=8)
        return refined(points, depth, no_progress), np.array(
            [one for part in found for one in part]
        )

    deepest, finer = float(depths[-1]), _EXTRAPOLATED[-1]
    steps = np.array([steps_a_period(cut, float(v), deepest, finer) for v in speeds])
    limits = limit_curve_by(PointMethod(plain, refined, heard), speeds, depths, steps, progress)
    return limits._replace(error=_limit_error(cut, cut_at(0.5), limits))


def _same_pieces(cut: SteppedCut, other: SteppedCut) -> bool:
    return cut.arrays.pieces.bottom.shape == other.arrays.pieces.bottom.shape


def _limit_error(cut: SteppedCut, fine_edges: SteppedCut, limits: LimitCurve) -> float:
    """Largest relative shift of some limits, see `converged_multiplier`.

    By what the extrapolation adds to the finer steps, and by shorter pieces of the edges.
    """
    found = np.flatnonzero(np.isfinite(limits.critical_depth))
    picked = found[:: max(1, found.size // _CHECKED)]
    if not picked.size:
        return 0.0
    speed, depth = limits.spindle_speed[picked], limits.critical_depth[picked]
    at = growth(multipliers(cut, speed, depth))
    finer = growth(multipliers(cut, speed, depth, refinements=_EXTRAPOLATED[1:]))
    off = np.abs(at - finer)
    if not _same_pieces(cut, fine_edges):
        # all of it: the limits are those of the longer pieces
        coarse, other = (
            growth(multipliers(c, speed, depth, refinements=_PLAIN)) for c in (cut, fine_edges)
        )
        off += np.abs(coarse - other) * 4.0 / 3.0
    slope = (growth(multipliers(cut, speed, 1.001 * depth)) - at) / (1e-3 * depth)
    return float(np.max(off / np.maximum(np.abs(slope) * depth, 1e-300)))


@njit(**DRIVER)
def steps_a_period(cut, speed, depth, refinement):
    """Steps in a period."""
    turn = spindle_turn(cut.arrays.variation, speed, cut.arrays.period_angle)
    return period_steps(cut, turn, depth, STEPS_A_WAVE, refinement).power.shape[0]
