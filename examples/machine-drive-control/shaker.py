"""The long-stroke shaker of the publication, with its own dynamics (section 2.4, Figure 5).

A tubular linear motor pushes its slider against the workpiece; the slider is joined to the tool
interface by a stinger, in which the force is measured. Above the mode of slider and stinger less
and less of the motor's force arrives. A FRF is taken over the measured force, so that the shaker
shows in it no more than the mass that it adds.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.plots import style
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.frf.excitation.chirp import linear_chirp

#: moved mass, kg, and natural frequency, Hz, of slider and stinger, and its damping ratio (chosen;
#: published: usable up to about 250 Hz)
MASS, NATURAL, DAMPING = 4.0, 250.0, 0.05
STIFFNESS = MASS * (2.0 * np.pi * NATURAL) ** 2  # N/m, of the stinger
#: force of the motor, N, and band, Hz (Table 1)
LEVEL, BAND = 250.0, (1.0, 200.0)
PERIOD, PERIODS = 4.0, 2  # s
_STIFF = 1e9


@dataclass(frozen=True, eq=False)
class ShakerTest:
    """Spectra (n,) of a test at lines of frequency, Hz."""

    frequency: NDArray[np.float64]
    receptance: NDArray[np.complex128]  # tool against work in x over the force measured, m/N
    transmitted: NDArray[np.float64]  # force measured over that of the motor


def with_shaker(machine: MachineFile, at: dict[str, float]) -> MachineFile:
    """Machine with the slider on the tool interface, the axes at positions, m."""
    nose = [0.0, 1.15, -0.05]
    stiff = dict.fromkeys(("y", "z"), _STIFF) | dict.fromkeys(("rx", "ry", "rz"), 1000000.0)
    damper = 2.0 * DAMPING * MASS * 2.0 * np.pi * NATURAL
    shaker = {
        "body.slider": {"mass": MASS, "inertia": [0.02, 0.02, 0.02], "centre": nose},
        "connector.stinger": {
            "between": ["slider", "ram"], "at": nose,
            "stiffness": stiff | {"x": STIFFNESS}, "damping": {"x": damper},
        },
        "point.slider": {"on": "slider", "at": nose},
    }  # fmt: skip
    carried = {f"axis.{axis}.carries": [*machine.axis[axis].carries, "slider"] for axis in "XYZ"}
    positions = {f"axis.{axis}.position": value for axis, value in at.items()}
    # its own mode lies above those that the machine keeps
    kept = {"highest_frequency": 2.0 * NATURAL}
    return machine.patch({**shaker, **carried, **positions, **kept})


def shaken(machine: MachineFile, at: dict[str, float], conditions: dict[str, str]) -> ShakerTest:
    """Chirp of the shaker's motor on a machine whose axes are at positions, m."""
    with_it = with_shaker(machine, at)
    whole, step = assembled_machine(with_it, conditions), machine.step
    chirp = linear_chirp(*BAND, PERIOD, LEVEL, step)
    values = chirp.repeated(PERIODS, 0)
    axis = np.array([1.0, 0.0, 0.0])
    motor = whole.structure.port("slider", axis, "work")
    stinger = whole.structure.port("slider", axis, "tool")
    tool = whole.structure.port("tool", axis, "work")
    inputs = RunInputs(
        len(values) * step,
        loads={"motor": (motor, np.append(values, values[0]))},
        outputs={"stinger": stinger, "tool": tool},
        stride=4,
    )
    went = run_machine(whole, step, inputs)
    damper = 2.0 * DAMPING * MASS * 2.0 * np.pi * NATURAL
    force = STIFFNESS * went.displacement["stinger"] + damper * went.velocity["stinger"]
    count = round(PERIOD / (4 * step))
    last = slice(len(force) - count, None)
    lines = np.fft.rfftfreq(count, 4 * step)
    used = (lines >= 10.0) & (lines <= BAND[1])
    spectrum = {
        name: np.fft.rfft(signal)[used]
        for name, signal in (
            ("force", force[last]),
            ("tool", went.displacement["tool"][last]),
            ("motor", values[3::4][last]),
        )
    }
    return ShakerTest(
        lines[used],
        spectrum["tool"] / spectrum["force"],
        np.abs(spectrum["force"] / spectrum["motor"]),
    )


def picture_of_shaker(test: ShakerTest, frequency: NDArray, ideal: NDArray) -> Figure:
    """FRF by the shaker beside that by an ideal force, and what of the force arrives."""
    figure = style.new_figure(9.0, 6.0)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    above.plot(frequency, 1e9 * np.abs(ideal), color=style.GREY, label="ideal force")
    above.plot(test.frequency, 1e9 * np.abs(test.receptance), color=style.BLUE, label="shaker")
    above.set_ylabel("receptance [nm/N]")
    above.legend(fontsize=8, frameon=False)
    above.set_title("S2, X, brakes on: chirp of 250 N by the long-stroke shaker", loc="left")
    below.plot(test.frequency, test.transmitted, color=style.RED)
    below.set_ylabel("transmitted force")
    below.set(xlabel="frequency [Hz]", xlim=(10.0, 200.0), ylim=(0.0, None))
    for each in (above, below):
        style.finish(each)
    return figure
