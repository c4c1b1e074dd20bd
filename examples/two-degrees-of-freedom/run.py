"""Benchmark with two degrees of freedom: the zeroth-order limit is twice too high.

At 5 % radial immersion a tooth cuts for a seventh of the time, and the mean directional matrix
says little. At 20 000 rpm the true limit is a flip at 3.2504 mm; the zeroth-order solution
promises 6.8496 mm.
"""

from pathlib import Path

import chatter

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Compute the diagram, print what to see, return what was written."""
    case = chatter.load(HERE / "case.toml")
    diagram = chatter.lobes(case)
    verdict = chatter.check(case)
    exact, zeroth = verdict.critical_depth * 1e3, verdict.zero_order_depth * 1e3
    print(f"limit at 20 000 rpm: {exact:.4f} mm ({verdict.limit.bifurcation[0]})")
    print(f"zeroth-order limit there: {zeroth:.4f} mm, {zeroth / exact:.2f} times as much")
    return diagram.save(out)


if __name__ == "__main__":
    main(Path("out"))
