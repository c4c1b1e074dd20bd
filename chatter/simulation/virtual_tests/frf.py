"""FRFs of a machine in its states: linearised, and by tests in time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.description.brief_repr import BriefRepr
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, finite_or_none, write_results
from dynamics.frf.container import Frf

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: what makes the unit of a motion that of each quantity, and the unit of what excites
_RATES = {"receptance": "", "mobility": "/s", "accelerance": "/s^2"}
_LOADS = {"force": "N", "torque": "(N*m)"}


@dataclass(frozen=True, eq=False, repr=False)
class FrfCurve(BriefRepr):
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
    notes: tuple[str, ...] = ()  # what the linearised curve assumes

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


@dataclass(frozen=True, eq=False, repr=False)
class FrfResult(BriefRepr, NotebookResult):
    """FRFs of a machine, by name."""

    machine: str
    curves: Sequence[FrfCurve]

    def __getitem__(self, name: str) -> FrfCurve:
        """Curve of a name."""
        return {curve.name: curve for curve in self.curves}[name]

    @property
    def notes(self) -> tuple[str, ...]:
        """What the linearised curves assume, and what is asked about."""
        return tuple(dict.fromkeys(note for curve in self.curves for note in curve.notes))

    def summary(self) -> dict:
        """Peaks of every curve, for people and machines."""
        curves = [curve.summary() for curve in self.curves]
        further = {"notes": list(self.notes)} if self.notes else {}
        return {"machine": self.machine, "curves": curves, **further}

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


#: a peak stands out by this factor, at the least, from the higher of the valleys that part it
#: from higher peaks: a mode of 40 % damping alone does
_STANDS_OUT = 1.05
#: lines around a peak that tell how noisy a test is
_NEIGHBOURS = 41
#: standard deviations by which a peak stands out: noise itself goes up and down by 7 in 2000 lines
_SURE = 10.0
#: the same from the scatter that the coherence tells, which counts single averages
_SURE_OF_COHERENCE = 3.0
#: of the third difference of white noise, over that of the noise itself
_THIRD_DIFFERENCE = np.sqrt(20.0)
#: median of |x| of a normal distribution, over its standard deviation
_MEDIAN = 0.6745


def peaks(frf: Frf) -> list[dict]:
    """Peaks of the magnitude of a smooth curve: frequency, height and damping by half power.

    The damping is None where a neighbour hides the flanks.
    """
    return _peaks(frf, np.full(len(frf.values), np.log(_STANDS_OUT)))


def peaks_of_test(frf: Frf) -> list[dict]:
    """Peaks that stand out from the noise of a test, as `peaks`.

    Noise is found from the roughness of the logarithm around each line, which also shows what is
    the same in every average (friction, motion), and from the coherence.
    """
    wanted = np.maximum(np.log(_STANDS_OUT), _SURE * _roughness(frf))
    if frf.coherence is not None:
        coherence = np.clip(frf.coherence, 1e-12, 1.0)
        # Bendat and Piersol 2010, Random Data, table 9.6, for one average
        scatter = np.sqrt((1.0 - coherence) / (2.0 * coherence))
        wanted = np.maximum(wanted, _SURE_OF_COHERENCE * scatter)
    return _peaks(frf, wanted)


def _peaks(frf: Frf, wanted: NDArray[np.float64]) -> list[dict]:
    """Peaks whose logarithm stands out by what is required at their line."""
    height = np.abs(frf.values)
    level = np.log(np.maximum(height, np.finfo(np.float64).tiny))
    indices, properties = scipy.signal.find_peaks(level, prominence=0.0)
    found = []
    for index in indices[properties["prominences"] >= wanted[indices]]:
        top, at = _vertex(frf.frequency, height, index)
        damping = _half_power(frf.frequency, height, index, top, at)
        found.append({"frequency_Hz": at, "magnitude": top, "damping": finite_or_none(damping)})
    return found


def _roughness(frf: Frf) -> NDArray[np.float64]:
    """Standard deviation of the logarithm of the magnitude about a smooth curve, by line."""
    height = np.abs(frf.values)
    level = np.log(np.maximum(height, np.finfo(np.float64).tiny))
    if len(level) < 5:
        return np.zeros(len(level))
    # cubic trends, such as the flanks of a peak, leave no third difference
    third = np.abs(np.diff(level, 3))
    size = min(_NEIGHBOURS, 2 * (len(third) // 2) - 1)
    around = scipy.ndimage.median_filter(third, size=max(size, 1), mode="nearest")
    return np.pad(around, (1, 2), mode="edge") / (_MEDIAN * _THIRD_DIFFERENCE)


def _vertex(frequency: NDArray, height: NDArray, index: int) -> tuple[float, float]:
    """Height and frequency of the parabola through a peak and its neighbours."""
    f, y = frequency[index - 1 : index + 2], height[index - 1 : index + 2]
    bend, slope, _ = np.polyfit(f - f[1], y, 2)
    if bend >= 0.0:
        return float(y[1]), float(f[1])
    off = -0.5 * slope / bend
    return float(y[1] + 0.5 * slope * off), float(f[1] + off)


def _half_power(frequency: NDArray, height: NDArray, index: int, top: float, at: float) -> float:
    level = top / np.sqrt(2.0)
    sides = []
    for direction in (-1, 1):
        line = index
        while 0 < line < len(height) - 1 and height[line] > level:
            if (height[line + direction] - height[line]) > 0.0 and line != index:
                return float("nan")
            line += direction
        if height[line] > level:
            return float("nan")
        inner = line - direction
        share = (height[inner] - level) / (height[inner] - height[line])
        sides.append(frequency[inner] + share * (frequency[line] - frequency[inner]))
    return float((sides[1] - sides[0]) / (2.0 * at))
