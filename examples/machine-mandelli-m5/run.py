"""A machining centre's Y and Z axes: sliders tuned to a modal test, loop diagrams, friction found.

The three steps that the paper on the Mandelli M5 takes on the real machine are taken here on its
model: the hammer test, the sweeps and the torque records are simulated, with noise. What is
published, chosen and calibrated: PROVENANCE.md.
"""

import sys
from pathlib import Path

import numpy as np

import chatter
from chatter.report.published_against_obtained import write_findings
from dynamics.frf.container import Frf

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from axis_friction import (  # noqa: E402
    J_AS_PRINTED,
    LEAD,
    TABLE_1,
    friction_findings,
    identified,
    plot_friction,
)
from closed_loops import loop_findings, loops, pairs_in_words, plot_loops  # noqa: E402
from slider_tuning import (  # noqa: E402
    TABLE_3,
    linearised,
    measured,
    plot_tuning,
    still_y,
    tuned,
    tuning_findings,
    with_sliders,
)


def main(out: Path) -> list[Path]:
    """Tune, sweep, identify; return the pictures and the table."""
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    machine = chatter.load_machine(HERE / "machine.toml")

    test = measured(machine)
    tuning = tuned(machine, test)
    for one, value, spread in zip(TABLE_3, tuning.values, tuning.spread, strict=True):
        print(
            f"{one.name}: from {one.start:.3g} to {value:.4g} {one.unit} (+-{100 * spread:.1f} %)"
        )
    print(f"{tuning.evaluations} evaluations")
    low = test["nose_x"].frequency[:1]
    before = linearised(with_sliders(machine, [one.start for one in TABLE_3]), low)["nose_x"]
    after = linearised(with_sliders(machine, tuning.values), low)["nose_x"]
    frequency = test["nose_y"].frequency
    still = still_y(machine, Frf(frequency, linearised(machine, frequency)["nose_y"], "receptance"))

    closed = loops(machine)
    for place, other in closed.at_ends.items():
        print(f"head at {place}: anti-resonance/resonance {pairs_in_words(other)} Hz")
    friction = {axis: identified(machine, axis) for axis in TABLE_1}
    for axis, one in friction.items():
        mass = one.fit.value("inertia") * (2.0 * np.pi / LEAD) ** 2
        print(f"{axis}: J_eq is that of {mass:.0f} kg on a lead of {1e3 * LEAD:.0f} mm")
    printed = J_AS_PRINTED * (2.0 * np.pi / LEAD) ** 2
    print(f"Y, J_eq as printed: {printed:.0f} kg, but Z carries all of Y and has 0.0272 kg m^2")

    pictures = {
        "tuning.png": plot_tuning(machine, test, tuning, still),
        "loops.png": plot_loops(closed),
        "friction.png": plot_friction(friction),
    }
    for name, figure in pictures.items():
        figure.savefig(out / name)
    stiffer = float(abs(after[0]) / abs(before[0]))
    findings = [
        *tuning_findings(tuning, stiffer, still),
        *loop_findings(closed),
        *friction_findings(friction),
    ]
    return [*(out / name for name in pictures), write_findings(findings, out)]


if __name__ == "__main__":
    main(Path("out"))
