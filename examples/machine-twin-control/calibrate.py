"""Fit what the chapter does not publish to the frequencies, heights and the error that it does.

Prints the values of comau.toml marked "calibrated", all but the last by the harmonic response with
the loops held as springs: two guides to the peaks of the frame at 110 and 260 Hz; bearings of the
spindle to its modes at 0.8 and 1.3 kHz in x and 0.65 kHz along; the Z guide in y to 0.8 kHz in y;
damping of the mode along to its height; the gain of Y's position controller to the
positioning error of 28 um.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from run import GRAVITY, held
from scipy.optimize import brentq, least_squares

import chatter
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.virtual_tests.frf import peaks

HERE = Path(__file__).parent
SPINDLE, ALONG, FRAME = (800.0, 1300.0), 650.0, (110.0, 260.0)  # Hz
HEIGHT_ALONG = 0.11  # g/N, table 3.1, model
ERROR = 28e-6  # m
RADIAL = tuple(f"beam.spindle.bearings[{i}].radial" for i in (0, 1))
AXIAL = "beam.spindle.bearings[1].axial"
ACROSS_Y, ACROSS_Z = "connector.guide_y.stiffness.x", "connector.guide_z.stiffness.x"
IN_Y = "connector.guide_z.stiffness.y"
DAMPING_ALONG = "mode_damping[0].ratio"
GAIN = "axis.Y.control.position.gain"
#: misfit of a peak that is not found
_FAR_OFF = 0.3


def peak_between(machine: MachineFile, name: str, low: float, high: float) -> tuple[float, float]:
    """Frequency, Hz, and height, g/N, of the highest peak between two frequencies."""
    found = [one for one in peaks(held(machine, name).harmonic) if low < one["frequency_Hz"] < high]
    if not found:
        return float("nan"), float("nan")
    highest = max(found, key=lambda one: one["magnitude"])
    return highest["frequency_Hz"], highest["magnitude"] / GRAVITY


def spindle_in_x(machine: MachineFile) -> NDArray[np.float64]:
    """Frequencies of both modes of the spindle in x, (2,), Hz."""
    bands = ((700.0, 880.0), (1050.0, 1550.0))
    return np.array([peak_between(machine, "tip_x", *band)[0] for band in bands])


def with_bearings(machine: MachineFile, rear: float, front: float) -> MachineFile:
    """Machine with radial stiffness of the spindle's bearings, N/m."""
    return machine.patch(dict(zip(RADIAL, ([rear] * 2, [front] * 2), strict=True)))


def with_guides(machine: MachineFile, y: float, z: float) -> MachineFile:
    """Machine with stiffness in x of each slider of the Y and of the Z guide, N/m."""
    return machine.patch({ACROSS_Y: y, ACROSS_Z: z})


def fitted(
    make: Callable[..., MachineFile],
    residual: Callable[[MachineFile], Sequence[float]],
    start: Sequence[float],
) -> MachineFile:
    """Machine of the values, from a start on, whose residuals are least."""
    found = least_squares(
        # a peak that is not there is far off
        lambda log: np.nan_to_num(residual(make(*np.exp(log))), nan=_FAR_OFF),
        np.log(start),
        diff_step=2e-3,
        xtol=1e-5,
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
                peak_between(one, "frame_x", 60.0, 170.0)[0] / FRAME[0] - 1.0,
                peak_between(one, "frame_x", 180.0, 340.0)[0] / FRAME[1] - 1.0,
            ],
            [machine.get(ACROSS_Y), machine.get(ACROSS_Z)],
        )
        machine = fitted(
            lambda rear, front, base=machine: with_bearings(base, rear, front),
            lambda one: spindle_in_x(one) / SPINDLE - 1.0,
            [machine.get(path)[0] for path in RADIAL],
        )
    machine = fitted(
        lambda k, base=machine: base.patch({IN_Y: k}),
        lambda one: [peak_between(one, "tip_y", 700.0, 880.0)[0] / SPINDLE[0] - 1.0],
        [machine.get(IN_Y)],
    )
    machine = fitted(
        lambda k, base=machine: base.patch({AXIAL: k}),
        lambda one: [peak_between(one, "tip_z", 350.0, 900.0)[0] / ALONG - 1.0],
        [machine.get(AXIAL)],
    )
    machine = fitted(
        lambda ratio, base=machine: base.patch({DAMPING_ALONG: ratio}),
        lambda one: [np.log(peak_between(one, "tip_z", 500.0, 800.0)[1] / HEIGHT_ALONG)],
        [machine.get(DAMPING_ALONG)],
    )
    gain = brentq(lambda k: error_at_peak(machine.patch({GAIN: k})) - ERROR, 60.0, 200.0, xtol=0.01)
    return machine.patch({GAIN: gain})


if __name__ == "__main__":
    found = calibrated(chatter.load_machine(HERE / "comau.toml"))
    for path in (*RADIAL, AXIAL, ACROSS_Y, ACROSS_Z, IN_Y, DAMPING_ALONG, GAIN):
        print(path, found.get(path))
