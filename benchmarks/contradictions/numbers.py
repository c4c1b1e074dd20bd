"""Numbers of a case by the product, in the form in which confrontations compare them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.contradictions.confrontation import Comparison, PremiseFailsError, relative
from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup
from chatter.stability.forced_vibration import notes_on_steady_cut
from chatter.stability.methods.collocation.collocation_method import COLLOCATION
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.registry import METHODS

#: depths of the grid of limits, and how far it goes in depths of the cut
_DEPTHS, _REACH = 48, 6.0


def signals(case: Case) -> NDArray[np.float64]:
    """Rows (n, 7) of forces, N, displacements, m, and torque, N m, of a simulated cut."""
    result, _ = run_setup(set_up(case))
    return result.rows


def rows_compared(
    one: NDArray[np.float64], other: NDArray[np.float64], share: float
) -> list[Comparison]:
    """Forces and displacements of two runs sample by sample, over the peaks of the second."""
    names = ("force, N", "displacement, m", "torque, N m")
    columns = (slice(0, 3), slice(3, 6), slice(6, 7))
    length = min(len(one), len(other))
    found = []
    for name, part in zip(names, columns, strict=True):
        a, b = one[:length, part], other[:length, part]
        scale = float(np.abs(b).max(initial=0.0))
        place = np.unravel_index(np.argmax(np.abs(a - b)), a.shape)
        found.append(relative(name, a[place], b[place], share, scale))
    return found


def spectral_radius(case: Case, method: str = "collocation") -> tuple[float, float]:
    """Spectral radius of a cut and its stated error."""
    found = METHODS[method].multiplier(milling_model(case), None)
    return abs(found.value), found.error


def critical_depths(model: MillingModel, methods: Sequence[str]) -> dict[str, tuple[float, float]]:
    """First limit, m, and its stated relative error by each method, at the speed of the cut.

    On the same grid of depths, to three times that of the cut.
    """
    speeds = np.array([model.case.cut.spindle_speed])
    depths = np.linspace(0.0, _REACH * model.case.cut.axial_depth, _DEPTHS + 1)[1:]
    found = {}
    for name in methods:
        limit = METHODS[name].limits(model, speeds, depths, None, no_progress)
        found[name] = float(limit.critical_depth[0]), float(np.nan_to_num(limit.error))
    return found


def refuse_large_vibration(case: Case) -> None:
    """PremiseFailsError where the product says that the steady cut is not the linear one."""
    notes = notes_on_steady_cut(milling_model(case), COLLOCATION)
    if notes:
        raise PremiseFailsError(notes[0])
