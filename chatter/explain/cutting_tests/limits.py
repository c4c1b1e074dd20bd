"""Limits of the tool at the first and at the last of its cutting tests."""

from __future__ import annotations

from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.description.units import rpm
from chatter.explain.cutting_tests.wear import cut_times
from chatter.explain.measurement import Measurement
from chatter.io.result_files import finite_or_none
from chatter.stability.lobes import lobes

#: speeds over the range of the tests, depths searched, and how far beyond the deepest test
_SPEEDS, _DEPTHS, _DEEPER = 60, 160, 3.0


def limits_over_time(measurement: Measurement, case: Case) -> dict[str, Any] | None:
    """Critical depths of a case at the first and at the last cutting time, over the speeds tested.

    As in explanation.json; None where the tests have no cutting time. A depth is null where the
    cut is stable down to three times the deepest test.
    """
    times = cut_times(measurement)
    if not times.size:
        return None
    runs = [run for run in measurement.runs if run.record == "stable"]
    speed, depth = (
        np.concatenate([run.signals[name] for run in runs])
        for name in ("spindle_speed", "axial_depth")
    )
    low, high = float(rpm(speed.min())), float(rpm(speed.max()))
    ranged = case.patch(
        {
            "lobes.speeds": {"from": f"{low:.9g} rpm", "to": f"{high:.9g} rpm", "count": _SPEEDS},
            "lobes.depths": {"to": float(_DEEPER * depth.max()), "count": _DEPTHS},
        }
    )
    found = {}
    for name, time in (("first", times[0]), ("last", times[-1])):
        if found and case.wear is None:
            found[name] = found["first"]
            continue
        limits = lobes(ranged.patch({"cut.cut_time": float(time)})).limits
        found[name] = [finite_or_none(1e3 * value) for value in limits.critical_depth]
    speeds = rpm(np.asarray(limits.spindle_speed)).tolist()
    return {"spindle_speed_rpm": speeds, "critical_depth_mm": found}
