"""Closed islands: stability ends, comes back and ends again with depth.

With a helix the period-doubling lobes close: at 19 000 rpm the cut is unstable from 1.61 to
2.50 mm, stable again above that, and lost for good at 5.17 mm. Between 19 200 and 20 000 rpm lies
a speed with no island at all.
"""

from pathlib import Path

import chatter

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Compute the diagram, print what to see, return what was written."""
    case = chatter.load(HERE / "case.toml")
    diagram = chatter.lobes(case)
    verdict = chatter.check(case)
    depths = ", ".join(f"{depth * 1e3:.3f}" for depth in verdict.limit.crossings[0])
    print(f"stability changes at 19 000 rpm at {depths} mm")
    return diagram.save(out)


if __name__ == "__main__":
    main(Path("out"))
