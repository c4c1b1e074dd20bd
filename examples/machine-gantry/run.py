"""A gantry: identified in its closed loops, bending moves with the head; a square at full speed.

The tests of the paper by Moten et al. (KU Leuven) on a model of its gantry: multisine in the motor
torque, FRFs to motor and tool, the bending of the crossbeam with the head in the middle and at the
left, and the tool's contour error on a square with fillets, planned time-optimally. Portal and
bracket are super-elements of solid elements; the same machine of tubes stands beside it. What is
published, assumed and calibrated: PROVENANCE.md.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import chatter
from chatter.compile.linearised_friction import rigid_motion
from chatter.compile.machine_parts import assembled_machine, machine_parts
from chatter.description.machine.machine_file import MachineFile
from chatter.plots import style
from chatter.report.console import print_table
from chatter.report.published_against_obtained import (
    CALIBRATED,
    RECOVERED,
    SELECTED,
    Finding,
    write_findings,
)
from chatter.simulation.virtual_tests.frf import FrfResult, peaks
from chatter.simulation.virtual_tests.move import MoveResult
from dynamics.frf.container import Frf
from dynamics.structure.assembly import assemble

HERE = Path(__file__).parent
#: the head at the left extreme, m: where its guides reach the last place on the rails, and on the
#: tubes the place that was chosen for 112 Hz
LEFT, LEFT_ON_TUBES = -0.54, -0.45
TRANSMISSION = 0.005  # of X, m/rad of its motors
#: published: what Y moves, kg, and up to which frequency its FRFs are the line of that mass, Hz
HEAD_MASS, MASS_LINE = 50.0, 100.0
#: test of the file for the FRF of an axis to a direction of the tool, figures 13 to 15
TESTS = {("X", "x"): "x_tcp", ("Y", "y"): "y_tcp", ("X", "z"): "z_tcp"}


def detuned(machine: MachineFile) -> MachineFile:
    """Machine as it is identified: position controller off, velocity controller soft."""
    changes: dict = {}
    for axis, gain in (("X", 0.3), ("Y", 2500.0)):  # N m s/rad, N s/m
        control = f"axis.{axis}.control"
        changes[f"{control}.position.gain"] = 0.0
        changes[f"{control}.velocity.proportional_gain"] = gain
        changes[f"{control}.velocity.integral_time"] = None
    return machine.patch(changes)


def clamped_bracket(machine: MachineFile) -> float:
    """First natural frequency of the bracket with its tool, Hz, clamped where it meets the head."""
    made = machine_parts(machine)
    bracket = [body for body in made.bodies if body.name in ("bracket", "tool")]
    held = [
        replace(one, second="ground") if one.name == "bracket_root" else one
        for one in made.connectors
        if one.name in ("bracket_root", "tool_grip")
    ]
    return float(assemble(bracket, held, []).natural_frequencies()[0])


def moved_mass(machine: MachineFile) -> float:
    """Mass that X moves, kg, without the inertia of its motors."""
    whole = assembled_machine(machine)
    rigid = rigid_motion(whole, {"X": 1.0})
    motors = machine.axis["X"].drive.motors
    turning = sum(one.inertia for one in motors) / TRANSMISSION**2
    return float(rigid @ whole.structure.mass @ rigid) - turning


def frfs_to_tool(machine: MachineFile, left: float) -> dict[tuple[str, str, str], Frf]:
    """FRFs of figures 13 to 15: axis, direction of the tool, head in the middle or at the left."""
    places = {"middle": 0.0, "left": left}
    at = {name: identified_at(machine, head) for name, head in places.items()}
    return {(*of, name): at[name][of] for of in TESTS for name in places}


def identified_at(machine: MachineFile, head: float) -> dict[tuple[str, str], Frf]:
    """FRFs from an axis to a direction of the tool, by multisine as in section 3.2, head at, m.

    The detuned velocity controllers run: each motor of X has its own, so that they damp yaw.
    """
    places = {f"frf.{test}.position": {"Y": head} for test in TESTS.values()}
    found = chatter.frf(detuned(machine).patch(places), list(TESTS.values()))
    return {of: found[test].tested for of, test in TESTS.items()}


def peak_near(frf: Frf, frequency: float) -> float:
    """Frequency, Hz, of the peak nearest to a frequency; not a number without any peak."""
    found = np.array([one["frequency_Hz"] for one in peaks(frf)])
    return float(found[np.argmin(np.abs(found - frequency))]) if found.size else float("nan")


def peaks_between(frf: Frf, low: float, high: float) -> str:
    """Peaks between two frequencies, in words."""
    found = [one["frequency_Hz"] for one in peaks(frf) if low < one["frequency_Hz"] < high]
    return ", ".join(f"{one:.0f} Hz" for one in found) or "none"


def usual_difference(identified: FrfResult, name: str) -> float:
    """Difference of a tested FRF from the linearised one that 95 % of its lines keep."""
    curve = identified[name]
    lines, linear = curve.tested.frequency, curve.harmonic
    at_lines = np.interp(lines, linear.frequency, linear.values)
    return float(np.percentile(np.abs(curve.tested.values / at_lines - 1.0), 95.0))


def over_mass_line(frf: Frf) -> float:
    """Receptance of Y over that of the mass it moves, where the published mass line ends."""
    size = np.interp(MASS_LINE, frf.frequency, np.abs(frf.values))
    return float(size * HEAD_MASS * (2.0 * np.pi * MASS_LINE) ** 2)


def print_tubes(
    solid: dict[tuple[str, str, str], Frf], tubes: dict[tuple[str, str, str], Frf]
) -> None:
    """Peaks below 300 Hz of both models beside one another: what tubes miss."""
    rows = [
        [f"{axis} to tool {way}, head {head}", *(peaks_between(one[axis, way, head], 20.0, 300.0)
                                                 for one in (solid, tubes))]
        for axis, way, head in solid
    ]  # fmt: skip
    print_table("peaks of solid elements and of tubes", ["response", "solid", "tubes"], rows)


def position_picture(
    frfs: dict[tuple[str, str, str], Frf], tubes: dict[tuple[str, str, str], Frf]
) -> Figure:
    """FRFs to the tool with the head in the middle and at the left, as figures 13 to 15."""
    figure = style.new_figure(9.0, 8.6)
    axes = figure.subplots(3, 1, sharex=True)
    rows = (
        ("X", "x", "figure 13: X torque to tool x", ((185.0, "bracket"),), "m/(N m)"),
        ("Y", "y", "figure 14: Y force to tool y", (), "m/N"),
        ("X", "z", "figure 15: X torque to tool z", ((98.0, "middle"), (112.0, "left")), "m/(N m)"),
    )
    for each, (axis, way, title, published, unit) in zip(axes, rows, strict=True):
        for head, colour in (("middle", style.BLUE), ("left", style.RED)):
            frf = frfs[axis, way, head]
            each.semilogy(frf.frequency, np.abs(frf.values), color=colour, label=f"head {head}")
            beams = tubes[axis, way, head]
            label = f"head {head}, tubes"
            each.semilogy(beams.frequency, np.abs(beams.values), ":", color=colour, label=label)
        for frequency, what in published:
            each.axvline(frequency, color=style.GREY, linestyle="--", linewidth=1.0)
            each.annotate(
                f"published: {frequency:g} Hz, {what} ",
                (frequency, 1.0 if what != "left" else 0.86),
                xycoords=("data", "axes fraction"),
                va="top",
                ha="right" if what == "middle" else "left",
                fontsize=8.0,
            )
        each.set_title(title, loc="left")
        each.set_ylabel(f"receptance [{unit}]")
        style.finish(each)
    axes[0].legend(fontsize=8.0, frameon=False)
    axes[-1].set_xlabel("frequency [Hz]")
    axes[-1].set_xlim(10.0, 500.0)
    return figure


def contour_picture(moves: dict[str, MoveResult]) -> Figure:
    """Contour errors, with the published largest ones of figure 17."""
    figure = style.new_figure(9.0, 4.2)
    axes = figure.subplots()
    colours = (style.BLUE, style.ORANGE)
    for (name, move), colour in zip(moves.items(), colours, strict=True):
        axes.plot(move.time, 1e6 * np.abs(move.contour), color=colour, linewidth=1.2, label=name)
    for level, what in ((30.0, "simulated"), (48.0, "measured")):
        axes.axhline(level, color=style.GREY, linestyle="--", linewidth=1.0)
        axes.annotate(f"published, {what}: {level:g} µm", (0.99, level + 0.8), fontsize=8.0,
                      xycoords=("axes fraction", "data"), ha="right")  # fmt: skip
    axes.set_xlabel("time [s]")
    axes.set_ylabel("size of the contour error [µm]")
    axes.set_ylim(0.0, 82.0)
    axes.legend(fontsize=8.0, frameon=False, loc="upper right")
    style.finish(axes)
    return figure


def main(out: Path) -> list[Path]:
    """Identify, compare positions, run the square; return what was written."""
    out = Path(out)
    machine = chatter.load_machine(HERE / "machine.toml")
    identified = chatter.frf(detuned(machine))
    written = identified.save(out / "identification")

    frfs = frfs_to_tool(machine, LEFT)
    tubes = frfs_to_tool(chatter.load_machine(HERE / "machine-of-beams.toml"), LEFT_ON_TUBES)
    print_tubes(frfs, tubes)
    moves = {
        "time-optimal within 1 µm of the path": chatter.move(machine, "planned"),
        "constant speed in the fillets: acceleration jumps there": chatter.move(machine, "square"),
    }
    for name, folder in zip(moves, ("planned", "square"), strict=True):
        written += moves[name].save(out / folder)
    for name, figure in (
        ("positions.png", position_picture(frfs, tubes)),
        ("contour.png", contour_picture(moves)),
    ):
        figure.savefig(out / name)
        written.append(out / name)
    written.append(write_findings(findings(machine, identified, frfs, moves), out))
    return written


def findings(
    machine: MachineFile,
    identified: FrfResult,
    frfs: dict[tuple[str, str, str], Frf],
    moves: dict[str, MoveResult],
) -> list[Finding]:
    """What is published beside what the model obtains."""
    planned, jumping = (float(np.max(np.abs(one.contour))) * 1e6 for one in moves.values())
    tool = max(usual_difference(identified, name) for name in ("x_tcp", "z_tcp", "y_tcp"))
    motor = max(usual_difference(identified, name) for name in ("x_motor", "y_motor"))
    return [
        Finding("mass with the head", 330.0, moved_mass(machine), "kg", "section 1.1", CALIBRATED),
        Finding("bracket, clamped", 182.0, clamped_bracket(machine), "Hz", "figure 4", CALIBRATED),
        Finding(
            "bending, head in the middle", 98.0, peak_near(frfs["X", "z", "middle"], 98.0), "Hz",
            "figure 15", CALIBRATED,
        ),
        Finding(
            "bending, head at the left", 112.0, peak_near(frfs["X", "z", "left"], 112.0), "Hz",
            "figure 15", SELECTED,
        ),
        Finding(
            "bracket in X torque to tool x", 185.0, peak_near(frfs["X", "x", "middle"], 185.0),
            "Hz", "figure 13",
        ),
        Finding(
            "the same, head at the left", 185.0, peak_near(frfs["X", "x", "left"], 185.0),
            "Hz", "figure 13",
        ),
        *(
            Finding(
                f"bending in {axis} to tool {way}, head {head}", "none",
                peaks_between(frfs[axis, way, head], 0.95 * bending, 1.05 * bending), "",
                source, SELECTED,
            )
            for axis, way, source in (("X", "x", "figure 13"), ("Y", "y", "figure 14"))
            for head, bending in (("middle", 98.0), ("left", 112.0))
        ),
        Finding(
            "other peaks of tool x, 20 to 150 Hz, middle", "none",
            peaks_between(frfs["X", "x", "middle"], 20.0, 150.0), "", "figure 13", SELECTED,
        ),
        Finding(
            "other peaks of tool x, 20 to 150 Hz, left", "none",
            peaks_between(frfs["X", "x", "left"], 20.0, 150.0), "", "figure 13", SELECTED,
        ),
        Finding(
            "peaks of tool y, 20 to 150 Hz, middle", "none",
            peaks_between(frfs["Y", "y", "middle"], 20.0, 150.0), "", "figure 14", SELECTED,
        ),
        *(
            Finding(f"Y to {what} over its mass line, 100 Hz", 1.0,
                    over_mass_line(identified[name].tested), "", source, SELECTED)
            for what, name, source in (
                ("motor", "y_motor", "section 3.3, figure 11"),
                ("tool y", "y_tcp", "section 3.3, figure 12"),
            )
        ),
        Finding("contour error, time-optimal within 1 um", 30.0, planned, "um", "figure 17"),
        Finding("the same beside the prototype's", 48.0, planned, "um", "figure 17"),
        Finding("contour error, acceleration jumps at arcs", "-", jumping, "um",
                "not published", RECOVERED),
        *(
            Finding(f"multisine from linearised, {what}, 95 % of lines", "-",
                    f"{100.0 * value:.2f} %", "", "not published", RECOVERED)
            for what, value in (("tool", tool), ("motor", motor))
        ),
    ]  # fmt: skip


if __name__ == "__main__":
    main(Path("out"))
