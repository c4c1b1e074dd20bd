"""Effect of a tool that wears from test to test: it grows, saturates, or chips."""

from __future__ import annotations

import numpy as np

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Values, free
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import Parameter

#: typical growth of cutting and edge coefficients over all tests, and of process damping
_CUTTING, _EDGE, _DAMPING = 0.2, 0.4, 1.0
#: bounds of growth over all tests
_LEAST, _MOST = -0.5, 20.0
#: times at which the edge may have chipped that are tried: by the power, and by verdicts alone
_MOST_TIMES, _FEW_TIMES = 40, 5
#: cutting times within which wear saturates, as shares of all tests
_SATURATED = (0.15, 0.4)


def cut_times(measurement: Measurement) -> np.ndarray:
    """Cutting times (n,) of all tests, s, ascending; empty where there is no such column."""
    columns = {id(run.whole or run): (run.whole or run).signals for run in measurement.runs}
    found = [one["cut_time"] for one in columns.values() if "cut_time" in one]
    times = np.concatenate(found) if found else np.empty(0)
    return np.unique(times[np.isfinite(times)])


def has_power(measurement: Measurement) -> bool:
    """Whether the spindle power of tests was read."""
    return any(run.record == "spindle_power" for run in measurement.runs)


class GradualWear(Effect):
    """Coefficients that grow in proportion to the cutting time."""

    name = "wear"
    label = "tool wear"
    help = "forces and process damping grow with the time that the tool has cut"
    kinds = ("stability",)

    def __init__(self, times: np.ndarray) -> None:
        self.times = times  # (n,), cutting times of the tests, s, ascending
        self.last = float(times[-1])

    def applies(self, measurement: Measurement) -> bool:
        """Of tests at several cutting times whose wear is not declared."""
        return self.times.size > 2 and measurement.case.wear is None

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth from the first to the last test, as shares of what the tool begins with."""
        bounds = {"lower": _LEAST, "upper": _MOST}
        case = measurement.case
        found = [free("cutting_increase", 0.0, _CUTTING, "", **bounds)]
        if has_power(measurement) and case.material.Kte:
            found.append(free("edge_increase", 0.0, _EDGE, "", **bounds))
        if case.process_damping is not None and case.process_damping.coefficient:
            found.append(free("process_damping_increase", 0.0, _DAMPING, "", **bounds))
        return found

    def patch(self, case: Case, values: Values) -> Patch:
        """Wear of the tool, and the cutting time of the last test: the case is the worn tool."""
        return {"wear": self.section_of(case, values), "cut.cut_time": self.last}

    def section_of(self, case: Case, values: Values) -> Patch:
        """Section [wear]."""
        return growths(case, values, self.last)

    def starts(self, measurement: Measurement) -> list[Values]:  # noqa: ARG002
        """From none to much, together."""
        return [
            {"cutting_increase": 0.3, "edge_increase": 0.5, "process_damping_increase": 1.0},
            {"cutting_increase": 0.05, "edge_increase": 0.05, "process_damping_increase": 0.0},
        ]

    def reported(self, values: Values) -> Reported:
        """Growth from the first to the last test, and what shapes it."""
        units = {"saturation_time": "s", "chipping_time": "s"}
        return {key: (value, units.get(key, "")) for key, value in values.items()}


class SaturatingWear(GradualWear):
    """Coefficients that grow less and less."""

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth, and its time constant."""
        last = self.last
        bounds = {"lower": 0.02 * last, "upper": 2.0 * last}
        time = free("saturation_time", 0.3 * last, 0.1 * last, "s", **bounds)
        return [*super().parameters(measurement), time]

    def section_of(self, case: Case, values: Values) -> Patch:
        """Section [wear], so that the growth at the last test is what is fitted."""
        time, last = float(values["saturation_time"]), self.last
        grown = -time * float(np.expm1(-last / time))
        return {**growths(case, values, grown), "saturation_time": time}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Early and late."""
        start = super().starts(measurement)[0]
        return [{**start, "saturation_time": share * self.last} for share in _SATURATED]


class ChippedEdge(GradualWear):
    """Coefficients that grow at once, between two tests."""

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Growth, and the time at which it comes."""
        bounds = {"lower": float(self.times[0]), "upper": self.last}
        time = free("chipping_time", 0.5 * self.last, 0.05 * self.last, "s", **bounds)
        return [*super().parameters(measurement), time]

    def section_of(self, case: Case, values: Values) -> Patch:
        """Section [wear.chipping]."""
        return {"chipping": {"time": float(values["chipping_time"]), **growths(case, values, 1.0)}}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Midway between tests: between them the time has no slope to follow."""
        start, middles = super().starts(measurement)[0], 0.5 * (self.times[:-1] + self.times[1:])
        most = _MOST_TIMES if has_power(measurement) else _FEW_TIMES
        chosen = np.unique(np.linspace(0, middles.size - 1, most).round().astype(int))
        return [{**start, "chipping_time": float(middles[index])} for index in chosen]


def growths(case: Case, values: Values, time: float) -> dict[str, float]:
    """Keys of [wear] for growth that is reached after a time, s."""
    edge = float(values.get("edge_increase", 0.0)) / time
    found = {
        "cutting": float(values.get("cutting_increase", 0.0)) / time,
        "edge_tangential": edge * float(case.material.Kte or 0.0),
        "edge_radial": edge * float(case.material.Kre or 0.0),
        "process_damping": float(values.get("process_damping_increase", 0.0)) / time,
    }
    return {key: value for key, value in found.items() if value}


def forms_of_wear(measurement: Measurement) -> list[GradualWear]:
    """Forms of wear that tests in order may show, the simplest first."""
    times = cut_times(measurement)
    if not times.size:
        return []
    forms = (GradualWear(times), SaturatingWear(times), ChippedEdge(times))
    return [form for form in forms if form.applies(measurement)]
