"""Benchmark with one degree of freedom: Hopf and flip lobes of the 922 Hz tool.

Down-milling at half immersion has two families of lobes: quasi-periodic chatter (Hopf) near
922 Hz, and period doubling (flip) near 10 000 and 15 000 rpm, where the cut repeats every second
tooth. The zeroth-order solution (dashed) knows only the first family.
"""

from pathlib import Path

import chatter

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Compute the diagram, print what to see, return what was written."""
    case = chatter.load(HERE / "case.toml")
    diagram = chatter.lobes(case)
    flips = [kind == "flip" for kind in diagram.limits.bifurcation]
    print(f"{sum(flips)} of {len(flips)} speeds lose stability by period doubling")
    return diagram.save(out)


if __name__ == "__main__":
    main(Path("out"))
