"""Parts of a program where the cut can repeat: at a constant feed, on a line or an arc.

At corners, stops, and where arcs begin, axes follow with a transient; the forces change with the
feed. None of that repeats from revolution to revolution, and none of it is chatter.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from chatter.detection.chatter_detection import Detection
from chatter.simulation.result import SimulationResult
from chatter.simulation.spindle import ProgrammedSpindle
from chatter.simulation.tool_course import ToolCourse

#: change of speed over the largest, and of the turn of the feed (rad), per revolution, that is none
_EVEN, _STRAIGHT = 1e-3, 1e-3
#: share of the largest speed below which the tool stands
_STANDS = 0.01
#: cycles over a part, as which a slow change of the forced vibration may appear
_FEW_CYCLES = 4.0


def steady_parts(result: SimulationResult) -> list[slice] | None:
    """Rows of each part of a programmed cut, in their order; None without a program."""
    course = result.setup.path
    if not isinstance(course, ToolCourse):
        return None
    velocity = np.asarray(course.trajectory.at(result.time).velocity, dtype=np.float64)
    velocity[~np.isfinite(velocity)] = 0.0
    speed = np.linalg.norm(velocity, axis=1)
    for begin, end in course.in_air:
        speed[(result.time >= begin) & (result.time <= end)] = 0.0
    cutting = speed > _STANDS * speed.max()
    goes_on = cutting[1:] & cutting[:-1]
    step = float(result.time[1] - result.time[0])
    a_revolution = 2.0 * math.pi / course.slowest / step
    goes_on &= np.abs(np.diff(speed)) * a_revolution <= _EVEN * speed.max()
    heading = np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0]))
    turn = np.diff(heading) * a_revolution
    bends = np.abs(np.diff(turn)) > _STRAIGHT
    goes_on[1:] &= ~bends
    if isinstance(result.setup.spindle, ProgrammedSpindle):
        goes_on &= np.diff(course.spindle.speed_at(result.time)) == 0.0
    return _runs(goes_on)


def in_direction_of_feed(result: SimulationResult, rows: slice) -> NDArray[np.float64]:
    """Displacement (n, 3) of rows along the feed, across it, and along the tool axis, m."""
    heading = _heading(result, rows)
    cosine, sine = np.cos(heading), np.sin(heading)
    x, y, z = result.displacement[rows].T
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=1)


def may_be_modulation(result: SimulationResult, rows: slice, found: Detection) -> bool:
    """Whether what does not repeat may be forced vibration that changes as the feed turns.

    It then goes against the harmonics of the teeth by few cycles over the part.
    """
    heading = np.unwrap(_heading(result, rows))
    if abs(heading[-1] - heading[0]) < _STRAIGHT:
        return False
    time, angle = result.time[rows], result.spindle_angle[rows]
    duration = float(time[-1] - time[0])
    rate = float(angle[-1] - angle[0]) / (2.0 * math.pi) / duration
    if found.period_unit == "tooth":
        rate *= result.setup.cutter.teeth
    beside = abs(found.chatter_frequency - rate * round(found.chatter_frequency / rate))
    return beside * duration < _FEW_CYCLES


def _heading(result: SimulationResult, rows: slice) -> NDArray[np.float64]:
    course = result.setup.path
    assert isinstance(course, ToolCourse)
    return course.heading_at(result.time[rows])


def _runs(goes_on: NDArray[np.bool_]) -> list[slice]:
    """Rows of each run of intervals that go on."""
    edges = np.diff(np.concatenate([[False], goes_on, [False]]).astype(np.int8))
    begins, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return [slice(int(begin), int(end) + 1) for begin, end in zip(begins, ends, strict=True)]
