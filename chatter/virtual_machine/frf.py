"""FRFs of a machine in its states: linearised, and by tests in time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.result_files import as_json, finite_or_none, write_results
from chatter.virtual_machine.rigid_motion import rigid_motion
from dynamics.frf import Frf
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.laws import FrictionLaw
from dynamics.machine.description import Machine
from dynamics.machine.harmonic import Linearised, at_amplitude, at_rest, at_velocity, receptance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: velocity of a friction, m/s or rad/s, below which it rests
_RESTING = 1e-12
#: stiffness of a dry friction at rest, N/m (N m/rad): it holds, and nothing in a machine is stiffer
_HELD = 1e14
#: a peak is told if it stands out by this factor from the valleys beside it
_STANDS_OUT = 1.15


def linearised_frf(
    machine: Machine,
    step: float,
    frequency: NDArray[np.float64],
    excited: NDArray[np.float64],
    read: NDArray[np.float64],
    velocity: Mapping[str, float] | None = None,
    amplitude: float | None = None,
) -> NDArray[np.complex128]:
    """Receptance (m,) of the linearised machine, its loops closed.

    Parameters
    ----------
    machine : Machine
    step : float
        On which the controllers are sampled, s.
    frequency : (m,) array of float
        Hz.
    excited, read : (n,) array of float
        Rows of the structure.
    velocity : mapping of str to float, optional
        Of axes that move, m/s; frictions that move with them slide, others stick.
    amplitude : float, optional
        Of the motion at every friction that does not slide, m (rad): their describing functions
        instead of their stiffness at rest.
    """
    frictions = linearised_frictions(machine, velocity or {}, amplitude)
    rows = np.array([read, excited])
    return receptance(machine, frequency, rows, step, frictions)[:, 0, 1]


def linearised_frictions(
    machine: Machine, velocity: Mapping[str, float], amplitude: float | None = None
) -> dict[str, Linearised]:
    """How each friction is linearised in a state of motion, by its name."""
    moving = rigid_motion(machine, velocity) if velocity else np.zeros(machine.structure.size)
    resting = _at_rest if amplitude is None else at_amplitude(amplitude)
    return {
        one.name: at_velocity(float(one.row @ moving))
        if abs(one.row @ moving) > _RESTING
        else resting
        for one in machine.frictions
    }


def _at_rest(law: FrictionLaw, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Friction under vanishing motion; a dry one holds."""
    if isinstance(law, CoulombStribeck):
        return np.full(frequency.shape, _HELD, dtype=np.complex128)
    return at_rest(law, frequency)


@dataclass(frozen=True, eq=False)
class FrfCurve:
    """One FRF of a machine.

    Parameters
    ----------
    name : str
    state : str
        In words.
    harmonic : Frf
        Of the linearised machine.
    tested : Frf, optional
        By a test in time.
    """

    name: str
    state: str
    harmonic: Frf
    tested: Frf | None = None

    def as_quantity(self, quantity: str) -> FrfCurve:
        """Same curve as receptance, mobility or accelerance."""
        tested = None if self.tested is None else self.tested.as_quantity(quantity)
        return FrfCurve(self.name, self.state, self.harmonic.as_quantity(quantity), tested)


@dataclass(frozen=True, eq=False)
class FrfResult:
    """FRFs of a machine, by name."""

    machine: str
    curves: Sequence[FrfCurve]

    def __getitem__(self, name: str) -> FrfCurve:
        """Curve of a name."""
        return {curve.name: curve for curve in self.curves}[name]

    def summary(self) -> dict:
        """Peaks of every curve, for people and machines."""
        return {
            "machine": self.machine,
            "curves": [
                {
                    "name": curve.name,
                    "state": curve.state,
                    "quantity": curve.harmonic.quantity,
                    "peaks": peaks(curve.harmonic),
                    "tested_peaks": None if curve.tested is None else peaks(curve.tested),
                }
                for curve in self.curves
            ],
        }

    def plot(self) -> Figure:
        """Picture of all curves."""
        from chatter.plots.frf import plot_frf

        return plot_frf(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write a CSV a curve (and test), frf.png and summary.json."""
        texts = {"summary.json": as_json(self.summary())}
        for curve in self.curves:
            stem = curve.name.replace(" ", "-").replace("/", "-").replace(":", "-")
            texts[f"{stem}.csv"] = as_csv(curve.harmonic)
            if curve.tested is not None:
                texts[f"{stem}-test.csv"] = as_csv(curve.tested)
        return write_results(folder, texts, {"frf.png": self.plot()})


_UNITS = {"receptance": "m/N", "mobility": "m/s/N", "accelerance": "m/s^2/N"}


def as_csv(frf: Frf) -> str:
    """An FRF as the CSV that `chatter modes` reads."""
    unit = _UNITS[frf.quantity]
    columns = [frf.frequency, frf.values.real, frf.values.imag]
    header = f"frequency [Hz],real [{unit}],imag [{unit}]"
    if frf.coherence is not None:
        columns.append(frf.coherence)
        header += ",coherence"
    rows = [",".join(f"{value:.9g}" for value in row) for row in np.column_stack(columns)]
    return "\n".join([header, *rows]) + "\n"


def peaks(frf: Frf) -> list[dict]:
    """Peaks of the magnitude: frequency, height and damping by half power.

    The damping is None where a neighbour hides the flanks.
    """
    height = np.abs(frf.values)
    found = []
    for place in range(1, len(height) - 1):
        if not height[place - 1] < height[place] >= height[place + 1]:
            continue
        left = _valley(height, place, -1)
        right = _valley(height, place, 1)
        if height[place] < _STANDS_OUT * max(height[left], height[right]):
            continue
        top, at = _vertex(frf.frequency, height, place)
        damping = _half_power(frf.frequency, height, place, top, at)
        found.append({"frequency_Hz": at, "magnitude": top, "damping": finite_or_none(damping)})
    return found


def _valley(height: NDArray, place: int, way: int) -> int:
    """Lowest line between a peak and the next higher one on a side."""
    lowest = place
    while 0 <= place + way < len(height) and height[place + way] <= height[lowest] * 1e6:
        place += way
        if height[place] < height[lowest]:
            lowest = place
        elif height[place] > height[lowest] * _STANDS_OUT:
            break
    return lowest


def _vertex(frequency: NDArray, height: NDArray, place: int) -> tuple[float, float]:
    """Height and frequency of the parabola through a peak and its neighbours."""
    f, y = frequency[place - 1 : place + 2], height[place - 1 : place + 2]
    bend, slope, _ = np.polyfit(f - f[1], y, 2)
    if bend >= 0.0:
        return float(y[1]), float(f[1])
    off = -0.5 * slope / bend
    return float(y[1] + 0.5 * slope * off), float(f[1] + off)


def _half_power(frequency: NDArray, height: NDArray, place: int, top: float, at: float) -> float:
    level = top / np.sqrt(2.0)
    sides = []
    for way in (-1, 1):
        line = place
        while 0 < line < len(height) - 1 and height[line] > level:
            if (height[line + way] - height[line]) > 0.0 and line != place:
                return float("nan")
            line += way
        if height[line] > level:
            return float("nan")
        inner = line - way
        share = (height[inner] - level) / (height[inner] - height[line])
        sides.append(frequency[inner] + share * (frequency[line] - frequency[inner]))
    return float((sides[1] - sides[0]) / (2.0 * at))
