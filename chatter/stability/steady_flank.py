"""Ploughing about the steady motion of a cut: the dashpot that small vibration meets there.

A flat land acts on the way into the work alone. What the steady motion of the cut does decides how
much of it acts: where forced vibration moves an edge into the work the land is pressed, and small
vibration meets the whole of its dashpot K l^2/2 and more; where it moves out, none; where there is
none, half, K l^2/4. So the dashpot follows the spindle angle, at every speed and depth its own.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.progress import Progress
from chatter.engine.parallel import each, one_thread
from chatter.stability.limit_curve import LimitCurve, joined_limits
from chatter.stability.model import MillingModel, SteadyPath
from chatter.stability.steady_motion import steady_motion
from cutting.process_damping.linear_flank import vibrating_land
from cutting.process_damping.ploughing import Ploughing

#: of a model, at a speed (rad/s), on a grid of depths (m)
LimitsAt = Callable[[MillingModel, float, Array], LimitCurve]
#: of a model, at points of speed (rad/s) and depth (m)
RadiusAt = Callable[[MillingModel, Array, Array], Array]

#: slope of the vibration beside the steady motion whose describing value is taken, of the steepest
#: of the steady motion: small, yet it takes the kinks off
_SWING = 0.1
#: a limit is that of its own steady motion where the depths differ by less, relative; and how often
#: it is moved at the most
_SAME_DEPTH, _MOST_MOVES = 3e-3, 6
#: searches over all depths at a speed, each from the first limit of the one before
_MOST_SEARCHES = 2
#: depths around the last limit on which the next one is searched first
_AROUND, _DEPTHS_AROUND = (0.6, 1.6), 6
#: rise of the depth over which the slope of the growth rate is taken; the largest step, as a
#: logarithm of the depth; and the tolerance of the limit that confirms the last one
_RISE, _LARGEST_MOVE, _LOOSE = 0.04, 0.5, 3e-3
#: depths at which a cut that is stable about a still tool is looked at beside its own motion
_LOOKED_AT = 8
#: up to this many speeds their limits keep to the tolerance of the case
_FEW_SPEEDS = 8
#: points of a map share the steady motion of a depth within this factor
_SHARED_DEPTH = 1.5
#: up to this many points each has its own
_FEW_POINTS = 32


def flank_in_motion(model: MillingModel) -> Ploughing | None:
    """Flank that ploughs beside a steady motion; None where it is taken about a still tool."""
    if isinstance(model.flank, Ploughing) and model.case.cut.speed_variation is None:
        return model.flank
    return None


def follows_steady_motion(model: MillingModel) -> bool:
    """Tell whether the dashpot of the flank is another one at every speed and depth."""
    return flank_in_motion(model) is not None


def about_steady_motion(
    model: MillingModel, speed: float, depth: float, chatter_frequency: float = math.nan
) -> MillingModel:
    """The model with the flank as it is beside the steady motion of a cut.

    At a spindle speed, rad/s, and a depth, m; the same model where nothing ploughs. The length of
    the land against the wave is that at the chatter frequency, Hz, by default at the natural
    frequency of the most flexible mode.
    """
    flank = flank_in_motion(model)
    if flank is None:
        return model
    motion = steady_motion(model, speed, depth)
    if motion is None or motion.steepest == 0.0:
        return model
    natural, damping, shape, gain = model.modal_arrays
    frequency = 2.0 * math.pi * chatter_frequency
    if not frequency > 0.0:
        reach = np.linalg.norm(shape, axis=1) * np.linalg.norm(gain, axis=1)
        frequency = float(natural[np.argmax(reach / (damping * natural**2))])
    land = vibrating_land(flank.contact_length, frequency, speed, model.cutter.radius)
    count, pressing = motion.spindle.size, flank.over_slope
    path = motion.path(motion.period * np.arange(count) / count) @ model.basis_on_tool.T
    return replace(
        model,
        steady_path=SteadyPath(
            path=path,
            period=motion.period,
            pressed=land.dashpot * pressing.described(_SWING * motion.steepest),
            steepest=pressing.steepest,
            slope=motion.steepest,
            depth=depth,
            stiffening=land.stiffness,
            speed=speed,
        ),
    )


def limits_about_steady_motion(
    model: MillingModel,
    still: LimitCurve,
    depths: Array,
    limits: LimitsAt,
    radius: RadiusAt | None,
    progress: Progress,
) -> LimitCurve:
    """Limits whose flank is that beside the steady motion at the limit itself.

    Parameters
    ----------
    model : MillingModel
    still : LimitCurve
        Limits with the flank about a still tool, at the same speeds.
    depths : (m,) array of float
        m, ascending.
    limits : callable
    radius : callable, optional
        Spectral radius, of a method that gives it: limits move with the motion by Newton steps.
    progress : callable
        Called with (done, total) speeds.
    """
    speeds = still.spindle_speed

    def still_at(i: int) -> LimitCurve:
        one = slice(i, i + 1)
        return LimitCurve(
            speeds[one], still.critical_depth[one], still.chatter_frequency[one],
            still.bifurcation[one], still.crossings[one], still.steps[one], 0.0,
        )  # fmt: skip

    def at(i: int) -> LimitCurve:
        speed = float(speeds[i])
        own = model.at_speed(speed) if model.depends_on_speed else model
        with one_thread():
            start = float(still.critical_depth[i]), float(still.chatter_frequency[i])
            crossings = len(still.crossings[i])
            if len(speeds) > _FEW_SPEEDS:
                own = replace(own, limit_tolerance=max(_LOOSE, own.tolerance))
            if radius is not None and crossings == 0 and _is_stable(own, speed, depths, radius):
                return still_at(i)
            if radius is not None and crossings == 1:
                found = _moved_limit(own, speed, start, depths, limits, radius)
                if found is not None:
                    return found
            return _limit_at(own, speed, start, depths, limits, radius)

    curves = each(at, len(speeds), progress)
    return joined_limits(speeds, [(np.array([i]), curve) for i, curve in enumerate(curves)])


def _moved_limit(
    model: MillingModel,
    speed: float,
    start: tuple[float, float],
    depths: Array,
    limits: LimitsAt,
    radius: RadiusAt,
) -> LimitCurve | None:
    """Limit at a speed by Newton steps from another, m, and its frequency, Hz; None without end."""
    depth = _moved_depth(model, speed, start, radius)
    if depth is None or depth >= depths[-1]:
        return None
    near = depth * np.linspace(*_AROUND, _DEPTHS_AROUND)
    near = near[near < depths[-1]]
    if not near.size:
        return None
    beside = about_steady_motion(model, speed, depth, start[1])
    found = limits(beside, speed, np.append(near, depths[-1]))
    moved = float(found.critical_depth[0])
    return found if abs(moved - depth) < 3.0 * _LOOSE * depth else None


def _moved_depth(
    model: MillingModel, speed: float, start: tuple[float, float], radius: RadiusAt
) -> float | None:
    """Depth, m, of the limit at a speed by Newton steps from another; None where they do not end.

    Every step moves along the growth rate at the flank of the last depth.
    """
    depth, frequency = start
    for _ in range(_MOST_MOVES):
        beside = about_steady_motion(model, speed, depth, frequency)
        at = depth * np.array([1.0, 1.0 + _RISE])
        rate, above = np.log(np.maximum(radius(beside, np.full(2, speed), at), 1e-30))
        slope = (above - rate) / np.log1p(_RISE)
        if not slope > 0.0 or abs(rate) > _LARGEST_MOVE * slope:
            return None
        depth *= float(np.exp(-rate / slope))
        if abs(rate) < _SAME_DEPTH * slope:
            return depth
    return None


def _is_stable(model: MillingModel, speed: float, depths: Array, radius: RadiusAt) -> bool:
    """Whether a speed is stable at depths from the least to the largest, each in its own motion."""
    for depth in np.geomspace(depths[0], depths[-1], _LOOKED_AT):
        beside = about_steady_motion(model, speed, float(depth))
        if radius(beside, np.array([speed]), np.array([depth]))[0] >= 1.0:
            return False
    return True


def _limit_at(
    model: MillingModel,
    speed: float,
    start: tuple[float, float],
    depths: Array,
    limits: LimitsAt,
    radius: RadiusAt | None,
) -> LimitCurve:
    """Limits at a speed, from the first limit, m, and its frequency, Hz, with another flank."""
    depth, frequency = min(start[0], float(depths[-1])), start[1]
    for _ in range(_MOST_SEARCHES):
        begin = depth, frequency
        moved = None if radius is None else _moved_depth(model, speed, begin, radius)
        if moved is None or moved >= depths[-1]:
            moved, frequency = _followed_depth(model, speed, begin, depths, limits)
        found = limits(about_steady_motion(model, speed, moved, frequency), speed, depths)
        depth, frequency = float(found.critical_depth[0]), float(found.chatter_frequency[0])
        if not np.isfinite(depth) or abs(depth - moved) < _SAME_DEPTH * moved:
            return found
    # which limit is the first has changed with the motion: that of the last one
    return limits(about_steady_motion(model, speed, depth, frequency), speed, depths)


def _followed_depth(
    model: MillingModel, speed: float, start: tuple[float, float], depths: Array, limits: LimitsAt
) -> tuple[float, float]:
    """Depth, m, and frequency, Hz, of a limit with the motion of the last, until they agree."""
    depth, frequency = start
    for _ in range(_MOST_MOVES):
        near = depth * np.linspace(*_AROUND, _DEPTHS_AROUND)
        beside = about_steady_motion(model, speed, depth, frequency)
        found = limits(beside, speed, near[near < depths[-1]])
        moved = float(found.critical_depth[0])
        if not near[0] < moved < np.inf:
            break
        last, depth, frequency = depth, moved, float(found.chatter_frequency[0])
        if abs(depth - last) < _SAME_DEPTH * depth:
            break
    return depth, frequency


def radius_about_steady_motion(
    model: MillingModel, speeds: Array, depths: Array, radius: RadiusAt, progress: Progress
) -> Array:
    """Spectral radius (n,) at points of speed (rad/s) and depth (m), beside their steady motions.

    Of many points those at one speed and at depths that are alike share a motion: what presses
    depends on its shape, which the depth hardly changes.
    """
    found = np.empty(len(speeds))
    groups = _groups(speeds, depths)

    def at(number: int) -> None:
        index = groups[number]
        speed, depth = float(speeds[index[0]]), float(np.exp(np.log(depths[index]).mean()))
        own = model.at_speed(speed) if model.depends_on_speed else model
        with one_thread():
            beside = about_steady_motion(own, speed, depth)
            found[index] = radius(beside, speeds[index], depths[index])

    each(at, len(groups), progress)
    return found


def _groups(speeds: Array, depths: Array) -> list[IntegerArray]:
    """Indices of the points that share a steady motion."""
    if len(speeds) <= _FEW_POINTS:
        return [np.array([i]) for i in range(len(speeds))]
    rung = np.round(np.log(depths) / np.log(_SHARED_DEPTH))
    _, group = np.unique(np.stack([speeds, rung]), axis=1, return_inverse=True)
    group = group.ravel()
    order = np.argsort(group, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(group[order])) + 1)
