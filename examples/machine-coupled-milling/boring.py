"""The boring trial: one insert in a hole, a pulse of torque as it points to +y (Figures 4 to 6).

A face mill with one insert left, 50 mm wide, opens a hole of 45 mm by 0.1 mm a revolution at
180 rpm, X and Y at rest. The chip is 2.5 mm wide and 0.1 mm thick, so that its force turns with the
tool; a vibration across the axis changes its width by so little (0.18 N/um) that it is left out
beside the contact of tool and work (2.50 N/um, 3.35 kN s/m). The dynamometer reads both.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.plots import style
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.frf.excitation.angle_triggered import angle_at_constant_speed, angle_triggered_pulses
from dynamics.frf.excitation.hammer import half_sine_blow

SPEED = 180.0 * np.pi / 30.0  # rad/s
#: width and thickness of the chip, m
WIDTH, THICKNESS = 2.5e-3, 0.1e-3
#: tangential force of S45C, Pa and N/m; as of the face mill
KTC, KTE = 1800e6, 40e3
#: run, and from when on the pulse waits for the insert, s
DURATION, ARMED = 5.0, 4.5
#: pulse, N m and s, towards -y
PULSE, WIDTH_OF_PULSE = -20.0, 9e-3
#: share of the largest acceleration below which the vibration counts as gone
_GONE = 0.1


@dataclass(frozen=True, eq=False)
class BoringTrial:
    """Signals (n,) of a trial."""

    time: NDArray[np.float64]  # s
    angle: NDArray[np.float64]  # of the insert, clockwise from +y, rad
    force: NDArray[np.float64]  # on the work, x and y, N, (n, 2)
    acceleration: NDArray[np.float64]  # of the table in y, m/s^2
    released: float  # time of the pulse, s

    @property
    def angle_of_largest_fx(self) -> float:
        """Angle of the insert where the force in x is largest, before the pulse, degrees."""
        before = (self.time > 1.0) & (self.time < self.released)
        largest = np.angle(np.sum(self.force[before, 0] * np.exp(1j * self.angle[before])))
        return float(np.degrees(largest))

    @property
    def spike(self) -> float:
        """Largest change of the force in y by the pulse, over the size of what it turns by."""
        turn = round(2.0 * np.pi / SPEED / (self.time[1] - self.time[0]))
        begin = int(np.searchsorted(self.time, self.released))
        change = self.force[begin : begin + turn, 1] - self.force[begin - turn : begin, 1]
        return float(np.abs(change).max() / np.abs(self.force[begin - turn : begin, 1]).max())

    @property
    def residual(self) -> float:
        """Time for which the vibration goes on behind the pulse, s."""
        behind = self.time > self.released
        size = np.abs(self.acceleration[behind])
        last = np.flatnonzero(size > _GONE * size.max())[-1]
        return float(self.time[behind][last] - self.released)


def boring_trial(machine: MachineFile) -> BoringTrial:
    """Run the trial on a machine in the cut."""
    whole, step = assembled_machine(machine, in_cut=True), machine.step
    count = round(DURATION / step)
    angle = angle_at_constant_speed(SPEED, count + 1, step)
    pulse = half_sine_blow(WIDTH_OF_PULSE, 1.0, step)
    armed = round(ARMED / step)
    train = angle_triggered_pulses(angle[armed:count], 0.0, pulse, step, revolutions=2)
    torque = np.concatenate([np.zeros(armed), PULSE * train.values])
    tangential = KTC * WIDTH * THICKNESS + KTE * WIDTH
    # the force turns up within the first revolution, as the insert comes into its full depth
    ramp = np.clip(angle / (2.0 * np.pi), 0.0, 1.0)
    on_work = tangential * ramp * np.array([np.cos(angle), -np.sin(angle)])
    tool = {way: whole.structure.port("tool", np.eye(3)["xyz".index(way)], "work") for way in "xy"}
    table = whole.structure.port("table", np.array([0.0, 1.0, 0.0]))
    inputs = RunInputs(
        DURATION,
        loads={f"cut {way}": (tool[way], -on_work[i]) for i, way in enumerate("xy")},
        injected={drive.name: torque for drive in whole.drives if drive.axis == "Y"},
        outputs={**tool, "table": table},
        stride=4,
    )
    went = run_machine(whole, step, inputs)
    k, c = machine.get("contact.stiffness"), machine.get("contact.damping")
    rows = np.arange(1, len(went.time) + 1) * 4
    contact = np.array([k * went.displacement[way] + c * went.velocity[way] for way in "xy"])
    released = step * (armed + int(np.flatnonzero(train.values)[0]))
    return BoringTrial(
        went.time,
        angle[rows],
        (on_work[:, rows] + contact).T,
        np.gradient(went.velocity["table"], went.time),
        released,
    )


def picture_of_trial(trial: BoringTrial) -> Figure:
    """Forces and acceleration, as Figure 6 has them."""
    figure = style.new_figure(9.0, 6.0)
    axes = figure.subplots(3, 1, sharex=True)
    for row, way in enumerate("xy"):
        axes[row].plot(trial.time, trial.force[:, row], color=style.BLUE, linewidth=1.0)
        axes[row].set_ylabel(f"force on the work, {way} [N]")
    axes[2].plot(trial.time, trial.acceleration, color=style.RED, linewidth=1.0)
    axes[2].set_ylabel("table in y [m/s$^2$]")
    axes[2].set(xlabel="time [s]", xlim=(3.9, DURATION))
    axes[0].set_title("boring at 180 rpm, a pulse of torque as the insert points to +y", loc="left")
    for each in axes:
        each.axvline(trial.released, color=style.GREY, linestyle="--", linewidth=1.0)
        style.finish(each)
    return figure
