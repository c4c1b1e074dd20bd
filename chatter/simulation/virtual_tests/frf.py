"""FRFs of a machine in its states: linearised, and by tests in time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from chatter.compile.rigid_motion import rigid_motion
from chatter.io.presentation import presentation
from chatter.io.result_files import as_json, write_results
from chatter.simulation.virtual_tests.frf_peaks import peaks, peaks_of_test
from dynamics.frf.container import Frf
from dynamics.machine.description import Machine
from dynamics.machine.harmonic import Linearised, at_amplitude, at_rest, at_velocity, receptance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: velocity of a friction, m/s or rad/s, below which it rests
_RESTING = 1e-12
#: what makes the unit of a motion that of each quantity, and the unit of what excites
_RATES = {"receptance": "", "mobility": "/s", "accelerance": "/s^2"}
_LOADS = {"force": "N", "torque": "(N*m)"}


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
    machine: Machine,
    velocity: Mapping[str, float],
    amplitude: float | Mapping[str, float] | None = None,
) -> dict[str, Linearised]:
    """How each friction is linearised in a state of motion, by its name.

    Parameters
    ----------
    machine : Machine
    velocity : mapping of str to float
        Of axes that move, m/s.
    amplitude : float or mapping of str to float, optional
        Of the motion at frictions that do not slide, m (rad): at all, or by their names; at those
        without one it vanishes.
    """
    moving = rigid_motion(machine, velocity) if velocity else np.zeros(machine.structure.size)
    return {
        one.name: at_velocity(float(one.row @ moving))
        if abs(one.row @ moving) > _RESTING
        else _resting(one.name, amplitude)
        for one in machine.frictions
    }


def _resting(name: str, amplitude: float | Mapping[str, float] | None) -> Linearised:
    here = amplitude.get(name) if isinstance(amplitude, Mapping) else amplitude
    return at_rest if here is None else at_amplitude(here)


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
    excited : {"force", "torque"}
    read : {"displacement", "rotation"}
    """

    name: str
    state: str
    harmonic: Frf
    tested: Frf | None = None
    excited: Literal["force", "torque"] = "force"
    read: Literal["displacement", "rotation"] = "displacement"

    @property
    def unit(self) -> str:
        """SI unit of the values."""
        motion = {"displacement": "m", "rotation": "rad"}[self.read] + _RATES[
            self.harmonic.quantity
        ]
        # the spelling of measured files: a/b/c, and brackets around a product
        return f"{motion}/{_LOADS[self.excited]}"

    def as_quantity(self, quantity: str) -> FrfCurve:
        """Same curve as receptance, mobility or accelerance."""
        tested = None if self.tested is None else self.tested.as_quantity(quantity)
        return replace(self, harmonic=self.harmonic.as_quantity(quantity), tested=tested)

    def summary(self) -> dict:
        """Peaks, and the largest value where there are none."""
        height = np.abs(self.harmonic.values)
        largest = int(np.argmax(height))
        return {
            "name": self.name,
            "state": self.state,
            "quantity": self.harmonic.quantity,
            "unit": self.unit,
            "band_Hz": [float(self.harmonic.frequency[0]), float(self.harmonic.frequency[-1])],
            "largest": {
                "frequency_Hz": float(self.harmonic.frequency[largest]),
                "magnitude": float(height[largest]),
            },
            "peaks": peaks(self.harmonic),
            "tested_peaks": None if self.tested is None else peaks_of_test(self.tested),
        }


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
            "curves": [curve.summary() for curve in self.curves],
        }

    def plot(self) -> Figure:
        """Picture of all curves."""
        return presentation("plots.frf").plot_frf(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write a CSV a curve (and test), frf.png and summary.json."""
        texts = {"summary.json": as_json(self.summary())}
        for curve in self.curves:
            stem = curve.name.replace(" ", "-").replace("/", "-").replace(":", "-")
            texts[f"{stem}.csv"] = as_csv(curve.harmonic, curve.unit)
            if curve.tested is not None:
                texts[f"{stem}-test.csv"] = as_csv(curve.tested, curve.unit)
        return write_results(folder, texts, {"frf.png": self.plot()})


def as_csv(frf: Frf, unit: str) -> str:
    """An FRF in a unit as the CSV that `chatter modes` reads."""
    columns = [frf.frequency, frf.values.real, frf.values.imag]
    header = f"frequency [Hz],real [{unit}],imag [{unit}]"
    if frf.coherence is not None:
        columns.append(frf.coherence)
        header += ",coherence"
    rows = [",".join(f"{value:.9g}" for value in row) for row in np.column_stack(columns)]
    return "\n".join([header, *rows]) + "\n"
