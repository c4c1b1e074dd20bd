"""A test machining centre: brake on, control on, moving, and the friction of its X axis.

The structure is reduced to the modes below 200 Hz, each axis has LuGre friction and a sampled
cascade. Under control the axial mode of the ram at 122 Hz vanishes from the response across it;
in motion a higher gain of the velocity controller raises the first structural mode and lowers its
frequency. Sine moves give the friction curves, from which the law of the X axis is found again.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import chatter
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.plots.style import BLUE, GREEN, GREY, ORANGE, RED, finish, new_figure
from chatter.report.published_against_obtained import (
    CALIBRATED,
    PREDICTED,
    RECOVERED,
    SELECTED,
    Finding,
    write_findings,
)
from chatter.simulation.virtual_tests.frf import FrfCurve, peaks
from dynamics.friction.identification.dynamic_fit import (
    AxisFit,
    AxisModel,
    fit_axis,
    friction_over_position,
)
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.record import DriveRecord, record_from_current
from dynamics.friction.lugre import LuGre
from dynamics.receptance.coupling import PointPort
from dynamics.reduction.modal_truncation import state_space, truncated, undamped_modes

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from eigenvalues import Eigenvalue, eigenvalues, most_damped  # noqa: E402
from shaker import ShakerTest, picture_of_shaker, shaken  # noqa: E402

GAINS = (30.0, 15.0, 7.5)  # N m s/rad, published
LEVELS = (25.0, 250.0, 500.0)  # N; 250 N published
PITCH = 0.040  # m, published
#: lines from which the second mode in motion is told, Hz
AROUND_SECOND = (28.0, 125.0)
TORQUE_CONSTANT = 1.5  # N m/A, chosen
LOW_PASS = LowPass(40.0)
BRAKES = {"X": "brake", "Y": "brake", "Z": "brake"}
S1 = {"X": 0.885, "Y": 0.327, "Z": 0.0}
S2 = {"X": 0.855, "Y": 0.373, "Z": 0.342}
COLOURS = (BLUE, RED, GREEN)
MODEL = "machine file; no published value"
_GAIN = "axis.X.control.velocity.proportional_gain"


def main(out: Path) -> list[Path]:
    """Run all tests, draw them, write the table of findings."""
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    machine = chatter.load_machine(HERE / "machine.toml")
    first = chatter.frf(machine, ["s1_x", "s1_y", "s1_z"]).curves
    states = chatter.frf(machine, ["brake", "control"]).curves
    moving = {
        gain: chatter.frf(machine.patch({_GAIN: gain}), ["moving"])["moving"] for gain in GAINS
    }
    levels = {
        level: states[0]
        if level == 250.0
        else chatter.frf(machine.patch({"frf.brake.level": level}), ["brake"])["brake"]
        for level in LEVELS
    }
    random = machine.patch(
        {"frf.brake.by": "multisine", "frf.brake.period": "2 s", "frf.brake.averages": 4}
    )
    noise = {
        level: chatter.frf(random.patch({"frf.brake.level": level}), ["brake"])["brake"]
        for level in (25.0, 500.0)
    }
    shaker = shaken(machine, S2, BRAKES)
    records = [sine_record(machine, name) for name in ("sine_1000", "sine_3000")]
    fit = identified(records)
    findings = [
        *frequency_findings(first, states),
        *repositioned_findings(machine),
        *control_findings(states),
        *gain_findings(moving),
        *friction_findings(machine, fit),
        *shaker_findings(shaker, states[0]),
        Finding(
            "state space of eqs. 9-15 against the full model, 20-150 Hz, largest deviation",
            "-",
            f"{100 * state_space_deviation(machine):.2g} %",
            source="section 2.1",
            kind=RECOVERED,
        ),
    ]
    curves = {f"{speed} mm/min": friction_over_position(record, fit.model.inertia, LOW_PASS)
              for speed, record in zip((1000, 3000), records, strict=True)}  # fmt: skip
    ideal = states[0].tested
    picture_of_shaker(shaker, ideal.frequency, ideal.values).savefig(out / "shaker.png")
    return [
        out / "shaker.png",
        draw_responses(first, states, moving, out / "responses.png"),
        draw_amplitude(levels, noise, out / "amplitude.png"),
        draw_friction(curves, records[1], fit, LOW_PASS, out / "friction.png"),
        write_findings(findings, out),
    ]


def peak_near(curve: FrfCurve, frequency: float, tested: bool = False) -> dict:
    """Peak of a curve nearest to a frequency."""
    frf = curve.tested if tested else curve.harmonic
    return min(peaks(frf), key=lambda one: abs(one["frequency_Hz"] - frequency))


def frequency_findings(first: list[FrfCurve], states: list[FrfCurve]) -> list[Finding]:
    """Frequencies in states S1 and S2, brakes on."""
    wanted = [
        ("S1, X, lateral mode of the ram", first[0], 74.0, "Figure 7"),
        ("S1, X, axial mode of Z", first[0], 100.0, "Figure 7"),
        ("S1, Y", first[1], 55.0, "Figure 7"),
        ("S2, X, first", states[0], 38.0, "Figure 8"),
        ("S2, X, second", states[0], 75.0, "Figure 8"),
        ("S2, X, lateral mode of the ram", states[0], 110.0, "Figure 8"),
        ("S2, X, axial mode of Z", states[0], 122.0, "Figure 8"),
    ]
    rows = [
        Finding(
            what, published, peak_near(curve, published)["frequency_Hz"], "Hz", source, CALIBRATED
        )
        for what, curve, published, source in wanted
    ]
    off = max(abs(row.obtained - row.published) for row in rows)
    text = f"at most {off:.1f} Hz"
    return [*rows, Finding("  off", "at most 4 Hz", text, "", "section 3", CALIBRATED)]


def repositioned_findings(machine: MachineFile) -> list[Finding]:
    """Modes that the publication sees hardly changed by the position, where none was fitted."""
    moved = machine.patch(
        {"frf.brake.by": "linearised", "frf.brake.position": S1, "frf.s1_y.position": S2}
    )
    found = chatter.frf(moved, ["brake", "s1_y"])
    return [
        Finding(f"{state}, the mode at {published:g} Hz of the other state", published,
                peak_near(found[name], published)["frequency_Hz"], "Hz", "section 3")
        for state, name, published in (("S1, X", "brake", 38.0), ("S2, Y", "s1_y", 55.0))
    ]  # fmt: skip


def level_at(curve: FrfCurve, frequency: float, tested: bool = False) -> float:
    """Receptance at a frequency, nm/N."""
    frf = curve.tested if tested else curve.harmonic
    return 1e9 * float(np.interp(frequency, frf.frequency, np.abs(frf.values)))


def control_findings(states: list[FrfCurve]) -> list[Finding]:
    """The mode at 122 Hz, brake on and control on."""
    brake, control = states
    top = peak_near(brake, 122.0)["frequency_Hz"]
    left = [one for one in peaks(control.harmonic) if abs(one["frequency_Hz"] - top) < 6.0]
    text = f"peak left at {left[0]['frequency_Hz']:.0f} Hz" if left else "no peak left"
    share = level_at(control, top) / level_at(brake, top)
    return [
        Finding(
            "mode at 122 Hz with active control",
            "completely attenuated",
            text,
            "",
            "Figure 9",
            SELECTED,
        ),
        Finding(
            "  receptance at its frequency, control over brake", "-", f"{share:.2f}", kind=SELECTED
        ),
    ]


def gain_findings(moving: dict[float, FrfCurve]) -> list[Finding]:
    """First two structural modes in motion at 100 mm/min.

    The second is that at 75 Hz of Figure 8, damped by the loop so that it is hardly a peak beside
    the next one at 92 Hz: it is told by its eigenvalue, and the response there.
    """
    findings = []
    for way, tested in (("linearised", False), ("chirp of 250 N", True)):
        first = [peak_near(moving[gain], 38.0, tested) for gain in GAINS]
        second = [second_mode(moving[gain], tested) for gain in GAINS]
        rows = (
            ("first", "amplitude", [1e9 * one["magnitude"] for one in first], SELECTED),
            ("first", "frequency", [one["frequency_Hz"] for one in first], SELECTED),
            (
                "second",
                "amplitude",
                [
                    level_at(moving[gain], one.frequency, tested)
                    for gain, one in zip(GAINS, second, strict=True)
                ],
                PREDICTED,
            ),
            ("second", "frequency", [one.frequency for one in second], PREDICTED),
        )
        for order, what, values, kind in rows:
            trend, unit = ("falls", "nm/N") if what == "amplitude" else ("rises", "Hz")
            text = ", ".join(f"{value:.1f}" for value in values) + f" {unit}"
            name = f"{order} mode, K_pn 30, 15, 7.5: {what}, {way}"
            findings.append(Finding(name, f"{trend} as K_pn falls", text, "", "Figure 10", kind))
    return findings


def second_mode(curve: FrfCurve, tested: bool = False) -> Eigenvalue:
    """Eigenvalue of the second mode in motion: of those from 70 to 95 Hz the one the loop damps."""
    frf = curve.tested if tested else curve.harmonic
    inside = (frf.frequency > AROUND_SECOND[0]) & (frf.frequency < AROUND_SECOND[1])
    return most_damped(eigenvalues(frf.frequency[inside], frf.values[inside]), 70.0, 95.0)


def shaker_findings(shaker: ShakerTest, ideal: FrfCurve) -> list[Finding]:
    """What the shaker's own dynamics do to the force and to the response taken over it."""
    frf = ideal.tested
    rows = []
    for frequency in (38.0, 110.0, 122.0):
        near = (shaker.frequency > 0.96 * frequency) & (shaker.frequency < 1.04 * frequency)
        by_shaker = np.abs(shaker.receptance[near]).max()
        lines = (frf.frequency > 0.96 * frequency) & (frf.frequency < 1.04 * frequency)
        share = by_shaker / np.abs(frf.values[lines]).max()
        rows.append(
            Finding(f"peak at {frequency:g} Hz by the shaker over that by an ideal force", "-",
                    f"{share:.2f}", "", "section 2.4", RECOVERED)
        )  # fmt: skip
    return rows


def sine_record(machine: MachineFile, name: str) -> DriveRecord:
    """Drive record of a sine move, from the motor current."""
    move = chatter.move(machine, name)
    current = move.effort[:, 0] / TORQUE_CONSTANT
    return record_from_current(
        move.time, move.scale[:, 0], move.velocity[:, 0], current,
        torque_constant=TORQUE_CONSTANT, transmission=2.0 * np.pi / PITCH, name=name,
    )  # fmt: skip


def identified(records: list[DriveRecord]) -> AxisFit:
    """LuGre law and inertia of the X axis from both records, from a rough first guess."""
    guess = AxisModel(LuGre(20e6, 0.0, 1000.0, 300.0, 400.0, 2e-3), 2500.0)
    free = ("bristle_stiffness", "viscous", "coulomb", "static", "stribeck_velocity", "inertia")
    return fit_axis(records, guess, free, low_pass=LOW_PASS, settling=0.2, starts=2)


def friction_findings(machine: MachineFile, fit: AxisFit) -> list[Finding]:
    """Identified friction against the law of the machine file."""
    law, found = machine.friction["x"].spec(), fit.model.law
    findings = [
        Finding(f"friction of X at {speed:g} mm/min", float(law.steady_state_force(speed / 6e4)),
                float(found.steady_state_force(speed / 6e4)), "N", MODEL, RECOVERED)
        for speed in (1000.0, 3000.0)
    ]  # fmt: skip
    presliding = Finding("presliding stiffness of X", law.bristle_stiffness * 1e-6,
                         found.bristle_stiffness * 1e-6, "N/um", MODEL, RECOVERED)  # fmt: skip
    inertia = Finding("moved mass of X with its turning parts", moved_mass(machine),
                      fit.model.inertia, "kg", MODEL, RECOVERED)  # fmt: skip
    return [*findings, presliding, inertia]


def moved_mass(machine: MachineFile) -> float:
    """Mass of what X carries, and of rotor and screw referred to the slide, kg."""
    carried = sum(machine.get(f"body.{name}.mass") for name in machine.axis["X"].carries)
    length, diameter = 2.7, 0.055
    screw = 7850.0 * np.pi * diameter**4 / 32.0 * length
    return (
        carried + (machine.get("axis.X.drive.motor_inertia") + screw) / (PITCH / (2 * np.pi)) ** 2
    )


def state_space_deviation(machine: MachineFile) -> float:
    """Largest deviation of the modal state space from the full model, over its largest value."""
    full = assembled_machine(machine.patch({"highest_frequency": None}), BRAKES, S2).structure
    modes = undamped_modes(full, 200.0)
    modal = truncated(full, modes, residual_at=("tool", "work"))
    port = PointPort("tool", [1.0, 0.0, 0.0], "work")
    system = state_space(modal, [port], [port])
    row = port.row(full)
    off, top = 0.0, 0.0
    for omega in 2.0 * np.pi * np.arange(20.0, 150.0, 1.0):
        dynamic = full.stiffness - omega**2 * full.mass + 1j * omega * full.damping
        exact = row @ np.linalg.solve(dynamic, row)
        inverse = np.linalg.solve(1j * omega * np.eye(len(system.a)) - system.a, system.b)
        off = max(off, abs((system.c @ inverse + system.d)[0, 0] - exact))
        top = max(top, abs(exact))
    return off / top


def draw_responses(
    first: list[FrfCurve], states: list[FrfCurve], moving: dict[float, FrfCurve], path: Path
) -> Path:
    """Figures 7 to 10 of the publication: states S1 and S2."""
    figure = new_figure(10.0, 7.0)
    axes = figure.subplots(2, 2)
    for curve, colour, way in zip(first, COLOURS, "XYZ", strict=True):
        _line(axes[0, 0], curve.harmonic, colour, way)
    _marked(axes[0, 0], (55.0, 75.0, 100.0), "S1: brakes on, linear (Figure 7)")
    _line(axes[0, 1], states[0].harmonic, GREY, "linearised at rest")
    _line(axes[0, 1], states[0].tested, BLUE, "chirp of 250 N")
    _marked(axes[0, 1], (38.0, 75.0, 110.0, 122.0), "S2, X: brakes on, friction (Figure 8)")
    for curve, colour, name in zip(states, COLOURS, ("brakes on", "control on"), strict=False):
        _line(axes[1, 0], curve.tested, colour, name)
    _marked(axes[1, 0], (122.0,), "S2, X: brake and control, chirp (Figure 9)")
    for (gain, curve), colour in zip(moving.items(), COLOURS, strict=True):
        _line(axes[1, 1], curve.harmonic, colour, f"K_pn = {gain:g} N m s/rad")
        _line(axes[1, 1], curve.tested, colour, "", ":")
    _marked(axes[1, 1], (38.0,), "S2, X: moving at 100 mm/min; dotted: chirp (Figure 10)")
    figure.savefig(path)
    return path


def draw_amplitude(levels: dict[float, FrfCurve], noise: dict[float, FrfCurve], path: Path) -> Path:
    """Response to chirps of several levels, and coherence of multisines."""
    figure = new_figure(9.0, 6.0)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    _line(above, next(iter(levels.values())).harmonic, GREY, "linearised at rest")
    for (level, curve), colour in zip(levels.items(), COLOURS, strict=True):
        _line(above, curve.tested, colour, f"chirp of {level:g} N")
    # periods of a chirp repeat exactly; only other phases show what is not linear
    for (level, curve), colour in zip(noise.items(), (BLUE, GREEN), strict=True):
        below.plot(curve.tested.frequency, curve.tested.coherence, color=colour, lw=1.0,
                   label=f"multisine of {level:g} N")  # fmt: skip
    below.legend(fontsize=8)
    above.set_title("S2, X, brakes on: friction makes the response depend on the force")
    above.set_ylabel("receptance [nm/N]")
    above.legend(fontsize=8)
    below.set_ylabel("coherence")
    below.set_xlabel("frequency [Hz]")
    below.set_ylim(0.98, 1.001)
    for one in (above, below):
        finish(one)
    figure.savefig(path)
    return path


def draw_friction(
    curves: dict[str, tuple[NDArray, NDArray]],
    record: DriveRecord,
    fit: AxisFit,
    low_pass: LowPass,
    path: Path,
) -> Path:
    """Figure 4: friction over position at two speeds, and the driving force over time."""
    figure = new_figure(11.0, 4.0)
    axes = figure.subplots(1, 3)
    for place, (name, (position, friction)) in zip(axes, curves.items(), strict=False):
        late = slice(len(position) // 3, None)
        place.plot((position[late] - position.mean()) * 1e3, friction[late], color=BLUE, lw=1.0)
        place.set_title(f"X axis, {name}")
        place.set_xlabel("position [mm]")
        place.set_ylabel("friction [N]")
    smooth = low_pass.apply(record.effort, record.sample_time)
    axes[2].plot(record.time, smooth, color=ORANGE, lw=1.0, label="drive record, low-passed")
    axes[2].plot(record.time, fit.model.effort(record, low_pass), color=BLUE, lw=1.0,
                 ls="--", label="identified")  # fmt: skip
    axes[2].set_title("driving force, 3000 mm/min")
    axes[2].set_xlabel("time [s]")
    axes[2].set_ylabel("force [N]")
    axes[2].legend(fontsize=8)
    for one in axes:
        finish(one)
    figure.savefig(path)
    return path


def _line(axes: object, frf: object, colour: str, label: str, style: str = "-") -> None:
    kept = frf.frequency >= 10.0
    values = 1e9 * np.abs(frf.values[kept])
    axes.plot(frf.frequency[kept], values, style, color=colour, lw=1.1, label=label or None)


def _marked(axes: object, frequencies: tuple[float, ...], title: str) -> None:
    """Title, labels and dashed lines at published frequencies."""
    for one in frequencies:
        axes.axvline(one, color=GREY, lw=0.7, ls="--")
    axes.set_title(title)
    axes.set_xlabel("frequency [Hz]  (dashed: published)")
    axes.set_ylabel("receptance [nm/N]")
    axes.set_xlim(10.0, 200.0)
    axes.set_ylim(bottom=0.0)
    axes.legend(fontsize=8)
    finish(axes)


if __name__ == "__main__":
    main(Path("out"))
