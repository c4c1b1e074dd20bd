"""What a residual may depend on: variables of every sample, conditions and measures of every run.

A kind of measurement lists those that it knows (`chatter.explain.kinds`).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.units import rpm
from chatter.explain.residuals.channel_residual import ChannelResidual

Array = NDArray[np.float64]
OfSamples = Callable[[ChannelResidual], Array]
OfRun = Callable[[ChannelResidual], float]

#: speed below which an axis rests, m/s
_REST = 1e-4
#: shortest travel since a reversal that is resolved, m
_SHORTEST_TRAVEL = 1e-6
_DEGREE = 180.0 / math.pi


@dataclass(frozen=True)
class Variable:
    """A variable over which a residual is examined."""

    name: str
    label: str  # in sentences: "the distance along the feed"
    unit: str  # in which it is reported
    scale: float  # reported over SI
    of: OfSamples  # ChannelResidual -> (n,) values in SI, nan where they are not known
    logarithmic: bool = False  # whether `of` gives the decimal logarithm
    own_period: OfRun | None = None  # ChannelResidual -> period that a run has in it by itself

    @property
    def heading(self) -> str:
        """Name with the unit, as at an axis."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def reported(self, values: Array) -> Array:
        """Values in the unit in which they are reported."""
        return (10.0**values if self.logarithmic else values) * self.scale


@dataclass(frozen=True)
class Form:
    """How a residual may depend on a variable v: g(v) times a weight."""

    name: str
    description: str  # put after the name of the residual: "as a share of the predicted force"
    weight: OfSamples  # ChannelResidual -> (n,) array; SI where it has a unit
    relative: bool = False  # whether g is a share rather than a signal


class Condition(NamedTuple):
    """What was set in a run: name, unit in which it is reported, reported over SI, value in SI."""

    name: str
    unit: str
    scale: float
    of: OfRun


class Measure(NamedTuple):
    """A number that describes the residual of a run.

    A trend counts only where ``also``, the same in another measure, has it too: a residual that
    is the same in all runs falls over the signal, one that is a share of it rises by itself.
    ``unit`` gives the unit of a channel's measure and its value over SI.
    """

    name: str
    description: str
    of: OfRun
    unit: Callable[[str], tuple[str, float]]
    also: OfRun | None = None


def reported_unit(channel: str) -> tuple[str, float]:
    """Unit in which a channel is reported, and its value over SI."""
    if channel in _MOTIONS:
        return _MOTIONS[channel]
    if channel == "spindle_power":
        return "W", 1.0
    if channel == "torque":
        return "N m", 1.0
    return ("N", 1.0) if channel[0] in "Ff" else ("µm", 1e6)


_MOTIONS = {
    **dict.fromkeys(("vx", "vy", "vz"), ("mm/s", 1e3)),
    **dict.fromkeys(("ax", "ay", "az"), ("m/s²", 1.0)),
}


def _percent(_: str) -> tuple[str, float]:
    return "%", 100.0


_ADDED = Form("added", "", lambda residual: np.ones(residual.measured.size))

# milling -----------------------------------------------------------------------------------------


def spindle_angle(residual: ChannelResidual) -> Array:
    """Angle of the spindle from the start of the run, rad."""
    signals = residual.run.signals
    if "spindle_angle" in signals:
        return signals["spindle_angle"]
    return residual.case.cut.spindle_speed * (signals["time"] - signals["time"][0])


def _feed_per_revolution(residual: ChannelResidual) -> float:
    return residual.case.tool.teeth * residual.case.cut.feed_per_tooth


def _feed_distance(residual: ChannelResidual) -> Array:
    """Travel of the tool along the feed from the start of the run, m."""
    return spindle_angle(residual) / (2.0 * math.pi) * _feed_per_revolution(residual)


def _angle_within(residual: ChannelResidual, parts: int) -> Array:
    return np.mod(spindle_angle(residual), 2.0 * math.pi / parts)


def _absolute(residual: ChannelResidual) -> float:
    """Root mean square beyond the noise, SI."""
    return math.sqrt(max(float(np.mean(residual.values**2)) - residual.noise**2, 0.0))


def _relative(residual: ChannelResidual) -> float:
    """Root mean square beyond the noise, over the signal."""
    return _absolute(residual) / max(math.sqrt(float(np.mean(residual.measured**2))), 1e-300)


def _gain(residual: ChannelResidual) -> float:
    """Share of itself by which the prediction is too small."""
    predicted = residual.predicted
    return float(residual.values @ predicted) / max(float(predicted @ predicted), 1e-300)


MILLING_VARIABLES = (
    Variable(
        "time",
        "the time since the start of the run",
        "s",
        1.0,
        lambda residual: residual.run.signals["time"] - residual.run.signals["time"][0],
    ),
    Variable(
        "spindle angle", "the angle of the spindle", "deg", _DEGREE, lambda r: _angle_within(r, 1)
    ),
    Variable(
        "tooth angle",
        "the angle from tooth to tooth",
        "deg",
        _DEGREE,
        lambda residual: _angle_within(residual, residual.case.tool.teeth),
    ),
    Variable(
        "feed distance",
        "the distance along the feed",
        "mm",
        1e3,
        _feed_distance,
        own_period=_feed_per_revolution,
    ),
)
MILLING_FORMS = (
    _ADDED,
    Form("in proportion", "as a share of what is predicted", lambda r: r.predicted, relative=True),
)
MILLING_CONDITIONS = (
    Condition("spindle speed", "rpm", rpm(1.0), lambda r: r.case.cut.spindle_speed),
    Condition("feed per tooth", "mm", 1e3, lambda r: r.case.cut.feed_per_tooth),
    Condition("axial depth", "mm", 1e3, lambda r: r.case.cut.axial_depth),
    Condition("radial depth", "mm", 1e3, lambda r: r.case.width_of_cut),
    Condition("cut time", "s", 1.0, lambda r: r.run.cut_time),
)
MILLING_MEASURES = (
    Measure("gain", "share by which the prediction is too small", _gain, _percent),
    Measure("size", "size over the signal", _relative, _percent, _absolute),
)

# axis --------------------------------------------------------------------------------------------


def direction(residual: ChannelResidual) -> Array:
    """Sign of the velocity; at rest that of the motion before."""
    velocity = residual.run.signals["velocity"]
    moving = np.abs(velocity) > _REST
    last = np.maximum.accumulate(np.where(moving, np.arange(velocity.size), -1))
    return np.where(last >= 0, np.sign(velocity[np.maximum(last, 0)]), 0.0)


def _travel_since_reversal(residual: ChannelResidual) -> Array:
    position, sense = residual.run.signals["position"], direction(residual)
    turned = np.concatenate(([True], np.diff(sense) != 0.0))
    begun = np.maximum.accumulate(np.where(turned, np.arange(position.size), 0))
    return np.log10(np.maximum(np.abs(position - position[begun]), _SHORTEST_TRAVEL))


def _acceleration(residual: ChannelResidual) -> Array:
    return np.gradient(residual.run.signals["velocity"], residual.run.signals["time"])


AXIS_VARIABLES = (
    Variable("velocity", "the velocity", "mm/s", 1e3, lambda r: r.run.signals["velocity"]),
    Variable("position", "the position", "mm", 1e3, lambda r: r.run.signals["position"]),
    Variable(
        "travel since reversal",
        "the travel since the last reversal",
        "mm",
        1e3,
        _travel_since_reversal,
        logarithmic=True,
    ),
    Variable("acceleration", "the acceleration", "m/s²", 1.0, _acceleration),
    Variable("direction", "the direction of motion", "", 1.0, direction),
)
AXIS_FORMS = (_ADDED, Form("with the direction", "along the direction of motion", direction))
AXIS_CONDITIONS = (
    Condition("time since the first move", "s", 1.0, lambda r: r.run.record.begun),
    Condition(
        "highest speed", "mm/s", 1e3, lambda r: float(np.max(np.abs(r.run.signals["velocity"])))
    ),
    Condition("travel", "mm", 1e3, lambda r: float(np.ptp(r.run.signals["position"]))),
)
AXIS_MEASURES = (
    Measure(
        "mean x direction",
        "mean along the direction of motion",
        lambda residual: float(np.mean(residual.values * direction(residual))),
        reported_unit,
    ),
    Measure("mean", "mean", lambda residual: float(np.mean(residual.values)), reported_unit),
)
