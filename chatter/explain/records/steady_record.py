"""What a run needs to be predicted in the settled part of its record."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.records.alignment import USUAL_ORDER, Alignment, Recorded, aligned
from chatter.explain.records.case_axes import Component
from chatter.explain.records.slow_channels import POWER
from chatter.explain.records.steady_cut import SteadyCut, steady_cut

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SteadyRecord:
    """Settled part of a run: its channels, and how it is predicted."""

    components: Mapping[str, Component]  # channel -> what it holds, in the order of `recorded`
    recorded: Recorded
    revolutions: int  # simulated from rest until the cut is settled
    revolutions_recorded: int  # of the cut, settled or not
    entered_by: str = ""  # stages of the record in words
    has_power: bool = False  # whether the power of the spindle is predicted
    filter_order: int = USUAL_ORDER  # of the anti-alias filter

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels that are predicted."""
        return (*self.components, *((POWER,) if self.has_power else ()))

    @property
    def knows_tooth(self) -> bool:
        """Whether it is known which tooth is where: by a tacho or a measured angle."""
        return self.recorded.angle is not None or self.recorded.expected is not None

    def with_revolutions(self, revolutions: int) -> "SteadyRecord":
        """Same record, predicted by another number of revolutions from rest."""
        return self if revolutions == self.revolutions else replace(self, revolutions=revolutions)

    def with_filter_of(self, order: int) -> "SteadyRecord":
        """Same record behind an anti-alias filter of another order."""
        return self if order == self.filter_order else replace(self, filter_order=order)

    def misfits(self, case: Case, orders: Sequence[int]) -> dict[int, float]:
        """Sum of squares of what differs, by a case with the overrides of the run.

        By order of the anti-alias filter.
        """
        cut = steady_cut(case, self.revolutions)
        return {one: self.with_filter_of(one)._laid_beside(cut).misfit for one in orders}

    def aligned(self, case: Case) -> Alignment:
        """Prediction of a case with the overrides of the run, laid beside the record."""
        return self._laid_beside(steady_cut(case, self.revolutions))

    def _laid_beside(self, cut: SteadyCut) -> Alignment:
        orders = self.recorded.orders
        harmonics = [cut.harmonics(one, orders) for one in self.components.values()]
        return aligned(np.array(harmonics), self.recorded, self.filter_order)

    def predicted(self, case: Case) -> dict[str, Array]:
        """Signals at the samples by a case with the overrides of the run."""
        cut = steady_cut(case, self.revolutions)
        found = dict(zip(self.components, self._laid_beside(cut).predicted, strict=True))
        if self.has_power:
            # what is settled has the same mean over every revolution
            found[POWER] = np.full(self.recorded.time.size, cut.power)
        return found


def smallest_symmetry(case: Case) -> float:
    """Smallest angle by which a declared tool may be turned without a difference, rad."""
    tool = case.tool
    uneven = tool.runout is not None or tool.radial_error or tool.axial_error
    pitch = np.asarray(tool.pitch or (1.0,))
    helix = np.atleast_1d(np.asarray(tool.helix, dtype=np.float64))
    if uneven or np.ptp(pitch) > 0.0 or np.ptp(helix) > 0.0:
        return 2.0 * math.pi
    return 2.0 * math.pi / tool.teeth
