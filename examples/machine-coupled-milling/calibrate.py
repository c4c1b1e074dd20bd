"""Calibrate what is not published to the response in motion and to the effect of the contact.

Four numbers, three conditions on the linearised response at the table in y while Y moves at
420 mm/min: its peak is at 50 Hz, is 4.2e-4 (m/s)/N high, and moves up by 2 Hz with the published
contact. Of all solutions the one nearest to the numbers in machine.toml is taken.
"""

from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

import chatter
from chatter.compile.linearised_friction import linearised_frictions
from chatter.compile.machine_parts import assembled_machine
from chatter.simulation.virtual_tests.frf import peaks
from chatter.simulation.virtual_tests.from_file import one_frf
from dynamics.frf.container import Frf
from dynamics.machine.harmonic import receptance

HERE = Path(__file__).parent
#: path -> unit to print it in
CALIBRATED = {
    "body.table.mass": "kg",
    "connector.column_foot.stiffness.rx": "N*m/rad",
    "connector.column_foot.damping.rx": "N*m*s/rad",
    "axis.Y.drive.nut_stiffness": "N/m",
}
#: bound of each, relative to the number in machine.toml
FARTHEST = 1.5
#: weight of staying near
NEAR = 0.02
LINES = np.linspace(42.0, 60.0, 181)
SPEED = 0.42 / 60.0


def peak_near_50(frf):
    """Frequency, Hz, and height of the highest peak from 42 to 60 Hz."""
    near = [one for one in peaks(frf) if 42.0 < one["frequency_Hz"] < 60.0]
    highest = max(near, key=lambda one: one["magnitude"])
    return highest["frequency_Hz"], highest["magnitude"]


def mobility(machine_file, velocity, in_cut, lines=LINES):
    """Linearised mobility of the table in y, (m/s)/N, sliding as without contact."""
    machine = assembled_machine(machine_file, {})
    frictions = linearised_frictions(machine, velocity)
    if in_cut:
        machine = assembled_machine(machine_file, {}, in_cut=True)
    row = machine.structure.port("table", [0.0, 1.0, 0.0])
    answer = receptance(machine, lines, [row], machine_file.step, frictions)[:, 0, 0]
    return Frf(lines, 2j * np.pi * lines * answer, "mobility")


def conditions(machine_file):
    """Peak in motion, and shift by the contact: Hz, (m/s)/N, Hz."""
    frequency, height = peak_near_50(mobility(machine_file, {"Y": SPEED}, in_cut=False))
    raised, _ = peak_near_50(mobility(machine_file, {"Y": SPEED}, in_cut=True))
    return frequency, height, raised - frequency


def calibrated(machine_file):
    """The four numbers, SI."""
    start = np.array([machine_file.get(path) for path in CALIBRATED])

    def residuals(logarithms):
        values = dict(zip(CALIBRATED, start * np.exp(logarithms), strict=True))
        frequency, height, shift = conditions(machine_file.patch(values))
        misses = [frequency - 50.0, 10.0 * np.log(height / 4.2e-4), 2.0 * (shift - 2.0)]
        return np.array([*misses, *(NEAR * logarithms)])

    bound = np.log(FARTHEST)
    solved = least_squares(
        residuals, np.zeros(len(start)), bounds=(-bound, bound), x_scale=0.1, diff_step=1e-3
    )
    return dict(zip(CALIBRATED, start * np.exp(solved.x), strict=True))


def robustness(machine_file):
    """Print what a tenth more or less of each calibrated number changes."""
    print("changed: in motion Hz, (m/s)/N; contact Hz; at rest Hz, (m/s)/N (blows in time)")
    for path in CALIBRATED:
        for factor in (0.9, 1.0, 1.1):
            changed = machine_file.patch({path: factor * machine_file.get(path)})
            frequency, height, shift = conditions(changed)
            rest = one_frf(changed, "rest", changed.frf["rest"]).as_quantity("mobility").tested
            at_rest = peak_near_50(rest)
            print(
                f"{factor:.1f} {path}: {frequency:.2f}, {height:.3g}; {shift:+.2f}; "
                f"{at_rest[0]:.2f}, {at_rest[1]:.3g}"
            )


def main():
    """Print the calibrated numbers, what they reach, and how robust it is."""
    machine_file = chatter.load_machine(HERE / "machine.toml")
    found = calibrated(machine_file)
    for path, value in found.items():
        print(f"{path} = {value:.6g} {CALIBRATED[path]}")
    patched = machine_file.patch(found)
    frequency, height, shift = conditions(patched)
    print(f"in motion {frequency:.2f} Hz, {height:.4g} (m/s)/N; with the contact {shift:+.2f} Hz")
    robustness(patched)


if __name__ == "__main__":
    main()
