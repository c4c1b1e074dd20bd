"""Forces against the pattern of the declared cut: axes, signs, teeth, mode of milling, depths.

The residual of the cut as declared is compared with that of others; another is reported only if
it fits well in itself and much better.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.explain.data_checks.finding import FATAL, NOTE, RUN, SignalFinding, of_all_or_some
from chatter.explain.data_checks.patterns import (
    Patterns,
    basis_patterns,
    factor_of,
    fitted,
    force_power,
    of_most_runs,
    residual_share,
    tooth_pattern,
)
from chatter.explain.measurement import Measurement, Run

#: residual, as a share, of a cut that fits, and over that of the declared one
_FITS, _BETTER = 0.25, 0.5
#: residual over that of the declared teeth below which a multiple of them counts: a multiple always
#: holds less of the forces, unless it is right
_CLEARER = 0.8
#: residual, as a share, below which the declared cut is not doubted
_DOUBTED = 0.3
#: radial depths and teeth that are tried, the former over the declared one
_WIDTHS = (0.4, 0.55, 1.6, 2.2)
_TEETH = range(1, 9)
#: factor of a run's forces against the others that no effect makes
_GROSS = 2.0
_TURNED = {"up": "down", "down": "up"}


@dataclass(frozen=True)
class ChannelAssignment:
    """How measured channels may really be meant: swapped, then turned."""

    swapped: bool
    signs: tuple[int, int]

    def applied(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rows x and y (2, n) put right."""
        rows = values[::-1] if self.swapped else values
        return rows * np.array(self.signs, dtype=np.float64)[:, None]

    def fault(self, names: tuple[str, str]) -> str:
        """What would be wrong, in words."""
        parts = [f"{names[0]} and {names[1]} are swapped"] if self.swapped else []
        turned = [name for name, sign in zip(names, self.signs, strict=True) if sign < 0]
        if turned:
            parts.append(f"the sign of {' and '.join(turned)} is turned")
        return " and ".join(parts)


ASSIGNMENTS = tuple(
    ChannelAssignment(swapped, signs)
    for swapped in (False, True)
    for signs in itertools.product((1, -1), repeat=2)
)


@dataclass(frozen=True, eq=False)
class Cut:
    """What may have been cut and measured: patterns of every run, and of each coefficient."""

    description: str
    measured: list[Patterns]  # list of (2, bins) array of float
    basis: list[NDArray[np.float64]]  # list of (4, 2, bins) array of float
    power_share: list[float]  # share of the forces' power that is in the measured pattern

    def of_all(self, share: float, runs: Sequence[int] | None = None) -> float:
        """Residual share of the forces as a whole, from that of the pattern."""
        power_share = float(
            np.mean([self.power_share[k] for k in runs or range(len(self.power_share))])
        )
        return float(np.sqrt(max(0.0, 1.0 - power_share + share**2 * power_share)))


def wrong_assignment(measurement: Measurement) -> list[SignalFinding]:
    """Force channels swapped or turned, another tool or mode of milling, depths grossly off."""
    runs = [run for run in measurement.runs if "Fx" in run.signals and "Fy" in run.signals]
    cut = measurement.case.cut
    # the pattern is one over the angle, which a varying speed does not turn evenly
    if cut is not None and cut.speed_variation is not None:
        return []
    try:
        return _compared(measurement, runs) if runs else []
    except (InputError, RunError):
        return []  # a case that cannot be simulated is reported where it is used


def _compared(measurement: Measurement, runs: Sequence[Run]) -> list[SignalFinding]:
    declared = _cut("", measurement, runs)
    coefficients, share = fitted(declared.measured, declared.basis)
    if max([share, *_shares(declared, coefficients)]) < _DOUBTED:
        return _multiple(declared, share, measurement, runs)
    others = _others(declared, measurement, runs)
    if share > _DOUBTED:
        tried = [(fitted(cut.measured, cut.basis)[1], cut) for cut in others]
        good = [(cut.of_all(one), one, cut) for one, cut in tried if one < _FITS]
        _, best, cut = min(good, key=lambda entry: entry[0], default=(0.0, share, declared))
        if best < _BETTER * share:
            description = f"{cut.description}: {_numbers(best, share)}"
            return [SignalFinding(FATAL, "", "Fx, Fy", description)]
    coefficients = of_most_runs(declared.measured, declared.basis)
    found = [
        SignalFinding(RUN, run.name, "Fx, Fy", f"{run.name}: {description}")
        for index, run in enumerate(runs)
        if (description := _single(index, declared, others, coefficients))
    ]
    about = "the forces of {count} of {runs} runs do not belong to the cut that is declared"
    return of_all_or_some(found, measurement, about)


def _multiple(
    declared: Cut, share: float, measurement: Measurement, runs: Sequence[Run]
) -> list[SignalFinding]:
    """Find a number of teeth that divides the declared one, or is a multiple of it.

    The pattern of the declared teeth then fits, but much of the forces is not in it.
    """
    of_all, teeth = declared.of_all(share), measurement.case.tool.teeth
    if of_all < _DOUBTED:
        return []
    for other in _TEETH:
        if other == teeth or (teeth % other and other % teeth):
            continue
        cut = _other_teeth(other, measurement, runs)
        best = fitted(cut.measured, cut.basis)[1]
        if best < _FITS and cut.of_all(best) < _CLEARER * of_all:
            description = f"{cut.description}: {_numbers(cut.of_all(best), of_all)}"
            if other > 1:
                return [SignalFinding(FATAL, "", "Fx, Fy", description)]
            # runout of more than half a feed lets one tooth cut for all
            description += "; there is one tooth, or runout lets one cut for all"
            return [SignalFinding(NOTE, "", "Fx, Fy", description)]
    return []


def _numbers(best: float, declared: float) -> str:
    return (
        f"the residual of the pattern of the forces is then {100.0 * best:.0f} %, as declared "
        f"{100.0 * declared:.0f} %"
    )


def _shares(cut: Cut, coefficients: NDArray[np.float64]) -> list[float]:
    return [
        residual_share(pattern, basis, coefficients)
        for pattern, basis in zip(cut.measured, cut.basis, strict=True)
    ]


def _single(
    index: int, declared: Cut, others: Sequence[Cut], coefficients: NDArray[np.float64]
) -> str:
    """What is wrong with one run by the coefficients of the others; empty for nothing."""
    pattern, basis = declared.measured[index], declared.basis[index]
    share = residual_share(pattern, basis, coefficients)
    if share < _DOUBTED:
        return ""
    tried = [
        (residual_share(cut.measured[index], cut.basis[index], coefficients), cut) for cut in others
    ]
    best, cut = min(tried, key=lambda entry: entry[1].of_all(entry[0], [index]))
    factor = factor_of(pattern, basis, coefficients)
    if factor > _GROSS or 0.0 < factor < 1.0 / _GROSS:
        scaled = residual_share(pattern / factor, basis, coefficients)
        if scaled < min(_FITS, _BETTER * share, best):
            return (
                f"the forces are {factor:.3g} times what the other runs predict: its axial "
                "depth, its feed, or their unit is declared wrong"
            )
    return (
        f"{cut.description}: {_numbers(best, share)}" if best < min(_FITS, _BETTER * share) else ""
    )


def _cut(
    description: str,
    measurement: Measurement,
    runs: Sequence[Run],
    changed: Callable[[Case], Case] = lambda case: case,
) -> Cut:
    """Cut whose case is changed in every run."""
    cases = [changed(run.of(measurement.case)) for run in runs]
    measured = [tooth_pattern(measurement, run) for run in runs]
    power_share = [
        float(np.mean(pattern**2)) / force_power(measurement, run)
        for pattern, run in zip(measured, runs, strict=True)
    ]
    return Cut(description, measured, [basis_patterns(case) for case in cases], power_share)


def _others(declared: Cut, measurement: Measurement, runs: Sequence[Run]) -> list[Cut]:
    """Cuts that may have been run, and ways they may have been measured, beside the declared."""
    found = [
        Cut(
            one.fault(("Fx", "Fy")),
            [one.applied(pattern) for pattern in declared.measured],
            declared.basis,
            declared.power_share,
        )
        for one in ASSIGNMENTS[1:]
    ]
    for teeth in _TEETH:
        if teeth != measurement.case.tool.teeth:
            found.append(_other_teeth(teeth, measurement, runs))
    modes = {run.of(measurement.case).cut.mode for run in runs}
    if modes <= {"up", "down"}:
        description = " and ".join(
            f"{_TURNED[mode]}-milling, not {mode}-milling" for mode in sorted(modes)
        )
        found.append(_cut(f"it was {description}", measurement, runs, _other_mode))
        stated = all(run.of(measurement.case).cut.radial_depth for run in runs)
        for factor in _WIDTHS if stated else ():
            description = f"the radial depth was about {factor:g} times the declared one"
            found.append(_cut(description, measurement, runs, partial(_of_width, factor)))
    return found


def _other_teeth(teeth: int, measurement: Measurement, runs: Sequence[Run]) -> Cut:
    tool = measurement.case.tool
    other = {
        "kind": "end mill",
        "teeth": teeth,
        "diameter": tool.diameter,
        "helix": float(np.mean(tool.helix)),
    }
    times = "once" if teeth == 1 else f"{teeth} times"
    description = f"the forces repeat {times} a revolution; the case declares {tool.teeth} teeth"
    return _cut(description, measurement.with_case(measurement.case.patch({"tool": other})), runs)


def _other_mode(case: Case) -> Case:
    return case.patch({"cut.mode": _TURNED[case.cut.mode]})


def _of_width(factor: float, case: Case) -> Case:
    depth = min(factor * case.cut.radial_depth, case.tool.diameter)
    return case.patch({"cut.radial_depth": depth})
