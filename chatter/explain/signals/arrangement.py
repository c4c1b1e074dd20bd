"""Forces against the pattern of the declared cut: axes, signs, mode of milling, depths.

The patterns of a tooth passing a rigid cut are linear in the four force coefficients. With these
free, what is left does not hang on coefficients, edge forces or wear that the case has wrong; and
as it is the mean over all teeth, hardly on runout or pitch. What is left by the declared
arrangement is compared with what others leave.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from chatter.case import Case
from chatter.errors import InputError, RunError
from chatter.explain.measurement import Measurement, Run
from chatter.explain.signals.finding import FATAL, RUN, SignalFinding, of_all_or_some
from chatter.explain.signals.spindle import declared_speed, settled
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup

Patterns = NDArray[np.float64]  # (2, bins): x and y

_BINS = 24
#: share that is left by an arrangement that fits, and of what the declared one leaves
_FITS, _BETTER = 0.25, 0.5
#: declared arrangements that leave less than this are not doubted
_DOUBTED = 0.3
_COEFFICIENTS = ("Ktc", "Krc", "Kte", "Kre")
_UNIT = {"Ktc": 1e9, "Krc": 1e9, "Kte": 1e4, "Kre": 1e4}
_NOTHING = {"Ktc": 1e3, "Krc": 0.0, "Kte": 0.0, "Kre": 0.0}
#: sections that a rigid cut of a fresh tool does without
_LEFT_OUT = ("structure", "process_damping", "contact", "wear", "dynamometer")
#: radial depths that are tried, over the declared one
_WIDTHS = (0.4, 0.55, 1.6, 2.2)
#: factors of a run's forces against the others that no effect makes
_GROSS = 2.0


@dataclass(frozen=True)
class Arrangement:
    """How measured channels may really be meant: swapped, then turned."""

    swapped: bool
    signs: tuple[int, int]

    def applied(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rows x and y (2, n) put right."""
        rows = values[::-1] if self.swapped else values
        return rows * np.array(self.signs, dtype=np.float64)[:, None]

    def says(self, names: tuple[str, str]) -> str:
        """What would be wrong, in words."""
        first, second = names
        parts = [f"{first} and {second} are swapped"] if self.swapped else []
        turned = [name for name, sign in zip(names, self.signs, strict=True) if sign < 0]
        if turned:
            parts.append(f"the sign of {' and '.join(turned)} is turned")
        return " and ".join(parts)


ARRANGEMENTS = tuple(
    Arrangement(swapped, signs)
    for swapped in (False, True)
    for signs in itertools.product((1, -1), repeat=2)
)
AS_GIVEN = ARRANGEMENTS[0]


def wrong_arrangement(measurement: Measurement) -> list[SignalFinding]:
    """Force channels swapped or turned, milling in the other mode, depths grossly off."""
    runs = [run for run in measurement.runs if "Fx" in run.signals and "Fy" in run.signals]
    if not runs:
        return []
    measured = [tooth_pattern(measurement, run) for run in runs]
    try:
        return _compared(measurement, runs, measured)
    except (InputError, RunError):
        return []  # a case that cannot be simulated is told where it is used


def _compared(
    measurement: Measurement, runs: Sequence[Run], measured: Sequence[Patterns]
) -> list[SignalFinding]:
    declared = [basis_patterns(own_case(measurement.case, run)) for run in runs]
    coefficients, left = fitted(measured, declared)
    alternatives: dict[str, tuple[Arrangement, list[NDArray]]] = {
        f"{one.says(('Fx', 'Fy'))}": (one, declared) for one in ARRANGEMENTS[1:]
    }
    doubted = left > _DOUBTED
    single = [_left(m, b, coefficients) for m, b in zip(measured, declared, strict=True)]
    if doubted or max(single) > _DOUBTED:
        alternatives |= _other_cuts(measurement.case, runs)
    if doubted:
        tried = {
            says: fitted([one.applied(m) for m in measured], basis)[1]
            for says, (one, basis) in alternatives.items()
        }
        best = min(tried, key=tried.__getitem__)
        if tried[best] < min(_FITS, _BETTER * left):
            text = (
                f"{best}, in all {len(runs)} runs: so the forces fit the cut up to "
                f"{100.0 * tried[best]:.0f} % of their pattern, as declared only up to "
                f"{100.0 * left:.0f} %"
            )
            return [SignalFinding(FATAL, "", "Fx, Fy", text)]
    if doubted or max(single) > _DOUBTED:
        coefficients = of_most_runs(measured, declared)
        single = [_left(m, b, coefficients) for m, b in zip(measured, declared, strict=True)]
    return _single_runs(measurement, runs, measured, declared, alternatives, coefficients, single)


def _single_runs(
    measurement: Measurement,
    runs: Sequence[Run],
    measured: Sequence[Patterns],
    declared: Sequence[NDArray],
    alternatives: Mapping[str, tuple[Arrangement, list[NDArray]]],
    coefficients: NDArray[np.float64],
    single: Sequence[float],
) -> list[SignalFinding]:
    """Runs that fit otherwise than declared, by the coefficients of all runs."""
    found = []
    for place, run in enumerate(runs):
        if single[place] < _DOUBTED:
            continue
        tried = {
            says: _left(one.applied(measured[place]), basis[place], coefficients)
            for says, (one, basis) in alternatives.items()
        }
        best = min(tried, key=tried.__getitem__)
        factor = _factor(measured[place], declared[place], coefficients)
        scaled = _left(measured[place] / max(factor, 1e-9), declared[place], coefficients)
        gross = factor > _GROSS or 0.0 < factor < 1.0 / _GROSS
        if gross and scaled < min(_FITS, _BETTER * single[place], tried[best]):
            says = (
                f"{run.name}: the forces are {factor:.3g} times what the other runs lead to "
                "expect: its axial depth, its feed, or their unit is declared wrong"
            )
        elif tried[best] < min(_FITS, _BETTER * single[place]):
            says = (
                f"{run.name}: {best}: so the forces fit the cut up to {100.0 * tried[best]:.0f} % "
                f"of their pattern, as declared only up to {100.0 * single[place]:.0f} %"
            )
        else:
            continue
        found.append(SignalFinding(RUN, run.name, "Fx, Fy", says))
    about = "the forces of {count} of {runs} runs do not belong to the cut that is declared"
    return of_all_or_some(found, measurement, about)


def _other_cuts(case: Case, runs: Sequence[Run]) -> dict[str, tuple[Arrangement, list[NDArray]]]:
    """Cuts that may have been run instead of the declared ones."""
    owns = [own_case(case, run) for run in runs]
    found = {}
    modes = {own.cut.mode for own in owns}
    if modes <= {"up", "down"}:
        other = [own.patch({"cut.mode": "down" if own.cut.mode == "up" else "up"}) for own in owns]
        says = f"it was {'down' if modes == {'up'} else 'up'}-milling, not {modes.copy().pop()}"
        says = says if len(modes) == 1 else "up- and down-milling are exchanged"
        found[says] = (AS_GIVEN, [basis_patterns(own) for own in other])
        for factor in _WIDTHS:
            wider = [
                own.patch(
                    {"cut.radial_depth": min(factor * own.cut.radial_depth, own.tool.diameter)}
                )
                for own in owns
            ]
            says = f"the radial depth was about {factor:g} times the declared one"
            found[says] = (AS_GIVEN, [basis_patterns(own) for own in wider])
    return found


def tooth_pattern(measurement: Measurement, run: Run) -> Patterns:
    """Mean force over the tooth angle in whole revolutions, (2, bins), N."""
    own = own_case(measurement.case, run)
    speed = declared_speed(measurement, run)
    chosen = settled(run, speed)
    time = run.signals["time"]
    begin = float(run.signals["spindle_angle"][0]) if "spindle_angle" in run.signals else 0.0
    angle = begin + (time[chosen] - time[0]) * speed
    force = np.array([run.signals[name][chosen] for name in ("Fx", "Fy")])
    return _folded(angle, force, own.tool.teeth)


def basis_patterns(case: Case) -> NDArray[np.float64]:
    """Patterns of a unit of each force coefficient in a rigid cut, (4, 2, bins), N."""
    materials = [{"law": "linear", **_NOTHING, key: _UNIT[key]} for key in _COEFFICIENTS]
    return np.array([rigid_pattern(case.patch({"material": one})) for one in materials])


def rigid_pattern(case: Case) -> Patterns:
    """Pattern of a tooth in a rigid cut, (2, bins), N."""
    bare: dict[str, Any] = dict.fromkeys(_LEFT_OUT)
    result, _ = run_setup(set_up(case.patch({**bare, "simulation": {"revolutions": 2}})))
    last = result.spindle_angle >= 2.0 * math.pi - 1e-9
    return _folded(result.spindle_angle[last], result.force[last, :2].T, case.tool.teeth)


def _folded(angle: NDArray[np.float64], force: NDArray[np.float64], teeth: int) -> Patterns:
    place = np.floor(np.mod(angle * teeth / (2.0 * math.pi), 1.0) * _BINS).astype(np.int64)
    place = np.minimum(place, _BINS - 1)
    counts = np.bincount(place, minlength=_BINS)
    sums = np.array([np.bincount(place, weights=row, minlength=_BINS) for row in force])
    means = sums / np.maximum(counts, 1)
    if np.any(counts == 0):
        known = np.flatnonzero(counts)
        means = np.array(
            [np.interp(np.arange(_BINS), known, row[known], period=_BINS) for row in means]
        )
    return means


def fitted(
    measured: Sequence[Patterns], basis: Sequence[NDArray]
) -> tuple[NDArray[np.float64], float]:
    """Coefficients, none negative, that fit all runs, and the share that is left of the patterns.

    Every run counts the same, whatever its forces.
    """
    rows, right = [], []
    for pattern, patterns in zip(measured, basis, strict=True):
        level = max(float(np.sqrt(np.mean(pattern**2))), 1e-300)
        rows.append(patterns.reshape(len(_COEFFICIENTS), -1).T / level)
        right.append(pattern.ravel() / level)
    matrix, wanted = np.concatenate(rows), np.concatenate(right)
    coefficients, left = scipy.optimize.nnls(matrix, wanted)
    return coefficients, float(left / np.sqrt(wanted.size))


def of_most_runs(measured: Sequence[Patterns], basis: Sequence[NDArray]) -> NDArray[np.float64]:
    """Coefficients of the runs without those, a third at the most, that do not go with them."""
    kept = list(range(len(measured)))
    while True:
        coefficients, _ = fitted([measured[k] for k in kept], [basis[k] for k in kept])
        left = {k: _left(measured[k], basis[k], coefficients) for k in kept}
        worst = max(left, key=left.__getitem__)
        if left[worst] < _DOUBTED or 3 * (len(kept) - 1) < 2 * len(measured):
            return coefficients
        kept.remove(worst)


def _left(pattern: Patterns, basis: NDArray, coefficients: NDArray[np.float64]) -> float:
    expected = np.tensordot(coefficients, basis, axes=1)
    level = max(float(np.sqrt(np.mean(pattern**2))), 1e-300)
    return float(np.sqrt(np.mean((pattern - expected) ** 2))) / level


def _factor(pattern: Patterns, basis: NDArray, coefficients: NDArray[np.float64]) -> float:
    expected = np.tensordot(coefficients, basis, axes=1)
    return float(np.sum(pattern * expected) / max(float(np.sum(expected**2)), 1e-300))


def own_case(case: Case, run: Run) -> Case:
    """Case with what is declared for a run."""
    return case.patch(dict(run.overrides)) if run.overrides else case
