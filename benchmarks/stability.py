"""Stability grids and limits against a plain NumPy semi-discretization, in one run.

The reference is first-order semi-discretization as it stands in textbooks: dense monodromy matrix,
matrix exponentials by scipy, all eigenvalues by numpy. It is timed on a sample of the points.
"""

import math
import sys
import time
from functools import partial

import numpy as np
from scipy.linalg import expm

from chatter.description.case import Case
from chatter.engine.parallel import kept_threads, worker_count
from chatter.stability.boundary_continuation import continued_crossings
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.semi_discretization.arrays import milling_arrays
from chatter.stability.methods.semi_discretization.multipliers import limit_curve, multipliers
from chatter.stability.model import milling_model

RPM = math.pi / 30.0
SPEEDS, DEPTHS, STEPS = 200, 100, 40
SAMPLE = 60
#: speeds from and to in rpm and their number, deepest depth and number of depths
TWO_MODES = (5000, 25000, 401, 10e-3, 201)
FOUR_MODES = (2000, 10000, 201, 8e-3, 101)


def two_degrees_of_freedom(immersion, tool=None, **cut):
    """Two teeth of 16 mm up-milling, or another tool; equal modes in both directions."""
    mode = {"frequency": "922 Hz", "damping": 0.011, "mass": "0.03993 kg"}
    return Case.from_dict(
        {
            "tool": {"diameter": "16 mm", **(tool or {"teeth": 2})},
            "material": {"Ktc": "600 MPa", "Krc": "200 MPa"},
            "cut": {
                "mode": "up",
                "spindle_speed": "10000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1 mm",
                "radial_depth": 16e-3 * immersion,
                **cut,
            },
            "structure": {
                "mode": [{**mode, "direction": [1, 0, 0]}, {**mode, "direction": [0, 1, 0]}]
            },
        }
    )


def plain_spectral_radius(speed, depth, immersion, steps=STEPS):
    """Textbook first-order semi-discretization of the case, one point."""
    omega, zeta, mass, teeth = 2 * math.pi * 922.0, 0.011, 0.03993, 2
    leave = math.acos(1.0 - 2.0 * immersion)
    period = 2 * math.pi / (teeth * speed)
    h = period / steps
    size = 4 + 2 * steps
    transition = np.eye(size)
    for step in range(steps):
        mean = np.zeros((2, 2))
        for phi in (step + (np.arange(20) + 0.5) / 20) * 2 * math.pi / (teeth * steps):
            for tooth in range(teeth):
                angle = (phi + tooth * math.pi) % (2 * math.pi)
                if angle < leave:
                    s, c = math.sin(angle), math.cos(angle)
                    t = np.array([600e6 * c + 200e6 * s, -600e6 * s + 200e6 * c])
                    mean += np.outer(t, [s, c]) / 20
        a = np.zeros((4, 4))
        a[:2, 2:] = np.eye(2)
        a[2:, :2] = -np.eye(2) * omega**2 - depth * mean / mass
        a[2:, 2:] = -np.eye(2) * 2 * zeta * omega
        block = np.zeros((8, 8))
        block[:4, :4] = a
        block[2:4, 4:6] = depth * mean / mass
        block[4:6, 6:8] = np.eye(2) / h
        big = expm(block * h)
        one = np.zeros((size, size))
        one[:4, :4] = big[:4, :4]
        one[:4, -2:] = big[:4, 4:6] - big[:4, 6:8]
        one[:4, -4:-2] += big[:4, 6:8]
        one[4:6, :2] = np.eye(2)
        one[6:, 4:-2] = np.eye(size - 6)
        transition = one @ transition
    return np.abs(np.linalg.eigvals(transition)).max()


def altintas_engin_budak(helix_deg):
    """Four teeth at 70 and 110 degrees, four modes (Altintas, Engin and Budak 1999)."""

    def mode(frequency, damping, mass, direction):
        return {
            "frequency": frequency, "damping": damping, "mass": mass, "direction": direction,
        }  # fmt: skip

    x, y = [1, 0, 0], [0, 1, 0]
    modes = [
        mode(441.64, 0.028722, 11.125, x),
        mode(563.6, 0.055801, 1.4986, x),
        mode(778.56, 0.058996, 13.063, x),
        mode(516.21, 0.025004, 1.199, y),
    ]
    return Case.from_dict(
        {
            "tool": {
                "teeth": 4,
                "diameter": "19.05 mm",
                "helix": math.radians(helix_deg),
                "pitch": [math.radians(angle) for angle in (70, 110, 70, 110)],
            },
            "material": {"Ktc": "697 MPa", "Krc": "255.8 MPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": "5000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1 mm",
                "radial_depth": 0.5 * 19.05e-3,
            },
            "structure": {"mode": modes},
        }
    )


def timed(function):
    """Return what a function gives, its wall time and its processor time, warm."""
    function()
    wall, processor = time.perf_counter(), time.process_time()
    result = function()
    return result, time.perf_counter() - wall, time.process_time() - processor


def collocation_grids():
    """Multipliers on the grids of published codes, by collocation."""
    grids = [
        ("2 modes, immersion 0.10", two_degrees_of_freedom(0.1), TWO_MODES, "178 s, RTX 3090"),
        ("2 modes, immersion 0.05", two_degrees_of_freedom(0.05), TWO_MODES, "168 s, RTX 3090"),
        ("4 modes, 70/110 deg", altintas_engin_budak(0.0), FOUR_MODES, "none"),
        ("the same, helix 30 deg", altintas_engin_budak(30.0), FOUR_MODES, "265 s, MATLAB"),
    ]
    for name, case, (low, high, columns, deepest, rows), published in grids:
        model = milling_model(case)
        speeds = np.linspace(low, high, columns) * RPM
        depths = np.linspace(0.0, deepest, rows + 1)[1:]
        s, d = (part.ravel() for part in np.meshgrid(speeds, depths))
        picked = np.random.default_rng(2).choice(s.size, 300, replace=False)
        exact = np.abs(
            collocation.multipliers(element_cut(model, deepest, 12, 0.6), s[picked], d[picked])
        )
        for points in (6, 8):
            cut = element_cut(model, deepest, points, 1.0)
            found, wall, processor = timed(partial(collocation.multipliers, cut, s, d))
            error = np.abs(np.abs(found[picked]) - exact) / np.maximum(1.0, exact)
            print(
                f"{name}, {columns} x {rows}, {points} points an element: {wall:6.2f} s wall, "
                f"{processor:6.2f} s processor, {s.size / processor:8.0f} points/s and core; "
                f"error of |mu| {np.median(error):.0e} median, {error.max():.0e} at most; "
                f"published {published}"
            )


def other_tools():
    """Cost of a point for tools beyond the plain end mill, and of one mode in one direction."""
    tools = {
        "ball, 160 and 200 deg, helix 30": (
            {"kind": "ball", "teeth": 2, "pitch": ["160 deg", "200 deg"], "helix": "30 deg"},
            6e-3,
        ),
        "helix 30/32/30/32": (
            {"teeth": 4, "helix": ["30 deg", "32 deg", "30 deg", "32 deg"]},
            2e-3,
        ),
        "four teeth, helix 30, runout 20 um": (
            {"teeth": 4, "helix": "30 deg", "runout": {"offset": "20 um", "angle": "30 deg"}},
            2e-3,
        ),
    }
    cases = {
        name: (two_degrees_of_freedom(0.5, tool), deepest)
        for name, (tool, deepest) in tools.items()
    }
    varied = {"amplitude": 0.1, "frequency": "10 Hz", "shape": "sine"}
    cases["speed varied by 10 % at 10 Hz"] = (
        two_degrees_of_freedom(0.5, speed_variation=varied),
        2e-3,
    )
    cases["one mode, helix 45, 5 % immersion"] = helical_islands(45.0), 9e-3
    for name, (case, deepest) in cases.items():
        model = milling_model(case)
        s, d = np.meshgrid(np.linspace(8000, 12000, 60) * RPM, np.linspace(0.1, 1.0, 10) * deepest)
        solve = partial(collocation.multipliers, element_cut(model, deepest), s.ravel(), d.ravel())
        _, _, processor = timed(solve)
        rate = s.size / processor
        print(f"{name}: {1e6 / rate:7.1f} us, {rate:8.0f} points/s and core")


def limit_curves():
    """A limit curve of 400 speeds to 0.5 %, two modes a direction."""
    model = milling_model(two_degrees_of_freedom(0.5))
    speeds = np.linspace(5000, 25000, 400) * RPM
    depths = np.linspace(0.0, 2e-3, 41)[1:]
    cut = element_cut(model, 2e-3)
    full, wall, processor = timed(lambda: collocation.limit_curve(cut, speeds, depths, stride=1))
    print(f"limits at 400 speeds, full net: {wall:6.3f} s wall, {processor:6.3f} s processor")
    followed, wall, processor = timed(lambda: collocation.limit_curve(cut, speeds, depths))
    print(f"the same as lobes does it: {wall:6.3f} s wall, {processor:6.3f} s processor")
    quick = element_cut(model, 2e-3, 6, 1.0)
    coarse = depths[1::2]
    fast = partial(collocation.limit_curve, quick, speeds, coarse, tolerance=5e-3, stride=8)
    found, wall, processor = timed(fast)
    both = np.isfinite(found.critical_depth) & np.isfinite(full.critical_depth)

    def growth_at(points, depth):
        return np.log(np.abs(collocation.multipliers(quick, speeds[points], depth)))

    with kept_threads():
        _, alone, _ = timed(partial(continued_crossings, len(speeds), coarse, growth_at, 5e-3, 8))
    off = np.abs(found.critical_depth[both] / full.critical_depth[both] - 1.0)
    missed = [
        sum(len(a) != len(b) for a, b in zip(some.crossings, full.crossings, strict=True))
        for some in (followed, found)
    ]
    print(
        f"the same followed to 0.5 %: {wall:6.3f} s wall, {processor:6.3f} s processor; without "
        f"frequency and kind {alone:6.3f} s wall (wanted 0.033 s); "
        f"off by {np.nanmax(off):.1e} at most, crossings missed at {missed} speeds"
    )


def helical_islands(helix_deg):
    """One direction, low immersion: flip lobes close to islands where the edge is inclined."""
    mode = {"frequency": "922 Hz", "damping": 0.011, "mass": "0.03993 kg", "direction": [1, 0, 0]}
    return Case.from_dict(
        {
            "tool": {"teeth": 2, "diameter": "8 mm", "helix": f"{helix_deg} deg"},
            "material": {"Ktc": "600 MPa", "Krc": "200 MPa"},
            "cut": {
                "mode": "up",
                "spindle_speed": "19000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1 mm",
                "radial_depth": "0.4 mm",
            },
            "structure": {"mode": [mode]},
        }
    )


def missed():
    """Changes of stability that following misses, against a net of eight times the depths."""
    diagrams = [
        *((two_degrees_of_freedom(part), 5000, 25000, 400, 10e-3) for part in (0.05, 0.1, 0.5)),
        *((altintas_engin_budak(helix), 2000, 10000, 200, 8e-3) for helix in (0.0, 30.0)),
        *((helical_islands(helix), 14000, 25000, 400, 9e-3) for helix in (20.0, 30.0, 45.0)),
    ]
    total = np.zeros(4, dtype=int)
    for case, low, high, count, deepest in diagrams:
        model, speeds = milling_model(case), np.linspace(low, high, count) * RPM
        cut, depths = element_cut(model, deepest), np.linspace(0.0, deepest, 61)[1:]
        fine = np.linspace(0.0, deepest, 8 * 60 + 1)[1:]
        found = collocation.limit_curve(cut, speeds, depths).crossings
        wanted = collocation.limit_curve(cut, speeds, fine, stride=1).crossings
        pairs = list(zip(found, wanted, strict=True))
        lost = [len(other) - len(one) for one, other in pairs]
        first = [one[:1] for one in found], [other[:1] for other in wanted]
        wrong = sum(
            one.size != other.size or bool(np.any(one > 1.005 * other))
            for one, other in zip(*first, strict=True)
        )
        total += [count, sum(map(len, wanted)), sum(map(abs, lost)), wrong]
        print(
            f"{case.tool.helix}, {case.cut.radial_depth * 1e3:g} mm wide, {count} speeds: "
            f"{sum(map(len, wanted))} changes of stability, {sum(map(abs, lost))} missed at "
            f"{sum(part != 0 for part in lost)} speeds, first limit wrong at {wrong}"
        )
    speeds, changes, lost, wrong = total
    print(f"all: {speeds} speeds, {changes} changes, {lost} missed, first limit wrong at {wrong}")


def main():
    collocation_grids()
    other_tools()
    limit_curves()
    print()
    semi_discretization_grids()


def semi_discretization_grids():
    """Grids and limits by first-order semi-discretization against the textbook's."""
    print(f"{worker_count()} threads; {SPEEDS} x {DEPTHS} points, {STEPS} steps a tooth period")
    speeds = np.linspace(5000, 25000, SPEEDS) * RPM
    for immersion in (0.05, 0.1, 0.5):
        arrays = milling_arrays(milling_model(two_degrees_of_freedom(immersion)))
        depths = np.linspace(0, 10e-3, DEPTHS + 1)[1:]
        s, d = (part.ravel() for part in np.meshgrid(speeds, depths))
        multipliers(arrays, s[:4], d[:4], STEPS)
        start = time.perf_counter()
        radius = np.abs(multipliers(arrays, s, d, STEPS))
        grid_time = time.perf_counter() - start
        picked = np.random.default_rng(1).choice(s.size, SAMPLE, replace=False)
        start = time.perf_counter()
        plain = np.array([plain_spectral_radius(s[i], d[i], immersion) for i in picked])
        plain_time = (time.perf_counter() - start) / SAMPLE * s.size
        worst = np.max(np.abs(plain - radius[picked]))
        start = time.perf_counter()
        limit_curve(arrays, speeds, depths)
        limit_time = time.perf_counter() - start
        print(
            f"immersion {immersion:4.2f}: grid {grid_time:6.2f} s; plain NumPy "
            f"{plain_time:7.1f} s (from {SAMPLE} points), ratio {plain_time / grid_time:5.0f}; "
            f"largest difference of |mu| {worst:.1e}; limits to 1e-4 {limit_time:5.2f} s"
        )


if __name__ == "__main__":
    if sys.argv[1:] == ["missed"]:
        missed()
    else:
        main()
