"""Sets of cutting tests judged stable or chatter."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.blind_sets.files import (
    folders,
    material_table,
    mode_tables,
    plain,
    write_signals,
    write_toml,
)
from benchmarks.blind_sets.machines import Machine, draw_machine, tool_table
from benchmarks.blind_sets.milling_physics import arc_of
from benchmarks.blind_sets.stability_physics import LinearCut, limit_depth

Rng = np.random.Generator
KNOWN = ("process_damping", "mode_shift")
UNLISTED = ("damping_falls_with_speed", "coefficients_fall_with_speed")
_ORDER = (*KNOWN, "none", *UNLISTED, "process_damping", "mode_shift", "none")
#: of a test: share of the depth over which the judgement is a guess, and errors for no reason
_SCATTER, _SLIPS = 0.04, 0.01
_DEEPEST = 80e-3


@dataclass(frozen=True)
class Truth:
    """What is true beyond the declared case."""

    name: str
    ploughing: float = 0.0  # N/m
    slope: float = 0.0  # of the natural frequencies, s/rad
    damping_fall: float = 0.0  # share lost at the highest speed
    force_fall: float = 0.0
    highest: float = 1.0  # rad/s


def _truth(rng: Rng, name: str, machine: Machine) -> Truth:
    highest = machine.kind.rpm[1] * np.pi / 30.0
    if name == "process_damping":
        return Truth(name, ploughing=float(rng.uniform(3e5, 8e5)), highest=highest)
    if name == "mode_shift":
        share = rng.uniform(0.05, 0.12) * rng.choice([-1.0, 1.0])
        return Truth(name, slope=float(share / highest), highest=highest)
    if name == "damping_falls_with_speed":
        return Truth(name, damping_fall=float(rng.uniform(0.45, 0.7)), highest=highest)
    if name == "coefficients_fall_with_speed":
        return Truth(name, force_fall=float(rng.uniform(0.4, 0.6)), highest=highest)
    return Truth(name, highest=highest)


def cut_at(machine: Machine, truth: Truth, mode: str, radial: float, speed: float) -> LinearCut:
    """Cut as it truly is at a spindle speed."""
    share = speed / truth.highest
    force = 1.0 - truth.force_fall * share
    radius = 0.5 * machine.kind.diameter
    return LinearCut(
        machine.kind.teeth,
        radius,
        *arc_of(mode, radial, radius),
        machine.Ktc * force,
        machine.Krc * force,
        truth.ploughing,
        0.3,
        machine.frequency * (1.0 + truth.slope * speed),
        machine.damping * (1.0 - truth.damping_fall * share),
        machine.mass,
        machine.direction,
    )


def write_set(out: Path, number: int, rng: Rng, only: str | None = None) -> list[str]:
    """Draw a set and write it; returns the names of its effects."""
    name = _ORDER[(number % 1000 - 1) % len(_ORDER)] if only is None else only
    slow = name == "process_damping"
    machine = draw_machine(rng, ("steel",) if slow else ("small", "middle"))
    truth = _truth(rng, name, machine)
    mode = str(rng.choice(["up", "down"]))
    radial = 0.5 * machine.kind.diameter
    low, high = (350.0, 2600.0) if slow else machine.kind.rpm
    count, beyond = int(rng.integers(45, 71)), 30
    rpm, depth, stable, limit = _points(
        rng, machine, truth, mode, radial, (low, high), count + beyond
    )
    place, hidden = folders(out, number)
    title = f"set-{number:04d}"
    case = {
        "title": title,
        "tool": tool_table(machine.kind, helix_deg=0.0),
        "material": material_table(rng, machine.Ktc, machine.Krc, machine.Kte, machine.Kre),
        "cut": {
            "mode": mode,
            "spindle_speed": f"{rpm[0]:.0f} rpm",
            "feed_per_tooth": "0.1 mm",
            "axial_depth": f"{1e3 * depth[0]:.6g} mm",
            "radial_depth": f"{1e3 * radial:.6g} mm",
        },
        "structure": {
            "mode": mode_tables(
                rng, machine.frequency, machine.damping, machine.mass, machine.direction
            )
        },
    }
    about = {
        "title": f"{title}: cutting tests judged stable or chatter",
        "kind": "stability",
        "case": "case.toml",
        "points": "points.csv",
    }
    apart = hidden / "unseen"
    apart.mkdir()
    for folder, part in ((place, slice(0, count)), (apart, slice(count, None))):
        write_toml(folder / "case.toml", case)
        write_toml(folder / "measurement.toml", about)
        write_signals(
            folder / "points.csv",
            ["spindle_speed [rpm]", "axial_depth [mm]", "stable"],
            [rpm[part], 1e3 * depth[part], stable[part]],
            ["%.0f", "%.4f", "%d"],
        )
    expected = {"process_damping": {"coefficient": truth.ploughing}}
    expected["mode_shift"] = {"slope": truth.slope}
    none, unlisted = name == "none", name in UNLISTED
    write_toml(
        hidden / "truth.toml",
        {
            "kind": "stability",
            "effects": [] if none else [name],
            "verdict": "nothing-missing" if none else "unexplained" if unlisted else "explained",
            "expected": {name: expected[name]} if name in expected else {},
            "limit_mm": (1e3 * limit).round(4),
            "true": plain(truth.__dict__),
            "plant": plain(
                {k: getattr(machine, k) for k in ("Ktc", "Krc", "frequency", "damping", "mass")}
            ),
        },
    )
    return [] if none else [name]


def _points(rng, machine, truth, mode, radial, rpm_range, count):
    """Speeds, depths around the true limit there, the verdicts as judged, and the limits."""
    rpm = np.round(np.exp(rng.uniform(*np.log(rpm_range), count)))
    limit = np.empty(count)
    start = rng.standard_normal(2 * len(machine.mass)) * 1e-6
    start[1::2] = 0.0
    for i in range(count):
        speed = rpm[i] * np.pi / 30.0
        cut = cut_at(machine, truth, mode, radial, speed)
        limit[i] = limit_depth(cut, speed, _DEEPEST, start)
    depth = np.round(limit * np.exp(rng.uniform(np.log(0.5), np.log(1.8), count)), 7)
    # a scatter of the limit from test to test turns some verdicts near it
    judged = depth < limit * np.exp(_SCATTER * rng.standard_normal(count))
    judged ^= rng.random(count) < _SLIPS
    return rpm, depth, judged.astype(int), limit
