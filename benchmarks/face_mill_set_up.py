"""FRFs, moves and cuts of the face mill on its machine, in one folder, explained.

The machine of `examples/face-mill-chatter` makes the data, with half its step, and noise; what is
declared lacks a part of it, or nothing. What `chatter explain` finds is printed beside what is
true, with the error of every kind before and after:

    python -m benchmarks.face_mill_set_up contact nothing --seed 1
"""

from __future__ import annotations

import argparse
import math
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import chatter
from chatter.compile.machine_response import machine_response
from chatter.description.case import Case, load
from chatter.simulation.virtual_tests.recorded_move import recorded_move

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "face-mill-chatter"
EVERY_FRICTION = tuple(f"{part}_{axis}" for axis in "xyz" for part in ("rotation", "translation"))
#: without both frictions of the axis that moves
NOT_OF_Y = tuple(name for name in EVERY_FRICTION if not name.endswith("y"))
#: published: spring, N/m, and damper, N s/m, between tool and workpiece
STIFFNESS, DAMPING = 2.50e6, 3.35e3
#: scatter of FRFs and noise of cuts, shares; noise of torque, N m, and of positions, m
SCATTER, NOISE, NOISE_OF_TORQUE, NOISE_OF_POSITION = 0.02, 0.02, 0.02, 0.3e-6
LINES = np.arange(20.0, 140.0, 3.0)  # Hz
SAMPLED = 5e-4  # cuts, s
#: of the data, against the case declared
FINER = {"machine.step": 25e-6}


class Machine(NamedTuple):
    """The face mill of the example, with what some of its tables describe."""

    contact: bool
    friction: tuple[str, ...]  # names of what rubs

    def case_in(self, folder: Path) -> Case:
        """Case of the face mill on this machine, written into a folder."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "machine.toml").write_text(self._machine(), encoding="utf-8")
        text = (EXAMPLE / "case.toml").read_text(encoding="utf-8")
        if self.contact:
            text += f"\n[contact]\nstiffness = {STIFFNESS}\ndamping = {DAMPING}\n"
        (folder / "case.toml").write_text(text, encoding="utf-8")
        return load(folder / "case.toml")

    def _machine(self) -> str:
        """Text of the machine file: its contact stands in the case, where cuts have it from."""
        first, *tables = (EXAMPLE / "machine.toml").read_text(encoding="utf-8").split("\n[")
        rubbing = tuple(f"friction.{name}]" for name in self.friction)
        kept = [
            table
            for table in tables
            if not table.startswith(("contact]", "friction.", "frf.", "move."))
            or table.startswith(rubbing)
        ]
        return "\n[".join([first, *kept])


class Trial(NamedTuple):
    """What makes the data, and what is declared."""

    true: Machine
    declared: Machine


class Extent(NamedTuple):
    """How much is measured."""

    directions: str  # of FRFs
    #: strokes, m, and frequency, Hz, of sines of the axes
    sines: tuple[tuple[str, float, float], ...]
    duration: float  # of each, s
    #: speed, rpm, and depth, mm, of the cuts; short of chatter
    cuts: tuple[tuple[float, float], ...]
    revolutions: int
    #: of the case, in the data and as declared
    overrides: Mapping[str, Any]


FULL = Extent(
    "xy", (("Y", 10e-3, 1.0), ("Y", 2e-3, 2.0), ("Y", 20e-3, 1.0)), 1.0,
    ((840, 2.0), (900, 1.5), (780, 2.5)), 5, {},
)  # fmt: skip
#: what a test has time for; axes come to the feed for less long before they cut
SMALL = Extent("y", (("Y", 10e-3, 2.0),), 0.5, ((840, 2.0),), 3, {"structure.settling": 0.35})


TRIALS: Mapping[str, Trial] = {
    "contact": Trial(Machine(True, EVERY_FRICTION), Machine(False, EVERY_FRICTION)),
    "friction": Trial(Machine(True, EVERY_FRICTION), Machine(True, NOT_OF_Y)),
    "both": Trial(Machine(True, EVERY_FRICTION), Machine(False, NOT_OF_Y)),
    "nothing": Trial(Machine(True, EVERY_FRICTION), Machine(True, EVERY_FRICTION)),
}


def write_set_up(folder: Path, trial: Trial, seed: int, extent: Extent = FULL) -> None:
    """Write measurement, case and machine of a trial into a folder."""
    truth = trial.true.case_in(folder / "truth").patch({**extent.overrides, **FINER})
    trial.declared.case_in(folder).patch(extent.overrides).save(folder / "case.toml")
    random = np.random.default_rng(seed)
    text = 'kind = "set-up"\ncase = "case.toml"\n'
    for part in (_taps, _moves, _cuts):
        text += part(folder, truth, random, extent)
    (folder / "measurement.toml").write_text(text, encoding="utf-8")


def _taps(folder: Path, truth: Case, random: Generator, extent: Extent) -> str:
    """FRFs at the tool point in two directions and three states, each twice."""
    text = '[[part]]\nkind = "frf"\n'
    for condition in ("at_rest", "moving", "in_cut"):
        for direction in extent.directions:
            exact = machine_response(truth, condition, direction, direction, LINES)
            for repetition in range(2):
                noise = random.standard_normal((2, LINES.size)) * np.abs(exact) * SCATTER
                noise /= math.sqrt(2.0)
                columns = [LINES, exact.real + noise[0], exact.imag + noise[1]]
                file = f"frf_{condition}_{direction}_{repetition}.csv"
                _write(folder / file, "frequency [Hz],real [m/N],imag [m/N]", columns)
                text += f'[[part.run]]\nfile = "{file}"\ncondition = "{condition}"\n'
                text += f'direction = "{direction}"\n'
    return text


def _moves(folder: Path, truth: Case, random: Generator, extent: Extent) -> str:
    """Strokes of the axes: torque of the motor, and its position."""
    text = '[[part]]\nkind = "axis"\n'
    for number, (axis, stroke, frequency) in enumerate(extent.sines):
        at = np.arange(0.0, extent.duration, 1e-3)
        command = 0.5 * stroke * (1.0 - np.cos(2.0 * math.pi * frequency * at))
        made = recorded_move(truth, axis, at, command)
        behind = np.interp(at, made.time, (made.wanted - made.motor)[:, 0], left=0.0)
        torque = np.interp(at, made.time, made.effort[:, 0], left=0.0)
        position = command - behind + NOISE_OF_POSITION * random.standard_normal(at.size)
        torque = torque + NOISE_OF_TORQUE * random.standard_normal(at.size)
        columns = [at, 1e3 * command, 1e3 * position, torque]
        file = f"move{number}.csv"
        _write(folder / file, "time [s],command [mm],position [mm],torque [N*m]", columns)
        text += f'[[part.run]]\nfile = "{file}"\naxis = "{axis}"\n'
    return text


def _cuts(folder: Path, truth: Case, random: Generator, extent: Extent) -> str:
    """Forces, and displacements of the tool against the work, of short cuts."""
    text = '[[part]]\nkind = "milling"\n'
    for number, (speed, depth) in enumerate(extent.cuts):
        conditions: dict[str, Any] = {"cut.spindle_speed": f"{speed} rpm"}
        conditions |= {"cut.axial_depth": f"{depth} mm", "simulation.duration": None}
        conditions["simulation.revolutions"] = extent.revolutions
        made = chatter.simulate(truth.patch(conditions))
        at = np.arange(0.0, made.time[-1], SAMPLED)
        exact = [*made.force[:, :2].T, *(1e6 * made.displacement[:, :2].T)]
        columns = [at]
        for values in exact:
            signal = np.interp(at, made.time, values)
            columns.append(signal + NOISE * signal.std() * random.standard_normal(at.size))
        file = f"cut{number}.csv"
        _write(folder / file, "time [s],Fx [N],Fy [N],x [um],y [um]", columns)
        text += f'[[part.run]]\nfile = "{file}"\nspindle_speed = "{speed} rpm"\n'
        text += f'axial_depth = "{depth} mm"\n'
    return text


def _write(path: Path, head: str, columns: list[np.ndarray]) -> None:
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=head, comments="")


def explained(name: str, seed: int) -> None:
    """Print what is found in a trial."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        write_set_up(folder, TRIALS[name], seed)
        begin = time.process_time()
        summary = chatter.explain(folder).summary()
        taken = time.process_time() - begin
    print(f"{name}, seed {seed}: {summary['verdict']}, {taken:.0f} s of CPU")
    for effect in summary["effects"]:
        for key, one in effect["parameters"].items():
            low, high = one["ci95"] or (math.nan, math.nan)
            print(f"  {effect['name']}.{key}: {one['value']:.5g}, {low:.5g} to {high:.5g}")
    for kind, error in summary["error_by_kind"].items():
        shown = ("before", "after", "holdout_before", "holdout_after", "noise_floor")
        print(f"  error of {kind}: " + ", ".join(f"{key} {error[key]:.4f}" for key in shown))


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("trials", nargs="*", default=list(TRIALS), choices=list(TRIALS))
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print(f"true contact: {STIFFNESS:.5g} N/m, {DAMPING:.5g} N s/m")
    for name in given.trials:
        explained(name, given.seed)


if __name__ == "__main__":
    main()
