"""Spectral radius on the grid of a stability diagram, in blocks of speeds on a cluster."""

from __future__ import annotations

from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import Executor
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.registry import METHODS, fixed_steps, with_radius
from chatter.studies.model import fingerprint
from chatter.studies.result_cache import ResultCache

_SPEEDS_PER_BLOCK = 4


def radius_in_blocks(
    case: Case,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    method: str,
    cluster: str | Executor | None = None,
    folder: str | Path | None = None,
    progress: Progress = no_progress,
) -> NDArray[np.float64]:
    """Spectral radius (depths, speeds) on every pair of speed and depth.

    Parameters
    ----------
    case : Case
    speeds, depths : array of float
        rad/s, m.
    method : str
        Name in `chatter.stability.registry.METHODS`.
    cluster : str or Executor, optional
        As for `chatter.studies.executor.open_executor`.
    folder : path, optional
        Keeps finished blocks in the result cache there, and reuses those of the same input.
    progress : callable
        Called with (done, total) blocks.

    Raises
    ------
    RunError
        If it is interrupted; finished blocks are in the folder.
    """
    blocks = [
        np.arange(first, min(first + _SPEEDS_PER_BLOCK, len(speeds)))
        for first in range(0, len(speeds), _SPEEDS_PER_BLOCK)
    ]
    radius_at = partial(_radius_of_speeds, case, depths, method)
    wanted = [speeds[block] for block in blocks]
    with ResultCache(folder, "grid", fingerprint(case), method, repr(depths.tolist())) as cache:
        keys = [cache.key(repr(block.tolist())) for block in wanted]
        found = cache.evaluate(
            radius_at, wanted, keys, "blocks of the grid", cluster=cluster, progress=progress
        )
    return np.concatenate([np.array(one, dtype=np.float64) for one in found], axis=1)


@lru_cache(maxsize=2)
def _model_of(case: Case) -> MillingModel:
    return milling_model(case)


def _radius_of_speeds(
    case: Case, depths: NDArray[np.float64], method: str, speeds: NDArray[np.float64]
) -> list[list[float]]:
    """Spectral radius of a block, as JSON knows it."""
    speed, depth = (part.ravel() for part in np.meshgrid(speeds, depths))
    chosen = with_radius(METHODS[method])
    radius = chosen.radius(_model_of(case), speed, depth, fixed_steps(case), no_progress)
    return radius.reshape(len(depths), len(speeds)).tolist()
