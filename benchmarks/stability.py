"""Stability grids and limits against a plain NumPy semi-discretization, in one run.

The reference is first-order semi-discretization as it stands in textbooks: dense monodromy matrix,
matrix exponentials by scipy, all eigenvalues by numpy. It is timed on a sample of the points.
"""

import math
import time

import numpy as np
from scipy.linalg import expm

from chatter.case import Case
from chatter.model import milling_model
from chatter.stability.semi_discretization import limit_curve, multipliers
from chatter.stability.sweep import worker_count

RPM = math.pi / 30.0
SPEEDS, DEPTHS, STEPS = 200, 100, 40
SAMPLE = 60


def two_degrees_of_freedom(immersion):
    mode = {"frequency": "922 Hz", "damping": 0.011, "mass": "0.03993 kg"}
    return Case.from_dict(
        {
            "tool": {"teeth": 2, "diameter": "16 mm"},
            "material": {"Ktc": "600 MPa", "Krc": "200 MPa"},
            "cut": {
                "mode": "up",
                "spindle_speed": "10000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1 mm",
                "radial_depth": 16e-3 * immersion,
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


def main():
    print(f"{worker_count()} threads; {SPEEDS} x {DEPTHS} points, {STEPS} steps a tooth period")
    speeds = np.linspace(5000, 25000, SPEEDS) * RPM
    for immersion in (0.05, 0.1, 0.5):
        arrays = milling_model(two_degrees_of_freedom(immersion)).arrays
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
    main()
