"""The methods that give stability limits, behind one call.

Adding a method is one function here and one entry in `METHODS`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.errors import InputError
from chatter.model import MillingModel
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.semi_discretization import limit_curve, multipliers
from chatter.stability.sweep import Progress
from chatter.stability.zero_order import ZeroOrderLimit, zero_order_limit

LimitMethod = Callable[
    [MillingModel, NDArray[np.float64], NDArray[np.float64], "int | None", Progress], LimitCurve
]


def by_semi_discretization(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,
    progress: Progress,
) -> LimitCurve:
    """Limits by first-order semi-discretization of the modal model."""
    return limit_curve(model.arrays, speeds, depths, steps, progress)


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


def by_time(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001  (every method has the same signature)
    progress: Progress,
) -> LimitCurve:
    """Limits from cuts simulated in the time domain, with all that the simulation holds."""
    from chatter.simulation.limits import time_limit_curve

    return time_limit_curve(model.case, model.structure.modes, speeds, depths, progress)


#: name on the command line and in case files -> method
METHODS: dict[str, LimitMethod] = {
    "semi-discretization": by_semi_discretization,
    "zero-order": by_zero_order,
    "time": by_time,
}


def radius_by_semi_discretization(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,
    progress: Progress,  # noqa: ARG001
) -> NDArray[np.float64]:
    """Spectral radius (n,) at n points by first-order semi-discretization."""
    return np.abs(multipliers(model.arrays, speeds, depths, steps))


def radius_by_time(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001
    progress: Progress,
) -> NDArray[np.float64]:
    """Spectral radius (n,) at n points from the growth in simulated cuts."""
    from chatter.simulation.limits import growths

    found = growths(model.case, model.structure.modes, speeds, depths, progress)
    return np.array([growth.radius for growth in found])


#: methods that give the spectral radius on a grid; the others leave it to semi-discretization
GRIDS = {"time": radius_by_time}


DEFAULT_METHOD = "semi-discretization"


def zero_order_of(model: MillingModel, speeds: NDArray[np.float64]) -> ZeroOrderLimit:
    """Zeroth-order limits of a model at given speeds (rad/s)."""
    return zero_order_limit(*model.receptance, model.mean_directional, model.teeth, speeds)


def chosen_method(case: Case, method: str | None) -> tuple[str, LimitMethod]:
    """Name and function of the method: as asked for, else as the case says, else the default.

    Raises
    ------
    InputError
        If there is no such method.
    """
    name = method or (case.lobes.method if case.lobes else None) or DEFAULT_METHOD
    if name not in METHODS:
        known = ", ".join(f'"{key}"' for key in METHODS)
        raise InputError(f'method "{name}" is not known; there are {known}')
    return name, METHODS[name]


def resolution(case: Case) -> int | None:
    """Steps a tooth period that the case fixes; None leaves them to the method."""
    return case.lobes.steps if case.lobes else None
