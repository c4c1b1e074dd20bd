"""A crossbeam of solid elements, as a super-element, carries a head between two columns.

The crossbeam comes from `crossbeam.py` as matrices of its two bolted ends, twelve places for
carriages and fixed-interface modes. Columns are rigid bodies on feet, the head is a rigid body on
four carriages. The same parts joined at other carriages are the machine at another position: from
the middle to the left the head's nodding on the twisting beam rises from 121 to 130 Hz and the
beam's bending across from 176 to 196 Hz, while the swaying of the columns stays where it is.
"""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chatter.io.matrices import imported_structure
from chatter.plots.style import BLUE, ORANGE, finish, new_figure
from dynamics.reduction.craig_bampton import ElasticJoint, joined
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Body, Connector, Point
from dynamics.structure.linear_structure import LinearStructure
from dynamics.structure.surface_constraint import RigidSurface

HERE = Path(__file__).parent
SUPER_ELEMENT = HERE / "super-element"

# Head between these carriages of each rail.
POSITIONS = {"in the middle": (3, 4), "at the left": (1, 2)}
# Plausible numbers of a small portal machine, not of a given one; N/m, N m/rad.
FOOT = (3e8, 3e8, 8e8, 0.0, 0.0, 0.0)
BOLTED = (6e9, 3e9, 3e9, 1.5e8, 2e8, 2e8)
# A rail's carriage across and along the face it is bolted to, and half of the drive along x.
CARRIAGE = {"lower": (0.0, 5e8, 4e8, 0.0, 0.0, 0.0), "upper": (0.8e8, 5e8, 4e8, 0.0, 0.0, 0.0)}
# From the middle of the carriages, m.
GRAVITY_CENTRE = np.array([0.0, -0.15, -0.05])
TOOL = np.array([0.0, -0.20, -0.40])
# Damping over stiffness, s: a loss of 2 x 2.5 % in joints and 2 x 0.3 % in steel, at 100 Hz.
JOINT_DAMPING = 2.0 * 0.025 / (2.0 * np.pi * 100.0)
STEEL_DAMPING = 2.0 * 0.003 / (2.0 * np.pi * 100.0)


def crossbeam() -> tuple[LinearStructure, dict[str, NDArray[np.float64]]]:
    """Read the super-element; also return where its points are, m."""
    with (SUPER_ELEMENT / "nodes.csv").open(newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    places = {row["point"]: np.array([float(row[axis]) for axis in "xyz"]) for row in table}
    beam = imported_structure(
        SUPER_ELEMENT / "mass.npz",
        SUPER_ELEMENT / "stiffness.npz",
        nodes=SUPER_ELEMENT / "nodes.csv",
        rigid=[
            RigidSurface(row["point"], places[row["point"]], [int(row["node"])]) for row in table
        ],
    )
    return replace(beam, damping=STEEL_DAMPING * beam.stiffness), places


def column(end: NDArray[np.float64], outwards: float) -> LinearStructure:
    """Rigid column on four feet, its "flange" at an end (3,) of the crossbeam, m."""
    centre = end + np.array([0.2 * outwards, 0.05, -0.55])
    body = Body("column", 1100.0, (320.0, 300.0, 70.0), centre)
    feet = [
        Connector(
            f"foot {number}",
            "column",
            "ground",
            centre + np.array([x, y, -0.75]),
            FOOT,
            JOINT_DAMPING * np.array(FOOT),
        )
        for number, (x, y) in enumerate([(-0.25, -0.4), (0.25, -0.4), (-0.25, 0.4), (0.25, 0.4)])
    ]
    return assemble([body], feet, [Point("flange", "column", end)])


def head(carriages: dict[str, NDArray[np.float64]]) -> LinearStructure:
    """Head with points at its carriages, m, and a "tool" below; free until they are joined."""
    middle = np.mean(list(carriages.values()), axis=0)
    body = Body("head", 160.0, (9.0, 5.0, 7.0), middle + GRAVITY_CENTRE)
    points = [Point(name, "head", at) for name, at in carriages.items()]
    points += [Point("tool", "head", middle + TOOL)]
    return assemble([body], [], points, allowed_rigid_motions=6)


def machine(numbers: tuple[int, int]) -> LinearStructure:
    """Columns, crossbeam, and the head on the carriages of these numbers."""
    beam, places = crossbeam()
    names = {f"{rail} {number}": rail for rail in CARRIAGE for number in numbers}
    parts = {
        "left column": column(places["left"], -1.0),
        "right column": column(places["right"], 1.0),
        "crossbeam": beam,
        "head": head({name: places[name] for name in names}),
    }
    ends = [
        (("crossbeam", side), (f"{side} column", "flange"), BOLTED) for side in ("left", "right")
    ]
    ends += [(("crossbeam", name), ("head", name), CARRIAGE[rail]) for name, rail in names.items()]
    return joined(
        parts,
        [
            ElasticJoint(first, second, stiffness, JOINT_DAMPING * np.array(stiffness))
            for first, second, stiffness in ends
        ],
    )


def main(out: Path) -> list[Path]:
    """Print natural frequencies, draw the frequency response at the tool, return the picture."""
    frequency = np.arange(20.0, 401.0)
    figure = new_figure(7.5, 7.5)
    panels = figure.subplots(3, 1, sharex=True)
    for (position, numbers), colour, line in zip(
        POSITIONS.items(), (BLUE, ORANGE), ("-", "--"), strict=True
    ):
        structure = machine(numbers)
        natural = structure.natural_frequencies(10)
        print(f"head {position}: " + ", ".join(f"{value:.1f}" for value in natural) + " Hz")
        ports = np.vstack([structure.port("head.tool", axis) for axis in np.eye(3)])
        receptance = structure.receptance(frequency, ports)
        for axis, panel in enumerate(panels):
            size = 1e9 * np.abs(receptance[:, axis, axis])
            panel.semilogy(frequency, size, line, color=colour, label=f"head {position}")
    for name, panel in zip("xyz", panels, strict=True):
        panel.set_ylabel(f"|receptance {name}{name}| [nm/N]")
        finish(panel)
    panels[0].legend(frameon=False, fontsize=9)
    panels[0].set_title("Tool on the crossbeam of solid elements")
    panels[-1].set_xlabel("frequency [Hz]")
    panels[-1].set_xlim(frequency[0], frequency[-1])
    out.mkdir(parents=True, exist_ok=True)
    picture = out / "receptance.png"
    figure.savefig(picture)
    return [picture]


if __name__ == "__main__":
    main(Path("out"))
