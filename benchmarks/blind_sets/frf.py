"""Sets of tap tests at the tool point, idle and in the cut."""

from __future__ import annotations

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

Rng = np.random.Generator
KNOWN = ("contact", "missing_mode")
UNLISTED = ("mass_in_cut", "friction_like_damping")
#: of the records, which the checks of the signals take off and name: nothing is missing of the case
FAULTS = ("sensor_delay",)
_ORDER = ("contact", "missing_mode", "none", *FAULTS, *UNLISTED, "contact", "missing_mode", "none")
#: standard deviation of real and imaginary part each, as a share of the peak
_NOISE = (0.003, 0.006)
_REPEATS, _UNSEEN_REPEATS = 3, 1


def receptance(w: np.ndarray, frequency, damping, mass, along) -> np.ndarray:
    """Displacement over force of modes in a direction, m/N."""
    total = np.zeros(len(w), dtype=complex)
    for f, ratio, m, share in zip(frequency, damping, mass, along, strict=True):
        natural = 2.0 * np.pi * f
        total += share**2 / (m * (natural**2 - w**2 + 2j * ratio * natural * w))
    return total


def _draw(rng: Rng, name: str, machine: Machine) -> dict[str, float]:
    """Parameters of an effect, SI."""
    stiffness = machine.mass * (2.0 * np.pi * machine.frequency) ** 2
    softest = float(stiffness.min())
    lowest = 2.0 * np.pi * float(machine.frequency.min())
    if name == "contact":
        k = float(rng.uniform(0.05, 0.25) * softest)
        return {"stiffness": k, "damping": float(k / lowest * rng.uniform(0.2, 1.0))}
    if name == "missing_mode":
        while True:
            f = float(rng.uniform(0.4, 1.8) * rng.choice(machine.frequency))
            if np.min(np.abs(np.log(machine.frequency / f))) > 0.12:
                break
        k = float(rng.uniform(1.0, 4.0) * softest)
        return {
            "frequency": f,
            "damping": float(rng.uniform(0.025, 0.04)),
            "compliance": 1.0 / k,
            "mass": k / (2.0 * np.pi * f) ** 2,
            "axis": int(rng.integers(2)),
        }
    if name == "sensor_delay":
        return {"delay": float(rng.uniform(0.15, 0.4) / (lowest * 3.0))}
    if name == "mass_in_cut":
        return {"mass": float(rng.uniform(0.06, 0.2) * machine.mass.min())}
    if name == "friction_like_damping":
        return {"loss": float(rng.uniform(0.05, 0.15) * softest)}
    return {}


def measured(
    w: np.ndarray, machine: Machine, axis: int, in_cut: bool, name: str, values: dict[str, float]
) -> np.ndarray:
    """Receptance as a noiseless tap test would show it, m/N."""
    frequency, damping, mass = machine.frequency, machine.damping, machine.mass
    along = machine.direction[:, axis]
    if name == "missing_mode":
        frequency = np.append(frequency, values["frequency"])
        damping = np.append(damping, values["damping"])
        mass = np.append(mass, values["mass"])
        along = np.append(along, 1.0 if axis == values["axis"] else 0.0)
    found = receptance(w, frequency, damping, mass, along)
    if name == "contact" and in_cut:
        found = 1.0 / (1.0 / found + values["stiffness"] + 1j * w * values["damping"])
    if name == "mass_in_cut" and in_cut:
        found = 1.0 / (1.0 / found - w**2 * values["mass"])
    if name == "friction_like_damping" and in_cut:
        found = 1.0 / (1.0 / found + 1j * values["loss"])
    if name == "sensor_delay":
        found = found * np.exp(-1j * w * values["delay"])
    return found


def write_set(out: Path, number: int, rng: Rng, only: str | None = None) -> list[str]:
    """Draw a set and write it; returns the names of its effects."""
    name = _ORDER[(number % 1000 - 1) % len(_ORDER)] if only is None else only
    machine = draw_machine(rng)
    values = _draw(rng, name, machine)
    place, truth = folders(out, number)
    apart = truth / "unseen"
    apart.mkdir()
    title = f"set-{number:04d}"
    case = {
        "title": title,
        "tool": tool_table(machine.kind),
        "material": material_table(rng, machine.Ktc, machine.Krc, machine.Kte, machine.Kre),
        "cut": {
            "mode": "down",
            "spindle_speed": "3000 rpm",
            "feed_per_tooth": "0.1 mm",
            "axial_depth": "1 mm",
            "radial_depth": "4 mm",
        },
        "structure": {
            "mode": mode_tables(
                rng, machine.frequency, machine.damping, machine.mass, machine.direction
            )
        },
    }
    lowest, highest = float(machine.frequency.min()), float(machine.frequency.max())
    frequency = np.arange(0.05 * lowest, 3.0 * highest, lowest / 150.0)
    noise = float(rng.uniform(*_NOISE))
    runs: tuple[list, list] = ([], [])
    for condition in ("idle", "in_cut"):
        for axis, direction in enumerate("xy"):
            clean = measured(
                2.0 * np.pi * frequency, machine, axis, condition == "in_cut", name, values
            )
            for repeat in range(_REPEATS + _UNSEEN_REPEATS):
                seen = repeat < _REPEATS
                size = noise * float(np.abs(clean).max())
                shown = clean + size * (
                    rng.standard_normal(len(clean)) + 1j * rng.standard_normal(len(clean))
                )
                file = f"{condition}_{direction}{repeat + 1}.csv"
                write_signals(
                    (place if seen else apart) / file,
                    ["frequency [Hz]", "real [m/N]", "imag [m/N]"],
                    [frequency, shown.real, shown.imag],
                    ["%.3f", "%.6e", "%.6e"],
                )
                runs[0 if seen else 1].append(
                    {"file": file, "condition": condition, "direction": direction}
                )
    about = {"title": f"{title}: tap tests at the tool point", "kind": "frf", "case": "case.toml"}
    for folder, entries in ((place, runs[0]), (apart, runs[1])):
        write_toml(folder / "case.toml", case)
        write_toml(folder / "measurement.toml", {**about, "run": entries})
    none, unlisted = name in ("none", *FAULTS), name in UNLISTED
    write_toml(
        truth / "truth.toml",
        {
            "kind": "frf",
            "effects": [] if none else [name],
            "faults": [name] if name in FAULTS else [],
            "verdict": "nothing-missing" if none else "unexplained" if unlisted else "explained",
            "expected": {name: values} if name in KNOWN else {},
            "true": {name: values},
            "noise": noise,
            "plant": plain({k: getattr(machine, k) for k in ("frequency", "damping", "mass")}),
        },
    )
    return [] if none else [name]
