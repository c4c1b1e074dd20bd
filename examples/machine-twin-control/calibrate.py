"""Fit what the chapter does not publish to the frequencies and the error that it does.

Prints the values of comau.toml marked "calibrated": bearings of the spindle to its modes at 0.8
and 1.3 kHz across and 0.65 kHz along, two guides to the peaks of the frame at 110 and 260 Hz, and
the gain of Y's position controller to the positioning error of 28 um.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from scipy.optimize import brentq, least_squares

import chatter
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.virtual_tests.frf import peaks

HERE = Path(__file__).parent
SPINDLE, ALONG, FRAME = (800.0, 1300.0), 650.0, (110.0, 260.0)  # Hz
ERROR = 28e-6  # m
RADIAL = tuple(f"beam.spindle.bearings[{i}].radial" for i in (0, 1))
AXIAL = "beam.spindle.bearings[1].axial"
GAIN = "axis.Y.control.position.gain"


def peak_between(machine: MachineFile, name: str, low: float, high: float) -> float:
    """Frequency, Hz, of the highest peak of a linearised FRF between two frequencies."""
    linear = machine.patch({f"frf.{name}.by": "linearised"})
    found = [
        one
        for one in peaks(chatter.frf(linear, [name])[name].harmonic)
        if low < one["frequency_Hz"] < high
    ]
    if not found:
        return float("nan")
    return max(found, key=lambda one: one["magnitude"])["frequency_Hz"]


def with_bearings(machine: MachineFile, rear: float, front: float) -> MachineFile:
    """Machine with radial stiffness of the spindle's bearings, N/m."""
    return machine.patch(dict(zip(RADIAL, ([rear] * 2, [front] * 2), strict=True)))


def with_guides(machine: MachineFile, y: float, z: float) -> MachineFile:
    """Machine with stiffness across of each slider of the Y and of the Z guide, N/m."""
    sides = {f"connector.guide_z.stiffness.{way}": z for way in "xy"}
    return machine.patch({"connector.guide_y.stiffness.x": y, **sides})


def fitted(
    make: Callable[..., MachineFile],
    residual: Callable[[MachineFile], list[float]],
    start: Sequence[float],
) -> MachineFile:
    """Machine of the stiffnesses, from a start on, whose residuals are least."""
    found = least_squares(
        lambda log: residual(make(*np.exp(log))), np.log(start), diff_step=2e-3, xtol=1e-5
    )
    return make(*np.exp(found.x))


def error_at_peak(machine: MachineFile) -> float:
    """Largest positioning error at the ruler, m, of the fastest 100 mm."""
    return float(np.max(np.abs(chatter.move(machine, "fast").tracking_error)))


def calibrated(machine: MachineFile) -> MachineFile:
    """Machine with the calibrated numbers."""
    for _ in range(2):  # frame and spindle know little of each other
        machine = fitted(
            lambda y, z, base=machine: with_guides(base, y, z),
            lambda one: [
                peak_between(one, "frame_x", 60.0, 170.0) / FRAME[0] - 1.0,
                peak_between(one, "frame_x", 180.0, 340.0) / FRAME[1] - 1.0,
            ],
            [machine.get(f"connector.guide_{way}.stiffness.x") for way in "yz"],
        )
        machine = fitted(
            lambda rear, front, base=machine: with_bearings(base, rear, front),
            lambda one: [
                peak_between(one, "tip_x", 600.0, 1000.0) / SPINDLE[0] - 1.0,
                peak_between(one, "tip_x", 1050.0, 1550.0) / SPINDLE[1] - 1.0,
            ],
            [machine.get(path)[0] for path in RADIAL],
        )
    axial = brentq(
        lambda k: peak_between(machine.patch({AXIAL: k}), "tip_z", 350.0, 900.0) / ALONG - 1.0,
        1.2e8,
        2.4e8,
        rtol=1e-4,
    )
    machine = machine.patch({AXIAL: axial})
    gain = brentq(lambda k: error_at_peak(machine.patch({GAIN: k})) - ERROR, 80.0, 200.0, xtol=0.01)
    return machine.patch({GAIN: gain})


if __name__ == "__main__":
    found = calibrated(chatter.load_machine(HERE / "comau.toml"))
    for path in (*RADIAL, AXIAL, "connector.guide_y.stiffness.x", "connector.guide_z.stiffness.x"):
        print(path, found.get(path))
    print(GAIN, found.get(GAIN))
