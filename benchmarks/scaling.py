"""How the cost of a multiplier grows, which share of the processor's peak it reaches, and memory.

All figures are of one core and one run. The peak is that of a product of two large matrices by
the BLAS of numpy on the same core. Floating-point operations are counted from the sizes of the
arrays (see `operations`); what the cut couples is not counted, so the fraction is a lower bound.
"""

import math
import os
import resource
import subprocess
import sys
import time

import numpy as np

from chatter.description.case import Case
from chatter.stability.methods.collocation import drivers
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.coupling_assembly import coupling_assemblies
from chatter.stability.methods.collocation.element_assembly import operator_arrays
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import milling_model

RPM = math.pi / 30.0
POINTS = 800


def case_of(modes, helix_deg=0.0, teeth=2):
    """Half immersion with modes spread over a decade, in two directions by turns."""
    frequency = 400.0 * 10.0 ** (np.arange(modes) / max(modes, 2))
    return Case.from_dict(
        {
            "tool": {"teeth": teeth, "diameter": "16 mm", "helix": f"{helix_deg} deg"},
            "material": {"Ktc": "600 MPa", "Krc": "200 MPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": "9000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1 mm",
                "radial_depth": "4 mm",
            },
            "structure": {
                "mode": [
                    {
                        "frequency": float(f),
                        "damping": 0.02,
                        # equally stiff, so that every one of them matters
                        "stiffness": "20 N/um",
                        "direction": [1, 0, 0] if i % 2 == 0 else [0, 1, 0],
                    }
                    for i, f in enumerate(frequency)
                ]
            },
        }
    )


def cost(cut, rpm_from, rpm_to, depth, points=POINTS):
    """Processor time of a point, s, and how many collocation points a period has on average."""
    speeds, depths = np.linspace(rpm_from, rpm_to, points) * RPM, np.full(points, depth)
    silent, arrays = np.zeros(points, dtype=np.bool_), operator_arrays(cut)
    collocation.multipliers(cut, speeds[:8], depths[:8])
    best = math.inf
    for _ in range(3):
        start = time.process_time()
        for first in range(0, points, 64):
            part = slice(first, first + 64)
            plans = coupling_assemblies(cut, speeds[part], depths[part])
            drivers.element_multipliers(arrays, plans, speeds[part], silent[part])
        best = min(best, time.process_time() - start)
    nodes = drivers.points_of_periods(cut, speeds, depth).mean()
    return best / points, nodes


def exponent(sizes, seconds):
    """Slope of the logarithm of the cost over that of the size."""
    return np.polyfit(np.log(sizes), np.log(seconds), 1)[0]


def show(what, sizes, seconds):
    """Print a row of costs and the exponent."""
    row = ", ".join(f"{s:g}: {1e6 * t:.3g}" for s, t in zip(sizes, seconds, strict=True))
    print(f"{what} [us a point]: {row}; exponent {exponent(sizes, seconds):.2f}")


def against_modes():
    """Cost against the number of modes; the highest frequency stays the same."""
    sizes = [1, 2, 4, 8, 16, 40]
    show(
        "modes",
        sizes,
        [cost(element_cut(milling_model(case_of(n)), 1e-3), 8e3, 1e4, 1e-3)[0] for n in sizes],
    )


def against_resolution():
    """Cost against the collocation points in a period, by shorter elements."""
    model = milling_model(case_of(4))
    pairs = [
        cost(element_cut(model, 1e-3, 8, waves), 8e3, 1e4, 1e-3)
        for waves in (1.0, 0.5, 0.25, 0.12, 0.06)
    ]
    show("points in a period", [nodes for _, nodes in pairs], [seconds for seconds, _ in pairs])


def against_speed():
    """Cost against the speed: slow cuts hold more waves."""
    cut = element_cut(milling_model(case_of(4)), 1e-3)
    sizes = [16000.0, 8000.0, 4000.0, 2000.0, 1000.0, 500.0]
    seconds = [cost(cut, 0.98 * rpm, rpm, 1e-3)[0] for rpm in sizes]
    show("speed in rpm", sizes, seconds)


def against_points():
    """Cost of a point against the number of points of a diagram."""
    cut = element_cut(milling_model(case_of(4)), 1e-3)
    sizes = [100, 400, 1600, 6400]
    show("points of a diagram", sizes, [cost(cut, 8e3, 1e4, 1e-3, n)[0] for n in sizes])


def operations(cut, nodes, krylov):
    """Floating-point operations of a point: response, factors, iteration, orthogonalisation."""
    modes, rank = cut.arrays.shape.shape
    p = cut.points.weight.shape[0]
    elements, q, size = nodes / p, p * rank, 2 * modes
    terms = cut.response.coefficient.shape[1]
    response = 2 * modes * terms * (p + 2) ** 2
    factors = elements * (2 / 3 * q**3 + 2 * q * rank * (q + size))
    an_apply = elements * (2 * (2 * q * q + 4 * q * size) + 2 * q * rank)
    dimension = size + elements * (q + rank)
    return response + factors + (krylov + 1) * an_apply + 4 * krylov**2 * dimension


#: run by itself, since the threads of a BLAS are settled when it is loaded
PRODUCT = """
import time
import numpy as np
a, best = np.random.default_rng(0).normal(size=(1024, 1024)), 1e9
for _ in range(5):
    start = time.perf_counter()
    a @ a
    best = min(best, time.perf_counter() - start)
print(2 * 1024**3 / best)
"""


def peak():
    """Floating-point operations a second of a product of matrices on one core."""
    one = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    command = [sys.executable, "-c", PRODUCT]
    found = subprocess.run(command, env={**os.environ, **one}, capture_output=True, check=True)
    return float(found.stdout)


def share_of_peak():
    """Operations a second reached, beside the peak."""
    top = peak()
    for modes, krylov in ((2, 7), (8, 19), (40, 83)):
        cut = element_cut(milling_model(case_of(modes)), 1e-3)
        seconds, nodes = cost(cut, 8e3, 1e4, 1e-3)
        rate = operations(cut, nodes, krylov) / seconds
        print(
            f"{modes} modes: {rate / 1e9:.2f} Gflop/s of {top / 1e9:.1f} measured peak: "
            f"{rate / top:.1%}; {1.0 / seconds:.0f} points a second and core"
        )


def main():
    """Print all of it."""
    against_modes()
    against_resolution()
    against_speed()
    against_points()
    share_of_peak()
    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"largest resident memory of this run: {largest:.0f} MiB")


if __name__ == "__main__":
    main()
