"""Random milling cases of every tool: pitch, helix, runout, corners, size effect, varying speed."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np

from .general_cut import GeneralCut, spectral_radius

SEED = 20261121
COUNT = 60
STORE = Path(__file__).with_name("general_cases.json")
#: agreement of two resolutions of the reference
_AGREEMENT = 2e-6


def _pitch(rng, teeth):
    if rng.random() < 0.4:
        return (2.0 * math.pi / teeth,) * teeth
    wobble = 1.0 + rng.uniform(-0.25, 0.25, teeth)
    return tuple(float(part) for part in wobble * 2.0 * math.pi / wobble.sum())


def _helix(rng, teeth):
    kind = rng.random()
    if kind < 0.3:
        return (0.0,) * teeth
    mean = rng.uniform(10.0, 45.0)
    if kind < 0.65:
        return (math.radians(mean),) * teeth
    return tuple(math.radians(part) for part in mean + rng.uniform(-4.0, 4.0, teeth))


def _modes(rng, highest):
    modes = []
    for _ in range(int(rng.integers(1, 4))):
        direction = rng.normal(size=3) * (1.0, 1.0, 0.6)
        if rng.random() < 0.4:
            direction = np.eye(3)[rng.integers(0, 2)]
        direction = direction / np.linalg.norm(direction)
        frequency = highest * rng.uniform(0.4, 1.0)
        mass = 10.0 ** rng.uniform(6.2, 7.6) / (2.0 * math.pi * frequency) ** 2
        modes.append(
            (frequency, rng.uniform(0.01, 0.08), mass, tuple(float(part) for part in direction))
        )
    return tuple(modes)


def random_cut(rng):
    """One cut; the depth is a random multiple of a rough limit."""
    teeth = int(rng.integers(1, 6))
    diameter = float(rng.choice([6e-3, 10e-3, 16e-3, 25e-3]))
    pitch, helix = _pitch(rng, teeth), _helix(rng, teeth)
    immersion = 1.0 if rng.random() < 0.2 else float(10.0 ** rng.uniform(-1.3, -0.05))
    mode = "slot" if immersion == 1.0 else str(rng.choice(["up", "down"]))
    corner, edge_angle = 0.0, 0.5 * math.pi
    shape = rng.random()
    if shape < 0.12:
        corner = 0.5 * diameter
    elif shape < 0.26:
        corner = float(rng.uniform(0.05, 0.3)) * diameter
    elif shape < 0.4:
        edge_angle = math.radians(rng.uniform(45.0, 85.0))
    feed = float(rng.uniform(0.03e-3, 0.2e-3))
    offsets = ()
    if rng.random() < 0.35:
        angles = np.concatenate([[0.0], np.cumsum(pitch)[:-1]])
        offset = feed * 10.0 ** rng.uniform(-1.0, 0.3)
        offsets = tuple(float(part) for part in offset * np.cos(rng.uniform(0, 6.0) - angles))
    kt = rng.uniform(400e6, 2200e6)
    coefficients = (kt, kt * rng.uniform(0.1, 0.7), kt * rng.uniform(-0.1, 0.4))
    highest = 10.0 ** rng.uniform(math.log10(200.0), math.log10(2500.0))
    modes = _modes(rng, highest)
    weakest = min(2.0 * z * (1.0 + z) * m * (2.0 * math.pi * f) ** 2 for f, z, m, _ in modes)
    waves = 10.0 ** rng.uniform(-0.5, 0.6)
    speed = 2.0 * math.pi * highest / (waves * teeth)
    arc = math.acos(1.0 - 2.0 * immersion)
    depth = weakest / (kt * max(1.0, teeth * arc / (2.0 * math.pi))) * 10.0 ** rng.uniform(0.1, 1.6)
    variation = None
    if rng.random() < 0.15:
        turns = int(rng.integers(3, 9))
        variation = (float(rng.uniform(0.05, 0.25)), 1, turns, bool(rng.random() < 0.5))
    damped = rng.random() < 0.25
    return GeneralCut(
        diameter, pitch, helix, mode, immersion * diameter, coefficients, modes, speed,
        float(min(depth, 1.5 * diameter, 0.5 * diameter if corner == 0.5 * diameter else 1.0)),
        feed=feed, corner_radius=corner, edge_angle=edge_angle, offsets=offsets,
        exponent=1.0 if rng.random() < 0.8 else float(rng.uniform(0.6, 0.9)),
        process_damping=float(10.0 ** rng.uniform(3.5, 5.0)) if damped else 0.0,
        friction=float(rng.uniform(0.0, 0.4)) if damped else 0.0,
        variation=variation,
    )  # fmt: skip


def _crosses(cut):
    """Tell whether two flutes run into each other below the depth of cut."""
    start = np.concatenate([[0.0], np.cumsum(cut.pitch)[:-1]])
    top = start - np.tan(np.array(cut.helix)) * cut.depth / (0.5 * cut.diameter)
    gaps = np.diff(np.append(top, top[0] + 2.0 * math.pi))
    return cut.teeth > 1 and gaps.min() < 0.25


def make(path=STORE, count=COUNT, seed=SEED):
    """Write the cases with converged multipliers; run as a module to make the file anew."""
    rng = np.random.default_rng(seed)
    rows = []
    while len(rows) < count:
        cut = random_cut(rng)
        if _crosses(cut):
            continue
        try:
            coarse = spectral_radius(cut, nodes=7, waves=0.7)
        except ValueError:
            continue  # nothing in the cut
        if not 0.02 < coarse < 30.0:
            continue
        fine = spectral_radius(cut, nodes=10, waves=0.5, longest_angle=0.4)
        if abs(coarse - fine) > _AGREEMENT * max(1.0, fine) * 20.0:
            continue
        rows.append({"cut": asdict(cut), "spectral_radius": fine, "change": abs(coarse - fine)})
        print(len(rows), fine, abs(coarse - fine), flush=True)
        path.write_text(json.dumps({"seed": seed, "cases": rows}, indent=1) + "\n", "utf-8")


def load(path=STORE):
    """Return the stored (cut, spectral radius over a turn or variation) pairs."""
    pairs = []
    for row in json.loads(path.read_text(encoding="utf-8"))["cases"]:
        data = {
            key: tuple(value) if isinstance(value, list) else value
            for key, value in row["cut"].items()
        }
        data["modes"] = tuple((f, z, m, tuple(e)) for f, z, m, e in data["modes"])
        pairs.append((GeneralCut(**data), row["spectral_radius"]))
    return pairs


def case_dict(cut):
    """Return the case that describes the same problem."""
    kind = "end mill"
    tool = {
        "teeth": cut.teeth,
        "diameter": cut.diameter,
        "helix": list(cut.helix),
        "pitch": list(cut.pitch),
    }
    if cut.corner_radius:
        kind = "ball" if cut.corner_radius == 0.5 * cut.diameter else "bull nose"
        tool["corner_radius"] = cut.corner_radius
    elif cut.edge_angle < 0.5 * math.pi:
        kind = "inserted"
        tool["cutting_edge_angle"] = cut.edge_angle
    tool["kind"] = kind
    if cut.offsets:
        tool["radial_error"] = list(cut.offsets)
    kt, kr, ka = cut.coefficients
    material = {"Ktc": kt, "Krc": kr, "Kac": ka}
    if cut.exponent < 1.0:
        material |= {"law": "exponential", "h0": cut.reference_chip, "exponent": cut.exponent}
    if cut.radial_exponent is not None:
        material["radial_exponent"] = cut.radial_exponent
    milling = {
        "mode": cut.mode,
        "spindle_speed": cut.speed,
        "feed_per_tooth": cut.feed,
        "axial_depth": cut.depth,
    }
    if cut.mode != "slot":
        milling["radial_depth"] = cut.radial_depth
    if cut.variation:
        amplitude, cycles, turns, triangle = cut.variation
        milling["speed_variation"] = {
            "amplitude": amplitude,
            "frequency": cycles * cut.speed / (2.0 * math.pi * turns),
            "shape": "triangle" if triangle else "sine",
        }
    case = {
        "tool": tool,
        "material": material,
        "cut": milling,
        "structure": {
            "mode": [
                {"frequency": f, "damping": z, "mass": m, "direction": list(e)}
                for f, z, m, e in cut.modes
            ]
        },
    }
    if cut.process_damping:
        case["process_damping"] = {"coefficient": cut.process_damping, "friction": cut.friction}
    return case


if __name__ == "__main__":
    make(*([Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])] if len(sys.argv) > 3 else []))
