"""Compares the reference simulator with the measurement sets, and with itself refined.

python -m tests.validation.reference.time_domain_check [MEASUREMENTS] [--runs 3] [--random 20]
"""

from __future__ import annotations

import argparse
import dataclasses
import time
from pathlib import Path

import numpy as np
import tomlkit

from tests.places import DATA
from tests.validation.reference.time_domain import (
    ReferenceCut,
    ReferenceMode,
    nrmse,
    random_cut,
    restlessness,
    simulate,
    simulate_at,
    suggested_steps,
)

UNIT = {"mm": 1e-3, "deg": np.pi / 180.0, "rpm": 2.0 * np.pi / 60.0}
SETS = ("set-101", "set-102", "set-103", "set-104", "set-105", "set-107")


def quantity(text: str) -> float:
    """A number with one of the few units that the sets use."""
    value, unit = text.split()
    return float(value) * UNIT[unit]


def load(folder: Path) -> tuple[list[ReferenceCut], list[np.ndarray], dict]:
    """Cuts with the true parameters, the measured tables and the truth of a set."""
    read = {name: tomlkit.parse((folder / f"{name}.toml").read_text()).unwrap()
            for name in ("case", "measurement", "truth")}  # fmt: skip
    truth, tool = read["truth"], read["case"]["tool"]
    plant, effects = truth["plant"], truth.get("true", {})
    modes = [ReferenceMode(f, z, m, (x, y, 0.0)) for f, z, m, x, y in plant["modes"]]
    if "missing_mode" in effects:
        extra = effects["missing_mode"]
        direction = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0)}[extra["direction"]]
        damping = extra.get("damping", 0.029)
        modes.append(ReferenceMode(extra["frequency_Hz"], damping, extra["mass_kg"], direction))
    teeth = tool["teeth"]
    runout = effects.get("runout", {})
    cuts, tables = [], []
    for run in read["measurement"]["run"]:
        cuts.append(
            ReferenceCut(
                radius=0.5 * quantity(tool["diameter"]),
                pitch=(2.0 * np.pi / teeth,) * teeth,
                helix=(quantity(tool["helix"]),) * teeth,
                modes=tuple(modes),
                spindle_speed=quantity(run["spindle_speed"]),
                feed_per_tooth=quantity(run["feed_per_tooth"]),
                axial_depth=quantity(run["axial_depth"]),
                radial_depth=quantity(run["radial_depth"]),
                mode=run["mode"],
                **{name: plant.get(name, 0.0) for name in ("Ktc", "Krc", "Kte", "Kre")},
                exponent=effects.get("chip_exponent", {}).get("exponent"),
                runout_offset=1e-6 * runout.get("offset_um", 0.0),
                runout_angle=np.radians(runout.get("angle_deg", 0.0)),
                damping_coefficient=effects.get("process_damping", {}).get(
                    "coefficient_N_per_m", 0.0
                ),
            )
        )
        tables.append(np.column_stack(list(np.load(folder / run["file"]).values())))
    return cuts, tables, truth


def score(cut: ReferenceCut, table: np.ndarray, slices: int = 100, refine: int = 1) -> np.ndarray:
    """NRMSE of Fx, Fy, x, y."""
    steps = refine * suggested_steps(cut, 60)
    times = np.arange(len(table)) / 12800.0
    record = simulate_at(cut, times, steps, slices)
    scale = (1.0, 1.0, 1e6, 1e6)
    signals = (record.Fx, record.Fy, record.x, record.y)
    return np.array([nrmse(f * s, table[:, 2 + i])
                     for i, (f, s) in enumerate(zip(signals, scale, strict=True))])  # fmt: skip


def row(values) -> str:
    """Four numbers in columns."""
    return "  ".join(f"{value:7.4f}" for value in values)


def variants(name: str, cut: ReferenceCut) -> dict[str, ReferenceCut]:
    """Readings of the conventions to hold against a set."""
    change = dataclasses.replace
    found = {"N passes": cut}
    found["2 N passes"] = change(cut, passes=2 * cut.teeth)
    found["1 pass"] = change(cut, passes=1)
    if cut.runout_offset:
        found["runout at height z"] = change(cut, runout_follows_helix=True)
        found["runout angle reversed"] = change(cut, runout_angle=-cut.runout_angle)
        found["runout + pi"] = change(cut, runout_angle=cut.runout_angle + np.pi)
    if cut.exponent is not None:
        found["h0 = 1 mm"] = change(cut, h0=1e-3)
        found["h0 = 0.05 mm"] = change(cut, h0=5e-5)
    if cut.damping_coefficient:
        for friction in (0.2, 0.3, 0.4):
            found[f"friction {friction}"] = change(cut, damping_friction=friction)
    if name == "set-105":  # the truth does not give the damping of the missing mode; 0.029 fits
        for damping in (0.025, 0.033):
            extra = change(cut.modes[-1], damping=damping)
            found[f"damping {damping}"] = change(cut, modes=(*cut.modes[:-1], extra))
    return found


def check_sets(root: Path, runs: int) -> None:
    """Prints the error of every reading against the noise of the set."""
    for name in SETS:
        cuts, tables, truth = load(root / name)
        print(f"{name} {truth['effects']}\n{'noise listed':28s} {row(truth['noise'])}")
        for i in range(min(runs, len(cuts))):
            for label, cut in variants(name, cuts[i]).items():
                print(f"run {i + 1:2d} {label:21s} {row(score(cut, tables[i]))}", flush=True)


def check_random(count: int, seed: int) -> None:
    """Prints how much each random cut changes when steps are halved and slices doubled."""
    rng = np.random.default_rng(seed)
    names = ("Fx", "Fy", "Fz", "x", "y")
    for i in range(count):
        cut = random_cut(rng)
        steps = suggested_steps(cut)
        begin = time.perf_counter()
        coarse = simulate(cut, 12, 199, steps, 200, phase=0.37)
        spent = time.perf_counter() - begin
        finer = simulate(cut, 12, 199, 2 * steps, 200, phase=0.37)
        sliced = simulate(cut, 12, 199, steps, 400, phase=0.37)
        early, late = restlessness(coarse, 12)
        peak = 1e6 * np.hypot(coarse.x, coarse.y).max()
        by_step = max(nrmse(getattr(coarse, n), getattr(finer, n)) for n in names)
        by_slice = max(nrmse(getattr(coarse, n), getattr(sliced, n)) for n in names)
        print(
            f"{i:3d} N={cut.teeth} {cut.mode:4s} {cut.spindle_speed * 9.5493:6.0f} rpm "
            f"b={1e3 * cut.axial_depth:7.3f} mm steps={steps:6d} step/2 {by_step:.1e} "
            f"slices*2 {by_slice:.1e} unrest {early:7.1e} {late:7.1e} peak {peak:6.1f} um "
            f"{spent:5.1f} s helix={np.degrees(cut.helix[0]):4.1f}",
            flush=True,
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("measurements", nargs="?", type=Path,
                        default=DATA / "measurements")  # fmt: skip
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--random", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if arguments.random:
        check_random(arguments.random, arguments.seed)
    else:
        check_sets(arguments.measurements, arguments.runs)
