"""Random milling cases in which many features act at once, three to seven in each.

The cases of `general_cases` hold each feature often and any three of them seldom; a fault that
only a certain combination shows may be in none of them.
"""

from __future__ import annotations

import json
import math
import signal
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np

from . import general_cases
from .general_cases import _crosses
from .general_cut import GeneralCut, spectral_radius

SEED = 20261122
COUNT = 60
STORE = Path(__file__).with_name("dense_cases.json")
#: features that a case has at the least, and seconds that its reference may take
_FEATURES, _PATIENCE = 3, 30
#: agreement of two resolutions of the reference, relative to max(1, |mu|)
_AGREEMENT = 2e-5
#: two of them
_COARSE = {"nodes": 7, "waves": 0.7, "longest_angle": 0.6, "samples": 400}
_FINE = {"nodes": 10, "waves": 0.5, "longest_angle": 0.4, "samples": 1600}


def _outline(rng, diameter):
    """Corner radius and edge angle: ball, large or small corner, cone, corner on a cone."""
    shape = rng.random()
    upright = 0.5 * math.pi
    if shape < 0.2:
        return 0.5 * diameter, upright
    if shape < 0.38:
        return float(rng.uniform(0.15, 0.45)) * diameter, upright
    if shape < 0.55:
        return float(10.0 ** rng.uniform(-2.3, -1.0)) * diameter, upright
    cone = math.radians(rng.uniform(25.0, 85.0))
    if shape < 0.72:
        return 0.0, cone
    if shape < 0.85:
        return float(10.0 ** rng.uniform(-2.0, -0.5)) * diameter, cone
    return 0.0, upright


def _modes(rng, highest):
    modes = []
    for _ in range(int(rng.integers(1, 5))):
        direction = rng.normal(size=3)
        if rng.random() < 0.3:
            direction[2] = 0.0
        direction = direction / np.linalg.norm(direction)
        frequency = highest * rng.uniform(0.3, 1.0)
        mass = 10.0 ** rng.uniform(6.2, 7.6) / (2.0 * math.pi * frequency) ** 2
        modes.append(
            (frequency, rng.uniform(0.005, 0.08), mass, tuple(float(part) for part in direction))
        )
    return tuple(modes)


def features(cut):
    """Names of what a case has beyond an even, upright, sharp cutter in a linear material."""
    present = {
        "corner": cut.corner_radius > 0.0,
        "cone": cut.edge_angle < 0.5 * math.pi,
        "pitch": np.ptp(cut.pitch) > 1e-9,
        "helices": len(set(cut.helix)) > 1,
        "runout": bool(cut.offsets),
        "exponent": cut.exponent < 1.0,
        "damping": cut.process_damping > 0.0,
        "variation": cut.variation is not None,
    }
    return tuple(name for name, there in present.items() if there)


def random_cut(rng):
    """One cut; every feature is more likely there than not but for the varying speed."""
    teeth = int(rng.integers(2, 6))
    diameter = float(rng.choice([4e-3, 8e-3, 12e-3, 20e-3, 40e-3]))
    pitch = np.full(teeth, 1.0)
    if rng.random() < 0.7:
        pitch += rng.uniform(-0.3, 0.3, teeth)
    pitch = tuple(float(part) for part in pitch * 2.0 * math.pi / pitch.sum())
    helix = np.full(teeth, rng.uniform(5.0, 50.0))
    kind = rng.random()
    if kind < 0.6:
        helix += rng.uniform(-5.0, 5.0, teeth)
    elif kind < 0.7:
        helix[:] = 0.0
    elif kind < 0.75:
        helix = -helix
    helix = tuple(math.radians(part) for part in helix)
    immersion = 1.0 if rng.random() < 0.15 else float(rng.uniform(0.02, 0.98))
    if rng.random() < 0.3:
        immersion = float(10.0 ** rng.uniform(-2.0, -0.5))
    mode = "slot" if immersion == 1.0 else str(rng.choice(["up", "down"]))
    corner, edge_angle = _outline(rng, diameter)
    feed = float(10.0 ** rng.uniform(-4.6, -3.5))
    offsets = ()
    if rng.random() < 0.65:
        offset = feed * 10.0 ** rng.uniform(-1.2, 0.6)
        if rng.random() < 0.6:
            angles = np.concatenate([[0.0], np.cumsum(pitch)[:-1]])
            offsets = offset * np.cos(rng.uniform(0, 6.0) - angles)
        else:
            offsets = offset * rng.uniform(-1.0, 1.0, teeth)
        offsets = tuple(float(part) for part in offsets)
    kt = rng.uniform(400e6, 2500e6)
    coefficients = (kt, kt * rng.uniform(0.1, 0.8), kt * rng.uniform(-0.2, 0.5))
    highest = 10.0 ** rng.uniform(math.log10(150.0), math.log10(3000.0))
    modes = _modes(rng, highest)
    weakest = min(2.0 * z * (1.0 + z) * m * (2.0 * math.pi * f) ** 2 for f, z, m, _ in modes)
    speed = 2.0 * math.pi * highest / (10.0 ** rng.uniform(-0.7, 0.6) * teeth)
    arc = math.acos(1.0 - 2.0 * immersion)
    depth = weakest / (kt * max(1.0, teeth * arc / (2.0 * math.pi))) * 10.0 ** rng.uniform(0.0, 1.7)
    variation = None
    if rng.random() < 0.2:
        cycles, turns = int(rng.integers(1, 3)), int(rng.integers(2, 5))
        variation = (float(rng.uniform(0.05, 0.3)), cycles, turns, bool(rng.random() < 0.5))
    damped = rng.random() < 0.5
    ball = corner == 0.5 * diameter
    return GeneralCut(
        diameter, pitch, helix, mode, immersion * diameter, coefficients, modes, speed,
        float(min(depth, 1.5 * diameter, (0.5 if ball else 1.5) * diameter)),
        feed=feed, corner_radius=corner, edge_angle=edge_angle, offsets=offsets,
        exponent=1.0 if rng.random() < 0.45 else float(rng.uniform(0.55, 0.95)),
        process_damping=float(10.0 ** rng.uniform(3.0, 5.3)) if damped else 0.0,
        friction=float(rng.uniform(0.0, 0.5)) if damped else 0.0,
        variation=variation,
    )  # fmt: skip


def dense_cuts(rng):
    """Yield cuts of at least three features whose flutes do not run into each other."""
    while True:
        cut = random_cut(rng)
        if len(features(cut)) >= _FEATURES and not _crosses(cut):
            yield cut


def case_dict(cut):
    """Return the case that describes the same problem; a corner may lie on a cone too."""
    case = general_cases.case_dict(cut)
    if cut.corner_radius and cut.edge_angle < 0.5 * math.pi:
        case["tool"] |= {"kind": "inserted", "cutting_edge_angle": cut.edge_angle}
    return case


class _TooSlowError(Exception):
    """The reference takes longer than is worth waiting for."""


def _give_up(signum, frame):
    raise _TooSlowError


def converged_radius(cut, patience=_PATIENCE):
    """Spectral radius and its change between two resolutions; none if too slow or out of range."""
    signal.signal(signal.SIGALRM, _give_up)
    signal.alarm(patience)
    try:
        coarse = spectral_radius(cut, **_COARSE)
        if not 0.02 < coarse < 30.0:
            return None
        fine = spectral_radius(cut, **_FINE)
    except (_TooSlowError, ValueError):
        return None  # too slow, or nothing in the cut
    finally:
        signal.alarm(0)
    return fine, abs(coarse - fine)


def make(path=STORE, count=COUNT, seed=SEED):
    """Write the cases with converged multipliers; run as a module to make the file anew."""
    cuts, rows = dense_cuts(np.random.default_rng(seed)), []
    while len(rows) < count:
        cut = next(cuts)
        found = converged_radius(cut)
        if found is None or found[1] > _AGREEMENT * max(1.0, found[0]):
            continue
        rows.append({"cut": asdict(cut), "spectral_radius": found[0], "change": found[1]})
        print(len(rows), *found, flush=True)
        lines = ",\n".join(json.dumps(row) for row in rows)
        path.write_text(f'{{"seed": {seed}, "cases": [\n{lines}\n]}}\n', "utf-8")


if __name__ == "__main__":
    make(*([Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])] if len(sys.argv) > 3 else []))
