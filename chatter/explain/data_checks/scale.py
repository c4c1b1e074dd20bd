"""Size of signals against that predicted by the declared case: units and dead sensors."""

import math
from collections.abc import Sequence

import numpy as np

from chatter.description.errors import InputError, RunError
from chatter.explain.data_checks.finding import CHANNEL, FATAL, SignalFinding, of_all_or_some
from chatter.explain.data_checks.patterns import rigid_pattern, tooth_pattern
from chatter.explain.measurement import Measurement, Run

#: factor within which a thousand is a wrong unit, and share below which a sensor is dead
_NEAR_THOUSAND, _DEAD = 2.5, 0.02
#: factor of the forces of all runs that no coefficient known a little explains
_GROSS = 4.0


def wrong_scales(measurement: Measurement) -> list[SignalFinding]:
    """Forces a thousand times too large or small, next to nothing, or grossly off in all runs."""
    runs = [run for run in measurement.runs if "Fx" in run.signals and "Fy" in run.signals]
    try:
        expected = [rigid_pattern(run.of(measurement.case)) for run in runs]
    except (InputError, RunError):
        return []  # a case that cannot be simulated is reported where it is used
    measured = [tooth_pattern(measurement, run) for run in runs]
    found = []
    for row, channel in enumerate(("Fx", "Fy")):
        factors = [_rms(m[row]) / _rms(e[row]) for m, e in zip(measured, expected, strict=True)]
        found += factor_findings(measurement, runs, factors, channel)
    if found or not runs:
        return found
    factors = [_rms(m) / _rms(e) for m, e in zip(measured, expected, strict=True)]
    typical = float(np.median(factors))
    if typical > _GROSS or typical < 1.0 / _GROSS:
        description = (
            f"the forces are {typical:.3g} times those of the declared case over all runs: depth, "
            "feed, coefficients or the unit of the forces are declared wrong"
        )
        found = [SignalFinding(FATAL, "", "Fx, Fy", description)]
    return found


def factor_findings(
    measurement: Measurement, runs: Sequence[Run], factors: Sequence[float], channel: str
) -> list[SignalFinding]:
    """Findings from factors of a channel over what is expected, one a run."""
    units, dead = [], []
    for run, factor in zip(runs, factors, strict=True):
        power = thousand(factor)
        if power:
            description = (
                f"{run.name}: {channel} is {factor:.3g} times what the declared case predicts: "
                f"its unit is wrong by 1000{'' if power > 0 else ' (too small)'}"
            )
            units.append(SignalFinding(CHANNEL, run.name, channel, description))
        elif factor < _DEAD:
            description = (
                f"{run.name}: {channel} holds {factor:.2g} of what the declared case "
                "predicts: the sensor is dead"
            )
            dead.append(SignalFinding(CHANNEL, run.name, channel, description))
    about = f"{channel} is off by a factor of 1000 in {{count}} of {{runs}} runs: its unit is wrong"
    dead_about = f"{channel} holds next to nothing in {{count}} of {{runs}} runs: a dead sensor"
    return of_all_or_some(units, measurement, about) + of_all_or_some(
        dead, measurement, dead_about, share=0.999
    )


def thousand(factor: float) -> int:
    """Sign of the power of 1000 that a factor is near to; 0 where it is near to none."""
    if not 0.0 < factor < math.inf:
        return 0
    for power in (-2, -1, 1, 2):
        if abs(math.log(factor / 1000.0**power)) < math.log(_NEAR_THOUSAND):
            return 1 if power > 0 else -1
    return 0


def _rms(values: np.ndarray) -> float:
    return max(float(np.sqrt(np.mean(values**2))), 1e-300)
