"""Time-domain engine against the floating-point peak, the memory bandwidth and jitcdde.

Every figure comes from one run on one core: the shortest and the median of some repeats, warm, with
compilation left out. Times are those of the processor in the only thread that works, which other
programs on the machine lengthen less than those of the clock. The bounds are measured in the same
run. jitcdde (Ansmann 2018), a compiled integrator of general delay differential equations, is no
dependency of the project; without it its table says so.
"""

from __future__ import annotations

import contextlib
import importlib.util
import math
import os
import statistics
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar, NamedTuple

# figures of one core: threads of the linear algebra would wait for a busy second one
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numba import njit

from chatter.description.case import Case
from chatter.simulation.setup import Setup, set_up
from chatter.simulation.simulate import run_setup
from cutting.dexel.carving import dexel_carve, dexel_chip_thickness
from cutting.dexel.stock import dexel_remove_path, dexel_stock
from cutting.engagement.immersion import slice_engagement
from cutting.voxel.carving import voxel_carve, voxel_chip_thickness
from cutting.voxel.stock import voxel_remove_path, voxel_stock

REPEATS = 7
TEETH, SLICES, STEPS, TURNS = 4, 10, 800, 100
AIM = 15.0  # ns a tooth-slice-step


class Timing(NamedTuple):
    """Shortest and median of repeats, s."""

    shortest: float
    median: float


def timed(call: Callable[[], object], repeats: int = REPEATS) -> Timing:
    """Time a call that was made once before."""
    call()
    taken = []
    for _ in range(repeats):
        start = time.thread_time()
        call()
        taken.append(time.thread_time() - start)
    return Timing(min(taken), statistics.median(taken))


def show(title: str, heads: str, rows: list[tuple]) -> list[dict]:
    """Print a table, its heads parted by bars, and return its rows by column."""
    columns = heads.split("|")
    text = [
        tuple(columns),
        *[tuple(x if isinstance(x, str) else f"{x:.3g}" for x in row) for row in rows],
    ]
    widths = [max(len(row[i]) for row in text) for i in range(len(columns))]
    print(f"\n{title}")
    for row in text:
        print("  " + "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)))
    return [dict(zip(columns, row, strict=True)) for row in rows]


# Bounds of one core


@njit(fastmath={"contract"}, error_model="numpy")
def _independent_fmas(value, factor, rounds):
    """16 multiply-adds on each of the values, which do not depend on each other."""
    for _ in range(rounds):
        for i in range(value.shape[0]):
            x = value[i]
            x = x * factor + 1e-9
            x = x * factor + 2e-9
            x = x * factor + 3e-9
            x = x * factor + 4e-9
            x = x * factor + 5e-9
            x = x * factor + 6e-9
            x = x * factor + 7e-9
            x = x * factor + 8e-9
            x = x * factor + 9e-9
            x = x * factor + 10e-9
            x = x * factor + 11e-9
            x = x * factor + 12e-9
            x = x * factor + 13e-9
            x = x * factor + 14e-9
            x = x * factor + 15e-9
            x = x * factor + 16e-9
            value[i] = x


def floating_point_peak() -> float:
    """Operations a second of one core, a multiply-add counted as two."""
    value, rounds = np.ones(512), 20_000
    taken = timed(lambda: _independent_fmas(value, 0.999, rounds))
    return 2 * 16 * value.size * rounds / taken.shortest


@njit
def _copies(source, target, rounds):
    """Copy arrays again and again."""
    for _ in range(rounds):
        target[:] = source


def bandwidth_of(numbers: int) -> float:
    """Bytes a second that one core copies, read and written, in arrays of so many numbers."""
    source, target = np.ones(numbers), np.zeros(numbers)
    rounds = max(1, (1 << 24) // numbers)
    taken = timed(lambda: _copies(source, target, rounds))
    return 2 * source.nbytes * rounds / taken.shortest


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


# 3. jitcdde

FREQUENCY, DAMPING, MASS, STRAIGHT_TEETH = 900.0, 0.02, 0.3, 2
TANGENTIAL, RADIAL, DEPTH, DELAYED_FEED, RPM = 600e6, 200e6, 0.2e-3, 0.1e-3, 6000.0
AGREEMENT_DEPTHS = (0.2e-3, 0.5e-3, 1e-3)
PERIOD = 60.0 / RPM / STRAIGHT_TEETH  # s, of a tooth
PERIODS = 40
SAMPLES = 12  # in half a tooth period
ENGINE_STEPS = (720, 1440, 2880, 5760, 11520)
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)


def straight_case(steps: int, depth: float) -> Case:
    """Half immersion, down, two straight teeth, linear law: the case of the delay equation."""
    flexible = {"frequency": FREQUENCY, "damping": DAMPING, "mass": MASS}
    return Case.from_dict(
        {
            "tool": {"teeth": STRAIGHT_TEETH, "diameter": "10 mm", "helix": 0.0},
            "material": {"Ktc": TANGENTIAL, "Krc": RADIAL},
            "cut": {
                "mode": "down",
                "spindle_speed": f"{RPM} rpm",
                "feed_per_tooth": DELAYED_FEED,
                "axial_depth": depth,
                "radial_depth": "5 mm",
            },
            "structure": {
                "mode": [{**flexible, "direction": [1, 0, 0]}, {**flexible, "direction": [0, 1, 0]}]
            },
            "simulation": {"revolutions": PERIODS / STRAIGHT_TEETH, "slices": 1, "steps": steps},
        }
    )


def engine_motion(case: Case) -> np.ndarray:
    """Displacement (samples, 2) by the engine, m."""
    result, _ = run_setup(set_up(case))
    at = np.arange(1, 2 * SAMPLES * PERIODS + 1) * PERIOD / (2 * SAMPLES)
    row = np.round(at / result.time[1]).astype(int)
    return result.displacement[row, :2]


@contextlib.contextmanager
def empty_folder():
    """Work in an empty folder: jitcdde's build reads a pyproject.toml where there is one."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def chip_after(passes: int):
    """Chip of a delay equation against the surface of an earlier pass, in feeds a tooth.

    Its sign is that of the sine: it is written for one tooth and serves both.
    """
    import symengine
    from jitcdde import t, y

    sine, cosine = symengine.sin(math.pi * t), symengine.cos(math.pi * t)
    across, along = y(0) - y(0, t - passes), y(1) - y(1, t - passes)
    return passes * sine + across * sine + along * cosine


def chip_with_loss_of_contact():
    """Chip against the outer surface of the two last passes, none in the air."""
    import symengine
    from jitcdde import t
    from jitcxde_common.symbolic import conditional

    sine = symengine.sin(math.pi * t)
    last, before = chip_after(1), chip_after(2)
    outer = conditional((before - last) * sine, 0.0, before, last, width=1e-7)
    return conditional(outer * sine, 0.0, 0.0, outer, width=1e-7)


def chip_without_vibration():
    """Chip of a rigid tool."""
    import symengine
    from jitcdde import t

    return symengine.sin(math.pi * t)


def delay_equation(chip, depth: float):
    """Compile the delay equation; time in tooth periods, displacement in feeds a tooth.

    In half immersion one of two teeth is in the cut at most, and the force repeats with each
    tooth. The screen is a parameter, changed at entry and exit, so that no step goes across them.
    """
    import symengine
    from jitcdde import jitcdde, t, y

    screen = symengine.Symbol("screen")
    sine, cosine = symengine.sin(math.pi * t), symengine.cos(math.pi * t)
    force = screen * chip * depth * PERIOD**2 / MASS
    turn = 2 * math.pi * FREQUENCY * PERIOD
    equation = [
        y(2),
        y(3),
        -force * (RADIAL * sine + TANGENTIAL * cosine) - 2 * DAMPING * turn * y(2) - turn**2 * y(0),
        force * (TANGENTIAL * sine - RADIAL * cosine) - 2 * DAMPING * turn * y(3) - turn**2 * y(1),
    ]
    integrator = jitcdde(equation, control_pars=[screen], max_delay=2.0, verbose=False)
    with empty_folder(), contextlib.redirect_stdout(None), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        integrator.compile_C(simplify=False)
    return integrator


def jitcdde_motion(integrator, tolerance: float, samples: int) -> np.ndarray:
    """Displacement (samples, 2) by jitcdde from rest, m, sampled within each half tooth period."""
    integrator.purge_past()
    integrator.constant_past(np.zeros(4), time=0.0)
    integrator.set_parameters(0.0)
    integrator.reset_integrator()
    integrator.set_integration_parameters(
        rtol=tolerance, atol=1e-3 * tolerance, first_step=0.01, max_step=0.2, min_step=1e-12
    )
    motion = []
    for half in range(2 * PERIODS):
        integrator.set_parameters(float(half % 2))
        # drops what was integrated beyond the event, and takes the new slope
        integrator.jump(0.0, 0.5 * half, 1e-7)
        with warnings.catch_warnings():
            # samples within a step are interpolated, as wanted
            warnings.simplefilter("ignore")
            for i in range(1, samples + 1):
                motion.append(integrator.integrate(0.5 * (half + i / samples))[:2].copy())
    return np.array(motion) * DELAYED_FEED


def error(motion: np.ndarray, reference: np.ndarray) -> float:
    """Root mean square difference over the standard deviation of the reference."""
    return float(np.sqrt(np.mean((motion - reference) ** 2)) / np.std(reference))


def delay_equations() -> list[dict]:
    """Engine and jitcdde on one case: errors, times a revolution and their ratio."""
    start = time.perf_counter()
    integrator = delay_equation(chip_after(1), DEPTH)
    compiled = time.perf_counter() - start
    reference = jitcdde_motion(integrator, 1e-9, SAMPLES)
    revolutions = PERIODS / STRAIGHT_TEETH
    engine, general = [], []
    for steps in ENGINE_STEPS:
        case = straight_case(steps, DEPTH)
        assert set_up(case).resolution.steps_per_revolution == steps
        taken = timed(lambda case=case: run_setup(set_up(case)))
        engine.append((error(engine_motion(case), reference), taken, f"{steps} steps"))
    for tolerance in TOLERANCES:
        taken = timed(lambda rtol=tolerance: jitcdde_motion(integrator, rtol, 1))
        difference = error(jitcdde_motion(integrator, tolerance, SAMPLES), reference)
        general.append((difference, taken, f"tolerance {tolerance:.0e}"))
    rows = []
    for name, own, others in (("engine", engine, general), ("jitcdde", general, engine)):
        for difference, taken, setting in own:
            good = [other[1].shortest for other in others if other[0] <= difference]
            rows.append(
                (
                    name,
                    setting,
                    f"{difference:.1e}",
                    f"{taken.shortest * 1e6 / revolutions:.1f}",
                    f"{taken.median * 1e6 / revolutions:.1f}",
                    f"{min(good) / taken.shortest:.2f}" if good else "none as good",
                )
            )
    print(f"\njitcdde compiled in {compiled:.1f} s, not counted")
    return show(
        f"3. Two straight teeth, half immersion, {revolutions:g} revolutions from rest; NRMSE of "
        "the displacement against jitcdde at 1e-9;\n   ratio: fastest of the other program that "
        "is at least as accurate, over this",
        "program|setting|NRMSE|us a revolution|median|other / this",
        rows,
    )


def agreement() -> list[dict]:
    """Differences of the engine from three delay equations, at depths where contact is lost."""
    rows = []
    equations = (
        ("loss of contact", chip_with_loss_of_contact),
        ("always in contact", lambda: chip_after(1)),
        ("rigid tool's chip", chip_without_vibration),
    )
    for depth in AGREEMENT_DEPTHS:
        motions = [engine_motion(straight_case(steps, depth)) for steps in ENGINE_STEPS]
        for name, chip in equations:
            reference = jitcdde_motion(delay_equation(chip(), depth), 1e-7, SAMPLES)
            differences = (f"{error(motion, reference):.1e}" for motion in motions)
            rows.append((f"{depth * 1e3:g} mm", name, *differences))
    return show(
        "4. The same cut at three depths: NRMSE of the engine against jitcdde (1e-7) with three "
        "delay equations",
        "|".join(["depth", "equation", *[f"{steps} steps" for steps in ENGINE_STEPS]]),
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
