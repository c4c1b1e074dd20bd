"""A case on the page: diagrams and simulated points for values of its sliders."""

import math
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from chatter.app.followed_limits import FollowedLimits
from chatter.app.sliders import Slider, case_sliders, checked_values, diagram_sliders
from chatter.compile.inclined_axis import refuse_inclined_axis
from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.progress import Progress
from chatter.description.units import from_rpm, rpm
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model
from chatter.stability.pockets import Pocket, find_pockets
from chatter.stability.registry import chosen_method, fixed_steps
from chatter.stability.search_range import beyond_the_cut, maximum_depth, spindle_speeds
from dynamics.modal.modes import inside_band

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
        started = time.perf_counter()
        case, view = self.patched(given)
        speed_count, depth_count = STAGES[stage]
        span = (from_rpm(view["lobes.speeds.from"]), from_rpm(view["lobes.speeds.to"]))
        max_depth = view["lobes.depths.to"] * 1e-3
        model = milling_model(case)
        steps = fixed_steps(case)
        speeds = np.linspace(*span, speed_count)
        depths = np.linspace(0.0, max_depth, depth_count + 1)[1:]
        follows = stage == "coarse" and self.method == "collocation" and not model.depends_on_speed
        limits_of = self._followed.limits if follows else self._method.limits
        curve = limits_of(model, speeds, depths, steps, progress)
        cut = case.cut
        inside = span[0] <= cut.spindle_speed <= span[1] and cut.axial_depth <= max_depth
        if stage == "coarse" and inside:
            operating, place = curve, int(np.argmin(np.abs(speeds - cut.spindle_speed)))
        else:
            deepest = beyond_the_cut(case, 1.02 * max_depth)
            to_operating = np.linspace(0.0, deepest, depth_count + 1)[1:]
            at = np.array([cut.spindle_speed])
            operating, place = limits_of(model, at, to_operating, steps, progress), 0
        below = int((operating.crossings[place] < cut.axial_depth).sum())
        lowest = int(np.argmin(curve.critical_depth))
        feed_per_turn = cut.feed_per_tooth * case.tool.teeth
        removal_area = case.width_of_cut * feed_per_turn / (2.0 * math.pi)
        pockets: Sequence[Pocket] = ()
        if stage == "fine":
            limits = curve.critical_depth
            pockets = find_pockets(curve.spindle_speed, limits, max_depth, removal_area)
        return {
            "stage": stage,
            "spindle_speed_rpm": _numbers(rpm(curve.spindle_speed)),
            "crossings_mm": [_numbers(found * 1e3) for found in curve.crossings],
            "chatter_frequency_Hz": _numbers(curve.chatter_frequency),
            "bifurcation": list(curve.bifurcation),
            "natural_frequencies_Hz": [
                mode.frequency for mode in inside_band(model.structure.modes)
            ],
            "max_axial_depth_mm": max_depth * 1e3,
            "pockets": [_pocket(one) for one in pockets],
            "lowest": {
                "depth_mm": _number(float(curve.critical_depth[lowest]) * 1e3),
                "spindle_speed_rpm": rpm(float(curve.spindle_speed[lowest])),
            },
            "operating": {
                "spindle_speed_rpm": rpm(cut.spindle_speed),
                "axial_depth_mm": cut.axial_depth * 1e3,
                "critical_depth_mm": _number(float(operating.critical_depth[place]) * 1e3),
                "stable": below % 2 == 0,
            },
            "removal_rate_per_mm_rpm": case.width_of_cut * feed_per_turn * 1e3,  # cm^3/min
            "notes": list(model.notes),
            "seconds": time.perf_counter() - started,
        }

    def simulation(
        self, given: Any, speed_rpm: float, depth_mm: float, progress: Progress
    ) -> dict[str, Any]:
        """Cut simulated at a point of the diagram.

        InputError is raised if the point is outside of the diagram or cannot be simulated, RunError
        if the tool moves so far that the model no longer holds.
        """
        started = time.perf_counter()
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
            "seconds": time.perf_counter() - started,
        }


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
