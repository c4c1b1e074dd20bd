"""Measured FRFs of a real beam, through the modal fit, to a stability diagram.

The beam stands for a slender workpiece that is finished with a stiff end mill: the workpiece gives
way, the tool does not. From the UFF-58 file come six modes (with the fit beside the measurement),
from them and a material the limits, with the zeroth-order solution taken straight from the
measured function as a check. It is a beam, not a tool tip: the numbers show the way of working.
"""

from pathlib import Path

import chatter

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Fit the modes, compute the diagram, print both, return what was written."""
    test = chatter.modes([HERE / "beam.uff"], direction="y", side="workpiece")
    print(f"modes, synthesis error {test.fit.worst_error:.1%} of the peak at most:")
    for mode in test.fit.modes:
        print(f"  {mode.frequency:8.2f} Hz  damping {mode.damping:.4f}  mass {mode.mass:8.4f} kg")
    case = chatter.load(HERE / "case.toml")
    diagram = chatter.lobes(case)
    print("pockets, with margin:")
    for pocket in diagram.summary()["pockets"]:
        print(
            f"  {pocket['spindle_speed_rpm']:6.0f} rpm  {pocket['axial_depth_mm']:7.4f} mm"
            f"  {pocket['removal_rate_cm3_per_min']:7.4f} cm3/min"
        )
    return [*diagram.save(out), *test.save(out / "modes")]


if __name__ == "__main__":
    main(Path("out"))
