"""Machine and cut together against real time: the coupled-milling machine under a face mill.

33 degrees of freedom, three controlled ball screws, friction at three guides and three screws;
five inserts of ten slices each, 5 mm by 5 mm, down-milling at 840 rpm and a step of 50 us. Every
figure comes from one core: the shortest and the median of some repeats, warm, with compilation,
setting up and the machine's coming to speed in the air left out. Times are those of the
processor in the only thread that works.
"""

from __future__ import annotations

import os
import statistics
import time
from pathlib import Path

# figures of one core: threads of the linear algebra would wait for a busy second one
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from numba.core.runtime import _nrt_python, rtsys

from chatter import Case
from chatter.engine.loop import Laws, run
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup

MACHINE = Path(__file__).parents[1] / "examples" / "machine-coupled-milling" / "machine.toml"
#: simulated time of the cut, s
DURATION = {"delay": 2.0, "dexel": 1.0}
REPEATS = 7
DEPTH = "5 mm"
#: times faster than real time
AIM = {"delay": 10.0, "dexel": 1.0}


def face_mill(chip: str, friction: bool = True) -> Case:
    """Five inserts on 50 mm, helix 14 degrees."""
    simulation = {"chip": chip, "slices": 10, "duration": DURATION[chip]}
    if chip == "dexel":
        simulation["resolution"] = "50 um"
    return Case.from_dict(
        {
            "title": "face milling",
            "tool": {"kind": "end mill", "teeth": 5, "diameter": "50 mm", "helix": "14 deg"},
            "material": {"law": "linear", "Ktc": "700 MPa", "Krc": "250 MPa", "Kac": "100 MPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": "840 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": DEPTH,
                "radial_depth": "5 mm",
            },
            "structure": {
                "machine": str(MACHINE),
                "feed": [-1, 0, 0],
                "friction": friction,
                "settling": 0.4,
            },
            "simulation": simulation,
        }
    )


def settling(case: Case) -> float:
    """Shortest time that the machine takes to come to speed in the air, s."""
    taken = []
    for _ in range(REPEATS):
        setup = set_up(case)
        tables = setup.structure.tables
        laws = Laws(tables.explicit, (), tables.implicit)
        start = time.thread_time()
        run(laws, tables.bus, 0, 0, setup.structure.settling)
        taken.append(time.thread_time() - start)
    return min(taken)


def measured(chip: str) -> dict:
    """Shortest and median of the runs of a chip."""
    case = face_mill(chip)
    setup = set_up(case)
    machine = setup.on_machine.machine
    teeth, slices = setup.slices.angle.shape
    simulated = setup.steps * setup.step
    run_setup(setup)
    in_the_air = settling(case)
    taken, allocated = [], 0
    _nrt_python.memsys_enable_stats()
    for _ in range(REPEATS):
        setup = set_up(case)
        before = rtsys.get_allocation_stats()
        start = time.thread_time()
        result, _ = run_setup(setup)
        taken.append(time.thread_time() - start - in_the_air)
        allocated = max(allocated, rtsys.get_allocation_stats().alloc - before.alloc)
    assert result.complete
    faster = [simulated / one for one in taken]
    print(
        f"{chip:6} {machine.structure.size} freedoms, {len(machine.drives)} drives, "
        f"{len(machine.frictions)} frictions, {teeth} inserts of "
        f"{slices} slices, step {setup.step * 1e6:.4g} us: {max(faster):.1f} times real time "
        f"(median {statistics.median(faster):.1f}; aim {AIM[chip]:g}), "
        f"{min(taken) / simulated * setup.step * 1e6:.2f} us a step, "
        f"allocations in the loop: {allocated}"
    )
    return {
        "chip": chip,
        "times real time": max(faster),
        "median": statistics.median(faster),
        "aim": AIM[chip],
    }


def main() -> list[dict]:
    """Print the figures and return them."""
    return [measured(chip) for chip in ("delay", "dexel")]


if __name__ == "__main__":
    main()
