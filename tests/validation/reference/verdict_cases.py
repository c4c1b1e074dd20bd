"""Makes random cuts with a clear truth for the tests of verdicts: verdict_cases.json.

python -m tests.validation.reference.verdict_cases [SEED]

The truth is that of the linear equations (semi-discretization; the growth of small vibration for
unequal pitch), where a run of 300 turns bears it out.
"""

import json
import math
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

import chatter
from chatter import Case
from chatter.simulation.perturbation.multiplier import simulated_multiplier
from chatter.simulation.structure_in_time import modes_of

FILE = Path(__file__).with_suffix(".json")
#: records whose spectral radius a tooth lies this close to one are left out
MARGIN = 0.02
KINDS = ("plain", "runout", "plain", "runout", "pitch", "flip")
COUNT = 60


class Recorded(NamedTuple):
    """A simulated cut with its truth."""

    document: dict
    kind: str
    stable: bool
    radius: float  # of the multipliers, over a tooth
    bifurcation: str


def random_document(rng, kind):
    """A random cut; its axial depth is set later."""
    teeth = int(rng.integers(2, 6))
    frequency = rng.uniform(300.0, 1400.0)
    # teeth that pass in a natural period; light cuts double their period near two thirds
    passing = rng.uniform(0.62, 0.72) if kind == "flip" else rng.uniform(0.3, 1.9)
    immersion = rng.uniform(0.04, 0.15) if kind == "flip" else rng.choice([0.1, 0.3, 0.6, 1.0])
    diameter = rng.uniform(6e-3, 20e-3)
    feed = rng.uniform(0.05e-3, 0.2e-3)
    tool = {"teeth": teeth, "diameter": diameter}
    if kind != "flip":
        tool["helix"] = f"{rng.uniform(0.0, 40.0)} deg"
    if kind == "runout":
        offset = feed * rng.uniform(0.3, 1.0)
        tool["runout"] = {"offset": offset, "angle": f"{rng.uniform(0.0, 360.0)} deg"}
    if kind == "pitch":
        uneven = 1.0 + rng.uniform(-0.2, 0.2, teeth)
        tool["pitch"] = [f"{angle} deg" for angle in 360.0 * uneven / uneven.sum()]
    stiffness = 10 ** rng.uniform(6.3, 7.3)
    modes = [
        {
            "frequency": f"{frequency * scale} Hz",
            "damping": rng.uniform(0.01, 0.05),
            "stiffness": stiffness * rng.uniform(1.0, 3.0),
            "direction": direction,
        }
        for scale, direction in ((1.0, [1, 0, 0]), (rng.uniform(0.8, 1.6), [0, 1, 0]))
    ]
    return {
        "title": f"random cut, {kind}",
        "tool": tool,
        "material": {
            "Ktc": rng.uniform(600e6, 2000e6),
            "Krc": rng.uniform(150e6, 700e6),
            "Kte": 10e3,
            "Kre": 10e3,
        },
        "cut": {
            "mode": str(rng.choice(["up", "down"])),
            "spindle_speed": 2.0 * math.pi * frequency * passing / teeth,
            "feed_per_tooth": feed,
            "axial_depth": 1e-3,
            "radial_depth": immersion * diameter,
        },
        "structure": {"mode": modes[: int(rng.integers(1, 3))]},
        "simulation": {"revolutions": int(rng.integers(60, 120))},
    }


def without_runout(case):
    """Return the case with a true tool."""
    document = case.model_dump(by_alias=True, exclude_none=True)
    document["tool"].pop("runout", None)
    return Case.from_dict(document)


def is_as_in_the_long_run(case, kind, stable):
    """Whether a run of 300 turns bears out what the linear equations say.

    Runout that keeps teeth out of the cut for a while changes the stability, and far from rest a
    cut can chatter that is stable near its forced motion: such records have no clear truth.
    """
    found = chatter.simulate(case.patch({"simulation.revolutions": 300}))
    a_turn = round((len(found.time) - 1) / found.turns)
    size = np.abs(found.displacement).max()
    # with all teeth alike the motion has to repeat with the tooth: a flip of two teeth
    # repeats with the turn
    periods = 300 * (1 if kind in ("runout", "pitch") else case.tool.teeth)
    each = found.displacement[: 300 * a_turn].reshape(periods, -1)
    change = np.abs(np.diff(each, axis=0)).max(axis=1) / size
    last, middle = change[-20:].max(), change[periods // 2 - 20 : periods // 2 + 20].max()
    return last < 1e-3 if stable else last > max(0.5 * middle, 1e-3)


def radius_of(case, kind):
    """Spectral radius over a tooth, and kind of instability."""
    if kind != "pitch":
        found = chatter.check(without_runout(case))
        return found.spectral_radius, found.bifurcation
    longer = case.patch({"simulation.revolutions": 400})
    growth = simulated_multiplier(longer, modes_of(longer)[0])
    return growth.radius ** (1.0 / case.tool.teeth), "unknown"


def recorded(rng, kind):
    """One record, or None where its truth is not clear."""
    document = random_document(rng, kind)
    share = rng.uniform(0.3, 1.0) if rng.random() < 0.45 else rng.uniform(1.05, 1.7)
    # unequal pitch has no limit of its own here; that of the even pitch is the measure
    even = {**document, "tool": {k: v for k, v in document["tool"].items() if k != "pitch"}}
    limit = chatter.check(without_runout(Case.from_dict(even))).critical_depth
    if not math.isfinite(limit):
        return None
    document["cut"]["axial_depth"] = share * limit
    case = Case.from_dict(document)
    radius, bifurcation = radius_of(case, kind)
    if not math.isfinite(radius) or abs(radius - 1.0) < MARGIN:
        return None
    stable = radius < 1.0
    try:
        if (stable or kind in ("runout", "pitch")) and not is_as_in_the_long_run(
            case, kind, stable
        ):
            return None
        chatter.simulate(case)
    except chatter.RunError:
        return None
    return Recorded(document, kind, stable, radius, bifurcation)


def records(seed, count):
    """Records of all kinds in turn."""
    rng = np.random.default_rng(seed)
    made = 0
    while made < count:
        record = recorded(rng, KINDS[made % len(KINDS)])
        if record is not None:
            made += 1
            yield record


if __name__ == "__main__":
    made = records(int(sys.argv[1]) if len(sys.argv) > 1 else 404, COUNT)
    FILE.write_text(json.dumps([record._asdict() for record in made], indent=1) + "\n")
