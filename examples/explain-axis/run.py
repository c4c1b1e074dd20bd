"""Moves of a feed axis whose friction is not what is declared: presliding.

Six moves, position and motor force measured; the README tells the story.
"""

from pathlib import Path

import chatter

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
    return result.save(out)


if __name__ == "__main__":
    main(Path("out"))
