"""Slotting with six teeth: two independent methods give the same diagram.

With several teeth always in the cut the directional matrix hardly varies, and the zeroth-order
solution, which keeps its mean alone, agrees with semi-discretization within 3 %.
"""

from pathlib import Path

import chatter

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Compute the diagram, print what to see, return what was written."""
    case = chatter.load(HERE / "case.toml")
    diagram = chatter.lobes(case)
    comparison = diagram.summary()["zero_order"]
    low, high = comparison["lowest_ratio"], comparison["highest_ratio"]
    print(f"zeroth-order over semi-discretization: {low:.4f} to {high:.4f} over all speeds")
    return diagram.save(out)


if __name__ == "__main__":
    main(Path("out"))
