"""A case on the page: diagrams and simulated points for values of its sliders."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from chatter.app.followed_limits import FollowedLimits
from chatter.app.sliders import Slider, case_sliders, checked_values, diagram_sliders
from chatter.compile.inclined_axis import refuse_inclined_axis
from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.progress import Progress
from chatter.description.units import from_rpm, rpm
from chatter.stability.limit_curve import LimitCurve, with_limits_between
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.neglected_effects import NeglectedEffect, deciding, notes_of
from chatter.stability.pockets import Pocket
from chatter.stability.pockets_of_limits import pockets_of_limits
from chatter.stability.registry import chosen_method, fixed_steps
from chatter.stability.search_range import beyond_the_cut, known_to, maximum_depth, spindle_speeds

#: stage -> speeds, depths of the grid
STAGES = {"coarse": (96, 24), "fine": (200, 50)}
_DRAWN_POINTS = 700


class LiveCase:
    """A case and the sliders that it has.

    The method is one of stability, as for `chatter.lobes`. InputError if the case lacks something,
    or the method is too slow to follow a slider.
    """

    def __init__(self, case: Case, method: str | None) -> None:
        self._method = chosen_method(case, method)
        self.method = self._method.name
        if not self._method.is_fast:
            raise InputError(
                f'method "{self.method}" cannot follow a slider; with --live, give another --method'
            )
        refuse_inclined_axis(case)
        self.case = case
        model = milling_model(case)
        speeds = spindle_speeds(case)
        max_depth = maximum_depth(case, zero_order_of(model, speeds))
        self.view = diagram_sliders((float(speeds[0]), float(speeds[-1])), max_depth)
        self.sliders = (*self.view, *case_sliders(case))
        self._followed = FollowedLimits()
        self._followed_diagram: _Drawn | None = None
        self._neglected: tuple[NeglectedEffect, ...] = ()
        self.by_path: dict[str, Slider] = {one.path: one for one in self.sliders}

    def patched(self, given: Any) -> tuple[Case, dict[str, float]]:
        """Case with the values of its sliders, and the ranges of the diagram by path.

        InputError if a value is unknown or out of range, or what comes of them is no cut.
        """
        values = checked_values(given, self.by_path)
        view = {one.path: values.get(one.path, one.value) for one in self.view}
        if view["lobes.speeds.from"] >= view["lobes.speeds.to"]:
            raise InputError("the lowest speed of the diagram is not below the highest")
        own = {
            path: self.by_path[path].text(value)
            for path, value in values.items()
            if not self.by_path[path].view
        }
        return (self.case.patch(own) if own else self.case), view

    def diagram(self, given: Any, stage: str, progress: Progress) -> dict[str, Any]:
        """Limits over spindle speed for values of sliders, coarse or fine.

        The stage is a key of STAGES; progress may raise to give up.
        """
        case, view = self.patched(given)
        speed_count, depth_count = STAGES[stage]
        ends = from_rpm(view["lobes.speeds.from"]), from_rpm(view["lobes.speeds.to"])
        max_depth = view["lobes.depths.to"] * 1e-3
        model = milling_model(case)
        speeds = np.linspace(*ends, speed_count)
        depths = np.linspace(0.0, max_depth, depth_count + 1)[1:]
        follows = stage == "coarse" and self.method == "collocation" and not model.depends_on_speed
        limits_of = self._followed.limits if follows else self._method.limits
        curve = limits_of(model, speeds, depths, fixed_steps(case), progress)
        drawn = _Drawn(case, model, stage, max_depth)
        self._followed_diagram = drawn if follows else None
        return self._described(drawn, curve, progress)

    def checked_diagram(self, progress: Progress) -> dict[str, Any] | None:
        """The last diagram with what following its limits did not see; None where that is nothing.

        It takes as long again as a coarse diagram, which is drawn before.
        """
        drawn, self._followed_diagram = self._followed_diagram, None
        curve = None if drawn is None else self._followed.check(progress)
        if drawn is None or curve is None:
            return None
        return self._described(drawn, curve, progress)

    def _described(self, drawn: "_Drawn", curve: LimitCurve, progress: Progress) -> dict[str, Any]:
        """Diagram of limits, as the page takes it."""
        cut, deepest = drawn.case.cut, drawn.max_depth
        pockets: Sequence[Pocket] = ()
        if drawn.stage == "fine":
            found = pockets_of_limits(drawn.model, self._method, curve, deepest)
            self._neglected, pockets = found.neglected, found.pockets
        neglected = self._neglected  # in a coarse diagram that of the last fine one
        at_cut = self._limits_of_cut(drawn, curve, progress)
        crossings, curve = at_cut.crossings[0], with_limits_between(curve, at_cut)
        depth = cut.axial_depth
        stable = int((crossings < depth).sum()) % 2 == 0
        zero_order = zero_order_of(drawn.model, np.array([cut.spindle_speed]))
        known = known_to(deepest, zero_order)
        certain = not deciding(neglected, depth, crossings, known, stable=stable)
        return {
            "stage": drawn.stage,
            "spindle_speed_rpm": _numbers(rpm(curve.spindle_speed)),
            "crossings_mm": [_numbers(found * 1e3) for found in curve.crossings],
            "chatter_frequency_Hz": _numbers(curve.chatter_frequency),
            "bifurcation": list(curve.bifurcation),
            "max_axial_depth_mm": deepest * 1e3,
            "pockets": [_pocket(one) for one in pockets],
            "operating": {
                "spindle_speed_rpm": rpm(cut.spindle_speed),
                "axial_depth_mm": depth * 1e3,
                "stable": stable,
                "certain": certain,
            },
            "notes": [*drawn.model.notes, *notes_of(neglected)],
        }

    def _limits_of_cut(self, drawn: "_Drawn", curve: LimitCurve, progress: Progress) -> LimitCurve:
        """Limits at the speed of the cut; in a coarse diagram those of the nearest speed."""
        case, cut, speeds = drawn.case, drawn.case.cut, curve.spindle_speed
        inside = speeds[0] <= cut.spindle_speed <= speeds[-1] and cut.axial_depth <= drawn.max_depth
        if drawn.stage == "coarse" and inside:
            return curve.at(int(np.argmin(np.abs(speeds - cut.spindle_speed))))
        deepest = beyond_the_cut(case, 1.02 * drawn.max_depth)
        depths = np.linspace(0.0, deepest, STAGES[drawn.stage][1] + 1)[1:]
        speed, steps = np.array([cut.spindle_speed]), fixed_steps(case)
        return self._method.limits(drawn.model, speed, depths, steps, progress)

    def simulation(
        self, given: Any, speed_rpm: float, depth_mm: float, progress: Progress
    ) -> dict[str, Any]:
        """Cut simulated at a point of the diagram.

        InputError is raised if the point is outside of the diagram or cannot be simulated, RunError
        if the tool moves so far that the model no longer holds.
        """
        case, view = self.patched(given)
        _check_point(view, speed_rpm, depth_mm)
        wanted = {
            "cut.spindle_speed": f"{speed_rpm:.7g} rpm",
            "cut.axial_depth": f"{depth_mm:.7g} mm",
        }
        from chatter.simulation.simulate import simulate

        result = simulate(case, wanted, progress)
        summary = result.summary()
        revolutions = result.spindle_angle / (2.0 * math.pi)
        axis = int(np.argmax(np.ptp(result.displacement, axis=0)))
        envelope = _envelope(revolutions, result.displacement[:, axis] * 1e6)
        whole = np.searchsorted(revolutions, np.arange(0.0, math.floor(revolutions[-1]) + 0.5))
        whole = whole[whole < len(revolutions)]
        return {
            "spindle_speed_rpm": speed_rpm,
            "axial_depth_mm": depth_mm,
            "verdict": summary["verdict"],
            "reason": summary["reason"],
            "chatter_frequency_Hz": summary["chatter_frequency_Hz"],
            "peak_resultant_N": summary["peak_resultant_N"],
            "mean_power_W": summary["power"]["mean_W"],
            "direction": "xyz"[axis],
            **envelope,
            "once_per_revolution": {
                "revolutions": _numbers(revolutions[whole]),
                "um": _numbers(result.displacement[whole, axis] * 1e6),
            },
            "notes": summary["notes"],
        }


class _Drawn(NamedTuple):
    """What a diagram is of."""

    case: Case
    model: MillingModel
    stage: str
    max_depth: float  # m


def _pocket(found: Pocket) -> dict[str, float | None]:
    return {
        "spindle_speed_rpm": rpm(found.spindle_speed),
        "axial_depth_mm": found.axial_depth * 1e3,
        "critical_depth_mm": _number(found.critical_depth * 1e3),
        "removal_rate_cm3_per_min": found.removal_rate * 6e7,
    }


def _check_point(view: Mapping[str, float], speed: float, depth: float) -> None:
    for name, value in (("spindle_speed_rpm", speed), ("axial_depth_mm", depth)):
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not number or not math.isfinite(value):
            raise InputError(f"{name}: a number is required")
    inside = 0.9 * view["lobes.speeds.from"] <= speed <= 1.1 * view["lobes.speeds.to"]
    if not inside or not 0.0 < depth <= 1.1 * view["lobes.depths.to"]:
        raise InputError(f"{speed:g} rpm, {depth:g} mm is not a point of the diagram")


def _envelope(x: Array, y: Array) -> dict[str, list[float | None]]:
    """Lowest and highest value in each of a few intervals, so that no peak is lost."""
    intervals = np.array_split(np.arange(len(x)), min(_DRAWN_POINTS, len(x)))
    return {
        "revolutions": _numbers(np.array([x[part[0]] for part in intervals])),
        "lowest_um": _numbers(np.array([y[part].min() for part in intervals])),
        "highest_um": _numbers(np.array([y[part].max() for part in intervals])),
    }


def _numbers(values: Array) -> list[float | None]:
    return [_number(float(value)) for value in values]


def _number(value: float) -> float | None:
    """Value as the page shows it; None where there is none."""
    return float(f"{value:.7g}") if math.isfinite(value) else None
