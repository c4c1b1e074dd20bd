"""The methods that give stability limits, behind one call.

Adding a method is one function here and one entry in `METHODS`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.progress import Progress
from chatter.stability.floquet_multiplier import Multiplier
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.converged_limits import (
    LIMIT_ERROR,
    converged_limit_curve,
)
from chatter.stability.methods.collocation.cut_arrays import CutArrays
from chatter.stability.methods.matrix_free import method as matrix_free
from chatter.stability.methods.multi_frequency import method as multi_frequency
from chatter.stability.methods.semi_discretization import method as semi_discretization
from chatter.stability.methods.semi_discretization.step_schemes import (
    FullDiscretization,
    SecondOrder,
    ZerothOrder,
)
from chatter.stability.methods.zeroth_order.distinct_delays import limits_of_delays
from chatter.stability.methods.zeroth_order.method import ZeroOrderLimit, zero_order_limit
from chatter.stability.model import MillingModel
from chatter.stability.reference_speeds import (
    LimitMethod,
    limits_by_group,
    radius_by_group,
    zero_order_by_group,
)


@limits_by_group
def by_semi_discretization(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,
    progress: Progress,
) -> LimitCurve:
    """Limits by first-order semi-discretization of the modal model."""
    return semi_discretization.limit_curve(model.arrays, speeds, depths, steps, progress)


def _by_scheme(scheme: semi_discretization.Scheme) -> LimitMethod:
    @limits_by_group
    def limits(
        model: MillingModel,
        speeds: NDArray[np.float64],
        depths: NDArray[np.float64],
        steps: int | None,
        progress: Progress,
    ) -> LimitCurve:
        return semi_discretization.limit_curve(
            model.arrays, speeds, depths, steps, progress, scheme
        )

    return limits


@limits_by_group
def by_collocation(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001  (every method has the same signature)
    progress: Progress,
) -> LimitCurve:
    """Limits by collocation on elements, of any tool."""

    def cut_at(points: int, waves: float) -> CutArrays:
        return model.cut(float(depths[-1]), points, waves)

    lobes = model.case.lobes
    tolerance = lobes.tolerance if lobes else LIMIT_ERROR
    return converged_limit_curve(cut_at, speeds, depths, progress, tolerance)


@limits_by_group
def by_matrix_free(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001  (every method has the same signature)
    progress: Progress,
) -> LimitCurve:
    """Limits from initial functions propagated in time, of any tool."""
    deepest = float(depths[-1])
    return matrix_free.limit_curve(
        lambda fineness: model.stepped_cut(deepest, fineness), speeds, depths, progress
    )


@limits_by_group
def by_multi_frequency(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001  (every method has the same signature)
    progress: Progress,
) -> LimitCurve:
    """Limits by the multi-frequency solution, from the FRFs themselves."""
    if model.case.cut.speed_variation is not None:
        raise InputError(
            f"{model.case.name}: cut.speed_variation: the multi-frequency solution takes a "
            'constant speed; "collocation" takes one that varies'
        )
    lines, receptance = model.receptance
    response = multi_frequency.FrequencyResponse(
        2.0 * np.pi * lines, np.ascontiguousarray(receptance)
    )
    cut = model.cut(float(depths[-1]))
    return multi_frequency.limit_curve(cut, response, speeds, depths, progress)


@limits_by_group
def by_zero_order(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001  (every method has the same signature)
    progress: Progress,
) -> LimitCurve:
    """Limits by the zeroth-order solution; it has neither steps nor flip bifurcations."""
    limit = zero_order_of(model, speeds)
    within = limit.critical_depth <= depths[-1]
    progress(len(speeds), len(speeds))
    return LimitCurve(
        spindle_speed=speeds,
        critical_depth=np.where(within, limit.critical_depth, np.inf),
        chatter_frequency=np.where(within, limit.chatter_frequency, np.nan),
        bifurcation=tuple("hopf" if found else "none" for found in within),
        crossings=tuple(
            np.array([depth]) if found else np.empty(0)
            for depth, found in zip(limit.critical_depth, within, strict=True)
        ),
        steps=np.zeros(len(speeds), dtype=np.int64),
    )


@limits_by_group
def by_time(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001  (every method has the same signature)
    progress: Progress,
) -> LimitCurve:
    """Limits from cuts simulated in the time domain, with all that the simulation holds."""
    from chatter.stability.methods.time_domain.critical_depths import time_limit_curve

    if model.case.cut.speed_variation is not None:
        raise InputError(
            f"{model.case.name}: cut.speed_variation: limits in the time domain are those of a "
            'constant speed; "collocation" takes one that varies, `chatter simulate` cuts with it'
        )
    return time_limit_curve(model.case, model.structure.modes, speeds, depths, progress)


#: name on the command line and in case files -> method
METHODS: dict[str, LimitMethod] = {
    "collocation": by_collocation,
    "semi-discretization": by_semi_discretization,
    "semi-discretization-0": _by_scheme(ZerothOrder()),
    "semi-discretization-2": _by_scheme(SecondOrder()),
    "full-discretization": _by_scheme(FullDiscretization()),
    "matrix-free": by_matrix_free,
    "multi-frequency": by_multi_frequency,
    "zero-order": by_zero_order,
    "time-domain": by_time,
}
#: chooses among them
AUTO = "auto"


#: steps, and speeds they take, to the depth whose couplings stand for a corner; share it may miss
_SCALE_STEPS, _SPEEDS_FOR_SCALE, _SAME_SCALE = 8, 24, 0.05


@radius_by_group
def radius_by_semi_discretization(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,
    progress: Progress,
) -> NDArray[np.float64]:
    """Spectral radius (n,) at n points by first-order semi-discretization."""
    return np.abs(semi_discretization.multipliers(model.arrays, speeds, depths, steps, progress))


@radius_by_group
def radius_by_collocation(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001
    progress: Progress,
) -> NDArray[np.float64]:
    """Spectral radius (n,) at n points by collocation."""
    cut = model.cut(float(np.max(depths)))
    return np.abs(collocation.multipliers(cut, speeds, depths, progress))


@radius_by_group
def radius_by_matrix_free(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001
    progress: Progress,
) -> NDArray[np.float64]:
    """Spectral radius (n,) at n points from initial functions propagated in time."""
    cut = model.stepped_cut(float(np.max(depths)))
    return np.abs(matrix_free.multipliers(cut, speeds, depths, progress))


@radius_by_group
def radius_by_time(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001
    progress: Progress,
) -> NDArray[np.float64]:
    """Spectral radius (n,) at n points from the growth in simulated cuts."""
    from chatter.stability.methods.time_domain.critical_depths import growths

    found = growths(model.case, model.structure.modes, speeds, depths, progress)
    return np.array([growth.radius for growth in found])


#: methods that give the spectral radius on a grid; the others leave it to collocation
GRIDS = {
    "time-domain": radius_by_time,
    "semi-discretization": radius_by_semi_discretization,
    "matrix-free": radius_by_matrix_free,
}


def operating_multiplier(model: MillingModel, method: str, steps: int | None) -> Multiplier:
    """Dominant multiplier at the operating point of a case, with an estimate of its error.

    By semi-discretization or the matrix-free method where that is the method, else by collocation.
    """
    cut = model.case.cut
    speed, depth = cut.spindle_speed, cut.axial_depth
    if method == "matrix-free":
        return matrix_free.converged_multiplier(
            lambda fineness: model.stepped_cut(depth, fineness), speed, depth
        )
    if method != "semi-discretization":
        return collocation.converged_multiplier(
            lambda points, waves: model.cut(depth, points, waves), speed, depth
        )
    if steps is None:
        return semi_discretization.converged_multiplier(model.arrays, speed, depth)
    points = np.array([speed]), np.array([depth])
    coarse, fine = (
        semi_discretization.multipliers(model.arrays, *points, n)[0] for n in (steps, 2 * steps)
    )
    return Multiplier(complex(coarse), steps, float(abs(abs(coarse) - abs(fine)) * 4.0 / 3.0))


def operating_frequency(model: MillingModel, method: str = "collocation") -> float:
    """Frequency (Hz) of the motion that grows fastest, or dies out slowest, as the case cuts."""
    cut = model.case.cut
    point = cut.spindle_speed, cut.axial_depth
    if method == "matrix-free":
        return matrix_free.chatter_frequency(model.stepped_cut(cut.axial_depth), *point)
    return collocation.chatter_frequency(model.cut(cut.axial_depth), *point)


@zero_order_by_group
def zero_order_of(model: MillingModel, speeds: NDArray[np.float64]) -> ZeroOrderLimit:
    """Zeroth-order limits of a model at given speeds (rad/s).

    For teeth that are not alike the couplings are those at the depth of the case; where the edge is
    not upright, at about the lowest limit: a corner cuts ever more as the depth grows.
    """
    if model.is_uniform:
        total = model.mean_directional
        return zero_order_limit(*model.receptance, total, model.teeth, speeds)
    couplings = model.mean_couplings
    cutter = model.cutter
    if cutter.corner_radius > 0.0 or cutter.edge_angle < 0.5 * np.pi - 1e-9:
        depth = model.case.cut.axial_depth
        some = speeds[:: -(-len(speeds) // _SPEEDS_FOR_SCALE)]
        for _ in range(_SCALE_STEPS):
            lowest = _zero_order_of_delays(model, couplings, some).lowest_depth
            if not np.isfinite(lowest) or abs(np.log(lowest / depth)) < _SAME_SCALE:
                break
            # half the way: what is cut grows faster than the depth
            depth = float(np.sqrt(depth * lowest))
            couplings = model.mean_couplings_at(depth)
    return _zero_order_of_delays(model, couplings, speeds)


def _zero_order_of_delays(
    model: MillingModel,
    couplings: tuple[NDArray[np.float64], NDArray[np.float64]],
    speeds: NDArray[np.float64],
) -> ZeroOrderLimit:
    delays, means = couplings
    # of evenly spaced teeth with the same mean: the scale of the lowest limit
    even = zero_order_limit(*model.receptance, means.sum(axis=0), model.teeth, speeds)
    depth, frequency = limits_of_delays(*model.receptance, delays, means, speeds)
    return even._replace(
        critical_depth=depth,
        chatter_frequency=frequency,
        lowest_depth=min(even.lowest_depth, float(depth.min())),
    )


def chosen_method(case: Case, method: str | None) -> tuple[str, LimitMethod]:
    """Name and function of the method: as asked for, else as the case says, else the best.

    ``"auto"`` takes collocation, semi-discretization where the case fixes its steps, and the
    matrix-free method where tool and work have a contact, which it alone of the linear ones holds.

    Raises
    ------
    InputError
        If there is no such method.
    """
    name = method or (case.lobes.method if case.lobes else None) or AUTO
    if name == AUTO:
        name = "collocation" if case.contact is None else "matrix-free"
        name = name if resolution(case) is None else "semi-discretization"
    if name not in METHODS:
        known = ", ".join(f'"{key}"' for key in (AUTO, *METHODS))
        raise InputError(f'method "{name}" is not known; there are {known}')
    return name, METHODS[name]


def resolution(case: Case) -> int | None:
    """Steps a tooth period that the case fixes; None leaves them to the method."""
    return case.lobes.steps if case.lobes else None
