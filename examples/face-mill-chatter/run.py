"""A face mill on a whole machine: chatter at 50 Hz, put off by friction, gone with contact.

The cutting test of "Time domain coupled simulation of machine tool dynamics and cutting forces
considering the influences of nonlinear friction characteristics and process damping": without
friction and contact, with friction, with both; and a fourth run that answers the question the
paper leaves open, with the flank ploughing where and when the edge is in the cut. Then the same
once more with the entry of the tool: it meets a block, carved as dexels, and comes to its full
engagement only after 2 s.
"""

from pathlib import Path

import numpy as np

import chatter
from chatter.description.case import Case
from chatter.plots import style
from chatter.report.published_against_obtained import Finding, write_findings

HERE = Path(__file__).parent
CONTACT = {"stiffness": "2.50 N/um", "damping": "3.35 kN*s/m"}
PLOUGHING = {"indentation_force": "4e13 N/m^3", "friction": 0.3}
#: change of the motion from turn to turn that is chatter, um
CHATTERING = 50.0
RUNS = {
    "neither": {"structure.friction": False},
    "friction": {},
    "friction and contact": {"contact": CONTACT},
    "friction and ploughing": {"process_damping": PLOUGHING, "tool.flank_wear": "0.08 mm"},
}
#: the tool meets the corner of a block, which it has in full engagement 15 mm later
ENTRY = {
    "simulation.chip": "dexel",
    "simulation.duration": "5 s",
    "stock": {
        "box": [{"x": ["15.5 mm", "70 mm"], "y": ["-25.5 mm", "-20 mm"], "z": ["0 mm", "5 mm"]}]
    },
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


def simulated(case: Case, runs: dict[str, dict], begin: dict) -> dict:
    """Results of runs that begin in one way, by name."""
    return {
        name: chatter.simulate(case.patch({**change, **begin})) for name, change in runs.items()
    }


def onsets(changes: dict, said: tuple[str, ...], label: str) -> list[Finding]:
    """When each run begins to chatter for good, beside what the paper says."""
    begun = [onset(*change, CHATTERING) for change in changes.values()]
    return [
        Finding(f"onset, {name}{label}", words, "never" if at is None else f"{at:.2f} s")
        for name, words, at in zip(changes, said, begun, strict=True)
    ]


def main(out: Path) -> list[Path]:
    """Run the cuts, draw them, tell what the paper found beside what comes out."""
    case = chatter.load(HERE / "case.toml")
    results, entering = (simulated(case, RUNS, begin) for begin in ({}, ENTRY))
    changes, entries = (
        {name: turn_to_turn(one) for name, one in all_.items()} for all_ in (results, entering)
    )
    said = ("about 1 s", "later", "after 2 s", "never (experiment)")
    heard = Finding(
        "chatter, neither, with the entry",
        50.0,
        entering["neither"].detection.chatter_frequency,
        "Hz",
    )
    findings = [
        Finding("chatter, neither", 50.0, results["neither"].detection.chatter_frequency, "Hz"),
        Finding("largest vibration, friction over neither", "less", _ratio(changes, "friction")),
        Finding("contact as well", "none up to 2 s", _ratio(changes, "friction and contact")),
        Finding("ploughing instead", "none in the test", _ratio(changes, "friction and ploughing")),
        *onsets(changes, said, ""),
        heard,
        *onsets(entries, said, ", with the entry"),
    ]
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    pictures = {"face-mill.png": (results, changes), "face-mill-entry.png": (entering, entries)}
    for name, shown in pictures.items():
        draw(*shown).savefig(out / name)
    return [*(out / name for name in pictures), write_findings(findings, out)]


def _ratio(changes: dict, name: str) -> str:
    ends = {key: size[-10:].mean() for key, (_, size) in changes.items()}
    return f"{ends[name] / ends['neither']:.2f} of it"


def draw(results: dict, changes: dict):
    """Force of each run, and how it changes from turn to turn."""
    figure = style.new_figure(10.0, 9.0)
    panels = figure.subplots(len(results) + 1, 1)
    for panel, (name, result) in zip(panels, results.items(), strict=False):
        panel.plot(result.time, result.force[:, 1], color=style.BLUE, lw=0.3)
        panel.set_title(name, loc="left")
        panel.set_ylabel("Fy [N]")
        style.finish(panel)
    colours = (style.RED, style.ORANGE, style.GREEN, style.GREY)
    for colour, (name, (time, size)) in zip(colours, changes.items(), strict=True):
        panels[-1].semilogy(time, size, color=colour, label=name)
    panels[-1].set_ylabel("change of y\nfrom turn to turn [µm]")
    panels[-1].set_xlabel("time [s]")
    panels[-1].legend(fontsize=8.0, frameon=False, ncols=4)
    style.finish(panels[-1])
    return figure


if __name__ == "__main__":
    main(Path("out"))
