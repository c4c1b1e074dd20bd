"""First use: the two large drivers of collocation are compiled side by side, in two processes."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import numba
import numpy as np

from chatter.engine.parallel import worker_count
from chatter.engine.presets import is_compiled
from chatter.stability.methods.collocation import drivers
from chatter.stability.methods.collocation.coupling_assembly import coupling_assemblies
from chatter.stability.methods.collocation.coupling_structure import CouplingAssemblies
from chatter.stability.methods.collocation.element_assembly import OperatorArrays, Structure
from chatter.stability.methods.collocation.element_cut import RESOLUTION, ElementCut
from chatter.stability.methods.collocation.element_response import element_points, response_table

_compiling = threading.Lock()


def compile_side_by_side(cut: ElementCut) -> None:
    """Compile what collocation needs where the cache does not hold it, in half the time.

    A second process compiles the map and its multipliers and leaves them in the cache, while this
    one compiles the assemblies, of any cut. Where it cannot, what is missing is compiled at its
    first call.
    """
    if drivers.element_multipliers.signatures:
        return
    with _compiling:
        if worker_count() < 2 or is_compiled(drivers.element_multipliers):
            return
        other = _start()
        if other is None:
            return
        try:
            coupling_assemblies(cut, np.ones(1), np.zeros(1))
            drivers.points_of_periods(cut, np.ones(1), 0.0)
            other.wait()
        finally:
            other.kill()


def _start() -> subprocess.Popen | None:
    """Start the second process; None where there is no interpreter that could run it."""
    if getattr(sys, "frozen", False) or not sys.executable:
        return None
    root = str(Path(__file__).resolve().parents[4])
    before = os.environ.get("PYTHONPATH")
    path = root if before is None else os.pathsep.join((root, before))
    try:
        return subprocess.Popen(
            [sys.executable, "-m", __name__],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    except OSError:
        return None


def arguments_of_operator() -> tuple[OperatorArrays, CouplingAssemblies, np.ndarray, np.ndarray]:
    """Arguments of the second driver, of the types that every cut has."""
    one, damping = np.ones(1), np.full(1, 0.1)
    points = element_points(RESOLUTION[0])
    structure = Structure(one, damping, np.ones((1, 1)), np.ones((1, 1)))
    whole = np.zeros(1, dtype=np.int64)
    return (
        OperatorArrays(structure, points, response_table(one, damping, points, 1.0), False, 1.0),
        CouplingAssemblies(whole, whole, one, whole, whole),
        one,
        np.zeros(1, dtype=np.bool_),
    )


if __name__ == "__main__":
    drivers.element_multipliers.compile(tuple(numba.typeof(a) for a in arguments_of_operator()))
