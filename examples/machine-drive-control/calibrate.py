"""Fit the stiffnesses that no source gives to the published frequencies; writes nothing.

Prints what it finds: the values in machine.toml are these, rounded. Brakes on, no friction, as
the publication compares its linear model. Run with `python calibrate.py` (some minutes).
"""

from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

import chatter
from chatter.compile.linearised_friction import linearised_frf
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.virtual_tests.frf import peaks
from dynamics.frf.container import Frf

HERE = Path(__file__).parent
BRAKES = {"X": "brake", "Y": "brake", "Z": "brake"}
S1 = {"X": 0.885, "Y": 0.327, "Z": 0.0}
S2 = {"X": 0.855, "Y": 0.373, "Z": 0.342}
#: state, direction at the tool, against the workpiece or not, published frequencies, Hz
PUBLISHED = (
    (S1, "x", None, (74.0, 100.0)),
    (S1, "y", None, (55.0,)),
    (S2, "x", "work", (38.0, 75.0, 110.0, 122.0)),
)
#: what is fitted, and by how much at most: a factor either way
FREE = (
    "connector.column_foot.stiffness.rz",
    "connector.column_foot.stiffness.ry",
    "connector.guides_z.stiffness.x",
    "axis.Z.drive.shaft.diameter",
    "axis.Z.drive.nut_stiffness",
    "axis.Y.drive.nut_stiffness",
    "axis.X.drive.axial",
)
WIDEST = 1.5


def frequencies(machine: MachineFile) -> list[float]:
    """Frequency of the peak nearest to each published one, Hz."""
    lines = np.arange(15.0, 160.0, 0.25)
    found = []
    for position, way, against, published in PUBLISHED:
        state = assembled_machine(machine, BRAKES, position).without_friction()
        row = state.structure.port("tool", np.eye(3)["xyz".index(way)], against)
        values = linearised_frf(state, machine.step, lines, row, row)
        at = np.array([one["frequency_Hz"] for one in peaks(Frf(lines, values, "receptance"))])
        found += [float(at[np.argmin(abs(at - wanted))]) for wanted in published]
    return found


def main() -> dict[str, float]:
    """Fit, print and return the fitted values, SI."""
    machine = chatter.load_machine(HERE / "machine.toml")
    first = np.array([machine.get(path) for path in FREE])
    wanted = np.array([one for *_, published in PUBLISHED for one in published])

    def patched(logs: np.ndarray) -> MachineFile:
        return machine.patch(dict(zip(FREE, (first * np.exp(logs)).tolist(), strict=True)))

    def residual(logs: np.ndarray) -> np.ndarray:
        off = np.log(np.array(frequencies(patched(logs))) / wanted)
        return np.concatenate([off, 0.003 * logs])  # a weak pull to the first values

    span = np.log(WIDEST)
    fit = least_squares(
        residual, np.zeros(len(FREE)), bounds=(-span, span), diff_step=0.01, max_nfev=12
    )
    values = dict(zip(FREE, (first * np.exp(fit.x)).tolist(), strict=True))
    for path, value in values.items():
        print(f"{path} = {value:.4g}")
    for published, obtained in zip(wanted, frequencies(patched(fit.x)), strict=True):
        print(f"{published:g} Hz: {obtained:.1f} Hz")
    return values


if __name__ == "__main__":
    main()
