"""Closed loops of Y of the Mandelli M5, in closed form and by sweeps: figures 12 and 13."""

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from chatter.compile.linearised_friction import linearised_frictions
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from chatter.plots import style
from chatter.report.published_against_obtained import RECOVERED, Finding
from chatter.simulation.virtual_tests.frf import peaks
from chatter.simulation.virtual_tests.loop_response import (
    LoopResponse,
    LoopSweep,
    loop_by_sweep,
    loop_response,
)
from dynamics.frf.container import Frf

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
