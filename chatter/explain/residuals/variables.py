"""What a residual may hang on, sample by sample, by kind of measurement."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.explain.residuals.normalised_residual import Left, Residual

Array = NDArray[np.float64]

#: speed below which an axis rests, m/s
_REST = 1e-4
#: shortest way since a reversal that is told apart, m
_SHORTEST_WAY = 1e-6


@dataclass(frozen=True)
class Variable:
    """A variable over which a residual is looked at.

    Parameters
    ----------
    name : str
    label : str
        In sentences: "the way along the feed".
    unit : str
        In which it is told.
    scale : float
        Told over SI.
    of : callable
        Left -> (n,) values in SI, nan where they are not known.
    logarithmic : bool
        Whether `of` gives the decimal logarithm.
    """

    name: str
    label: str
    unit: str
    scale: float
    of: Callable[[Left], Array]
    logarithmic: bool = False

    def told(self, values: Array) -> Array:
        """Values in the unit in which they are told."""
        return (10.0**values if self.logarithmic else values) * self.scale


@dataclass(frozen=True)
class Form:
    """How a residual may hang on a variable v: g(v) times a weight.

    Parameters
    ----------
    name : str
    says : str
        Put after the name of the residual: "as a share of the predicted force".
    weight : callable
        Left -> (n,) array; SI where it has a unit.
    relative : bool
        Whether g is a share rather than a signal.
    """

    name: str
    says: str
    weight: Callable[[Left], Array]
    relative: bool = False


# milling -----------------------------------------------------------------------------------------


def spindle_angle(left: Left) -> Array:
    """Angle of the spindle from the start of the run, rad."""
    signals = left.run.signals
    if "spindle_angle" in signals:
        return signals["spindle_angle"]
    return left.case.cut.spindle_speed * (signals["time"] - signals["time"][0])


def feed_way(left: Left) -> Array:
    """Way of the tool along the feed from the start of the run, m."""
    cut = left.case.cut
    turns = spindle_angle(left) / (2.0 * math.pi)
    return turns * left.case.tool.teeth * cut.feed_per_tooth


def _tooth_angle(left: Left) -> Array:
    return np.mod(spindle_angle(left), 2.0 * math.pi / left.case.tool.teeth)


def _time(left: Left) -> Array:
    return left.run.signals["time"] - left.run.signals["time"][0]


_DEGREE = 180.0 / math.pi
MILLING = (
    Variable("time", "the time since the start of the run", "s", 1.0, _time),
    Variable(
        "spindle angle",
        "the angle of the spindle",
        "deg",
        _DEGREE,
        lambda left: np.mod(spindle_angle(left), 2.0 * math.pi),
    ),
    Variable("tooth angle", "the angle from tooth to tooth", "deg", _DEGREE, _tooth_angle),
    Variable("feed way", "the way along the feed", "mm", 1e3, feed_way),
)

# axis --------------------------------------------------------------------------------------------


def direction(left: Left) -> Array:
    """Sign of the velocity; at rest that of the motion before."""
    velocity = left.run.signals["velocity"]
    moving = np.abs(velocity) > _REST
    last = np.maximum.accumulate(np.where(moving, np.arange(velocity.size), -1))
    return np.where(last >= 0, np.sign(velocity[np.maximum(last, 0)]), 0.0)


def _way_since_reversal(left: Left) -> Array:
    position, sense = left.run.signals["position"], direction(left)
    turned = np.concatenate(([True], np.diff(sense) != 0.0))
    begun = np.maximum.accumulate(np.where(turned, np.arange(position.size), 0))
    way = np.abs(position - position[begun])
    return np.log10(np.maximum(way, _SHORTEST_WAY))


def _acceleration(left: Left) -> Array:
    return np.gradient(left.run.signals["velocity"], left.run.signals["time"])


def begun_at(left: Left) -> float:
    """Time between the first of all moves and the start of this one, s."""
    return float(left.run.signals.get("motion begun", np.zeros(1))[0])


AXIS = (
    Variable("velocity", "the velocity", "mm/s", 1e3, lambda left: left.run.signals["velocity"]),
    Variable("position", "the position", "mm", 1e3, lambda left: left.run.signals["position"]),
    Variable(
        "way since reversal",
        "the way since the last reversal",
        "mm",
        1e3,
        _way_since_reversal,
        logarithmic=True,
    ),
    Variable("acceleration", "the acceleration", "m/s²", 1.0, _acceleration),
    Variable("direction", "the direction of motion", "", 1.0, direction),
)

VARIABLES: Mapping[str, tuple[Variable, ...]] = {"milling": MILLING, "axis": AXIS}

FORMS: Mapping[str, tuple[Form, ...]] = {
    "milling": (
        Form("added", "", lambda left: np.ones(left.measured.size)),
        Form(
            "in proportion",
            "as a share of what is predicted",
            lambda left: left.predicted,
            relative=True,
        ),
    ),
    "axis": (
        Form("added", "", lambda left: np.ones(left.measured.size)),
        Form("with the direction", "along the direction of motion", direction),
    ),
}


def variables_of(residual: Residual) -> tuple[Variable, ...]:
    """Variables that a measurement of this kind knows sample by sample."""
    return VARIABLES.get(residual.kind.name, ())


def named(residual: Residual, name: str) -> Variable:
    """One of them, by name."""
    return next(one for one in variables_of(residual) if one.name == name)


#: SI unit of a channel, how it is told, told over SI
_UNITS = {"F": ("N", 1.0), "f": ("N", 1.0)}


def told_unit(channel: str) -> tuple[str, float]:
    """Unit in which a channel is told, and its value over SI."""
    return _UNITS.get(channel[0], ("µm", 1e6))
