"""Current loops: how the torque follows its set point.

Every current loop is a continuous plant of at most two states, discretised exactly for an input
held over the step (zero-order hold: matrix exponential; Franklin, Powell and Workman 1998,
section 4.3.3), and an input law sampled with the current loop. The input is the torque set point
itself (ideal, lags), or the voltage of a PI controller (motor of resistance and inductance).
The torque of a step is that at its beginning.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.control.sampling import require_limit, require_not_negative, require_positive
from dynamics.matrix_exponential import exact_step


class CurrentPlant(NamedTuple):
    """x' = A x + b u, torque = c x + d u: continuous, x[0] being what the loop measures."""

    matrix: NDArray[np.float64]  # (2, 2)
    entry: NDArray[np.float64]  # (2,)
    torque: NDArray[np.float64]  # (2,)
    feedthrough: float

    def sampled(self, step: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return transition (2, 2) and entry (2,) over a step, s, of held input."""
        return _sampled(tuple(self.matrix.ravel().tolist()), tuple(self.entry.tolist()), step)

    def response(self, frequencies: ArrayLike, step: float) -> NDArray[np.complex128]:
        """Return both states per input in the z-domain of a step, s: (..., 2); Hz."""
        transition, entry = self.sampled(step)
        z = np.exp(2j * np.pi * np.asarray(frequencies, dtype=np.float64) * step)
        resolvent = z[..., None, None] * np.eye(2) - transition
        return np.linalg.solve(resolvent, np.broadcast_to(entry[:, None], (*z.shape, 2, 1)))[..., 0]


@lru_cache(maxsize=256)
def _sampled(
    matrix: tuple[float, ...], entry: tuple[float, ...], step: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Transition (2, 2) and entry (2,) of a step; a response asks for the same many times."""
    over = exact_step(np.reshape(matrix, (2, 2)), np.reshape(entry, (2, 1)), step)
    found = np.ascontiguousarray(over.transition), over.constant[:, 0].copy()
    for part in found:
        part.setflags(write=False)
    return found


class InputLaw(NamedTuple):
    """u = through m + PI of (m/torque constant - current), within limits; see RegulatedMotor."""

    through: float  # of the torque set point
    proportional: float  # V/A
    integral: float  # V/A per sample
    limit: float  # of the voltage, V
    torque_constant: float  # N m/A
    back_emf: float  # V s/rad


class _Unregulated:
    """Current loop that is a plant alone."""

    def input_law(self, sample_time: float) -> InputLaw:  # noqa: ARG002
        """Return the sampled input law."""
        return InputLaw(1.0, 0.0, 0.0, math.inf, 1.0, 0.0)


@dataclass(frozen=True)
class IdealCurrentLoop(_Unregulated):
    """The torque is its set point."""

    def plant(self) -> CurrentPlant:
        """Return the continuous plant."""
        return CurrentPlant(-np.eye(2), np.zeros(2), np.zeros(2), 1.0)


@dataclass(frozen=True)
class FirstOrderCurrentLoop(_Unregulated):
    """T m' + m = set point.

    Raises
    ------
    ControlError
        If it is not above 0.
    """

    time_constant: float  # T, s

    def __post_init__(self):
        require_positive("current loop", "time constant", self.time_constant)

    def plant(self) -> CurrentPlant:
        """Return the continuous plant."""
        rate = 1.0 / self.time_constant
        return CurrentPlant(-rate * np.eye(2), np.array([rate, 0.0]), np.array([1.0, 0.0]), 0.0)


@dataclass(frozen=True)
class SecondOrderCurrentLoop(_Unregulated):
    """m''/w^2 + 2 D m'/w + m = set point.

    Raises
    ------
    ControlError
        If one of them is not above 0.
    """

    natural_frequency: float  # w/(2 pi), Hz
    damping: float = math.sqrt(0.5)  # D

    def __post_init__(self):
        require_positive("current loop", "natural frequency", self.natural_frequency)
        require_positive("current loop", "damping", self.damping)

    def plant(self) -> CurrentPlant:
        """Return the continuous plant; the second state is m'/w."""
        w = 2.0 * math.pi * self.natural_frequency
        matrix = w * np.array([[0.0, 1.0], [-1.0, -2.0 * self.damping]])
        return CurrentPlant(matrix, np.array([0.0, w]), np.array([1.0, 0.0]), 0.0)


@dataclass(frozen=True)
class RegulatedMotor:
    """PI current controller on the quadrature axis of a field-oriented synchronous motor.

    L i' = u - R i - k_e w_motor, torque = k_t i; u = K_p e + sum(K_p T/T_n e) of
    e = set torque/k_t - i, held over the sample time T (Schröder 2009, Elektrische Antriebe -
    Regelung von Antriebssystemen). The sum grows no further than to
    where the voltage meets its limit.

    Raises
    ------
    ControlError
        If a value is out of its range.
    """

    resistance: float  # R, ohm
    inductance: float  # L, H
    torque_constant: float  # k_t, N m/A
    proportional_gain: float  # K_p, V/A
    integral_time: float = math.inf  # T_n, s; infinite: no integral part
    back_emf: float = 0.0  # k_e, V s/rad; 0 where the controller decouples it
    voltage_limit: float = math.inf  # V; infinite: none

    def __post_init__(self):
        part = "current loop"
        for key in ("resistance", "inductance", "torque_constant", "proportional_gain"):
            require_positive(part, key.replace("_", " "), getattr(self, key))
        require_limit(part, "integral time", self.integral_time)
        require_not_negative(part, "back emf", self.back_emf)
        require_limit(part, "voltage limit", self.voltage_limit)

    def plant(self) -> CurrentPlant:
        """Return the continuous plant; its first state is the current, A."""
        rate = self.resistance / self.inductance
        entry = np.array([1.0 / self.inductance, 0.0])
        return CurrentPlant(-rate * np.eye(2), entry, np.array([self.torque_constant, 0.0]), 0.0)

    def input_law(self, sample_time: float) -> InputLaw:
        """Return the input law at the sample time of the current loop, s."""
        integral = self.proportional_gain * sample_time / self.integral_time
        return InputLaw(
            0.0,
            self.proportional_gain,
            integral,
            self.voltage_limit,
            self.torque_constant,
            self.back_emf,
        )


CurrentLoop = IdealCurrentLoop | FirstOrderCurrentLoop | SecondOrderCurrentLoop | RegulatedMotor
