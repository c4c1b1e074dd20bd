"""A cut in time: stable with strong runout at 1.5 mm, chatter at 3 mm.

The runout fills the spectrum with spindle harmonics, none of which is chatter; at 3 mm a line off
all of them grows, and the once-per-revolution points leave their place for a closed curve.
"""

from pathlib import Path

import chatter

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Simulate both depths, print the verdicts, return what was written."""
    case = chatter.load(HERE / "case.toml")
    written = []
    for depth in ("1.5 mm", "3 mm"):
        result = chatter.simulate(case.patch({"cut.axial_depth": depth}))
        summary = result.summary()
        print(f"{depth}: {summary['verdict']}: {summary['reason']}")
        written += result.save(Path(out) / depth.replace(" ", "-"))
    diagram = chatter.bifurcation(
        case.patch({"tool.runout": None, "simulation.revolutions": 150}),
        "cut.axial_depth",
        [f"{1.0 + 0.05 * i:.2f} mm" for i in range(41)],
    )
    return written + diagram.save(Path(out) / "bifurcation")


if __name__ == "__main__":
    main(Path("out"))
