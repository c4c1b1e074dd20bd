"""Spindle power of cutting tests: readings out of line, and in another unit than they say."""

import numpy as np

from chatter.explain.cutting_tests.spindle_power import readings
from chatter.explain.data_checks.finding import NOTE, SAMPLES, SignalFinding
from chatter.explain.measurement import Measurement
from chatter.explain.stability_margin import tests_of

#: factor on readings -> words
_UNITS = {1e3: "1000 times too small: taken as kW", 1e-3: "1000 times too large: taken as mW"}


def wrong_powers(measurement: Measurement) -> list[SignalFinding]:
    """Readings that differ from those of the tests around them, or are off by 1000."""
    run, case = measurement.runs[0], measurement.case
    measured = run.signals.get("spindle_power")
    if measured is None or not np.isfinite(measured).any():
        return []
    found = readings(case, tests_of(case, run.signals), measured, measurement.idle_power)
    findings = []
    if found.factor != 1.0:
        text = f"{run.name}: the spindle powers are {_UNITS[found.factor]}"
        findings.append(SignalFinding(NOTE, run.name, "spindle_power", text))
    bad = found.out_of_line | (np.isfinite(measured) & (found.power <= 0.0))
    if bad.any():
        listed = ", ".join(
            f"test {index + 1} ({measured[index]:.4g} W)" for index in np.flatnonzero(bad)[:5]
        )
        text = (
            f"{run.name}: {bad.sum()} of {np.isfinite(measured).sum()} spindle powers do not fit "
            f"those of the tests around them: {listed}"
        )
        findings.append(SignalFinding(SAMPLES, run.name, "spindle_power", text, bad))
    return findings
