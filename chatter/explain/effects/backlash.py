"""Backlash of a feed axis, or of the drive of an axis of a machine.

Flanks that meet ring, and a gap that is a few percent off rings out of step: the misfit then has a
narrow valley at the true gap, which no step finds from afar. What a gap does slowly, lost motion
and a push that comes late, is there in smoothed records too, and their misfit has one minimum.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import MACHINE_PATH, Case
from chatter.description.machine.machine_file import MachineFile
from chatter.explain.effects.effect import Effect, Patch, Signals, Values, free
from chatter.explain.effects.machine import MOST_AXES
from chatter.explain.kinds.drive import Drive
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter
from chatter.explain.prediction import Predictions

#: gaps that are tried, m
_GAPS = (3e-6, 1e-5, 3e-5, 1e-4)
#: of a gap, m
_SIZE, _LARGEST = 5e-6, 1e-3
#: kinds of drives whose flanks may have a gap
_WITH_FLANKS = ("ball screw", "screw on beam", "rack and pinion")
#: gaps of a machine that are tried in smoothed records, m, and the share of the misfit that the
#: best must take away there
_LOOKED_AT, _LEAST_GAIN = 1e-6 * 2.0 ** np.arange(9), 0.02
#: smoothing of records, s, and gaps about the best of the one before, over it
_SMOOTHED = (
    (0.03, np.geomspace(0.6, 1.6, 9)),
    (0.01, np.linspace(0.86, 1.14, 9)),
    (0.0, np.linspace(0.96, 1.04, 9)),
    (0.0, np.linspace(0.9925, 1.0075, 7)),
)


class Backlash(Effect):
    """Gap of the drive, and the mass of its motor where the motion of both sides is known."""

    name = "backlash"
    label = "backlash"
    help = "the motor crosses a gap at every reversal"
    kinds = ("axis", "drive")
    section = "axis"
    declared = "axis.backlash"

    @property
    def variants(self) -> tuple[Effect, ...]:
        """Of an axis by itself, and of each axis of a machine."""
        return (self, *(DriveBacklash(number) for number in range(MOST_AXES)))

    def applies(self, measurement: Measurement) -> bool:
        """Of an axis by itself that has none declared."""
        return not measurement.case.on_machine and super().applies(measurement)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """The gap, and the mass of the motor."""
        gap = free("backlash", 2e-5, _SIZE, "m", lower=0.0, upper=_LARGEST)
        if not any("backlash" in run.signals for run in measurement.runs):
            return [gap]
        mass = measurement.case.axis.moving_mass
        return [gap, free("motor_mass", 0.2 * mass, 0.05 * mass, "kg", lower=0.0, upper=mass)]

    def nothing(self, measurement: Measurement) -> Values:
        """No gap."""
        return {"backlash": 0.0}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Gaps from small to large."""
        return [{"backlash": gap} for gap in _GAPS]


class DriveBacklash(Effect):
    """Gap between the flanks of the drive of an axis of a machine."""

    name = "backlash"
    label = "backlash"
    help = Backlash.help
    kinds = ("drive",)

    def __init__(self, number: int = 0) -> None:
        self.number = number

    def applies(self, measurement: Measurement) -> bool:
        """Of a machine with so many axes that move in the records and have none declared."""
        return measurement.case.on_machine and self.number < len(_axes(measurement))

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """The gap, named by the axis."""
        axis = _axes(measurement)[self.number]
        return [free(f"backlash_{axis}", 0.0, _SIZE, "m", lower=0.0, upper=_LARGEST)]

    def starts(self, measurement: Measurement) -> list[Values]:
        """None: the residual proposes the gap."""
        return []

    def proposed(self, measurement: Measurement, predicted: Mapping[str, Signals]) -> list[Values]:
        """Gap of the least misfit of smoothed records, and then of those as they are."""
        if not predicted:
            return []
        (one,) = self.parameters(measurement)
        trial = _TrialGaps(self, one.name, measurement, predicted)
        window, _ = _SMOOTHED[0]
        gap, misfit = trial.best(_LOOKED_AT, window)
        if misfit > (1.0 - _LEAST_GAIN) * trial.misfit(0.0, window):
            return []
        for window, about in _SMOOTHED:
            gap, _ = trial.best(gap * about, window)
        return [{one.name: gap}]

    def patch(self, case: Case, values: Values) -> Patch:
        """Backlash of the drive."""
        del case
        ((name, gap),) = values.items()
        axis = name.removeprefix("backlash_")
        return {f"{MACHINE_PATH}axis.{axis}.drive.backlash": float(gap)}


@dataclass(frozen=True, eq=False)
class _TrialGaps:
    """Misfits of records by what a gap changes in the prediction of the declared case."""

    effect: DriveBacklash
    name: str  # of the gap
    measurement: Measurement
    predicted: Mapping[str, Signals]  # by run, without a gap
    predictions: Predictions = field(default_factory=lambda: Predictions(Drive()))

    def best(self, gaps: Iterable[float], window: float) -> tuple[float, float]:
        """Gap, m, of the least misfit of records smoothed over a window, s, and that misfit."""
        misfit, gap = min((self.misfit(float(gap), window), float(gap)) for gap in gaps)
        return gap, misfit

    def misfit(self, gap: float, window: float) -> float:
        """Sum over channels of the squares of residuals over those without a gap."""
        left: dict[str, float] = {}
        all_of: dict[str, float] = {}
        for run in self.measurement.runs:
            for channel, change in self._changes(run, gap).items():
                residual = run.signals[channel] - self.predicted[run.name][channel]
                weight = run.weight(channel)
                before, after = (
                    float(np.sum((weight * _smoothed(part, window / run.step)) ** 2))
                    for part in (residual, residual - change)
                )
                all_of[channel] = all_of.get(channel, 0.0) + before
                left[channel] = left.get(channel, 0.0) + after
        return sum(left[channel] / all_of[channel] for channel in left if all_of[channel] > 0.0)

    def _changes(self, run: Run, gap: float) -> Signals:
        """What a gap adds to each channel of a run."""
        case = self.measurement.case
        without = self.predictions.of(case, run)
        changed = case.patch(self.effect.patch(case, {self.name: gap}))
        found = self.predictions.of(changed, run) if gap > 0.0 else without
        return {channel: found[channel] - values for channel, values in without.items()}


def _smoothed(values: NDArray[np.float64], samples: float) -> NDArray[np.float64]:
    """Values (n,) weighted over some samples about each by a Hann window."""
    width = round(samples)
    if width < 2:
        return values
    window = np.hanning(width + 2)[1:-1]
    return np.convolve(values, window / np.sum(window), "same")


def _axes(measurement: Measurement) -> list[str]:
    """Axes under control that the records move, whose drives have flanks and no gap declared."""
    file: MachineFile = measurement.case.machine_file()
    moved = {run.axis for run in measurement.runs if run.kind in ("", "drive")}
    return [
        name
        for name, axis in file.axis.items()
        if axis.control is not None
        and axis.drive is not None
        and axis.drive.kind in _WITH_FLANKS
        and not axis.drive.backlash
        and (name in moved or "" in moved)
    ]
