"""What a cut may use: speeds, depths, radial depths, feeds, and the limits of [optimum]."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.sections.optimisation import Feeds, Optimum, RadialDepths
from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import MillingModel
from chatter.stability.pockets import DEPTH_MARGIN, SPEED_MARGIN
from chatter.stability.search_range import maximum_depth, spindle_speeds
from chatter.studies.model import standard_deviations
from chatter.studies.optimisation.element_size import extreme_models, max_wavelengths
from chatter.studies.optimisation.operating_point import model_with
from chatter.studies.optimisation.steady_cut import SteadyCuts

#: key of [optimum] -> what of a steady cut it limits
LIMITED: Mapping[str, str] = {
    f"max_{quantity}": quantity for quantity in ("power", "torque", "deflection", "surface_error")
}
_DEPTHS = 60
#: depths below the first of an even grid, each half of the one above
_HALVINGS = 4
#: speeds evaluated within the margin on either side, and speeds of the coarse grid
_SPEEDS_A_MARGIN = 2
_LEAST_SPEEDS, _MOST_SPEEDS = 8, 400
_COARSEST_STEP = 0.01
#: highest over lowest speed below which there is nothing to search
_LEAST_RANGE = 1.001


@dataclass(frozen=True)
class Limits:
    """Ranges and limits of a search, SI."""

    speeds: Array  # coarse grid, rad/s, each the same share above the one before (n,)
    depths: Array  # m (m,)
    radial_depths: Array  # m; one value where they are fixed
    feeds: Array  # m; one value where they are fixed
    most: Mapping[str, float]  # key of [optimum] -> what is allowed
    depth_margin: float
    speed_margin: float
    confidence: float
    wavelengths: float  # chatter wavelengths that an element of collocation holds at the most

    @property
    def speed_step(self) -> float:
        """Ratio of a speed of the grid to the one before."""
        return float(self.speeds[1] / self.speeds[0])

    def evaluation_speeds(self, speeds: Array) -> Array:
        """Speeds at which stability must be known for the margins at some speeds, ascending."""
        shares = np.linspace(-self.speed_margin, self.speed_margin, 2 * _SPEEDS_A_MARGIN + 1)
        return np.unique(np.outer(speeds, 1.0 + shares))

    def extended_speeds(self) -> Array:
        """Speeds of the coarse grid, run on by the margin at both ends."""
        more = math.ceil(math.log1p(self.speed_margin) / math.log(self.speed_step) - 1e-9)
        steps = self.speed_step ** np.arange(1, more + 1)
        return np.concatenate([self.speeds[0] / steps[::-1], self.speeds, self.speeds[-1] * steps])

    def usage(self, cuts: SteadyCuts) -> dict[str, Array]:
        """Share (n,) of every limit that steady cuts use; above 1 is too much."""
        return {key: np.abs(getattr(cuts, LIMITED[key])) / most for key, most in self.most.items()}


def limits_of(case: Case, model: MillingModel, sampled: Sequence[MillingModel] = ()) -> Limits:
    """Ranges and limits that a case gives, completed where it is silent.

    `sampled` are models of the samples of what is uncertain: elements are as short as these need
    them.
    """
    section = case.optimum or Optimum()
    uncertain = bool(standard_deviations(case))
    given = {key: getattr(section, key) for key in LIMITED}
    margins = [
        value if value is not None else 0.0 if uncertain else usual
        for value, usual in (
            (section.depth_margin, DEPTH_MARGIN),
            (section.speed_margin, SPEED_MARGIN),
        )
    ]
    speeds, depths = _speeds(case, section, margins[1]), _depths(case, section, model)
    radial_depths = _values(section.radial_depths, case.width_of_cut)
    feed = case.cut.feed_per_tooth
    extremes = [
        model_with(one, float(radial_depth), feed)
        for one in (model, *extreme_models(sampled))
        for radial_depth in {radial_depths[0], radial_depths[-1]}
    ]
    return Limits(
        speeds=speeds,
        depths=depths,
        radial_depths=radial_depths,
        feeds=_values(section.feeds, case.cut.feed_per_tooth),
        most={key: value for key, value in given.items() if value is not None},
        depth_margin=margins[0],
        speed_margin=margins[1],
        confidence=section.confidence,
        wavelengths=min(max_wavelengths(one, speeds, depths) for one in extremes),
    )


def _speeds(case: Case, section: Optimum, margin: float) -> Array:
    if section.speeds is not None:
        first, last = section.speeds.from_, section.speeds.to
    else:
        first, last = spindle_speeds(case)[[0, -1]]
    last = _lasting(case, section, float(first), float(last))
    step = min(margin / _SPEEDS_A_MARGIN, _COARSEST_STEP) or _COARSEST_STEP
    count = math.ceil(math.log(last / first) / math.log1p(step)) + 1
    return np.geomspace(first, last, min(max(count, _LEAST_SPEEDS), _MOST_SPEEDS))


def _lasting(case: Case, section: Optimum, first: float, last: float) -> float:
    """Highest speed, rad/s, up to the last one at which the edge lasts as long as it must."""
    if section.min_tool_life is None:
        return last
    if case.tool_life is None:
        raise InputError(
            f"{case.name}: optimum.min_tool_life: needs [tool_life] with cutting_speed, life and "
            "exponent"
        )
    fastest = case.tool_life.cutting_speed_for(section.min_tool_life)
    highest = 2.0 * fastest / case.tool.diameter
    if highest <= first * _LEAST_RANGE:
        raise InputError(
            f"{case.name}: optimum.min_tool_life: an edge that lasts "
            f"{section.min_tool_life / 60.0:.3g} min cuts at "
            f"{units_of(case).cutting_speed.text(fastest)} at the most, {rpm(highest):.4g} rpm; "
            f"the search begins at {rpm(first):.4g} rpm"
        )
    return min(last, highest)


def _depths(case: Case, section: Optimum, model: MillingModel) -> Array:
    deepest = case.tool.depth_that_tool_allows
    if section.depths is not None and section.depths.from_ is not None:
        ends = min(section.depths.from_, deepest), min(section.depths.to, deepest)
        return np.linspace(*ends, section.depths.count)
    if section.depths is not None:
        max_depth, count = min(section.depths.to, deepest), section.depths.count
    else:
        max_depth, count = maximum_depth(case, zero_order_of(model, spindle_speeds(case))), _DEPTHS
    even = np.linspace(0.0, max_depth, count + 1)[1:]
    return np.concatenate([even[0] / 2.0 ** np.arange(_HALVINGS, 0, -1), even])


def _values(given: RadialDepths | Feeds | None, fixed: float) -> Array:
    return np.array([fixed]) if given is None else np.linspace(given.from_, given.to, given.count)
