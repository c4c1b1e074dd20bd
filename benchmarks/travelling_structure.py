"""Machines of solid elements that change as their axes travel, against the same ones kept frozen.

Each machine has parts from finite elements, drives under control and friction. A move and a cut are
made with the structure following its axes, and with the structure kept as it is at the start
(`travel_positions = 1`), in turns in one run. A run goes from the files to the result: parts are
read and reduced, the machine is assembled, stepped and told; a move is also made again of a
file that is read, whose machines along the travel are kept. Times are those of the processor, the
shortest of some repeats, warm, with compilation left out.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

# figures of one core: threads of the linear algebra would wait for a busy second one
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import chatter
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.virtual_tests.from_file import file_move

EXAMPLES = Path(__file__).parents[1] / "examples"
REPEATS = 5
#: times of the frozen machine, at the most
AIM = 2.0
MANDELLI_MOVE = {
    "kind": "jerk limited",
    "axes": ["Y"],
    "travel": ["200 mm"],
    "velocity": "24 m/min",
    "acceleration": "4 m/s^2",
    "jerk": "60 m/s^3",
}


class Paired(NamedTuple):
    """Times of the processor of a run frozen and following, s."""

    frozen: float
    following: float
    ratio: float  # the median of those of the pairs


def paired(run: Callable[[int | None], object]) -> Paired:
    """Time runs of a number of positions, frozen and following in turns, both made before."""
    taken: list[list[float]] = [[], []]
    for _ in range(REPEATS + 1):
        for times, count in zip(taken, (1, None), strict=True):
            start = time.process_time()
            run(count)
            times.append(time.process_time() - start)
    frozen, following = taken[0][1:], taken[1][1:]
    ratios = [two / one for one, two in zip(frozen, following, strict=True)]
    return Paired(min(frozen), min(following), statistics.median(ratios))


class Move(NamedTuple):
    """Move of a machine file."""

    path: str
    name: str
    changes: Mapping[str, object] = MappingProxyType({})  # of the file

    def file(self) -> MachineFile:
        """Read the file."""
        return chatter.load_machine(EXAMPLES / self.path).patch(self.changes)

    def run(self, file: MachineFile, count: int | None) -> object:
        """Move the machine with its structure at so many positions."""
        section = file.move[self.name].model_copy(update={"travel_positions": count})
        return file_move(file, self.name, section)

    def from_file(self, count: int | None) -> object:
        """Read the file and move the machine."""
        return self.run(self.file(), count)

    def again(self) -> Callable[[int | None], object]:
        """Return runs that read the file once: a further move of a machine."""
        return partial(self.run, self.file())


MOVES = {
    # 0.8 m along its beam, 17 positions
    "move of the crossbeam's head": Move("solid-crossbeam/machine.toml", "across"),
    # 0.2 m along its column
    "move of the Mandelli's head": Move(
        "machine-mandelli-m5/machine-of-solids.toml", "forward", {"move.forward": MANDELLI_MOVE}
    ),
    # 50 mm
    "square of the gantry": Move("machine-gantry/machine.toml", "square"),
}


def cut_of(path: str) -> Callable[[int | None], object]:
    """Return runs of a case on a machine."""

    def run(count: int | None) -> object:
        changes = {} if count is None else {"structure.travel_positions": count}
        return chatter.simulate(chatter.load(EXAMPLES / path), changes)

    return run


RUNS: dict[str, Callable[[int | None], object]] = {
    **{name: move.from_file for name, move in MOVES.items()},
    **{f"{name}, again": move.again() for name, move in MOVES.items()},
    "slot along the crossbeam": cut_of("solid-crossbeam/case.toml"),
    "slot upwards on the Mandelli": cut_of("machine-mandelli-m5/slot-upwards.toml"),
}


def main() -> list[dict]:
    """Print the table and return it."""
    print(f"{'':36} frozen, s  following, s  ratio (aim at most {AIM:g})")
    rows = []
    for name, run in RUNS.items():
        one = paired(run)
        print(f"{name:36} {one.frozen:9.3f}  {one.following:12.3f}  {one.ratio:5.2f}", flush=True)
        rows.append({"run": name, **one._asdict(), "aim": AIM})
    return rows


if __name__ == "__main__":
    main()
