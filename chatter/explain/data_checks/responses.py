"""FRFs: units, quantity, sign and directions against the declared structure; repetitions."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.compile.structure import structure_of
from chatter.description.formatting import to_digits
from chatter.explain.data_checks.finding import FATAL, NOTE, RUN, SignalFinding, of_all_or_some
from chatter.explain.data_checks.scale import thousand
from chatter.explain.measurement import Measurement, Run
from dynamics.modal.modes import receptance_matrix

Response = NDArray[np.complex128]

_AXES = "xyz"
#: shares by which natural frequencies may be off the declared ones
_SHIFTS = np.linspace(-0.06, 0.06, 25)
#: correlation of what fits, and most of what does not
_FITS, _MISFIT = 0.9, 0.6
#: share by which one FRF may differ from others alike, and over their own scatter
_DIFFERS, _BEYOND = 0.3, 4.0
#: what may have been measured in the place of a receptance -> what makes it one, of i omega
_QUANTITIES = {"a mobility": -1, "an accelerance": -2}


def wrong_responses(measurement: Measurement) -> list[SignalFinding]:
    """FRFs in another unit, of another quantity, turned, or of exchanged directions."""
    runs = [run for run in measurement.runs if _is_whole(run)]
    if measurement.case.structure is None or not runs:
        return []
    if measurement.case.on_machine:
        # at rest, moving and in the cut a machine is another structure each
        return []
    found = []
    for run in runs:
        description = _single(measurement, run)
        if description:
            found.append(SignalFinding(RUN, run.name, "real, imag", f"{run.name}: {description}"))
    about = "the FRFs do not go with the declared structure in {count} of {runs} runs"
    if found:
        about += f"; {found[0].description}"
        return of_all_or_some(found, measurement, about)
    return _exchanged(measurement, runs)


def _is_whole(run: Run) -> bool:
    return (
        all(name in run.signals for name in ("frequency", "real", "imag"))
        and len(run.direction) in (1, 2)
        and all(axis in _AXES for axis in run.direction)
        and run.signals["frequency"].size > 8
    )


def _measured(run: Run) -> Response:
    return run.signals["real"] + 1j * run.signals["imag"]


def _declared(measurement: Measurement, run: Run, direction: str, shift: float = 0.0) -> Response:
    frequency = run.signals["frequency"] / (1.0 + shift)
    matrix = receptance_matrix(structure_of(measurement.case).modes, frequency)
    return matrix[:, _AXES.index(direction[0]), _AXES.index(direction[-1])]


def _single(measurement: Measurement, run: Run) -> str:
    values = _measured(run)
    declared = _declared(measurement, run, run.direction)
    if not np.any(declared):
        return ""
    factor = float(np.exp(np.median(np.log(np.abs(values) + 1e-300) - np.log(np.abs(declared)))))
    as_given = _fit(measurement, run, values, run.direction)
    if as_given < _MISFIT:
        omega = 2.0 * np.pi * run.signals["frequency"]
        for name, order in _QUANTITIES.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                tried = np.where(omega > 0.0, values * (1j * omega) ** order, 0.0)
            if _fit(measurement, run, tried, run.direction) > _FITS:
                return f"it is {name}, not a receptance"
    if as_given < -_FITS:
        return "its sign is turned: the tool would move against the force"
    if thousand(factor):
        return f"it is {factor:.3g} times the declared one: its unit is wrong by 1000"
    return ""


def _fit(measurement: Measurement, run: Run, values: Response, direction: str) -> float:
    """Correlation with the declared receptance whose frequencies are a little off, -1 to 1."""
    found = []
    for shift in _SHIFTS:
        declared = _declared(measurement, run, direction, float(shift))
        norm = np.linalg.norm(values) * np.linalg.norm(declared)
        found.append(float(np.vdot(declared, values).real) / max(norm, 1e-300))
    return max(found, key=abs)


def _exchanged(measurement: Measurement, runs: Sequence[Run]) -> list[SignalFinding]:
    """Directions x and y exchanged in idle FRFs."""
    idle = [run for run in runs if run.condition in ("", "idle") and run.direction in ("x", "y")]
    if {run.direction for run in idle} != {"x", "y"}:
        return []
    other = {"x": "y", "y": "x"}
    given = [_fit(measurement, run, _measured(run), run.direction) for run in idle]
    exchanged = [_fit(measurement, run, _measured(run), other[run.direction]) for run in idle]
    if min(exchanged) > _FITS and max(given) < _MISFIT + 0.25 < min(exchanged):
        gain = (1.0 - np.mean(exchanged)) / max(1.0 - np.mean(given), 1e-9)
        if gain < 0.4:
            description = (
                "the directions x and y of the FRFs are exchanged: so they correlate with the "
                f"declared structure by {np.mean(exchanged):.2f}, as labelled by "
                f"{np.mean(given):.2f}"
            )
            return [SignalFinding(FATAL, "", "real, imag", description)]
    return []


def disagreeing_responses(measurement: Measurement) -> list[SignalFinding]:
    """FRFs that differ from the others of their condition and direction."""
    runs = [run for run in measurement.runs if _is_whole(run)]
    found = []
    for condition, direction in sorted({(run.condition, run.direction) for run in runs}):
        alike = [run for run in runs if (run.condition, run.direction) == (condition, direction)]
        lengths = {run.signals["frequency"].size for run in alike}
        if len(alike) < 2 or len(lengths) != 1:
            continue
        values = np.array([_measured(run) for run in alike])
        what = f'"{condition}" in {direction}' if condition else f"in {direction}"
        if len(alike) == 2:
            apart = float(np.linalg.norm(values[0] - values[1]) / np.linalg.norm(values[0]))
            if apart > 2.0 * _DIFFERS:
                description = (
                    f"the two FRFs {what} differ by {100.0 * apart:.0f} %: which is right?"
                )
                found.append(SignalFinding(NOTE, "", "real, imag", description))
            continue
        middle = np.median(values.real, axis=0) + 1j * np.median(values.imag, axis=0)
        apart = np.linalg.norm(values - middle, axis=1) / np.linalg.norm(middle)
        for index, run in enumerate(alike):
            others = float(np.median(np.delete(apart, index)))
            if apart[index] > max(_DIFFERS, _BEYOND * others):
                description = (
                    f"{run.name}: differs from the other FRFs {what} by "
                    f"{100.0 * apart[index]:.0f} %, they among each other by "
                    f"{to_digits(100.0 * others)} %"
                )
                found.append(SignalFinding(RUN, run.name, "real, imag", description))
    return found
