"""Displacements against the measured forces through the declared structure: axes, signs, units."""

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.compile.structure import structure_of
from chatter.explain.data_checks.channel_assignment import ASSIGNMENTS, ChannelAssignment
from chatter.explain.data_checks.finding import FATAL, NOTE, RUN, SignalFinding, of_all_or_some
from chatter.explain.data_checks.scale import factor_findings
from chatter.explain.measurement import Measurement, Run
from dynamics.modal.modes import receptance_matrix

#: residual share of a channel that fits, of one that a missing mode spoils, and over that of the
#: declared channel assignment
_FITS, _PASSES, _BETTER = 0.35, 0.8, 0.5
#: residual share of a channel that fits so well that the other one need only gain
_WELL = 0.2
#: tails after the end of a record, in its lengths: what rings on must not come round to the start
_TAIL = 3


def wrong_displacements(measurement: Measurement) -> list[SignalFinding]:
    """Displacements swapped, turned or in a wrong unit."""
    needed = ("Fx", "Fy", "x", "y")
    # what a record from the middle of a cut begins with is not at rest
    runs = [
        run
        for run in measurement.runs
        if run.record is None and all(name in run.signals for name in needed)
    ]
    structure = measurement.case.structure
    # on a machine the displacement holds the motion of its axes, which no receptance gives
    if not runs or structure is None or structure.machine is not None:
        return []
    measured = [np.array([run.signals["x"], run.signals["y"]]) for run in runs]
    expected = [by_forces(measurement, run) for run in runs]
    found: list[SignalFinding] = []
    for row, channel in enumerate(("x", "y")):
        factors = [_rms(m[row]) / _rms(e[row]) for m, e in zip(measured, expected, strict=True)]
        found += factor_findings(measurement, runs, factors, channel)
    if found:
        return found
    by_run = [
        {one: _residual_shares(one.applied(values), wanted) for one in ASSIGNMENTS}
        for values, wanted in zip(measured, expected, strict=True)
    ]
    of_all = {
        one: np.sqrt(np.mean([errors[one] ** 2 for errors in by_run], axis=0))
        for one in ASSIGNMENTS
    }
    singles = [
        SignalFinding(RUN, run.name, "x, y", f"{run.name}: {description}")
        for run, errors in zip(runs, by_run, strict=True)
        if (description := _better(errors))
    ]
    if description := _better(of_all):
        notes = [SignalFinding(NOTE, one.run, one.channel, one.description) for one in singles]
        return [
            SignalFinding(FATAL, "", "x, y", f"{description}, over all {len(runs)} runs"),
            *notes,
        ]
    about = "the displacements of {count} of {runs} runs are swapped or turned"
    return of_all_or_some(singles, measurement, about)


def _better(errors: dict[ChannelAssignment, NDArray[np.float64]]) -> str:
    """ChannelAssignment that fits much better than the one given, in words; empty for none.

    A mode that the case lacks spoils a channel. One must fit well, the other not badly, and each
    that would change must fit much better than it does now.
    """
    given = errors[ASSIGNMENTS[0]]
    best = min(ASSIGNMENTS, key=lambda one: float(np.sum(np.minimum(errors[one], 2.0))))
    found = errors[best]
    changes = np.array([best.swapped or sign < 0 for sign in best.signs])
    if not changes.any() or found.min() > _FITS:
        return ""
    better = found < _BETTER * given
    well = changes & better & (found < _WELL)
    passes = better & (found < _PASSES) | (well.any() & (found <= given))
    if not np.all(passes[changes]):
        return ""
    return (
        f"{best.fault(('x', 'y'))}: the measured forces move the declared structure like that but "
        f"for {100.0 * found[0]:.0f} % of x and {100.0 * found[1]:.0f} % of y, as given but for "
        f"{100.0 * given[0]:.0f} % and {100.0 * given[1]:.0f} %"
    )


def by_forces(measurement: Measurement, run: Run) -> NDArray[np.float64]:
    """Displacements (2, n) of the declared structure from rest under the measured forces, m."""
    case = run.of(measurement.case)
    time = run.signals["time"]
    step = float(np.median(np.diff(time)))
    size = scipy.fft.next_fast_len(_TAIL * time.size, real=True)
    forces = np.array([run.signals["Fx"], run.signals["Fy"]])
    spectra = scipy.fft.rfft(forces, size, axis=1)
    receptances = receptance_matrix(structure_of(case).modes, scipy.fft.rfftfreq(size, step))
    moved = np.einsum("nij,jn->in", receptances[:, :2, :2], spectra)
    return scipy.fft.irfft(moved, size, axis=1)[:, : time.size]


def _residual_shares(
    values: NDArray[np.float64], wanted: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Residuals (2,) of both displacements as shares of them."""
    return np.array([_rms(a - b) / _rms(b) for a, b in zip(values, wanted, strict=True)])


def _rms(values: NDArray[np.float64]) -> float:
    return max(float(np.sqrt(np.mean(values**2))), 1e-300)
