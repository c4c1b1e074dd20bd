"""Speed-dependent dynamics for methods that take one structure.

The speeds of a sweep are grouped by their reference speed, whose structure they share; every group
goes to the method on a model with that structure.
"""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from chatter.compile.structure import reference_speeds
from chatter.description.arrays import Array, IntegerArray
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import each, one_thread, worker_count
from chatter.stability.model import MillingModel
from dynamics.modal.modes import inside_band

Result = TypeVar("Result")
#: called with the model of a group, the indices of its speeds, and its progress
OfGroup = Callable[[MillingModel, IntegerArray, Progress], Result]

#: below this many groups per thread, the threads work inside each group instead
_GROUPS_PER_THREAD = 4


def over_reference_speeds(
    model: MillingModel, speeds: Array, of_group: OfGroup, progress: Progress
) -> list[tuple[IntegerArray, Result]]:
    """Indices and result of every group of speeds (rad/s) with the same structure."""
    if not model.depends_on_speed:
        index = np.arange(len(speeds))
        return [(index, of_group(model, index, progress))]
    reference, group_of = np.unique(reference_speeds(model.case, speeds), return_inverse=True)
    groups = [np.flatnonzero(group_of == group) for group in range(reference.size)]
    if reference.size < _GROUPS_PER_THREAD * worker_count():
        found, done = [], 0
        for speed, index in zip(reference, groups, strict=True):
            found.append(of_group(model.at_speed(float(speed)), index, no_progress))
            done += index.size
            progress(done, len(speeds))
        return list(zip(groups, found, strict=True))

    def at(group: int) -> Result:
        with one_thread():
            return of_group(model.at_speed(float(reference[group])), groups[group], no_progress)

    return list(zip(groups, each(at, reference.size, progress), strict=True))


def natural_frequencies(model: MillingModel, speeds: Array) -> Array:
    """Natural frequencies (k, n), Hz, of k modes at n speeds (rad/s).

    Of FRFs measured at several speeds those at the speed of the cut.
    """
    given = model.case.structure.mode
    if given and model.depends_on_speed:
        return np.array([[mode.frequency_at(float(speed)) for speed in speeds] for mode in given])
    own = np.array([mode.frequency for mode in inside_band(model.structure.modes)])
    return np.repeat(own[:, None], len(speeds), axis=1)
