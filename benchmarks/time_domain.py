"""Time-domain engine against the floating-point peak, the memory bandwidth and jitcdde.

Every figure comes from one run on one core (see `benchmarks.one_core`), as the bounds do. Without
jitcdde (see `benchmarks.delay_equations`) its table says so.
"""

from __future__ import annotations

import importlib.util
import math
import statistics
import time
from collections.abc import Callable
from typing import ClassVar

import numpy as np
from numba import njit

from benchmarks.delay_equations import agreement, delay_equations
from benchmarks.one_core import REPEATS, bandwidth_of, floating_point_peak, show, timed
from chatter.description.case import Case
from chatter.simulation.setup import Setup, set_up
from chatter.simulation.simulate import run_setup
from cutting.dexel.carving import dexel_carve, dexel_chip_thickness
from cutting.dexel.stock import dexel_remove_path, dexel_stock
from cutting.engagement.immersion import slice_engagement
from cutting.voxel.carving import voxel_carve, voxel_chip_thickness
from cutting.voxel.stock import voxel_remove_path, voxel_stock

TEETH, SLICES, STEPS, TURNS = 4, 10, 800, 100
AIM = 15.0  # ns a tooth-slice-step


# 1. Delayed chip


def delayed_case(mode: str, immersion: float, law: str) -> Case:
    """Four teeth of ten slices, stable, two degrees of freedom."""
    flexible = {"frequency": "900 Hz", "damping": 0.02, "mass": "0.3 kg"}
    material = {"Ktc": "600 MPa", "Krc": "200 MPa", "Kac": "100 MPa"}
    if law == "exponential":
        material |= {"law": law, "h0": "0.1 mm", "exponent": 0.75}
    return Case.from_dict(
        {
            "tool": {"teeth": TEETH, "diameter": "12 mm", "helix": "30 deg"},
            "material": material,
            "cut": {
                "mode": mode,
                "spindle_speed": "6000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "0.5 mm",
                "radial_depth": 12e-3 * immersion,
            },
            "structure": {
                "mode": [{**flexible, "direction": [1, 0, 0]}, {**flexible, "direction": [0, 1, 0]}]
            },
            "simulation": {"revolutions": TURNS, "slices": SLICES, "steps": STEPS},
        }
    )


def engaged_share(setup: Setup) -> float:
    """Share of the tooth-slice-steps whose slice has its middle in the arc of the cut."""
    angle = setup.slices.angle
    entry, leave = slice_engagement(setup.case.uncut_band, setup.slices.radius)
    bins = setup.resolution.steps_per_revolution
    turn = np.arange(bins)[:, None, None] * 2 * math.pi / bins
    place = np.mod(turn + angle - entry, 2 * math.pi)
    return float(np.mean(place < leave - entry))


def counted_operations(law: str) -> int:
    """Floating-point operations of an engaged slice in a step, counted from the formulas.

    Two Gauss points; comparisons count as one, a power as 40 (a logarithm and an exponential, each
    a polynomial of some ten terms). What a tooth's slices share (the motion since each earlier
    pass) and the structure are left out, so that the bound is a lower one.
    """
    direction = 6  # sine and cosine of a sum of angles, the spindle's being known
    # two products with the immersion; each pass three products, three sums, the least of all
    chip = 2 + TEETH * (3 + 3 + 1)
    law_only = 3 * 2 + (42 if law == "exponential" else 0)  # K h + K_e; h0 (h/h0)^p
    rotation = 12  # into x, y, z
    sums = 3 * 2 + 3 + 1  # length times force, torque, length
    ends = 7  # the chip at both ends, for loss of contact
    to_tool = 10
    return 2 * (direction + chip + law_only + rotation + sums) + ends + to_tool


def state_bytes(table: object) -> int:
    """Bytes of all arrays in nested tables."""
    if isinstance(table, np.ndarray):
        return table.nbytes
    return sum(map(state_bytes, table)) if isinstance(table, tuple) else 0


def delayed_chip(peak: float) -> list[dict]:
    """Time of a tooth-slice-step, and its share of the floating-point peak."""
    rows = []
    for name, mode, immersion in (
        ("half immersion, down", "down", 0.5),
        ("slot", "slot", 1.0),
        ("5 % immersion, down", "down", 0.05),
    ):
        for law in ("linear", "exponential"):
            case = delayed_case(mode, immersion, law)
            setup = set_up(case)
            number = setup.resolution.steps * setup.slices.angle.size
            taken = timed(lambda case=case: run_setup(set_up(case)))
            share, operations = engaged_share(setup), counted_operations(law)
            each = taken.shortest * 1e9 / number
            bound = operations / peak * 1e9
            rows.append(
                (
                    name,
                    law,
                    each,
                    taken.median * 1e9 / number,
                    each / AIM,
                    share,
                    each / share,
                    operations,
                    bound,
                    f"{100 * bound * share / each:.1f} %",
                )
            )
    print(
        f"state of the cut {state_bytes(setup.groups) / 1024:.0f} KiB (stays in the caches); "
        f"{TEETH} teeth, {SLICES} slices, {STEPS} steps a turn, {TURNS} turns"
    )
    return show(
        f"1. Delayed chip: `run_setup`, ns a tooth-slice-step (aim {AIM:g}); bound by the peak",
        "cut|law|ns|median|of aim|engaged|ns engaged|operations|bound ns|of peak",
        rows,
    )


# 2. Dexel and voxel workpiece

RADIUS, FEED, WINDOW, CARVING_TEETH = 5e-3, 0.15e-3, 0.4e-3, 2


@njit
def _dexel_run(stock, axis, edge, thickness):
    for i in range(1, axis.shape[0]):
        (ax, ay), (bx, by) = axis[i - 1], axis[i]
        for tooth in range(edge.shape[1]):
            (px, py), (qx, qy) = edge[i - 1, tooth], edge[i, tooth]
            h = dexel_chip_thickness(stock, 0, tooth, ax, ay, px, py, bx, by, qx, qy)
            thickness[i, tooth] = h
            dexel_carve(stock, 0, tooth, ax, ay, px, py, bx, by, qx, qy)


@njit
def _voxel_run(stock, axis, edge, thickness):
    for i in range(1, axis.shape[0]):
        (ax, ay), (bx, by) = axis[i - 1], axis[i]
        for tooth in range(edge.shape[1]):
            (px, py), (qx, qy) = edge[i - 1, tooth], edge[i, tooth]
            h = voxel_chip_thickness(stock, 0, tooth, ax, ay, px, py, bx, by, qx, qy)
            thickness[i, tooth] = h
            voxel_carve(stock, 0, tooth, ax, ay, px, py, bx, by, qx, qy)


def edge_path(turns: float, first: float, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Axis (n, 2) and edges (n, teeth, 2) of a tool that feeds along x, m."""
    turn = first + np.arange(round(turns * steps) + 1) / steps
    axis = np.stack([FEED * CARVING_TEETH * turn, np.zeros(turn.size)], -1)
    angle = 2 * math.pi * (turn[:, None] + np.arange(CARVING_TEETH) / CARVING_TEETH)
    return axis, axis[:, None] + RADIUS * np.stack([np.sin(angle), np.cos(angle)], -1)


class Watched(np.ndarray):
    """Array that notes the cache lines (64 bytes) of the numbers read from and written to it."""

    read: ClassVar[set[int]] = set()
    written: ClassVar[set[int]] = set()

    def _line(self, index: object) -> int:
        places = index if isinstance(index, tuple) else (index,)
        offset = sum(int(i) * s for i, s in zip(places, self.strides, strict=True))
        return (self.__array_interface__["data"][0] + offset) // 64

    def __getitem__(self, index: object) -> object:
        """Note a number read."""
        value = super().__getitem__(index)
        if not isinstance(value, np.ndarray):
            Watched.read.add(self._line(index))
        return value

    def __setitem__(self, index: object, value: object) -> None:
        """Note a number written."""
        Watched.written.add(self._line(index))
        super().__setitem__(index, value)


def watched(array: np.ndarray) -> Watched:
    """Watched copy that begins with a cache line."""
    room = np.zeros(array.nbytes + 64, dtype=np.uint8)
    start = -room.ctypes.data % 64
    copy = room[start : start + array.nbytes].view(array.dtype).reshape(array.shape)
    copy[...] = array
    return copy.view(Watched)


def bytes_a_call(stock: tuple, run: Callable, axis: np.ndarray, edge: np.ndarray) -> float:
    """Bytes of the stock touched by a call, in whole cache lines; those written count twice."""
    arrays = {k: watched(v) for k, v in stock._asdict().items() if isinstance(v, np.ndarray)}
    seen, total = stock._replace(**arrays), 0
    thickness = np.zeros((2, 1))
    for i in range(1, len(axis)):
        # one tooth: the other does the same half a turn later
        Watched.read, Watched.written = set(), set()
        run.py_func(seen, axis[i - 1 : i + 1], edge[i - 1 : i + 1, :1], thickness)
        total += 64 * (len(Watched.read | Watched.written) + len(Watched.written))
    return total / (len(axis) - 1)


def slotted(kind: str, resolution: float) -> tuple:
    """Block with a slot up to x = 0."""
    make = dexel_stock if kind == "dexel" else voxel_stock
    remove = dexel_remove_path if kind == "dexel" else voxel_remove_path
    block = ((-6e-3, 9e-3, -6e-3, 6e-3), True)
    stock = make([[block]], 1, resolution, CARVING_TEETH, WINDOW)
    remove(stock, 0, -12e-3, 0.0, 0.0, 0.0, RADIUS)
    return stock


def workpieces(bandwidth: float) -> list[dict]:
    """Pairs of thickness and carve a second, and their share of the memory bandwidth."""
    steps, turns, rows = 720, 8, []
    settling, path = edge_path(2, 0.0, steps), edge_path(turns, 2.0, steps)
    for kind, run in (("dexel", _dexel_run), ("voxel", _voxel_run)):
        for resolution in (20e-6, 50e-6):
            taken = []
            for _ in range(REPEATS):
                stock = slotted(kind, resolution)
                run(stock, *settling, np.zeros(settling[1].shape[:2]))
                thickness = np.zeros(path[1].shape[:2])
                start = time.thread_time()
                run(stock, *path, thickness)
                taken.append(time.thread_time() - start)
            calls = thickness[1:].size
            share = float(np.mean(thickness[1:] > 0.0))
            turn = edge_path(1, 2.0 + turns, steps)
            touched = bytes_a_call(stock, run, *turn)
            shortest, median = min(taken) / calls, statistics.median(taken) / calls
            bound = touched / bandwidth
            rows.append(
                (
                    kind,
                    f"{resolution * 1e6:.0f} um",
                    f"{1e-6 / shortest:.2f}",
                    f"{1e-6 / median:.2f}",
                    shortest * 1e9,
                    share,
                    f"{1e-6 * share / shortest:.2f}",
                    f"{touched:.0f}",
                    bound * 1e9,
                    f"{100 * bound / shortest:.1f} %",
                    f"{state_bytes(stock) / 1024:.0f} KiB",
                )
            )
    return show(
        f"2. Workpiece: thickness and carve, slot, {CARVING_TEETH} teeth, {steps} steps a turn; "
        "bound by the memory bandwidth",
        "kind|resolution|1e6 pairs/s|median|ns a pair|in the cut|1e6 removals/s|"
        "bytes a pair|bound ns|of bandwidth|stock",
        rows,
    )


def main() -> dict[str, list[dict]]:
    """Print all tables and return them."""
    peak, bandwidth, cached = floating_point_peak(), bandwidth_of(1 << 24), bandwidth_of(1 << 13)
    print(
        f"one core: {peak / 1e9:.1f} Gflop/s of vector multiply-adds; copies "
        f"{bandwidth / 1e9:.1f} GB/s in memory, {cached / 1e9:.1f} GB/s in 128 KiB of cache"
    )
    tables = {"delayed chip": delayed_chip(peak), "workpiece": workpieces(bandwidth)}
    if importlib.util.find_spec("jitcdde") is None:
        print("\n3. jitcdde is not installed; pip install jitcdde setuptools")
        return tables
    return tables | {"delay equation": delay_equations(), "agreement": agreement()}


if __name__ == "__main__":
    main()
