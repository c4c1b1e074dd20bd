"""A face mill on a whole machine: chatter at 50 Hz, put off by friction, and more by contact.

The cutting test of "Time domain coupled simulation of machine tool dynamics and cutting forces
considering the influences of nonlinear friction characteristics and process damping": without
friction and contact, with friction, with both; and a fourth run that answers the question the
paper leaves open, with the flank ploughing where and when the edge is in the cut. The tool enters a
block of voxels, as in the paper, and of dexels. A chip by delay beside them has no entry.
"""

from pathlib import Path

import numpy as np

import chatter
from chatter.description.case import Case
from chatter.plots import style
from chatter.report.published_against_obtained import PREDICTED, SELECTED, Finding, write_findings

HERE = Path(__file__).parent
CONTACT = {"stiffness": "2.50 N/um", "damping": "3.35 kN*s/m"}
PLOUGHING = {"indentation_force": "4e13 N/m^3", "friction": 0.3}
#: change of the motion from turn to turn that is chatter, um
CHATTERING = 50.0
RUNS = {
    "neither": {"structure.friction": False},
    "friction": {},
    "friction and contact": {"contact": CONTACT},
}
#: not published: the clearance angle
FLANK = {"tool.clearance_angle": "7 deg", "tool.flank_wear": "0.08 mm"}
FOURTH = {"friction and ploughing": {"process_damping": PLOUGHING, **FLANK}}
#: the tool meets the corner of a block, which it has in full engagement 15 mm later
STOCK = {"box": [{"x": ["15.5 mm", "110 mm"], "y": ["-25.5 mm", "-20 mm"], "z": ["0 mm", "5 mm"]}]}
CHIPS = {
    "voxel": {"simulation.chip": "voxel", "stock": STOCK},
    "dexel": {"simulation.chip": "dexel", "stock": STOCK},
    "delay": {},
}
#: what the paper says of the onset of chatter, and what it is here
PUBLISHED = {
    "neither": ("about 1 s", SELECTED),
    "friction": ("later", PREDICTED),
    "friction and contact": ("after 2 s", PREDICTED),
}


def turn_to_turn(result) -> tuple[np.ndarray, np.ndarray]:
    """Largest change of the displacement in y from turn to turn, um, over time, s."""
    step = result.time[1] - result.time[0]
    turn = round(60.0 / 840.0 / step)
    y = result.displacement[:, 1]
    change = np.abs(y[turn:] - y[:-turn]) * 1e6
    turns = len(change) // turn
    size = change[: turns * turn].reshape(turns, turn).max(axis=1)
    return 60.0 / 840.0 * (1.0 + np.arange(turns)), size


def onset(time: np.ndarray, size: np.ndarray, level: float) -> float | None:
    """When the change from turn to turn comes to a level for good, s."""
    below = np.flatnonzero(size < level)
    first = 0 if below.size == 0 else below[-1] + 1
    return float(time[first]) if first < len(time) else None


def simulated(case: Case, runs: dict[str, dict], chip: str) -> dict:
    """Results of runs with one kind of chip, by name."""
    return {
        name: chatter.simulate(case.patch({**change, **CHIPS[chip]}))
        for name, change in runs.items()
    }


def begun(result) -> float | None:
    """When a run begins to chatter for good, s."""
    return onset(*turn_to_turn(result), CHATTERING)


def in_words(at: float | None) -> str:
    """Onset as the table shows it."""
    return "never" if at is None else f"{at:.2f} s"


def onsets(results: dict, chip: str) -> list[Finding]:
    """When each run begins to chatter for good, beside what the paper says."""
    return [
        Finding(
            f"onset, {name}, {chip}",
            words if chip != "delay" else "not in the paper",
            in_words(begun(results[name])),
            "",
            "section 6",
            kind if chip != "delay" else PREDICTED,
        )
        for name, (words, kind) in PUBLISHED.items()
    ]


def main(out: Path) -> list[Path]:
    """Run the cuts, draw them, tell what the paper found beside what comes out."""
    case = chatter.load(HERE / "case.toml")
    by_chip = {chip: simulated(case, RUNS, chip) for chip in CHIPS}
    fourth = simulated(case, FOURTH, "dexel")
    findings = [
        *(one for chip, results in by_chip.items() for one in onsets(results, chip)),
        Finding("chatter frequency, neither, voxel", 50.0,
                by_chip["voxel"]["neither"].detection.chatter_frequency, "Hz", "section 6"),
        *(
            Finding(f"onset, {name}, dexel", "none in the test", in_words(begun(result)), "",
                    "section 6")
            for name, result in fourth.items()
        ),
    ]  # fmt: skip
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    draw_forces(by_chip["voxel"]).savefig(out / "face-mill-entry.png")
    draw_changes(by_chip, fourth).savefig(out / "face-mill-onsets.png")
    pictures = ("face-mill-entry.png", "face-mill-onsets.png")
    return [*(out / name for name in pictures), write_findings(findings, out)]


def draw_forces(results: dict):
    """Forces in three directions over time, run by run, as figures 10 to 12."""
    figure = style.new_figure(10.0, 7.5)
    panels = figure.subplots(3, len(results), sharex=True, sharey="row")
    for column, (name, result) in zip(panels.T, results.items(), strict=True):
        column[0].set_title(name, loc="left")
        for panel, force in zip(column, result.force.T, strict=True):
            panel.plot(result.time, force, color=style.BLUE, lw=0.3)
            style.finish(panel)
        at = begun(result)
        if at is not None:
            for panel in column:
                panel.axvline(at, color=style.RED, lw=1.0, linestyle="--")
            column[0].text(at, 0.98, f" chatter from {at:.2f} s", color=style.RED, va="top",
                           fontsize=8.0, transform=column[0].get_xaxis_transform())  # fmt: skip
        column[-1].set_xlabel("time [s]")
    for panel, axis in zip(panels[:, 0], "xyz", strict=True):
        panel.set_ylabel(f"F{axis} [N]")
    return figure


def draw_changes(by_chip: dict, fourth: dict):
    """Change of the motion from turn to turn over time, by kind of chip."""
    figure = style.new_figure(10.0, 4.2)
    panels = figure.subplots(1, len(by_chip), sharey=True)
    colours = (style.RED, style.ORANGE, style.GREEN, style.GREY)
    for panel, (chip, results) in zip(panels, by_chip.items(), strict=True):
        shown = {**results, **(fourth if chip == "dexel" else {})}
        for colour, (name, result) in zip(colours, shown.items(), strict=False):
            panel.semilogy(*turn_to_turn(result), color=colour, label=name)
        panel.axhline(CHATTERING, color="black", lw=0.8, linestyle=":")
        panel.set_title(
            f"{chip}{', full engagement at once' if chip == 'delay' else ''}", loc="left"
        )
        panel.set_xlabel("time [s]")
        style.finish(panel)
    panels[0].set_ylabel("change of y from turn to turn [µm]")
    # the panel without entry has room
    panels[-1].legend(*panels[1].get_legend_handles_labels(), fontsize=8.0, frameon=False)
    return figure


if __name__ == "__main__":
    main(Path("out"))
