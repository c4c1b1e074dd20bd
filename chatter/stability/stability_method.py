"""What every stability method is: its names, what it takes, and the numbers that it gives.

A method is a class in its own package under `chatter.stability.methods` and one line in
`chatter.stability.registry`. Its module imports compiled code only inside the calls, so that the
list of methods with their help texts costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.stability.limit_curve import LimitCurve, joined_limits

if TYPE_CHECKING:
    from chatter.stability.model import MillingModel


class Multiplier(NamedTuple):
    """Dominant Floquet multiplier over one period."""

    value: complex
    steps: int  # steps or points per period of the finest resolution
    error: float  # estimated error of |value|


class Sweep(NamedTuple):
    """Speeds and depths for one model: a grid of them, or points."""

    model: MillingModel
    speeds: Array  # rad/s (n,)
    depths: Array  # m, of the grid (m,) or of the points (n,)
    steps: int | None  # per tooth period, where the case fixes them
    progress: Progress

    @property
    def max_depth(self) -> float:
        """Deepest of all, m."""
        return float(np.max(self.depths))


class StabilityMethod:
    """A method for the critical depth; subclasses state what it takes and gives.

    Attributes
    ----------
    name : str
        On the command line and in case files.
    label : str
        In pictures.
    help : str
        One line for help texts and docs: what it is and what it is for.
    takes_any_tool : bool
        Whether other tools than uniform-pitch cylindrical end mills are taken.
    takes_varying_speed, takes_process_damping, takes_contact : bool
        Whether a varying spindle speed, process damping, the contact of tool and work are taken.
    takes_frfs : bool
        Whether measured FRFs are taken as they are, without fitted modes.
    is_linear : bool
        Whether it assumes that no tooth loses contact.
    is_fast : bool
        Whether limits over all speeds take seconds.
    gives_radius : bool
        Whether it gives the spectral radius at points.
    gives_multiplier, gives_chatter_frequency : bool
        Whether it gives the dominant multiplier, and the chatter frequency, of the cut of a case.
    """

    name: str
    label: str
    help: str
    takes_any_tool = True
    takes_varying_speed = False
    takes_process_damping = True
    takes_contact = False
    takes_frfs = False
    is_linear = True
    is_fast = True
    gives_radius = False
    gives_multiplier = False
    gives_chatter_frequency = False

    def limits(
        self,
        model: MillingModel,
        speeds: Array,
        depths: Array,
        steps: int | None,
        progress: Progress,
    ) -> LimitCurve:
        """Limits of stability, every speed with the dynamics of the structure at it.

        Parameters
        ----------
        model : MillingModel
        speeds : (n,) array of float
            rad/s, ascending.
        depths : (m,) array of float
            m, ascending, > 0: grid on which changes of stability are searched.
        steps : int or None
            Steps per tooth period that the case fixes; None leaves them to the method.
        progress : callable
            Called with (done, total).

        Raises
        ------
        InputError
            If the method does not take the case.
        """
        from chatter.stability.reference_speeds import over_reference_speeds

        self.check(model)

        def limits(own: MillingModel, index: IntegerArray, report: Progress) -> LimitCurve:
            return self._limits_of(Sweep(own, speeds[index], depths, steps, report))

        if not self.follows_flank(model):
            return joined_limits(speeds, over_reference_speeds(model, speeds, limits, progress))
        from chatter.stability.steady_flank import limits_about_steady_motion

        still = joined_limits(speeds, over_reference_speeds(model, speeds, limits, no_progress))

        def at(own: MillingModel, speed: float, wanted: Array) -> LimitCurve:
            return self.limits_of(Sweep(own, np.array([speed]), wanted, steps, no_progress))

        def radius(own: MillingModel, speed: Array, depth: Array) -> Array:
            return self.radius_of(Sweep(own, speed, depth, steps, no_progress))

        of_points = radius if self.gives_radius else None
        return limits_about_steady_motion(model, still, depths, at, of_points, progress)

    def radius(
        self,
        model: MillingModel,
        speeds: Array,
        depths: Array,
        steps: int | None,
        progress: Progress,
    ) -> Array:
        """Spectral radius (n,) at n points of speed (rad/s) and depth (m); see `limits`."""
        from chatter.stability.reference_speeds import over_reference_speeds

        self.check(model)
        if self.follows_flank(model):
            from chatter.stability.steady_flank import radius_about_steady_motion

            def at(own: MillingModel, speed: Array, depth: Array) -> Array:
                return self.radius_of(Sweep(own, speed, depth, steps, no_progress))

            return radius_about_steady_motion(model, speeds, depths, at, progress)

        def radius(own: MillingModel, index: IntegerArray, report: Progress) -> Array:
            sweep = Sweep(own, speeds[index], depths[index], steps, report)
            if self.is_linear and own.is_inclined:
                from chatter.stability.limits_by_depth import radius_by_depth

                return radius_by_depth(self, sweep)
            return self.radius_of(sweep)

        found = np.empty(len(speeds))
        for index, values in over_reference_speeds(model, speeds, radius, progress):
            found[index] = values
        return found

    def _limits_of(self, sweep: Sweep) -> LimitCurve:
        """Limits with the same dynamics at all speeds, of a cut that each depth may have anew."""
        if self.is_linear and self.gives_radius and sweep.model.is_inclined:
            from chatter.stability.limits_by_depth import limits_by_depth

            return limits_by_depth(self, sweep)
        return self.limits_of(sweep)

    def follows_flank(self, model: MillingModel) -> bool:
        """Tell whether a flank that ploughs is taken beside the steady motion of each cut."""
        from chatter.stability.steady_flank import follows_steady_motion

        return self.is_linear and self.takes_process_damping and follows_steady_motion(model)

    def check(self, model: MillingModel) -> None:
        """Raise InputError where the method does not take a case."""
        if model.case.cut.speed_variation is not None and not self.takes_varying_speed:
            raise InputError(
                f'{model.case.name}: cut.speed_variation: method "{self.name}" takes a constant '
                'speed; "collocation" and "matrix-free" take one that varies'
            )
        if not self.takes_any_tool and not model.is_uniform:
            raise InputError(
                f'{model.case.name}: tool: method "{self.name}" takes uniform-pitch cylindrical '
                'end mills; "collocation" takes any tool'
            )

    def limits_of(self, sweep: Sweep) -> LimitCurve:
        """Limits with the same dynamics at all speeds; see `limits`."""
        raise NotImplementedError

    def radius_of(self, sweep: Sweep) -> Array:
        """Spectral radius with the same dynamics at all points; see `radius`."""
        raise NotImplementedError

    def multiplier(self, model: MillingModel, steps: int | None) -> Multiplier:
        """Dominant multiplier of the cut of a case, with an estimate of its error."""
        raise NotImplementedError

    def chatter_frequency(self, model: MillingModel) -> float:
        """Frequency (Hz) of the motion that grows fastest, or decays slowest, as the case cuts."""
        raise NotImplementedError

    def chatter_frequencies_of(self, sweep: Sweep) -> Array:
        """Chatter frequencies (n,), Hz, with the same dynamics at all points."""
        from chatter.engine.parallel import each

        model, speeds, depths = sweep.model, sweep.speeds, sweep.depths

        def at(point: int) -> float:
            return self.chatter_frequency(model.at_cut(float(speeds[point]), float(depths[point])))

        return np.array(each(at, len(speeds)))
