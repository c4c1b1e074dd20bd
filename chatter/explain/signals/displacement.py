"""Displacements against the measured forces through the declared structure: axes, signs, units."""

from __future__ import annotations

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from chatter.explain.measurement import Measurement, Run
from chatter.explain.signals.arrangement import ARRANGEMENTS, own_case
from chatter.explain.signals.finding import FATAL, NOTE, RUN, SignalFinding, of_all_or_some
from chatter.explain.signals.scale import factor_findings
from chatter.structure import structure_of
from dynamics.modal import receptance_matrix

#: share that is left by an arrangement that fits, and of what the declared one leaves
_FITS, _BETTER = 0.45, 0.5
#: tails after the end of a record, in its lengths: what rings on must not come round to the start
_TAIL = 3


def wrong_displacements(measurement: Measurement) -> list[SignalFinding]:
    """Displacements swapped, turned or in a wrong unit."""
    needed = ("Fx", "Fy", "x", "y")
    runs = [run for run in measurement.runs if all(name in run.signals for name in needed)]
    if not runs or measurement.case.structure is None:
        return []
    measured = [np.array([run.signals["x"], run.signals["y"]]) for run in runs]
    expected = [by_forces(measurement, run) for run in runs]
    found: list[SignalFinding] = []
    for row, channel in enumerate(("x", "y")):
        factors = [_rms(m[row]) / _rms(e[row]) for m, e in zip(measured, expected, strict=True)]
        found += factor_findings(measurement, runs, factors, channel)
    if found:
        return found
    singles = []
    left = {one: [] for one in ARRANGEMENTS}
    for run, values, wanted in zip(runs, measured, expected, strict=True):
        errors = {one: _left(one.applied(values), wanted) for one in ARRANGEMENTS}
        for one, error in errors.items():
            left[one].append(error)
        best = min(errors, key=errors.__getitem__)
        if errors[best] < min(_FITS, _BETTER * errors[ARRANGEMENTS[0]]):
            says = f"{run.name}: {best.says(('x', 'y'))}: {_numbers(errors[best], errors)}"
            singles.append(SignalFinding(RUN, run.name, "x, y", says))
    mean = {one: float(np.sqrt(np.mean(np.square(errors)))) for one, errors in left.items()}
    best = min(mean, key=mean.__getitem__)
    if mean[best] < min(_FITS, _BETTER * mean[ARRANGEMENTS[0]]):
        says = f"{best.says(('x', 'y'))}, in all {len(runs)} runs: {_numbers(mean[best], mean)}"
        notes = [SignalFinding(NOTE, one.run, one.channel, one.says) for one in singles]
        return [SignalFinding(FATAL, "", "x, y", says), *notes]
    about = "the displacements of {count} of {runs} runs are swapped or turned"
    return of_all_or_some(singles, measurement, about)


def _numbers(best: float, errors: dict) -> str:
    given = errors[ARRANGEMENTS[0]]
    return (
        f"the measured forces move the declared structure like that up to {100.0 * best:.0f} %, "
        f"as given only up to {100.0 * given:.0f} %"
    )


def by_forces(measurement: Measurement, run: Run) -> NDArray[np.float64]:
    """Displacements (2, n) of the declared structure from rest under the measured forces, m."""
    case = own_case(measurement.case, run)
    time = run.signals["time"]
    step = float(np.median(np.diff(time)))
    size = scipy.fft.next_fast_len(_TAIL * time.size, real=True)
    forces = np.array([run.signals["Fx"], run.signals["Fy"]])
    spectra = scipy.fft.rfft(forces, size, axis=1)
    receptances = receptance_matrix(structure_of(case).modes, scipy.fft.rfftfreq(size, step))
    moved = np.einsum("nij,jn->in", receptances[:, :2, :2], spectra)
    return scipy.fft.irfft(moved, size, axis=1)[:, : time.size]


def _left(values: NDArray[np.float64], wanted: NDArray[np.float64]) -> float:
    """Share that is left of both displacements together, each by its own size."""
    shares = [_rms(a - b) / _rms(b) for a, b in zip(values, wanted, strict=True)]
    return float(np.sqrt(np.mean(np.square(shares))))


def _rms(values: NDArray[np.float64]) -> float:
    return max(float(np.sqrt(np.mean(values**2))), 1e-300)
