"""FRFs of a machine in its states: linearised, and by tests in time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from chatter.io.presentation import presentation
from chatter.io.result_files import as_json, write_results
from chatter.simulation.virtual_tests.frf_peaks import peaks, peaks_of_test
from dynamics.frf.container import Frf

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: what makes the unit of a motion that of each quantity, and the unit of what excites
_RATES = {"receptance": "", "mobility": "/s", "accelerance": "/s^2"}
_LOADS = {"force": "N", "torque": "(N*m)"}


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
