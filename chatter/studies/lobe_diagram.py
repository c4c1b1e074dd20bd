"""`lobes`: a stability lobe diagram, its grid in blocks of speeds on a cluster where asked for."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import Executor
from chatter.stability import diagram
from chatter.stability.diagram import LobeDiagram, StabilityGrid
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.registry import GRIDS, radius_by_collocation, resolution
from chatter.stability.search_range import axial_depths, spindle_speeds
from chatter.studies.model import fingerprint
from chatter.studies.result_cache import ResultCache

_SPEEDS_PER_BLOCK = 4


def lobes(
    case: Case,
    method: str | None = None,
    grid: bool = False,
    progress: Progress = no_progress,
    cluster: str | Executor | None = None,
    folder: str | Path | None = None,
) -> LobeDiagram:
    """Compute the stability lobe diagram of a case.

    Parameters
    ----------
    case : Case
    method : str, optional
        One of `chatter.stability.registry.METHODS`, or "auto"; by default what the case says,
        else "auto".
    grid : bool
        Also the spectral radius on the whole grid of speeds and depths.
    progress : callable, optional
        Called with (done, total) speeds.
    cluster : str or Executor, optional
        Where the grid is computed, as for `chatter.studies.executor.open_executor`; None: here.
    folder : path, optional
        On a cluster, keeps finished blocks of the grid in the result cache there.

    Returns
    -------
    LobeDiagram

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be computed.
    RunError
        If the grid is interrupted; finished blocks are in the folder.
    """
    found = diagram.lobes(case, method, grid and cluster is None, progress)
    if not grid or cluster is None:
        return found
    speeds, depths = spindle_speeds(case), axial_depths(case, found.deepest)
    blocks = [
        speeds[first : first + _SPEEDS_PER_BLOCK]
        for first in range(0, len(speeds), _SPEEDS_PER_BLOCK)
    ]
    radius_at = partial(_radius_of_speeds, case, depths, found.method)
    inputs = ("grid", fingerprint(case), found.method, repr(depths.tolist()))
    with ResultCache(folder, *inputs) as cache:
        keys = [cache.key(repr(block.tolist())) for block in blocks]
        records = cache.evaluate(radius_at, blocks, keys, "blocks of the grid", cluster, progress)
    radius = np.concatenate([np.array(one, dtype=np.float64) for one in records], axis=1)
    return replace(found, grid=StabilityGrid(speeds, depths, radius))


@lru_cache(maxsize=2)
def _model_of(case: Case) -> MillingModel:
    return milling_model(case)


def _radius_of_speeds(
    case: Case, depths: NDArray[np.float64], method: str, speeds: NDArray[np.float64]
) -> list[list[float]]:
    """Spectral radius of a block, as JSON knows it."""
    speed, depth = (part.ravel() for part in np.meshgrid(speeds, depths))
    radius_at = GRIDS.get(method, radius_by_collocation)
    radius = radius_at(_model_of(case), speed, depth, resolution(case), no_progress)
    return radius.reshape(len(depths), len(speeds)).tolist()
