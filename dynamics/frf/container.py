"""Frequency response functions: one container for measured and computed ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Quantity = Literal["receptance", "mobility", "accelerance"]

#: power of (i omega) that turns receptance into each quantity
DERIVATIVE_ORDER: dict[str, int] = {"receptance": 0, "mobility": 1, "accelerance": 2}

#: quantity of the FRF that a motion per force is
QUANTITY_OF_MOTION: dict[str, Quantity] = {
    "displacement": "receptance",
    "velocity": "mobility",
    "acceleration": "accelerance",
}

#: SI unit of each quantity
QUANTITY_UNIT: dict[str, str] = {"receptance": "m/N", "mobility": "m/s/N", "accelerance": "m/s^2/N"}

#: magnitude beyond which a number of a file was not measured: it is damaged, or marks a gap
LARGEST = 1e30


class MeasurementError(ValueError):
    """A measured file or signal that cannot be used; the message says which and why."""


@dataclass(frozen=True)
class Point:
    """A measured degree of freedom: a node of the structure and a direction."""

    node: str = ""  # name or number; empty where the file gives none
    direction: str = ""  # "x", "y" or "z"; empty where the file gives none
    sign: int = 1  # +1 or -1: the sense of the sensor along the direction


@dataclass(frozen=True)
class Frf:
    """One frequency response function in SI units."""

    frequency: NDArray[np.float64]  # (n,), Hz, ascending
    values: NDArray[np.complex128]  # (n,), response per force, in the SI unit of the quantity
    quantity: Quantity = "receptance"
    response: Point = Point()  # where the motion was measured
    reference: Point = Point()  # where the force acted
    coherence: NDArray[np.float64] | None = None  # (n,), ordinary coherence, 0 to 1
    source: str = ""  # file (and record) the function came from
    # Decay rate that an exponential window added to every pole, rad/s (1/s); 0 without one. The
    # values are then those of the function at i omega + added_decay, and a damping fitted to them
    # is put right by `without_added_decay`.
    added_decay: float = 0.0

    def __post_init__(self) -> None:
        """Check shapes, order and finiteness; raise MeasurementError naming the source."""
        where = self.source or "FRF"
        frequency = np.asarray(self.frequency, dtype=np.float64)
        values = np.asarray(self.values, dtype=np.complex128)
        if frequency.ndim != 1 or frequency.shape != values.shape:
            raise MeasurementError(
                f"{where}: frequency has shape {frequency.shape} and values {values.shape}; "
                "both must be one column of the same length"
            )
        if frequency.size < 2:
            raise MeasurementError(f"{where}: {frequency.size} lines; an FRF needs at least 2")
        if not np.all(np.isfinite(frequency)) or not np.all(np.isfinite(values)):
            line = int(np.argmin(np.isfinite(frequency) & np.isfinite(values)))
            raise MeasurementError(f"{where}: line {line + 1} of the FRF is not a finite number")
        if np.any(far := (np.abs(values) > LARGEST) | (np.abs(frequency) > LARGEST)):
            line = int(np.argmax(far))
            raise MeasurementError(
                f"{where}: line {line + 1} of the FRF, {np.abs(values[line]):g} at "
                f"{frequency[line]:g} Hz, is no measured number (at most {LARGEST:g})"
            )
        if 0.0 < (largest := float(np.abs(values).max())) < 1.0 / LARGEST:
            raise MeasurementError(
                f"{where}: the FRF is {largest:g} at the most, which no instrument tells from 0; "
                f"{1.0 / LARGEST:g} is the least"
            )
        if np.any(np.diff(frequency) <= 0.0):
            line = int(np.argmax(np.diff(frequency) <= 0.0))
            raise MeasurementError(
                f"{where}: frequencies must rise; {frequency[line]:g} Hz is followed by "
                f"{frequency[line + 1]:g} Hz"
            )
        if frequency[0] < 0.0:
            raise MeasurementError(f"{where}: negative frequency {frequency[0]:g} Hz")
        if frequency[-1] < 1.0 / LARGEST:
            raise MeasurementError(
                f"{where}: the last line of the FRF is at {frequency[-1]:g} Hz; nothing that is "
                f"measured ends below {1.0 / LARGEST:g} Hz"
            )
        if self.quantity not in DERIVATIVE_ORDER:
            raise MeasurementError(
                f"{where}: quantity {self.quantity!r}; allowed are {', '.join(DERIVATIVE_ORDER)}"
            )
        if self.coherence is not None and np.shape(self.coherence) != frequency.shape:
            raise MeasurementError(
                f"{where}: coherence has shape {np.shape(self.coherence)} and frequency "
                f"{frequency.shape}"
            )
        if not (0.0 <= self.added_decay < np.inf):
            raise MeasurementError(f"{where}: added decay {self.added_decay:g} 1/s")
        object.__setattr__(self, "frequency", frequency)
        object.__setattr__(self, "values", values)

    def as_quantity(self, quantity: Quantity) -> Frf:
        """Return the same function as receptance, mobility or accelerance.

        A line at 0 Hz cannot be divided by i omega and is dropped then, save where an exponential
        window moved the function off the imaginary axis: there s = i omega + added_decay.
        """
        order = DERIVATIVE_ORDER[quantity] - DERIVATIVE_ORDER[self.quantity]
        if order == 0:
            return self
        s = self.added_decay + 2j * np.pi * self.frequency
        keep = np.ones(s.size, dtype=bool) if order > 0 else s != 0.0
        coherence = None if self.coherence is None else self.coherence[keep]
        return replace(
            self,
            frequency=self.frequency[keep],
            values=self.values[keep] * s[keep] ** order,
            quantity=quantity,
            coherence=coherence,
        )

    def receptance(self) -> Frf:
        """Return the function as displacement per force, m/N."""
        return self.as_quantity("receptance")

    def band(self, lowest: float, highest: float) -> Frf:
        """Return the lines with lowest <= frequency <= highest, both in Hz."""
        keep = (self.frequency >= lowest) & (self.frequency <= highest)
        coherence = None if self.coherence is None else self.coherence[keep]
        return replace(
            self, frequency=self.frequency[keep], values=self.values[keep], coherence=coherence
        )

    def along_axes(self) -> Frf:
        """Return the function with response and force taken along the positive axes.

        A sensor (or force) against its axis, sign -1 of its `Point`, turns the sign of the values.
        """
        return replace(
            self,
            values=self.values * (self.response.sign * self.reference.sign),
            response=replace(self.response, sign=1),
            reference=replace(self.reference, sign=1),
        )

    @property
    def is_drive_point(self) -> bool:
        """True where force and response share node and direction."""
        return (self.response.node, self.response.direction) == (
            self.reference.node,
            self.reference.direction,
        )


def on_common_lines(frfs: Sequence[Frf]) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Stack FRFs of one quantity on one frequency axis.

    Where the axes differ, the lines of the first FRF inside the range common to all are kept and
    the others are interpolated linearly to them. Lines (n,), Hz, and values (n, k), one column an
    FRF. MeasurementError if the quantities or the decays added by windows differ, or the frequency
    ranges do not overlap.
    """
    if len({frf.added_decay for frf in frfs}) != 1:
        raise MeasurementError("FRFs with different exponential windows cannot be stacked")
    quantities = {frf.quantity for frf in frfs}
    if len(quantities) != 1:
        raise MeasurementError(f"FRFs of different quantities cannot be stacked: {quantities}")
    lowest = max(frf.frequency[0] for frf in frfs)
    highest = min(frf.frequency[-1] for frf in frfs)
    axis = frfs[0].frequency
    axis = axis[(axis >= lowest) & (axis <= highest)]
    if axis.size < 2:
        raise MeasurementError("the FRFs share no frequency range")
    columns = [
        np.interp(axis, frf.frequency, frf.values.real)
        + 1j * np.interp(axis, frf.frequency, frf.values.imag)
        for frf in frfs
    ]
    return axis, np.stack(columns, axis=1)


def without_added_decay(
    frequency: float, damping: float, added_decay: float
) -> tuple[float, float]:
    """Frequency and damping ratio of a mode, freed of the decay an exponential window added.

    From the fitted undamped natural frequency, Hz, the viscous damping ratio and 1 / tau, rad/s
    (`Frf.added_decay`) to those of the structure; damping is negative where the fit fell short of
    the added decay. A window exp(-t / tau) moves each pole from -zeta omega_n +- i omega_d to the
    left by 1 / tau: the damped frequency stays (Fladung and Rost, 1997, "Application and correction
    of the exponential window for frequency response functions").
    """
    natural = 2.0 * np.pi * frequency
    damped_squared = natural**2 * (1.0 - damping**2)
    decay = damping * natural - added_decay
    natural = float(np.sqrt(damped_squared + decay**2))
    return natural / (2.0 * np.pi), decay / natural
