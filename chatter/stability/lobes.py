"""Stability lobe diagram of a case: limits over spindle speed by two independent methods."""

import math

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.progress import Progress, begin, no_progress
from chatter.description.questioned import question_of_flutes, question_of_search
from chatter.description.units import rpm
from chatter.stability.diagram import DiagramAxis, StabilityDiagram, StabilityMap
from chatter.stability.forced_vibration import notes_on_dashpot
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.lowest_limit import LowestLimit, lowest_limit
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.neglected_effects import notes_of
from chatter.stability.pockets_of_limits import pockets_of_limits
from chatter.stability.reference_speeds import natural_frequencies
from chatter.stability.registry import chosen_method, fixed_steps, with_radius
from chatter.stability.search_range import (
    axial_depths,
    beyond_the_cut,
    maximum_depth,
    spindle_speeds,
)
from chatter.stability.stability_method import StabilityMethod


def lobes(
    case: Case, method: str | None = None, grid: bool = False, progress: Progress = no_progress
) -> StabilityDiagram:
    """Compute the stability lobe diagram of a case.

    Parameters
    ----------
    case : Case
    method : str, optional
        Name in `chatter.stability.registry.METHODS`, or "auto"; by default what the case says, else
        "auto".
    grid : bool
        Also the spectral radius on the whole grid of speeds and depths.
    progress : callable, optional
        Called with (done, total) speeds.

    Returns
    -------
    StabilityDiagram

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be computed.
    """
    chosen = chosen_method(case, method)
    if case.on_machine:
        begin(progress, "machine: structure, frictions and loops")
    model = milling_model(case)
    if case.on_machine:
        begin(progress, "stability limits at all speeds")
    speeds = spindle_speeds(case)
    zero_order = zero_order_of(model, speeds)
    max_depth = maximum_depth(case, zero_order)
    depths = axial_depths(case, max_depth)
    limits = chosen.limits(model, speeds, depths, fixed_steps(case), progress)
    radius = None
    if grid:
        begin(progress, "spectral radius at all speeds and depths")
        speed, depth = (part.ravel() for part in np.meshgrid(speeds, depths))
        all_points = with_radius(chosen).radius(model, speed, depth, fixed_steps(case), progress)
        radius = all_points.reshape(len(depths), len(speeds))
    begin(progress, "what linear methods leave out")
    found = pockets_of_limits(model, chosen, limits, max_depth, zero_order)
    deepest_pocket = max([0.0, *(pocket.axial_depth for pocket in found.pockets)])
    begin(progress, "limit at the speed of the cut")
    operating = _operating_limit(model, chosen, max_depth, progress)
    begin(progress, "lowest limit between the speeds")
    lowest = lowest_limit(chosen, model, limits, depths, progress)
    return StabilityDiagram(
        case=case,
        method=chosen.name,
        axis=_speed_axis(case, speeds),
        limits=limits,
        max_depth=np.full(len(speeds), max_depth),
        notes=(
            *model.notes, *notes_of(found.neglected),
            *notes_on_dashpot(model, chosen), *notes_on_tolerance(model, limits),
            *notes_on_spacing(case, speeds, lowest),
            *(question_of_flutes(case, deepest_pocket) or question_of_search(case, max_depth)),
        ),
        zero_order=zero_order,
        pockets=found.pockets,
        neglected=found.neglected,
        operating=operating,
        lowest=lowest,
        at_lowest=_limits_at(lowest, model, chosen, speeds, depths),
        resting_friction=found.resting_friction,
        natural_frequencies=natural_frequencies(model, speeds),
        depth_step=max_depth / len(depths),
        grid=None if radius is None else map_over_speed(case, chosen, speeds, depths, radius),
    )  # fmt: skip


def _speed_axis(case: Case, speeds: Array) -> DiagramAxis:
    return DiagramAxis("spindle_speed", "rpm", rpm(speeds), (), rpm(case.cut.spindle_speed))


def map_over_speed(
    case: Case, method: StabilityMethod, speeds: Array, depths: Array, radius: Array
) -> StabilityMap:
    """Map of the spectral radius (depths, speeds) over spindle speed (rad/s) and depth (m)."""
    depth = DiagramAxis("axial_depth", "mm", depths * 1e3, (), case.cut.axial_depth * 1e3)
    return StabilityMap(case, with_radius(method).name, _speed_axis(case, speeds), depth, radius)


def notes_on_tolerance(model: MillingModel, limits: LimitCurve) -> tuple[str, ...]:
    """Say where the tolerance on the critical depths is not met."""
    if not limits.error > model.tolerance:
        return ()
    return (
        f"the critical depths are accurate to {limits.error:.1%}, not to the {model.tolerance:.2%} "
        "asked for; a lower lobes.tolerance takes finer elements, and longer",
    )


def notes_on_spacing(case: Case, speeds: Array, lowest: LowestLimit) -> tuple[str, ...]:
    """Say where speeds (n,), rad/s, are farther apart than the lobes about the lowest limit."""
    speed = lowest.spindle_speed
    if len(speeds) < 2 or not math.isfinite(lowest.chatter_frequency):
        return ()
    waves = 2.0 * math.pi * lowest.chatter_frequency / (case.tool.teeth * speed)
    width = speed / (waves + 1.0)
    behind = int(np.clip(np.searchsorted(speeds, speed), 1, len(speeds) - 1))
    spacing = float(speeds[behind] - speeds[behind - 1])
    if spacing <= width:
        return ()
    return (
        f"the speeds are {rpm(spacing):.0f} rpm apart, lobes about {rpm(speed):.0f} rpm "
        f"{rpm(width):.0f} rpm wide: between the speeds limits may be lower than the lowest found; "
        "lobes.speeds takes more of them",
    )


def _limits_at(
    lowest: LowestLimit, model: MillingModel, method: StabilityMethod, speeds: Array, depths: Array
) -> LimitCurve | None:
    """All limits at the speed of the lowest; None where it is one of the speeds, or there is none.

    Speeds (n,) in rad/s, depths (m,) in m.
    """
    speed = np.array([lowest.spindle_speed])
    if np.isnan(speed[0]) or np.isclose(speeds, speed, rtol=1e-9).any():
        return None
    return method.limits(model, speed, depths, fixed_steps(model.case), no_progress)


def _operating_limit(
    model: MillingModel, method: StabilityMethod, max_depth: float, progress: Progress
) -> LimitCurve:
    """Limits at the operating speed, searched at least to the operating depth."""
    case = model.case
    depths = axial_depths(case, beyond_the_cut(case, max_depth))
    speeds = np.array([case.cut.spindle_speed])
    return method.limits(model, speeds, depths, fixed_steps(case), progress)
