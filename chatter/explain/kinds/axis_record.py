"""What is derived from the record of a move: smoothed motion, weights of samples, noise."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.explain.measurement import Run
from chatter.explain.residuals.channel_residual import white_level
from dynamics.friction.axis_force import SMOOTH, AxisForce

Array = NDArray[np.float64]

#: low pass of motion and force alike, of the sampling frequency, and samples kept a cycle of it
_CUT_OFF, _KEPT = 0.08, 4
#: low pass of the motion, and a finer one, of the sampling frequency
_MOTION_CUT_OFF, _FINER_CUT_OFF = 0.15, 0.3
#: speed of an axis that creeps, m/s
_NEAR_REST = 1e-4
#: weight of the low pass on usable samples from which on one kept is used
_ALL_USABLE = 0.999
#: samples on either side, and degree, of the polynomials through a motion that creeps
_BESIDE, _DEGREE = 40, 3
#: standard deviations of the noise from which the motor runs ahead
_AHEAD = 12.0
#: samples kept on either side for which an uncertainty holds, and at the ends; the least weight
_NEARBY, _ENDS, _LEAST_WEIGHT = 1, 8, 0.02
#: standard deviation of the moment of a jump between two samples, over the time between them
_WITHIN_A_SAMPLE = 12.0**-0.5
#: share of a dry friction that is uncertain while an axis creeps
_CREEP_UNCERTAINTY = 0.1
#: share of the force to which it can be followed along a motion that was measured
_FOLLOWED = 0.01
#: share of the usual force from which on its sign decides which flank of a backlash drives
_DRIVES = 0.3
#: samples kept on either side of a crossing of the backlash, and their weight
_CROSSING, _CROSSING_WEIGHT = 8, 0.02
#: travel of a motor within which it has crossed a gap, m: four times a wide one
_WIDEST_GAP = 1e-4


class Motion(NamedTuple):
    """Smoothed position, m, velocity, m/s, and acceleration, m/s^2, (n,) each."""

    position: Array
    velocity: Array
    acceleration: Array


class Motor(NamedTuple):
    """Motion of a motor that runs ahead of its slide."""

    acceleration: Array  # (n,), m/s^2
    weights: Array  # (m,) of the samples kept of its travel


@dataclass(frozen=True, eq=False)
class AxisRecord:
    """What is derived from the record of a move."""

    motion: Motion
    step: float  # between samples, s
    begun: float = 0.0  # time between the first of all moves and the start of this one, s
    measured: Array = field(default_factory=lambda: np.empty(0))  # (n,), position as measured, m
    #: (m,), samples kept that the checks did not exclude
    usable: NDArray[np.bool_] = field(default_factory=lambda: np.empty(0, dtype=bool))
    #: standard deviation by channel, SI, at the samples kept
    noise: Mapping[str, float] = field(default_factory=dict)
    motor: Motor | None = None


def prepared(run: Run, begun: float, rubbing: AxisForce) -> Run:
    """Return a run with its record, at the samples kept of a low pass.

    The run begins some time after the first of all moves, s; `rubbing` is the force of the declared
    axis with a dry friction.
    """
    signals = run.signals
    step = float(np.median(np.diff(signals["time"])))
    motion = _motion(signals["position"], step, _MOTION_CUT_OFF)
    force = kept(signals["force"])
    usable = np.ones(motion.position.size) if run.usable is None else run.usable
    # the force follows from a motion that was measured to a share of itself
    followed = _FOLLOWED * float(np.sqrt(np.mean(signals["force"] ** 2)))
    noise = {"force": math.hypot(_noise_of(signals["force"]), followed)}
    record = AxisRecord(motion, step, begun, signals["position"], kept(usable) > _ALL_USABLE, noise)
    samples = {
        "time": signals["time"][::_KEPT][: force.size],
        "force": force,
        "position": kept(signals["position"]),
        "velocity": kept(motion.velocity),
    }
    weights = {"force": force_weights(record, rubbing)}
    return replace(run, signals=samples, usable=None, weights=weights, record=record)


def with_motor(made: Run, recorded: Run, slide_force: Array) -> Run:
    """Return a prepared run with the motion of the motor, and its travel ahead of the slide.

    The slide asks its drive for a force (n,), N, by the declared axis.
    """
    velocity = recorded.signals["velocity"]
    step = made.record.step
    travel = scipy.integrate.cumulative_trapezoid(velocity, dx=step, initial=0.0)
    crossing = np.abs(np.diff(driving_flank(slide_force), prepend=0.0)) > 0.0
    about_kept = scipy.ndimage.maximum_filter1d(crossing, 2 * _KEPT + 1)[::_KEPT]
    near = scipy.ndimage.maximum_filter1d(about_kept, 2 * _CROSSING + 1)
    near |= _within_travel(kept(travel), about_kept)
    weights = np.where(near, _CROSSING_WEIGHT, 1.0)
    # what noise of the velocity adds up to
    drift = white_level(_slip(recorded)) * step * math.sqrt(travel.size)
    record = replace(
        made.record,
        noise={**made.record.noise, "backlash": drift},
        motor=Motor(_derivative(_smooth(velocity, _MOTION_CUT_OFF), step, 1), weights),
    )
    ahead = centred(kept(travel - recorded.signals["position"]), weights)
    return replace(
        made,
        signals={**made.signals, "backlash": ahead},
        weights={**made.weights, "backlash": weights},
        record=record,
    )


def _within_travel(travel: Array, crossing: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Samples (m,) that the motor has no more than a gap to travel to, or from, a crossing.

    A motor that creeps takes long to cross a gap, and the slide rests meanwhile.
    """
    if not np.any(crossing):
        return np.zeros(travel.size, dtype=bool)
    path = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(travel)))])
    ends = path[crossing]
    after = np.minimum(np.searchsorted(ends, path), ends.size - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.minimum(np.abs(ends[after] - path), np.abs(ends[before] - path))
    return nearest < _WIDEST_GAP


def force_weights(record: AxisRecord, rubbing: AxisForce) -> Array:
    """Weights (m,): 1, or less where the force depends on how the motion is smoothed.

    At a reversal a dry friction jumps within less than the motion is resolved to. How far off its
    force may be is seen from a motion smoothed less; when between two samples it jumped, no sample
    tells. Of an axis that creeps, the speed says little
    about a friction without presliding, and nothing of one at rest: any force up to it holds.
    """
    coarse, fine = (
        kept(rubbing.along(*_motion(record.measured, record.step, cut), record.step, record.begun))
        for cut in (_MOTION_CUT_OFF, _FINER_CUT_OFF)
    )
    uncertainty = scipy.ndimage.maximum_filter1d(np.abs(fine - coarse), 2 * _NEARBY + 1)
    if rubbing.presliding_stiffness is None:
        position, velocity, _ = record.motion
        dry = _smooth(rubbing.dry_friction(position, velocity, record.step), _CUT_OFF)
        uncertainty = np.hypot(uncertainty, _WITHIN_A_SAMPLE * np.gradient(dry)[::_KEPT])
        speed = np.abs(record.motion.velocity)
        unknown = np.where(speed < SMOOTH, 1.0, _CREEP_UNCERTAINTY * (speed < _NEAR_REST))
        uncertainty += rubbing.coulomb * np.clip(kept(unknown), 0.0, 1.0)
    weights = 1.0 / np.hypot(1.0, uncertainty / max(record.noise["force"], 1e-12))
    weights[:_ENDS] = weights[-_ENDS:] = _LEAST_WEIGHT
    return np.maximum(weights, _LEAST_WEIGHT) * record.usable


def motor_runs_ahead(runs: Sequence[Run]) -> bool:
    """Whether the motor's velocity is not that of the position, but runs ahead of it at times."""
    if any("velocity" not in run.signals for run in runs):
        return False
    slips = [_slip(run) for run in runs]
    return any(np.abs(kept(slip)[_ENDS:-_ENDS]).max() > _AHEAD * _noise_of(slip) for slip in slips)


def driving_flank(force: Array) -> Array:
    """Which flank drives, 1 or -1, (n,); where there is hardly a force, the one that did."""
    drives = np.abs(force) > _DRIVES * np.median(np.abs(force))
    last = np.maximum.accumulate(np.where(drives, np.arange(force.size), 0))
    return np.sign(force)[last]


def centred(values: Array, weight: Array) -> Array:
    """Values without their weighted mean, which the motor's encoder does not know."""
    return values - np.average(values, weights=weight)


def kept(values: Array, delay: float = 0.0) -> Array:
    """Samples (m,) kept of a signal (n,) behind the low pass, later by a delay in samples."""
    smooth = _smooth(values, _CUT_OFF)
    if delay:
        smooth = scipy.ndimage.shift(smooth, delay, order=3, mode="nearest")
    return smooth[::_KEPT]


def _motion(position: Array, step: float, cut_off: float) -> Motion:
    smooth = _smooth(position, cut_off)
    velocity, acceleration = _derivative(smooth, step, 1), _derivative(smooth, step, 2)
    # the direction of friction near rest depends on velocities far below the noise of a difference
    # of positions: where the axis creeps, they are taken over more samples
    nearby = scipy.ndimage.maximum_filter1d(np.abs(velocity), 2 * _BESIDE + 1)
    creeping = scipy.signal.savgol_filter(smooth, 2 * _BESIDE + 1, _DEGREE, 1, step)
    return Motion(smooth, np.where(nearby < _NEAR_REST, creeping, velocity), acceleration)


def _derivative(smooth: Array, step: float, order: int) -> Array:
    """Derivative of samples (n,) by the quintic spline through them.

    Differences of neighbours lose 8 % of an acceleration at the low pass of the force.
    """
    time = step * np.arange(smooth.size)
    return scipy.interpolate.make_interp_spline(time, smooth, k=5)(time, order)


def _noise_of(signal: Array) -> float:
    """Standard deviation of the noise of a signal at the samples kept."""
    # second differences of white noise have six times its variance; the low pass takes the rest
    return white_level(np.diff(signal, 2)) * math.sqrt(2.0 * _CUT_OFF / 6.0)


def _slip(run: Run) -> Array:
    """Velocity (n,), m/s, of the motor's encoder beyond that of the position."""
    step = float(np.median(np.diff(run.signals["time"])))
    smooth = _smooth(run.signals["position"], _MOTION_CUT_OFF)
    return run.signals["velocity"] - np.gradient(smooth, step)


def _smooth(values: Array, cut_off: float) -> Array:
    sections = scipy.signal.butter(4, 2.0 * cut_off, output="sos")
    return scipy.signal.sosfiltfilt(sections, values)
