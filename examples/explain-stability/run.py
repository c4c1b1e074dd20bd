"""Cutting tests that are stable where lobes forbid it: process damping.

56 tests judged stable or chatter; the README tells the story.
"""

from pathlib import Path

import chatter
from chatter.plots.explanation import plot_lobes_before_after

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Find out what the declared case lacks, print the story, return what was written."""
    result = chatter.explain(HERE / "measurement")
    print(f"verdict: {result.verdict}")
    for finding in result.refitted_signature.significant:
        print(finding.description)
    summary = result.summary()
    for effect in summary["effects"]:
        numbers = ", ".join(
            f"{key} {one['value']:.4g} {one['unit']} ({one['ci95'][0]:.4g} to {one['ci95'][1]:.4g})"
            for key, one in effect["parameters"].items()
        )
        print(f"missing: {effect['name']}: {numbers}")
    error = summary["error"]
    print(
        f"error on holdout runs: {100 * error['holdout_before']:.3g} % before, "
        f"{100 * error['holdout_after']:.3g} % after, noise {100 * error['noise_floor']:.3g} %"
    )
    written = result.save(out)
    for sentence in result.lobes.description:
        print(sentence)
    plot_lobes_before_after(result.lobes).savefig(out / "lobes.png")
    return [*written, out / "lobes.png"]


if __name__ == "__main__":
    main(Path("out"))
