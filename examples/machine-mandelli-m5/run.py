"""A machining centre's Y and Z axes: sliders tuned to a modal test, loop diagrams, friction found.

The three steps that the paper on the Mandelli M5 takes on the real machine are taken here on its
model: the hammer test, the sweeps and the torque records are simulated, with noise. What is
published, chosen and calibrated: PROVENANCE.md.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import least_squares

import chatter
from chatter.compile.linearised_friction import linearised_frictions
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.plots import style
from chatter.report.published_against_obtained import CALIBRATED, RECOVERED, Finding, write_findings
from chatter.simulation.virtual_tests.frf import peaks
from chatter.simulation.virtual_tests.loop_response import (
    LoopResponse,
    LoopSweep,
    loop_by_sweep,
    loop_response,
)
from dynamics.frf.container import Frf
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.linear_fit import LinearFriction, fit_linear
from dynamics.friction.identification.record import DriveRecord
from dynamics.machine.harmonic import receptance

HERE = Path(__file__).parent

# --- tuning of the sliders, section 6 -------------------------------------------------------------


class Tuned(NamedTuple):
    """A number of the sliders that is tuned."""

    name: str
    unit: str
    published: float  # Table 3
    start: float  # "theoretical": a catalogue's carriage on a rigid base
    paths: tuple[str, ...]


def _y_sliders(key: str) -> tuple[str, ...]:
    return tuple(f"connector.sliders_y_{side}.{key}" for side in ("left", "right"))


def _damping(connectors: Sequence[str], directions: str) -> tuple[str, ...]:
    return tuple(f"connector.{one}.damping.{way}" for one in connectors for way in directions)


TABLE_3 = (
    Tuned("Y normal stiffness", "N/m", 3e8, 9e8, _y_sliders("stiffness.z")),
    Tuned("Y lateral stiffness", "N/m", 1.5e8, 6e8, _y_sliders("stiffness.x")),
    Tuned("Y damping", "N s/m", 12e3, 4e3, _damping(("sliders_y_left", "sliders_y_right"), "xz")),
    Tuned("Z normal stiffness", "N/m", 4e8, 11e8, ("connector.sliders_z.stiffness.y",)),
    Tuned("Z lateral stiffness", "N/m", 2.5e8, 7e8, ("connector.sliders_z.stiffness.x",)),
    Tuned("Z damping", "N s/m", 8e3, 4e3, _damping(("sliders_z",), "xy")),
)
#: FRF of the machine file -> excited and read
PLACES = {
    "nose_x": ("tool x", "tool x"),
    "nose_y": ("tool y", "tool y"),
    "nose_z": ("tool z", "tool z"),
    "column_x": ("tool x", "bridge x"),
    "column_z": ("tool y", "bridge z"),
    "foot_x": ("tool x", "foot x"),
    "foot_y": ("tool y", "foot y"),
}
POINTS = ("tool", "bridge", "foot")
NOISE, FLOOR = 0.03, 2e-3  # of each line, and of the highest one


def with_sliders(machine: MachineFile, values: Sequence[float]) -> MachineFile:
    """Machine with the numbers of Table 3 replaced."""
    pairs = zip(TABLE_3, values, strict=True)
    return machine.patch({path: float(value) for one, value in pairs for path in one.paths})


def measured(machine: MachineFile) -> dict[str, Frf]:
    """FRFs by blows in time on the machine of Table 3, with noise."""
    random = np.random.default_rng(7)
    noisy = {}
    for curve in chatter.frf(machine, list(PLACES)).curves:
        test = curve.tested
        errors = random.standard_normal((4, test.frequency.size))
        relative = 1.0 + NOISE * (errors[0] + 1j * errors[1]) / np.sqrt(2.0)
        floor = FLOOR * np.abs(test.values).max() * (errors[2] + 1j * errors[3]) / np.sqrt(2.0)
        noisy[curve.name] = Frf(test.frequency, test.values * relative + floor, "receptance")
    return noisy


def sureness(test: Frf) -> NDArray[np.float64]:
    """Weight of the logarithm of each line, 1 where the floor takes no part: coherence tells it."""
    height = np.abs(test.values)
    return 1.0 / np.hypot(1.0, FLOOR / NOISE * height.max() / height)


def linearised(machine: MachineFile, frequency: NDArray) -> dict[str, NDArray]:
    """Same FRFs of the linearised model, without friction as published."""
    whole = assembled_machine(machine).without_friction()
    names = [f"{point} {way}" for point in POINTS for way in "xyz"]
    rows = np.array([whole.structure.port(point, way) for point in POINTS for way in np.eye(3)])
    matrix = receptance(whole, frequency, rows, machine.step)
    return {
        name: matrix[:, names.index(read), names.index(excited)]
        for name, (excited, read) in PLACES.items()
    }


class Tuning(NamedTuple):
    """What the optimisation found."""

    values: NDArray[np.float64]
    spread: NDArray[np.float64]  # relative standard deviation
    misfit: tuple[float, float]  # weighted rms of the magnitudes' logarithm, before, after, dB
    evaluations: int


#: factor by which a tuned number may leave its start
FARTHEST = 100.0


def tuned(machine: MachineFile, test: dict[str, Frf]) -> Tuning:
    """Slider numbers by least squares on the logarithm of the magnitudes."""
    frequency = next(iter(test.values())).frequency
    wanted = np.concatenate([np.log(np.abs(test[name].values)) for name in PLACES])
    weight = np.concatenate([sureness(test[name]) for name in PLACES])

    def residual(logarithms: NDArray) -> NDArray:
        curves = linearised(with_sliders(machine, np.exp(logarithms)), frequency)
        values = np.concatenate([np.log(np.abs(curves[name])) for name in PLACES])
        return weight * (values - wanted)

    start = np.log([one.start for one in TABLE_3])
    # far off, peaks lie beside peaks: soft_l1 keeps them from deciding
    tolerances = {"xtol": 1e-3, "ftol": 1e-4}
    found = least_squares(
        residual,
        start,
        bounds=(start - np.log(FARTHEST), start + np.log(FARTHEST)),
        loss="soft_l1",
        f_scale=0.3,
        diff_step=1e-3,
        **tolerances,
    )
    left = residual(found.x)
    variance = np.sum(left**2) / (left.size - start.size)
    spread = np.sqrt(variance * np.diag(np.linalg.inv(found.jac.T @ found.jac)))
    to_db = 20.0 / np.log(10.0) / np.sqrt(np.mean(weight**2))
    misfit = tuple(to_db * float(np.sqrt(np.mean(one**2))) for one in (residual(start), left))
    return Tuning(np.exp(found.x), spread, misfit, found.nfev)


# --- closed loops, figures 12 and 13 --------------------------------------------------------------

SPEED = 0.03  # m/s, of Y under the sweeps: friction slides
HIGHEST = 500.0  # Hz
SWEEPS = {
    # the position loop samples at 1 kHz
    "position": LoopSweep("position", (5.0, 400.0), 3e-7, 1.0, SPEED),
    "velocity": LoopSweep("velocity", (5.0, HIGHEST), 5e-4, 1.0, SPEED),
}


class Loops(NamedTuple):
    """Closed loops of Y, in closed form and by sweeps."""

    closed_form: LoopResponse
    swept: dict[str, tuple[NDArray, NDArray]]
    deviation: dict[str, float]
    at_ends: dict[str, LoopResponse]  # head low and high


def loops(machine: MachineFile) -> Loops:
    """Loops of Y while it moves; sweeps as the control's measuring functions make them."""
    whole = assembled_machine(machine)
    frequency = np.linspace(2.0, HIGHEST - 0.5, 996)
    closed = _loops_at(machine, frequency, "0 mm")
    swept = {name: loop_by_sweep(whole, machine.step, "Y", sweep) for name, sweep in SWEEPS.items()}
    sliding = linearised_frictions(whole, {"Y": SPEED})
    deviation = {}
    for name, (lines, values) in swept.items():
        # the tapered ends of a chirp have little power
        lowest, highest = SWEEPS[name].band
        inside = (lines > 1.5 * lowest) & (lines < 0.95 * highest)
        exact = getattr(loop_response(whole, machine.step, "Y", lines, sliding), name)
        error = np.abs(values - exact)[inside]
        deviation[name] = float(np.max(error / np.abs(exact[inside])))
    ends = {place: _loops_at(machine, frequency, place) for place in ("-300 mm", "300 mm")}
    return Loops(closed, swept, deviation, ends)


def _loops_at(machine: MachineFile, frequency: NDArray, head: str) -> LoopResponse:
    whole = assembled_machine(machine, positions={"Y": head})
    return loop_response(
        whole, machine.step, "Y", frequency, linearised_frictions(whole, {"Y": SPEED})
    )


# --- friction, equation 1 and Table 1 ---------------------------------------------------------

LEAD = 0.020  # m; the belt's ratio is 1, so motor and driving screw turn alike
TABLE_1 = {"Y": (3.57, 0.0105, 0.0192), "Z": (3.87, 0.075, 0.0272)}
J_AS_PRINTED = 0.192  # kg m^2, of Y
IDENTIFYING = ("slow_forward", "slow_backward", "fast_forward", "fast_backward")
TORQUE_NOISE, SPEED_NOISE = 0.2, 0.05  # N m and rad/s, standard deviations
LOW_PASS = LowPass(30.0)
SLOWEST = 3.0  # rad/s


class Identified(NamedTuple):
    """Friction and inertia of an axis from its torque records."""

    fit: LinearFriction
    records: list[DriveRecord]
    other: DriveRecord  # not fitted
    residual: float  # on it, rms over rms, both behind the low-pass


def torque_record(machine: MachineFile, axis: str, name: str, seed: int) -> DriveRecord:
    """Simulated record of a move about the driving screw, with noise."""
    run = chatter.move(machine.patch({f"move.{name}.axes": [axis]}), name)
    random = np.random.default_rng(seed)
    per_travel = 2.0 * np.pi / LEAD
    # the torque is the mean over a cycle, so the motion has to be that of its middle
    middle, angle, speed = (
        0.5 * (one[1:] + one[:-1])
        for one in (run.time, run.motor[:, 0] * per_travel, run.velocity[:, 0] * per_travel)
    )
    torque = run.effort[1:, 0]
    return DriveRecord(
        middle,
        angle,
        speed + SPEED_NOISE * random.standard_normal(speed.size),
        torque + TORQUE_NOISE * random.standard_normal(torque.size),
        name=f"{axis}, {name}",
    )


def identified(machine: MachineFile, axis: str) -> Identified:
    """Equation 1 in the least-squares sense, judged on another profile."""
    records = [torque_record(machine, axis, name, k) for k, name in enumerate(IDENTIFYING)]
    fit = fit_linear(records, low_pass=LOW_PASS, minimum_speed=SLOWEST)
    other = torque_record(machine, axis, "other_profile", 9)
    wanted, predicted = filtered_torques(fit, other)
    moving = np.abs(other.velocity) > SLOWEST
    error = np.sqrt(np.mean((predicted - wanted)[moving] ** 2) / np.mean(wanted[moving] ** 2))
    return Identified(fit, records, other, float(error))


def filtered_torques(fit: LinearFriction, record: DriveRecord) -> tuple[NDArray, NDArray]:
    """Torque of a record, and that of the fitted equation, behind the same low-pass."""
    quiet = LOW_PASS.apply(record.velocity, record.sample_time)
    predicted = fit.effort(quiet, np.gradient(quiet, record.sample_time))
    return (LOW_PASS.apply(one, record.sample_time) for one in (record.effort, predicted))


# --- Y at rest: friction holds it -------------------------------------------------------------


class StillY(NamedTuple):
    """Response of the nose in Y without and with friction."""

    free: Frf
    held: Frf
    tested: Frf  # with friction, by blows

    @property
    def ratio(self) -> float:
        """Static compliance without friction over that with."""
        return float(abs(self.free.values[0]) / abs(self.held.values[0]))


def still_y(machine: MachineFile, free: Frf) -> StillY:
    """What the friction that the published model leaves out does to Y."""
    curve = chatter.frf(machine.patch({"frf.nose_y.friction": True}), ["nose_y"])["nose_y"]
    return StillY(free, curve.harmonic, curve.tested)


# --- pictures -----------------------------------------------------------------------------------


def plot_tuning(
    machine: MachineFile, test: dict[str, Frf], tuning: Tuning, still: StillY
) -> Figure:
    """Responses before and after, as figures 10 and 11; Y with friction."""
    frequency = test["nose_x"].frequency
    before = linearised(with_sliders(machine, [one.start for one in TABLE_3]), frequency)
    after = linearised(with_sliders(machine, tuning.values), frequency)
    figure = style.new_figure(9.0, 8.6)
    panels = figure.subplots(3, 2).ravel()
    titles = {
        "nose_x": "nose, X (Fig. 10 and 11)",
        "nose_y": "nose, Y (Fig. 10 and 11)",
        "nose_z": "nose, Z",
        "column_x": "blow on the nose in X, top of the column in X",
        "column_z": "blow on the nose in Y, top of the column in Z",
    }
    for axes, (name, title) in zip(panels[:5], titles.items(), strict=True):
        axes.semilogy(frequency, 1e6 * np.abs(test[name].values), color=style.RED, label="blows")
        axes.semilogy(
            frequency, 1e6 * np.abs(before[name]), "--", color=style.GREY, label="before tuning"
        )
        axes.semilogy(frequency, 1e6 * np.abs(after[name]), color=style.BLUE, label="after tuning")
        axes.set_title(title)
    axes = panels[5]
    axes.semilogy(
        still.free.frequency, 1e6 * np.abs(still.free.values), color=style.BLUE, label="no friction"
    )
    axes.semilogy(
        still.held.frequency, 1e6 * np.abs(still.held.values), color=style.GREEN, label="friction"
    )
    axes.semilogy(
        still.tested.frequency,
        1e6 * np.abs(still.tested.values),
        ".",
        markersize=2.5,
        color=style.ORANGE,
        label="friction, blows",
    )
    axes.set_title("nose, Y: what friction at rest does")
    for axes in panels:
        style.finish(axes)
        axes.legend(fontsize=8, frameon=False)
        axes.set_ylabel("receptance [um/N]")
    for axes in panels[4:]:
        axes.set_xlabel("frequency [Hz]")
    return figure


def plot_loops(found: Loops) -> Figure:
    """Bode diagrams of the closed loops of Y, as figures 12 and 13."""
    figure = style.new_figure(9.0, 6.4)
    panels = figure.subplots(2, 2, sharex=True)
    titles = {
        "position": "Y, closed position loop (Fig. 12)",
        "velocity": "Y, closed velocity loop (Fig. 13)",
    }
    for column, (name, title) in enumerate(titles.items()):
        lines, swept = found.swept[name]
        exact = getattr(found.closed_form, name)
        gain, phase = panels[:, column]
        for other in found.at_ends.values():
            values = getattr(other, name)
            gain.semilogx(other.frequency, decibel(values), ":", color=style.GREY, linewidth=1.0)
        gain.semilogx(lines, decibel(swept), color=style.RED, linewidth=2.4, label="sweep in time")
        gain.semilogx(
            found.closed_form.frequency,
            decibel(exact),
            color=style.BLUE,
            linewidth=1.1,
            label="closed form",
        )
        gain.plot([], [], ":", color=style.GREY, label="head 300 mm lower, higher")
        gain.axhline(-3.0, color=style.GREY, linewidth=0.6)
        gain.set_title(title)
        gain.set_ylim(-45.0, 8.0)
        gain.legend(fontsize=8, frameon=False)
        phase.semilogx(lines, degrees(swept), color=style.RED, linewidth=2.4)
        phase.semilogx(found.closed_form.frequency, degrees(exact), color=style.BLUE, linewidth=1.1)
        gain.set_ylabel("magnitude [dB]")
        phase.set_ylabel("phase [deg]")
        phase.set_xlabel("frequency [Hz]")
        phase.set_xlim(5.0, HIGHEST)
        for axes in (gain, phase):
            style.finish(axes)
    return figure


def decibel(values: NDArray) -> NDArray:
    return 20.0 * np.log10(np.abs(values))


def degrees(values: NDArray) -> NDArray:
    return np.degrees(np.unwrap(np.angle(values)))


def plot_friction(found: dict[str, Identified]) -> Figure:
    """Torque over speed of the records fitted, and the other profile, as figure 7."""
    figure = style.new_figure(9.0, 6.2)
    panels = figure.subplots(2, 2)
    for row, (axis, one) in enumerate(found.items()):
        left, right = panels[row]
        for record in one.records:
            left.plot(record.time, record.effort, color=style.RED, linewidth=0.6)
            left.plot(record.time, filtered_fit(one.fit, record), color=style.BLUE, linewidth=1.3)
        left.set_title(f"{axis}: records fitted, 4 and 24 m/min, both ways")
        right.plot(
            one.other.time, one.other.effort, color=style.RED, linewidth=0.6, label="simulated"
        )
        right.plot(
            one.other.time,
            filtered_fit(one.fit, one.other),
            color=style.BLUE,
            linewidth=1.3,
            label="equation 1 as fitted",
        )
        right.set_title(f"{axis}: another profile (Fig. 7)")
        right.legend(fontsize=8, frameon=False)
        for axes in (left, right):
            axes.set_xlabel("time [s]")
            axes.set_ylabel("motor torque [N m]")
            style.finish(axes)
    return figure


def filtered_fit(fit: LinearFriction, record: DriveRecord) -> NDArray:
    """Torque of the fitted equation where it is one: not at rest."""
    torque = tuple(filtered_torques(fit, record))[1]
    return np.where(np.abs(record.velocity) > SLOWEST, torque, np.nan)


# --- published and obtained -------------------------------------------------------------------


def bandwidth(frequency: NDArray, values: NDArray) -> float:
    """Frequency where the magnitude first falls below -3 dB, Hz."""
    return float(frequency[np.argmax(np.abs(values) < np.sqrt(0.5))])


def pairs_in_words(found: LoopResponse) -> str:
    """Anti-resonances of the velocity loop, each with the resonance above it."""
    valleys = peaks(Frf(found.frequency, 1.0 / found.velocity, "receptance"))
    hills = peaks(Frf(found.frequency, found.velocity, "receptance"))
    above = [
        min((h["frequency_Hz"] for h in hills if h["frequency_Hz"] > v["frequency_Hz"]), default=0)
        for v in valleys
    ]
    return ", ".join(
        f"{v['frequency_Hz']:.0f}/{h:.0f}" for v, h in zip(valleys, above, strict=True) if h
    )


def tuning_findings(tuning: Tuning, before: float, still: StillY) -> list[Finding]:
    sources = "Table 3, from simulated blows"
    before_db, after_db = (f"{value:.3g} dB" for value in tuning.misfit)
    return [
        *(
            Finding(one.name, one.published, float(value), one.unit, sources, RECOVERED)
            for one, value in zip(TABLE_3, tuning.values, strict=True)
        ),
        Finding(
            "misfit of magnitudes before tuning",
            "peaks misaligned",
            before_db,
            "",
            "Fig. 10",
            RECOVERED,
        ),
        Finding(
            "misfit of magnitudes after tuning",
            "peaks replicated",
            after_db,
            "",
            "Fig. 11",
            RECOVERED,
        ),
        Finding(
            "stiffness in X at 8 Hz, before over after",
            "statically more rigid",
            before,
            "",
            "section 6",
            RECOVERED,
        ),
        Finding(
            "Y: compliance at 8 Hz without friction over that with",
            "static stiffness not reproduced for want of friction",
            still.ratio,
            "",
            "section 6",
        ),
    ]


def loop_findings(found: Loops) -> list[Finding]:
    closed = found.closed_form
    position, velocity = (
        f"{bandwidth(closed.frequency, values):.3g} Hz"
        for values in (closed.position, closed.velocity)
    )
    return [
        Finding("Y position loop: -3 dB", "curve only", position, "", "Fig. 12"),
        Finding("Y velocity loop: first -3 dB", "curve only", velocity, "", "Fig. 13"),
        Finding(
            "Y velocity loop: anti-resonance/resonance",
            "seen, curve only",
            f"{pairs_in_words(closed)} Hz",
            "",
            "Fig. 13",
        ),
        *(
            Finding(
                f"{name} loop: largest deviation of the sweep from the closed form",
                "good accordance",
                f"{100.0 * value:.2g} %",
                "",
                "section 6",
                RECOVERED,
            )
            for name, value in found.deviation.items()
        ),
    ]


def friction_findings(found: dict[str, Identified]) -> list[Finding]:
    rows = []
    for axis, one in found.items():
        coulomb, viscous, inertia = TABLE_1[axis]
        rows += [
            Finding(
                f"{axis}: tau_st", coulomb, one.fit.value("coulomb"), "N m", "Table 1", RECOVERED
            ),
            Finding(
                f"{axis}: mu", viscous, one.fit.value("viscous"), "N m s", "Table 1", RECOVERED
            ),
        ]
        if axis == "Y":
            rows.append(
                Finding(
                    "Y: J_eq as printed",
                    J_AS_PRINTED,
                    one.fit.value("inertia"),
                    "kg m^2",
                    "Table 1",
                    RECOVERED,
                )
            )
        reading = "Y: J_eq read as 0.0192" if axis == "Y" else "Z: J_eq"
        rows += [
            Finding(reading, inertia, one.fit.value("inertia"), "kg m^2", "Table 1", CALIBRATED),
            Finding(
                f"{axis}: torque left unexplained on another profile",
                "curves agree",
                f"{100.0 * one.residual:.2g} %",
                "",
                "Fig. 7",
                RECOVERED,
            ),
        ]
    return rows


def main(out: Path) -> list[Path]:
    """Tune, sweep, identify; return the pictures and the table."""
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    machine = chatter.load_machine(HERE / "machine.toml")

    test = measured(machine)
    tuning = tuned(machine, test)
    for one, value, spread in zip(TABLE_3, tuning.values, tuning.spread, strict=True):
        print(
            f"{one.name}: from {one.start:.3g} to {value:.4g} {one.unit} (+-{100 * spread:.1f} %)"
        )
    print(f"{tuning.evaluations} evaluations")
    low = test["nose_x"].frequency[:1]
    before = linearised(with_sliders(machine, [one.start for one in TABLE_3]), low)["nose_x"]
    after = linearised(with_sliders(machine, tuning.values), low)["nose_x"]
    frequency = test["nose_y"].frequency
    still = still_y(machine, Frf(frequency, linearised(machine, frequency)["nose_y"], "receptance"))

    closed = loops(machine)
    for place, other in closed.at_ends.items():
        print(f"head at {place}: anti-resonance/resonance {pairs_in_words(other)} Hz")
    friction = {axis: identified(machine, axis) for axis in TABLE_1}
    for axis, one in friction.items():
        mass = one.fit.value("inertia") * (2.0 * np.pi / LEAD) ** 2
        print(f"{axis}: J_eq is that of {mass:.0f} kg on a lead of {1e3 * LEAD:.0f} mm")
    printed = J_AS_PRINTED * (2.0 * np.pi / LEAD) ** 2
    print(f"Y, J_eq as printed: {printed:.0f} kg, but Z carries all of Y and has 0.0272 kg m^2")

    pictures = {
        "tuning.png": plot_tuning(machine, test, tuning, still),
        "loops.png": plot_loops(closed),
        "friction.png": plot_friction(friction),
    }
    for name, figure in pictures.items():
        figure.savefig(out / name)
    stiffer = float(abs(after[0]) / abs(before[0]))
    findings = [
        *tuning_findings(tuning, stiffer, still),
        *loop_findings(closed),
        *friction_findings(friction),
    ]
    return [*(out / name for name in pictures), write_findings(findings, out)]


if __name__ == "__main__":
    main(Path("out"))
