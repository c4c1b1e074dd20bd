"""Steps, slices and length of a run, chosen where the case is silent."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.compile.cutter import cutter_of
from chatter.compile.inclined_axis import is_inclined
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.simulation.inclined_slices import InclinedSlices, inclined_slices
from cutting.engagement.immersion import slice_engagement
from cutting.engagement.slice_bounds import SliceLimits, slice_bounds
from cutting.tool.cutter import Cutter, slices_between
from dynamics.modal.modes import Mode

#: steps within a period of the highest mode: where it leaves the chip, the moment counts
_STEPS_A_PERIOD = 120
#: of a mode above the band of a measurement, which stands for a compliance
_STEPS_BEYOND = 30
#: steps of a turn, and of the time that a tooth is in the cut, at the least
_LEAST_STEPS_A_TURN = 1440
_STEPS_A_CUT = 60
#: of a carved chip whose edge trails by less than this share of the arc
_STEPS_AT_ONCE, _AT_ONCE = 240, 0.05
#: steps between teeth, at the least, and steps of a turn, at the most
_STEPS_A_PITCH = 16
_MOST_STEPS_A_TURN = 4_000_000
_MOST_SLICES = 5000
#: turns of a run, at the least and at the most, and time constants of the slowest mode in it
_LEAST_TURNS = 40.0
_MOST_TURNS = 400.0
_TIME_CONSTANTS = 12.0
#: relative error of mean forces at which the limits below stand; see docs/time-domain.md
_FORCE_TOLERANCE = 0.005
#: what may change within a slice, by the kind of chip: layers of a carved workpiece are cut as a
#: whole
_LIMITS = {
    "delay": SliceLimits(lag=0.05, tilt=math.radians(5.0), arc=1.0 / 16.0),
    "dexel": SliceLimits(lag=0.01, tilt=math.radians(2.5), arc=1.0 / 64.0),
    "voxel": SliceLimits(lag=0.01, tilt=math.radians(2.5), arc=1.0 / 64.0),
}
#: lag within a layer of a carved workpiece, of the arc of the cut: peaks are high by half of it
_LAG_OF_ARC = 0.015
#: depth of the waves of an edge in feeds per tooth below which no tooth loses a part of its edge;
#: parts of a wave within a slice of shallow and deep waves: the mean force of 36 random serrated
#: tools is within 0.7 % then, where 16 slices a wave leave up to 6 %
_SHALLOW = 0.7
_SHALLOW_WAVE, _DEEP_WAVE, _LEAST_WAVE = 1.0 / 16.0, 1.0 / 48.0, 1.0 / 192.0
#: rows of the record, at the most
_MOST_ROWS = 120_000


@dataclass(frozen=True, eq=False)
class Resolution:
    """Steps and slices of a run."""

    steps_per_revolution: int  # time steps, and bins of the surface memory
    bounds: NDArray[np.float64]  # heights between which the slices of the edge lie, m, (L + 1,)
    revolutions: float  # length of the run
    stride: int  # steps from one row of the record to the next

    @property
    def steps(self) -> int:
        """Steps of the run."""
        return max(1, round(self.revolutions * self.steps_per_revolution))


def shortest_arc(case: Case, cutter: Cutter, radius: float) -> float:
    """Angle within which an edge at a radius, m, crosses the cut, with its lag, rad."""
    return max(_arc_at(case, radius) + _least_lag(case, cutter), 1e-3)


def _arc_at(case: Case, radius: float) -> float:
    """Angle from entry to exit of an edge at a radius, m, in the cut of [cut], rad.

    Of an inclined tool the longest of all.
    """
    if is_inclined(case):
        return slices_of_inclined(case, cutter_of(case)).longest_arc
    entry, leave = slice_engagement(case.uncut_band, np.array([radius]))
    return float(leave[0] - entry[0])


def _least_lag(case: Case, cutter: Cutter) -> float:
    """Angle by which the upper end of an edge trails its tip, of the straightest flute, rad."""
    return (
        min(abs(math.tan(helix)) for helix in cutter.helix) * case.cut.axial_depth / cutter.radius
    )


def outermost_radius(case: Case, cutter: Cutter) -> float:
    """Radius of the widest slice of the edge, m; less than that of the tool within a corner."""
    return float(slices_between(cutter, bounds_of(case, cutter)).radius.max())


def resolved_arc(case: Case, cutter: Cutter) -> float:
    """Angle over which the steps of a cut are counted, rad.

    That of the shortest arc, less for a smaller tolerance of the forces. A carved chip is read at
    the end of each step, so that an edge that comes in at once needs more steps.
    """
    refinement = min(1.0, _refinement(case))
    if case.simulation is None or case.simulation.chip == "delay":
        return refinement * shortest_arc(case, cutter, cutter.radius)
    arc = shortest_arc(case, cutter, outermost_radius(case, cutter))
    at_once = _least_lag(case, cutter) < _AT_ONCE * arc
    return refinement * arc * (_STEPS_A_CUT / _STEPS_AT_ONCE if at_once else 1.0)


def _refinement(case: Case) -> float:
    """What may change within a slice, as a share of what may by default.

    Errors fall with the square of the slices where a slice is partly in the cut.
    """
    section = case.simulation
    if section is None:
        return 1.0
    return math.sqrt(section.force_tolerance / _FORCE_TOLERANCE)


def resolution_of(case: Case, cutter: Cutter, modes: Sequence[Mode]) -> Resolution:
    """Choose steps, slices and length of a run."""
    section = case.simulation
    steps = section.steps if section and section.steps else None
    if steps is None:
        steps = steps_per_revolution(case, modes, resolved_arc(case, cutter), cutter.pitch)
    if steps > _MOST_STEPS_A_TURN:
        raise InputError(
            f"{case.name}: simulation.steps: {steps:.3g} steps a revolution would be needed for "
            "the highest mode, the contact or the closest teeth; at most "
            f"{_MOST_STEPS_A_TURN:.0e} are allowed: give simulation.steps, or leave out what is "
            "so fast"
        )
    turns = revolutions_of(case, modes)
    whole = math.lcm(4, case.tool.teeth)
    if section is None or not section.steps:
        steps = _evenly_recorded(steps, turns, whole)
    steps = _divisible(steps, whole)
    total = max(1, round(turns * steps))
    return Resolution(steps, bounds_of(case, cutter), turns, _stride(steps, total))


def bounds_of(case: Case, cutter: Cutter) -> NDArray[np.float64]:
    """Heights (L + 1,) between which the slices of the edge lie, m.

    They are graded over what of the edge is in the cut of [cut]; a stock may be anywhere.
    """
    if is_inclined(case):
        return slices_of_inclined(case, cutter).bounds
    section = case.simulation
    chip = section.chip if section else "delay"
    band = case.uncut_band if case.stock is None else None
    limits = _LIMITS[chip]
    if chip != "delay":
        # the upper end of a layer leaves the chip before its middle does
        limits = replace(limits, lag=min(limits.lag, _LAG_OF_ARC * _arc_at(case, cutter.radius)))
    boxes = () if case.stock is None else case.stock.box
    bounds = slice_bounds(
        cutter,
        case.cut.axial_depth,
        band,
        replace(limits, wavelength=_part_of_a_wave(case)).refined(_refinement(case)),
        section.slices if section else None,
        [height for box in boxes for height in (box.z[0], box.z[1])],
    )
    if bounds.size - 1 > _MOST_SLICES:
        raise InputError(
            f"{case.name}: tool: {bounds.size - 1:.3g} slices would be needed for the lag of the "
            f"helix or the waves of the edge; at most {_MOST_SLICES} are allowed"
        )
    return bounds


def slices_of_inclined(case: Case, cutter: Cutter) -> InclinedSlices:
    """Slices of an inclined tool, and their arcs; `simulation.slices` does not fix them."""
    return inclined_slices(case, cutter, _LIMITS["delay"].lag, min(1.0, _refinement(case)))


def _part_of_a_wave(case: Case) -> float:
    """Part of the wave of a serrated edge within a slice.

    Waves deeper than the feed leave every tooth but parts of the edge, whose ends the slices place.
    """
    if case.tool.serration is None:
        return _SHALLOW_WAVE
    depth = case.tool.serration.depth / case.cut.feed_per_tooth
    if depth < _SHALLOW:
        return _SHALLOW_WAVE
    return max(_DEEP_WAVE / math.sqrt(max(1.0, depth / 4.0)), _LEAST_WAVE)


def steps_per_revolution(
    case: Case, modes: Sequence[Mode], shortest_arc: float, pitch: Sequence[float]
) -> int:
    """Steps a revolution that resolve the highest mode and the time of a tooth in the cut."""
    stiff = case.contact.stiffness if case.contact else 0.0
    needed = max(
        (
            math.sqrt((mode.stiffness + stiff) / mode.mass)
            / (2.0 * math.pi)
            * (_STEPS_BEYOND if mode.band == "above" else _STEPS_A_PERIOD)
            for mode in modes
        ),
        default=0.0,
    )
    a_turn = 2.0 * math.pi / case.cut.spindle_speed
    return max(
        _LEAST_STEPS_A_TURN,
        math.ceil(needed * a_turn),
        math.ceil(_STEPS_A_CUT * 2.0 * math.pi / shortest_arc),
        math.ceil(_STEPS_A_PITCH * 2.0 * math.pi / min(pitch)),
    )


def revolutions_of(case: Case, modes: Sequence[Mode]) -> float:
    """Length of the run in revolutions: as the case says, else until transients have died out."""
    section = case.simulation
    per_second = case.cut.spindle_speed / (2.0 * math.pi)
    if section and section.revolutions:
        return section.revolutions
    if section and section.duration:
        return section.duration * per_second
    slowest = max((1.0 / (mode.damping * mode.natural_frequency) for mode in modes), default=0.0)
    wanted = _TIME_CONSTANTS * slowest * per_second
    return float(math.ceil(min(_MOST_TURNS, max(_LEAST_TURNS, wanted))))


def _divisible(steps: int, by: int) -> int:
    """Teeth and quarter turns fall on whole steps."""
    return math.ceil(steps / by) * by


def _evenly_recorded(steps: int, turns: float, by: int) -> int:
    """Steps a turn, a few more, that hold a stride which fills the record.

    Of steps with few divisors a long run would record but a few rows a turn, too few to be judged.
    """
    rows = math.floor(_MOST_ROWS / turns / by) * by
    if rows == 0 or rows >= steps:
        return steps
    return _divisible(steps, by * math.ceil(steps / rows))


def _stride(steps: int, total: int) -> int:
    """Divisor of a turn that keeps the record within bounds."""
    least = math.ceil(total / _MOST_ROWS)
    divisors = (stride for stride in range(least, steps + 1) if steps % stride == 0)
    return next(divisors, steps)
