"""Delay between the channels of force and response of FRFs.

Power flows into a passive structure at a drive point, so that the imaginary part of a receptance
is nowhere above zero. A delay of the measuring chain turns the phase in proportion to the
frequency and breaks this. The residues of a structure without such a delay may well be a little
complex, so that a delay is believed only where power flows out, or where drive points along
several axes, which are complex in ways of their own, have the same.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.compile.measured_frf import is_passive
from chatter.explain.data_checks.finding import NOTE, SignalFinding
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.response_scatter import repetitions_of, scatter
from dynamics.frf.container import Frf, MeasurementError
from dynamics.identification.fit import delay_between_channels

_AXES = "xyz"
#: directions of drive points, as they may be given
_ALONG = (*_AXES, *(2 * axis for axis in _AXES))
#: axes along which a delay has to be the same
_SEVERAL = 2
#: lines over which the imaginary part is averaged
_LINES = 31
#: averages above zero in their standard deviations, and over the response as a phase, rad
_BEYOND_SCATTER, _LEAST_PHASE = 6.0, 0.02
#: share of what is above zero that may remain without the delay
_REMAINS = 0.25
#: share of a delay up to which the delays of drive points differ from it, and least phase, rad,
#: that it makes at the highest line
_AGREES, _LEAST_TURN = 0.2, 0.05
#: share of the summed imaginary part above zero from which the sign is wrong, not the delay
_SIGN_TURNED = 0.9


@dataclass(frozen=True, eq=False)
class _DrivePoint:
    """Receptance (n,), m/N, of a drive point at frequencies (n,), Hz, with its scatter (n,)."""

    frequency: NDArray[np.float64]
    values: NDArray[np.complex128]
    scatter: NDArray[np.float64]

    def above(self, delay: float = 0.0) -> NDArray[np.float64]:
        """Averages of the imaginary part above zero without a delay, s, in their deviations."""
        turned = _advanced(self.values, self.frequency, delay).imag
        mean, size = _averaged(turned), _averaged(np.abs(self.values))
        deviation = np.sqrt(_averaged(self.scatter**2) / min(_LINES, self.values.size))
        least = np.maximum(_BEYOND_SCATTER * deviation, _LEAST_PHASE * size)
        return np.where(mean > least, mean / np.maximum(deviation, 1e-300), 0.0)

    def is_broken(self) -> bool:
        """Whether power flows out at some lines, and the sign is right."""
        imaginary = self.values.imag
        turned = np.sum(np.maximum(imaginary, 0.0)) > _SIGN_TURNED * np.sum(np.abs(imaginary))
        return bool(np.any(self.above()) and not turned)

    @property
    def frf(self) -> Frf:
        """Lines above 0 Hz."""
        return _frf(self.frequency, self.values)

    def lines(self) -> NDArray[np.float64]:
        """Frequencies, Hz, at which power flows out."""
        return _averaged(self.frequency)[self.above() > 0.0]


def without_delay(measurement: Measurement) -> tuple[Measurement, list[SignalFinding]]:
    """Take the delay of the response channels off, where the drive points of several axes agree.

    Then by axis, where power flows out of a drive point.

    A machine is left as it was measured: its control may well give power.
    """
    if measurement.case.on_machine:
        return measurement, []
    runs, notes = list(measurement.runs), []
    shared = _shared_delay(runs)
    if shared:
        notes.append(SignalFinding(NOTE, "", "real, imag", _sentence_of_shared(shared)))
        runs = [_without(run, shared) if run.direction[-1:] in _AXES else run for run in runs]
    for axis in _AXES:
        read = [run for run in runs if run.direction[:1] == axis and run.direction[-1] in _AXES]
        drives = [_drive_point(run, read) for run in read if set(run.direction) == {axis}]
        broken = [one for one in drives if one.is_broken()]
        if 2 * len(broken) <= len(drives):
            continue
        delay = _common_delay(broken)
        if not delay and all(is_passive(one.frf) for one in broken):
            # between resonances of little damping a small error of phase is enough
            continue
        notes.append(SignalFinding(NOTE, "", "real, imag", _sentence(axis, broken, delay)))
        runs = [_without(run, delay) if run in read else run for run in runs]
    return measurement.with_runs(runs), notes


def _drive_point(run: Run, read: Sequence[Run]) -> _DrivePoint:
    own = scatter(run, repetitions_of(run, read))
    return _DrivePoint(run.signals["frequency"], _receptance(run), own)


def _receptance(run: Run) -> NDArray[np.complex128]:
    return run.signals["real"] + 1j * run.signals["imag"]


def _frf(frequency: NDArray[np.float64], values: NDArray[np.complex128]) -> Frf:
    """Lines above 0 Hz."""
    positive = frequency > 0.0
    return Frf(frequency[positive], values[positive])


def _shared_delay(runs: Sequence[Run]) -> float:
    """Delay, s, that drive points along several axes share; 0 where there is none."""
    found: dict[str, list[float]] = {}
    for run in runs:
        if run.direction in _ALONG:
            frf = _frf(run.signals["frequency"], _receptance(run))
            found.setdefault(f"{run.direction[0]} {run.condition}", []).append(_delay(frf))
    if len({key[0] for key in found}) < _SEVERAL:
        return 0.0
    each = np.array([np.median(one) for one in found.values()])
    delay = float(np.median(each))
    highest = max(float(run.signals["frequency"].max()) for run in runs)
    agrees = bool(np.all(np.abs(each - delay) <= _AGREES * abs(delay)))
    return delay if agrees and 2.0 * np.pi * highest * abs(delay) > _LEAST_TURN else 0.0


def _common_delay(drives: Sequence[_DrivePoint]) -> float:
    """Median of the delays of FRFs, s; 0 where it does not make them passive."""
    found = [_delay(one.frf) for one in drives]
    delay = float(np.median(found))
    remains, all_of_it = (
        sum(float(np.sum(one.above(at) ** 2)) for one in drives) for at in (delay, 0.0)
    )
    return delay if remains < _REMAINS * all_of_it else 0.0


def _delay(frf: Frf) -> float:
    try:
        return delay_between_channels(frf)
    except MeasurementError:
        return 0.0


def _sentence_of_shared(delay: float) -> str:
    return (
        f"drive points along several axes have the same delay: the response {_lags(delay)}; this "
        "was taken off"
    )


def _lags(delay: float) -> str:
    return f"{'lags' if delay > 0.0 else 'leads'} the force by {abs(delay) * 1e6:.1f} us"


def _sentence(axis: str, drives: Sequence[_DrivePoint], delay: float) -> str:
    lines = np.concatenate([one.lines() for one in drives])
    where = f"between {lines.min():.0f} and {lines.max():.0f} Hz"
    about = (
        f"the imaginary part of the FRFs in {axis} is above zero {where}, where a passive drive "
        "point takes up power"
    )
    if delay:
        return f"{about}: the response {_lags(delay)}; this was taken off"
    return f"{about}, and no delay accounts for it: were force and response at the same point?"


def _without(run: Run, delay: float) -> Run:
    if not delay:
        return run
    turned = _advanced(_receptance(run), run.signals["frequency"], delay)
    return replace(run, signals={**run.signals, "real": turned.real, "imag": turned.imag})


def _advanced(
    values: NDArray[np.complex128], frequency: NDArray[np.float64], delay: float
) -> NDArray[np.complex128]:
    return values * np.exp(2j * np.pi * frequency * delay)


def _averaged(values: NDArray[np.float64]) -> NDArray[np.float64]:
    count = min(_LINES, values.size)
    return np.convolve(values, np.full(count, 1.0 / count), mode="valid")
