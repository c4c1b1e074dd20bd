"""Limits, maps and charts of stability."""

import statistics
import time

import numpy as np

import chatter
from benchmarks.figures.figure import Figure, Reached, shortest
from benchmarks.scaling import cost, operations, peak
from benchmarks.stability import RPM, plain_spectral_radius, two_degrees_of_freedom
from chatter.description.case import Case
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import ElementCut, element_cut
from chatter.stability.model import milling_model

_DEEPEST, _SERIES = 2e-3, 40
#: pixels of a chart, and those that are compared with the spectral radius
_COLUMNS, _ROWS, _COMPARED = 1920, 1080, 2000
#: Arnoldi vectors of a point with two modes (`benchmarks.scaling`)
_KRYLOV = 7


def _two_modes() -> ElementCut:
    return element_cut(milling_model(two_degrees_of_freedom(0.5)), _DEEPEST, 6, 1.0)


def _limits() -> Reached:
    cut, speeds = _two_modes(), np.linspace(5000, 25000, 400) * RPM
    depths = np.linspace(0.0, _DEEPEST, 21)[1:]

    def once() -> float:
        begun = time.perf_counter()
        collocation.limit_curve(cut, speeds, depths, tolerance=5e-3, stride=8)
        return time.perf_counter() - begun

    once()
    taken = [once() for _ in range(_SERIES)]
    worst = f"shortest {1e3 * min(taken):.0f}, longest {1e3 * max(taken):.0f} ms"
    return Reached(1e3 * statistics.median(taken), worst)


def _map() -> Reached:
    model = milling_model(two_degrees_of_freedom(0.1))
    cut = element_cut(model, 10e-3, 6, 1.0)
    speeds, depths = np.meshgrid(
        np.linspace(5000, 25000, 401) * RPM, np.linspace(0.0, 10e-3, 202)[1:]
    )
    points = speeds.ravel(), depths.ravel()
    wall = shortest(lambda: collocation.multipliers(cut, *points))
    seconds, nodes = cost(cut, 8e3, 1e4, 1e-3)
    share = operations(cut, nodes, _KRYLOV) / seconds / peak()
    plain = shortest(lambda: plain_spectral_radius(9000 * RPM, 1e-3, 0.1), 2)
    return Reached(
        wall,
        f"{100 * share:.0f} % of the peak of a core, couplings not counted",
        f"textbook semi-discretization, 40 steps: {plain * points[0].size:.0f} s",
    )


def _one_mode() -> Case:
    keys = {"frequency": "922 Hz", "damping": 0.011, "mass": "0.03993 kg", "direction": [0, 1, 0]}
    return two_degrees_of_freedom(0.5).patch({"structure.mode": [keys]})


def stable_chart(cut: ElementCut, speeds: np.ndarray, deepest: float, rows: int) -> np.ndarray:
    """Whether each pixel (rows, n) of a chart is stable, from all limits at every speed.

    Below the first limit the cut is stable, and at each further one that changes.
    """
    depths = np.linspace(0.0, deepest, 41)[1:]
    found = collocation.limit_curve(cut, speeds, depths, tolerance=0.2 / rows)
    heights = (np.arange(rows) + 0.5) * deepest / rows
    chart = np.empty((rows, len(speeds)), dtype=bool)
    for column, limits in enumerate(found.crossings):
        chart[:, column] = np.searchsorted(limits, heights) % 2 == 0
    return chart


def _chart() -> Reached:
    cut = element_cut(milling_model(_one_mode()), _DEEPEST, 6, 1.0)
    speeds = np.linspace(5000, 25000, _COLUMNS) * RPM
    wall = shortest(lambda: stable_chart(cut, speeds, _DEEPEST, _ROWS))
    chart = stable_chart(cut, speeds, _DEEPEST, _ROWS)
    rng = np.random.default_rng(1)
    row, column = rng.integers(_ROWS, size=_COMPARED), rng.integers(_COLUMNS, size=_COMPARED)
    depth = (row + 0.5) * _DEEPEST / _ROWS
    begun = time.perf_counter()
    radius = np.abs(collocation.multipliers(cut, speeds[column], depth))
    pixelwise = (time.perf_counter() - begun) * _ROWS * _COLUMNS / _COMPARED
    wrong = int(np.sum((radius < 1.0) != chart[row, column]))
    return Reached(
        wall, f"{wrong} of {_COMPARED} pixels off", f"|mu| at every pixel: {pixelwise:.0f} s"
    )


def _varying() -> Reached:
    varied = {"amplitude": 0.1, "frequency": "10 Hz", "shape": "sine"}
    case = two_degrees_of_freedom(0.5, speed_variation=varied)
    return _diagram(case)


def _everything() -> Reached:
    tool = {
        "kind": "bull nose", "teeth": 3, "corner_radius": "2 mm",
        "pitch": ["110 deg", "120 deg", "130 deg"], "helix": ["28 deg", "30 deg", "32 deg"],
        "runout": {"offset": "10 um", "angle": "30 deg"},
    }  # fmt: skip
    case = two_degrees_of_freedom(0.5, tool)
    size = {"law": "exponential", "h0": "0.1 mm", "exponent": 0.75}
    case = case.patch({f"material.{key}": value for key, value in size.items()})
    return _diagram(case)


def _diagram(case: Case) -> Reached:
    """Wall time of a diagram, once: it takes long, and was compiled by a small one before."""
    speeds = {"from": "8000 rpm", "to": "16000 rpm"}
    chatter.lobes(case.patch({"lobes.speeds": {**speeds, "count": 4}}))
    begun = time.perf_counter()
    found = chatter.lobes(case.patch({"lobes.speeds": {**speeds, "count": 400}}))
    wall = time.perf_counter() - begun
    return Reached(wall, f"estimated error of the limits {100 * found.limits.error:.2g} %")


FIGURES = (
    Figure("limits", "400 limits to 0.5 %, median of 40 series", 25.0, "ms", _limits),
    Figure("map", "401 x 201 spectral radii, 2 modes", 0.4, "s", _map),
    Figure("chart", "stable or not, 1920 x 1080, 1 mode", 1.0, "s", _chart),
    Figure("varying speed", "400 limits, speed varied by 10 %", 1.0, "s", _varying),
    Figure("everything", "bull nose, 3 pitches, 3 helices, runout, size effect", 3.0, "s",
           _everything),
)  # fmt: skip
