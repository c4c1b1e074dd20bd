"""Fit what the paper does not publish: bracket root, bore of the crossbeam's tubes, carriages.

Prints the values of machine.toml marked "calibrated": the bracket alone, clamped, bends first at
182 Hz; the crossbeam bends at 98 Hz with the head in the middle; everything weighs 330 kg.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import chatter
from chatter.compile.machine_parts import assembled_machine, machine_parts
from chatter.description.machine.machine_file import MachineFile
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.assembly import assemble

HERE = Path(__file__).parent
MASS = 330.0  # kg, with the head
BRACKET, BENDING = 182.0, 98.0  # Hz


def bracket_frequencies(machine: MachineFile) -> np.ndarray:
    """Natural frequencies, Hz, of the bracket clamped where it meets the head."""
    parts = machine_parts(machine)
    bracket = next(body for body in parts.bodies if body.name == "bracket")
    root = next(one for one in parts.connectors if one.name == "bracket_root")
    return assemble([bracket], [replace(root, second="ground")], []).natural_frequencies()


def bending_frequency(machine: MachineFile, head: float = 0.0) -> float:
    """Frequency, Hz, of the mode below 200 Hz that moves the crossbeam's middle most in z.

    With both drives free and the head at a place, m.
    """
    whole = assembled_machine(machine, {"X": "free", "Y": "free"}, {"Y": head})
    modes = undamped_modes(whole.structure)
    middle = np.abs(whole.structure.port("crossbeam", (0.0, 0.0, 1.0)) @ modes.shapes)
    low = modes.frequency < 200.0
    return float(modes.frequency[low][np.argmax(middle[low])])


def of_bore(machine: MachineFile, bore: float) -> MachineFile:
    """Machine with tubes of an inner diameter, m, and carriages that make up 330 kg."""
    bored = machine.patch({f"beam.{one}.segments[0].inner": bore for one in ("front", "rear")})
    parts = machine_parts(bored)
    tubes = 0.0
    for beam in parts.beams:
        shifted = beam.rigid_motions[:, 2]
        tubes += float(shifted @ beam.mass_matrix @ shifted)
    others = sum(body.mass for body in parts.bodies if body.name in ("head", "bracket"))
    carriage = 0.5 * (MASS - tubes - others)
    return bored.patch({"body.left.mass": carriage, "body.right.mass": carriage})


def calibrated(machine: MachineFile) -> MachineFile:
    """Machine with the three calibrated numbers."""
    root = brentq(
        lambda k: bracket_frequencies(machine.patch({"connector.bracket_root.stiffness.ry": k}))[0]
        - BRACKET,
        1e4,
        9e4,
    )
    held = machine.patch({"connector.bracket_root.stiffness.ry": root})
    bore = brentq(lambda d: bending_frequency(of_bore(held, d)) - BENDING, 0.085, 0.099)
    return of_bore(held, bore)


if __name__ == "__main__":
    found = calibrated(chatter.load_machine(HERE / "machine.toml"))
    print(f"bracket_root ry {found.get('connector.bracket_root.stiffness.ry'):.5g} N*m/rad")
    print(f"bore {1e3 * found.get('beam.front.segments[0].inner'):.5g} mm")
    print(f"carriage {found.get('body.left.mass'):.5g} kg")
