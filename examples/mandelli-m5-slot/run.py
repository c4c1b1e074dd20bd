"""A slot on a machining centre whose Y is held by its controller and whose X is not.

The last simulation of the paper on the Mandelli M5 (figures 14 to 16): position of the spindle
nose and torque on the Y axis under the forces of its Table 2. What is published, chosen and read
how: PROVENANCE.md.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import chatter
from chatter.description.case import Case
from chatter.plots import style
from chatter.report.published_against_obtained import RECOVERED, Finding, write_findings
from chatter.simulation.simulate import MachineResult
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model

HERE = Path(__file__).parent
LEAD = 0.020  # m, of Y
#: end of the record over which means are taken, s
LAST = 0.9
FLEXIBLE = {"tool_point": "tool"}
RUNS = {
    "as published": ({}, {}),
    "friction of Table 1": ({"structure.friction": True}, {}),
    "flexible cutter, 1 % damping": ({}, FLEXIBLE),
    "flexible cutter, 2 % damping": ({}, {**FLEXIBLE, "damping_ratio": 0.02}),
}


def varied(case: Case, change: dict, of_machine: dict) -> Case:
    """Case with some values changed, of the machine too."""
    changed = case.patch(change)
    return changed.with_machine(changed.machine_file().patch(of_machine))


def as_printed(case: Case) -> dict:
    """Edge coefficients times the chip as equations 2 and 3 print it, not times the depth."""
    material, depth = case.material, case.cut.axial_depth
    return {
        "material.Ktc": material.Ktc + material.Kte / depth,
        "material.Krc": material.Krc + material.Kre / depth,
        "material.Kte": 0.0,
        "material.Kre": 0.0,
    }


def settled(result: MachineResult) -> np.ndarray:
    return result.time > result.time[-1] - LAST


def mean_force_of_slot(case: Case) -> float:
    """Mean force across the feed, N: Altintas (2012), Manufacturing Automation, equation 2.29."""
    depth, feed, teeth = case.cut.axial_depth, case.cut.feed_per_tooth, case.tool.teeth
    return teeth * depth * (case.material.Ktc * feed / 4.0 + case.material.Kte / np.pi)


def limit(case: Case) -> str:
    """Limit depth at the speed of the cut by the zeroth-order solution, in words."""
    found = zero_order_of(milling_model(case), np.array([case.cut.spindle_speed]))
    return f"{1e3 * found.critical_depth[0]:.3g} mm at {found.chatter_frequency[0]:.0f} Hz"


def in_words(result: MachineResult) -> str:
    frequency = result.detection.chatter_frequency
    return "no chatter" if np.isnan(frequency) else f"chatter at {frequency:.0f} Hz"


def torque_in_words(result: MachineResult) -> str:
    """Mean of the torque on Y, and how far it swings."""
    torque = result.torque_of("Y")[settled(result)]
    return f"{torque.mean():.2f} N m, {torque.min():.1f} to {torque.max():.1f} N m"


def findings_of(cases: dict[str, Case], results: dict[str, MachineResult]) -> list[Finding]:
    """What the paper tells of the cut beside what comes out."""
    published = results["as published"]
    last = settled(published)
    nose = 1e6 * published.displacement[last].mean(axis=0)
    scale = 1e6 * published.position_of("Y")[last].mean()
    force = mean_force_of_slot(cases["as published"])
    rows = [
        Finding("cut", "drawn without a word of chatter", in_words(published), "", "section 6"),
        Finding("nose in X, mean", "not controlled", f"{nose[0]:.1f} um", "", "Fig. 14, 15"),
        Finding("nose in Y, mean", "controlled", f"{nose[1]:.1f} um", "", "Fig. 14, 15"),
        Finding("scale of Y, mean", "compensated by control", f"{scale:.1g} um", "", "Fig. 14, 15"),
        Finding("torque on Y", "curve only", torque_in_words(published), "", "Fig. 16"),
        Finding(
            "torque on Y, mean against mean force by lead/2 pi",
            -force * LEAD / (2.0 * np.pi),
            float(published.torque_of("Y")[last].mean()),
            "N m",
            "closed form of the slot",
            RECOVERED,
        ),
        Finding(
            "torque on Y, edge forces as printed",
            "k h instead of k b",
            torque_in_words(results["edge forces as printed"]),
            "",
            "eq. 2 and 3",
        ),
    ]
    rows += [
        Finding(
            name,
            "no cutter, no friction in the model",
            f"{in_words(results[name])}; torque {torque_in_words(results[name])}",
            "",
            "section 6",
        )
        for name in list(RUNS)[1:]
    ]
    rows += [
        Finding(f"limit depth, {name}", "not published", limit(cases[name]))
        for name in RUNS
        if "friction" not in name
    ]
    return rows


def plot_slot(results: dict[str, MachineResult]) -> Figure:
    """Position of the nose and torque on Y over time, as figures 14 to 16."""
    figure = style.new_figure(9.0, 9.6)
    panels = figure.subplots(4, 1)
    published = results["as published"]
    beginning = published.time < 0.5
    time = published.time[beginning]
    places = 1e6 * published.displacement[beginning]
    panels[0].plot(time, places[:, 0], color=style.GREEN, lw=0.7, label="X, not controlled")
    panels[0].plot(time, places[:, 1], color=style.RED, lw=0.7, label="Y, controlled")
    panels[0].set_ylabel("spindle nose [µm]")
    scale = 1e6 * published.position_of("Y")[beginning]
    panels[1].plot(time, scale, color=style.RED, lw=0.7, label="without friction")
    held = 1e6 * results["friction of Table 1"].position_of("Y")[beginning]
    panels[1].plot(time, held, color=style.GREY, lw=0.7, label="friction of Table 1")
    panels[1].set_ylabel("scale of Y [µm]")
    for name, colour in (("as published", style.BLUE), ("friction of Table 1", style.GREY)):
        torque = results[name].torque_of("Y")[beginning]
        panels[2].plot(time, torque, color=colour, lw=0.7, label=name)
    panels[2].set_ylabel("torque on Y [N m]")
    for name, colour in zip(list(RUNS)[2:], (style.ORANGE, style.BLUE), strict=True):
        result = results[name]
        panels[3].plot(result.time, result.force[:, 1], color=colour, lw=0.3, label=name)
    panels[3].set_ylabel("force in Y [N]")
    for panel in panels:
        panel.set_xlabel("time since the cut began [s]")
        panel.legend(fontsize=8.0, frameon=False, ncols=2)
        style.finish(panel)
    return figure


def main(out: Path) -> list[Path]:
    """Run the cuts, draw them, tell what the paper found beside what comes out."""
    case = chatter.load(HERE / "case.toml")
    cases = {name: varied(case, *changes) for name, changes in RUNS.items()}
    cases["edge forces as printed"] = case.patch(as_printed(case))
    results = {name: chatter.simulate(one) for name, one in cases.items()}
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    picture = out / "mandelli-m5-slot.png"
    plot_slot(results).savefig(picture)
    return [picture, write_findings(findings_of(cases, results), out)]


if __name__ == "__main__":
    main(Path("out"))
