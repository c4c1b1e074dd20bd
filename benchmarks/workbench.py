"""Slider to diagram in the workbench, and its memory over many moves.

    python -m benchmarks.workbench [--moves 10000] [--timed 200]

Two modes in each direction, collocation. The time runs from the new value of the slider to the
new data of the picture; what the browser takes to draw them comes on top.
"""

from __future__ import annotations

import argparse
import gc
import resource
import statistics
import threading
import time
from pathlib import Path

import chatter
from chatter.app.workbench.stability_view import StabilityView

CASE = Path(__file__).parents[1] / "examples" / "two-degrees-of-freedom" / "case.toml"
#: frequency, damping ratio, mass, direction
MODES = (
    ("922 Hz", 0.011, "0.03993 kg", [1, 0, 0]),
    ("1340 Hz", 0.02, "0.12 kg", [1, 0, 0]),
    ("940 Hz", 0.013, "0.041 kg", [0, 1, 0]),
    ("1510 Hz", 0.02, "0.1 kg", [0, 1, 0]),
)


def two_modes_a_direction() -> chatter.Case:
    """Case that is measured."""
    keys = ("frequency", "damping", "mass", "direction")
    modes = [dict(zip(keys, one, strict=True)) for one in MODES]
    return chatter.load(CASE).patch({"structure.mode": modes})


def memory(process: int | str = "self") -> float:
    """Resident memory of a process, MB."""
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--moves", type=int, default=10_000)
    parser.add_argument("--timed", type=int, default=200)
    given = parser.parse_args()
    case = two_modes_a_direction()
    drawn = threading.Event()

    def show(change):
        change()
        drawn.set()

    view = StabilityView(case, "case.toml", show)
    view.computations.wait(600.0)
    slider = view.sliders["material.Ktc"]
    walls, work = [], []
    for number in range(given.timed):
        drawn.clear()
        begun, spent = time.perf_counter(), time.process_time()
        slider.value = 600.0 + 0.5 * number
        drawn.wait(60.0)
        walls.append(time.perf_counter() - begun)
        work.append(time.process_time() - spent)
    print(
        f"slider to diagram, {given.timed} moves: median {1e3 * statistics.median(walls):.0f} ms, "
        f"90 % below {1e3 * sorted(walls)[int(0.9 * len(walls))]:.0f} ms; "
        f"processor time {1e3 * statistics.median(work):.0f} ms"
    )
    gc.collect()
    before = memory()
    for number in range(given.moves):
        drawn.clear()
        slider.value = 600.0 + 0.1 * (number % 1000)
        drawn.wait(60.0)
        if number % max(1, given.moves // 10) == 0:
            print(f"  {number} moves: {memory():.0f} MB", flush=True)
    view.computations.cancel()
    gc.collect()
    print(f"memory over {given.moves} moves: {before:.0f} to {memory():.0f} MB")


if __name__ == "__main__":
    main()
