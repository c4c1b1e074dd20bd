"""Random milling cases over tools, immersions, directions, mode sets, helix and process damping."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path

import numpy as np

from .milling import MillingCase, multipliers

SEED = 20240607
COUNT = 200
STORE = Path(__file__).with_name("random_cases.json")


def random_case(rng):
    """One case; the depth is a random multiple of a rough limit."""
    teeth = int(rng.integers(1, 9))
    diameter = float(rng.choice([4e-3, 8e-3, 12e-3, 20e-3, 50e-3, 80e-3]))
    helix = 0.0 if rng.random() < 0.35 else math.radians(rng.uniform(3.0, 50.0))
    immersion = float(10.0 ** rng.uniform(-1.5, 0.0))
    arc = math.acos(1.0 - 2.0 * immersion)
    kind = rng.choice(["up", "down", "slot"], p=[0.42, 0.42, 0.16])
    entry, leave = {"up": (0.0, arc), "down": (math.pi - arc, math.pi), "slot": (0.0, math.pi)}[
        kind
    ]
    kt = rng.uniform(300e6, 2500e6)
    coefficients = (kt, kt * rng.uniform(0.05, 0.8), kt * rng.uniform(0.0, 0.4))
    highest = 10.0 ** rng.uniform(math.log10(60.0), math.log10(3000.0))
    modes = []
    for _ in range(int(rng.integers(1, 6))):
        spatial = rng.random() < 0.4
        direction = rng.normal(size=3) if spatial else np.append(rng.normal(size=2), 0.0)
        if rng.random() < 0.4:
            direction = np.eye(3)[rng.integers(0, 2)]
        direction = direction / np.linalg.norm(direction)
        frequency = highest * rng.uniform(0.25, 1.0)
        stiffness = 10.0 ** rng.uniform(6.0, 7.8)
        mass = stiffness / (2.0 * math.pi * frequency) ** 2
        damping = rng.uniform(0.005, 0.08)
        modes.append((frequency, damping, mass, tuple(float(part) for part in direction)))
    weakest = min(2.0 * z * (1.0 + z) * m * (2.0 * math.pi * f) ** 2 for f, z, m, _ in modes)
    waves = 10.0 ** rng.uniform(-0.7, 1.0)
    speed = 2.0 * math.pi * highest / (waves * teeth)
    engaged = max(1.0, teeth * arc / (2.0 * math.pi))
    depth = weakest / (kt * engaged) * 10.0 ** rng.uniform(0.0, 2.0)
    damped = rng.random() < 0.35
    return MillingCase(
        teeth,
        diameter,
        helix,
        entry,
        leave,
        coefficients,
        tuple(modes),
        speed,
        float(min(depth, 3.0 * diameter)),
        float(10.0 ** rng.uniform(3.5, 5.5)) if damped else 0.0,
        float(rng.uniform(0.0, 0.5)) if damped else 0.0,
    )


def make(path=STORE):
    """Write the cases with converged multipliers; run as a module to make the file anew."""
    rng = np.random.default_rng(SEED)
    rows = []
    while len(rows) < COUNT:
        case = random_case(rng)
        coarse, fine = (multipliers(case, nodes, 0.5)[0] for nodes in (10, 14))
        size = abs(fine)
        if not 0.05 < size < 4.0 or abs(abs(coarse) - size) > 1e-8 * size:
            continue
        rows.append({"case": asdict(case), "spectral_radius": size})
        print(len(rows), size, flush=True)
    path.write_text(json.dumps({"seed": SEED, "cases": rows}, indent=1) + "\n", encoding="utf-8")


def load(path=STORE):
    """Return the stored (case, spectral radius) pairs."""
    rows = json.loads(path.read_text(encoding="utf-8"))["cases"]
    pairs = []
    for row in rows:
        data = dict(row["case"])
        data["coefficients"] = tuple(data["coefficients"])
        data["modes"] = tuple((f, z, m, tuple(e)) for f, z, m, e in data["modes"])
        pairs.append((MillingCase(**data), row["spectral_radius"]))
    return pairs


def case_file(case):
    """Return the text of a case file that describes the same problem."""
    radius = 0.5 * case.diameter
    if case.entry == 0.0 and abs(case.exit - math.pi) < 1e-12:
        cut = 'mode = "slot"'
    elif case.entry == 0.0:
        cut = f'mode = "up"\nradial_depth = {radius * (1.0 - math.cos(case.exit))!r}'
    else:
        width = radius * (1.0 - math.cos(math.pi - case.entry))
        cut = f'mode = "down"\nradial_depth = {width!r}'
    kt, kr, ka = case.coefficients
    lines = [
        "[tool]",
        f"teeth = {case.teeth}",
        f"diameter = {case.diameter!r}",
        f"helix = {case.helix!r}",
        "[material]",
        f"Ktc = {kt!r}\nKrc = {kr!r}\nKac = {ka!r}",
        "[cut]",
        cut,
        f'spindle_speed = "{case.speed!r} rad/s"\n'
        f"feed_per_tooth = 1e-4\naxial_depth = {case.depth!r}",
    ]
    if case.process_damping:
        lines.append("[process_damping]")
        lines.append(f"coefficient = {case.process_damping!r}\nfriction = {case.friction!r}")
    for number, (frequency, damping, mass, direction) in enumerate(case.modes):
        lines.append("[[structure.mode]]")
        lines.append(f"frequency = {frequency!r}\ndamping = {damping!r}\nmass = {mass!r}")
        lines.append(f"direction = {list(direction)!r}")
        # the side of a mode changes nothing in the relative motion
        lines.append(f'side = "{"workpiece" if number % 2 else "tool"}"')
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    make()
