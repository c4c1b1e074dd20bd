"""Fit what the paper does not publish: plate of the bracket, guides of X, drives.

Prints the values marked "calibrated" in gantry_parts.py and machine.toml: the bracket, clamped,
bends first at 182 Hz; the crossbeam bends at 98 Hz with the head in the middle; all weighs 330 kg.
Of the guides the paper says that the behaviour depends on them and that they are uncertain.
"""

import tempfile
from dataclasses import replace
from pathlib import Path

import gantry_parts as parts
import numpy as np
from scipy.optimize import brentq

import chatter
from chatter.compile.machine_parts import assembled_machine, machine_parts
from chatter.description.machine.machine_file import MachineFile
from chatter.io.super_element import write_super_element
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.assembly import assemble

HERE = Path(__file__).parent
MASS, HEAD = 330.0, 50.0  # kg, with the head; the head with bracket and tool
BRACKET, BENDING = 182.0, 98.0  # Hz
#: vertical over lateral stiffness of a guide block, as a catalogue has it (assumed)
VERTICAL = 0.75


def bracket_frequencies(machine: MachineFile) -> np.ndarray:
    """Natural frequencies, Hz, of the bracket with its tool, clamped where it meets the head."""
    made = machine_parts(machine)
    bracket = [body for body in made.bodies if body.name in ("bracket", "tool")]
    root, *grip = (
        replace(one, second="ground") if one.name == "bracket_root" else one
        for one in made.connectors
        if one.name in ("bracket_root", "tool_grip")
    )
    return assemble(bracket, [root, *grip], []).natural_frequencies()


def bending_frequency(machine: MachineFile, head: float = 0.0) -> float:
    """Frequency, Hz, of the mode below 200 Hz that moves the crossbeam's middle most in z.

    With both drives free and the head at a place, m.
    """
    whole = assembled_machine(machine, {"X": "free", "Y": "free"}, {"Y": head})
    modes = undamped_modes(whole.structure)
    middle = np.abs(whole.structure.port("crossbeam", (0.0, 0.0, 1.0)) @ modes.shapes)
    low = modes.frequency < 200.0
    return float(modes.frequency[low][np.argmax(middle[low])])


def with_plate(machine: MachineFile, plate: float) -> MachineFile:
    """Machine with a plate of the bracket, m, meshed and reduced anew, and a head that fits it."""
    part = parts.bracket(plate)
    element = parts.reduced(part, parts.HIGHEST["bracket"])
    files = write_super_element(tempfile.mkdtemp(prefix="bracket"), element, part.positions)
    keys = ("mass", "stiffness", "nodes")
    changes = {f"imported.bracket.{key}": str(file) for key, file in zip(keys, files, strict=True)}
    mass = parts.total_mass(element, part.positions)
    changes["imported.bracket.total_mass"] = mass
    changes["body.head.mass"] = HEAD - mass - machine.get("body.tool.mass")
    return machine.patch(changes)


def with_guides(machine: MachineFile, lateral: float) -> MachineFile:
    """Machine with a lateral stiffness of its guide blocks, N/m, and drives that make up 330 kg."""
    gantry = machine.get("imported.gantry.total_mass")
    drive = 0.5 * (MASS - HEAD - gantry)
    guides = {"y": lateral, "z": VERTICAL * lateral}
    return machine.patch(
        {f"connector.guides.stiffness.{way}": value for way, value in guides.items()}
        | {f"body.{side}_drive.mass": drive for side in ("left", "right")}
    )


def calibrated(machine: MachineFile) -> tuple[float, MachineFile]:
    """Plate, m, and the machine with it, its guides and masses."""
    plate = brentq(
        lambda one: bracket_frequencies(with_plate(machine, one))[0] - BRACKET,
        0.95 * parts.PLATE,
        1.05 * parts.PLATE,
        xtol=1e-6,
    )
    held = with_plate(machine, plate)
    lateral = brentq(
        lambda one: bending_frequency(with_guides(held, one)) - BENDING, 1e8, 1e9, xtol=1e4
    )
    return plate, with_guides(held, lateral)


if __name__ == "__main__":
    thickness, found = calibrated(chatter.load_machine(HERE / "machine.toml"))
    print(f"plate {1e3 * thickness:.4g} mm")
    print(f"guides, y {1e-6 * found.get('connector.guides.stiffness.y'):.4g} N/um")
    for key in ("body.left_drive.mass", "body.head.mass"):
        print(f"{key} {found.get(key):.5g} kg")
