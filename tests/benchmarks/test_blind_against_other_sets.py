"""The physics of the blind generator against sets that others made, with their true parameters."""

from pathlib import Path

import numpy as np
import pytest
import tomlkit

from benchmarks.blind_sets.milling_physics import TURN, Cut, Plant, arc_of, run
from tests.places import DATA

SETS = DATA / "measurements"
#: damping of the missing mode, which its truth does not say
MISSING_DAMPING = 0.03


def number(text: str) -> float:
    return float(text.split()[0])


def read(path: Path) -> dict:
    return tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()


def plant_of(case: dict, truth: dict) -> Plant:
    true, own = truth.get("true", {}), truth["plant"]
    modes = [list(map(float, mode)) for mode in own["modes"]]
    if "missing_mode" in true:
        mode = true["missing_mode"]
        along = [0.0, 1.0] if mode["direction"] == "y" else [1.0, 0.0]
        modes.append([mode["frequency_Hz"], MISSING_DAMPING, mode["mass_kg"], *along])
    table = np.array(modes)
    radius, teeth = 0.5e-3 * number(case["tool"]["diameter"]), case["tool"]["teeth"]
    changes = {}
    if "runout" in true:
        changes["runout_offset"] = 1e-6 * true["runout"]["offset_um"]
        changes["runout_angle"] = float(np.radians(true["runout"]["angle_deg"]))
    if "process_damping" in true:
        changes["ploughing"] = float(true["process_damping"]["coefficient_N_per_m"])
    if "chip_exponent" in true:
        changes["exponent"] = float(true["chip_exponent"]["exponent"])
    if "hard_spots" in true:
        changes["spot_amplitude"] = float(true["hard_spots"]["amplitude"])
        changes["spot_wavelength"] = 1e-3 * true["hard_spots"]["wavelength_mm"]
    return Plant(
        radius,
        float(np.tan(np.radians(number(case["tool"]["helix"]))) / radius),
        np.arange(teeth) * TURN / teeth,
        np.ones(teeth),
        *(np.ascontiguousarray(table[:, i]) for i in range(3)),
        np.ascontiguousarray(table[:, 3:]),
        *(float(own[key]) for key in ("Ktc", "Krc", "Kte", "Kre")),
    )._replace(**changes)


@pytest.mark.parametrize("name", [f"set-{n}" for n in range(101, 108)])
def test_true_parameters_are_met_to_the_noise(name):
    """Two runs each; the noise of a single run differs from the mean of all that is stated."""
    folder = SETS / name
    case, truth = read(folder / "case.toml"), read(folder / "truth.toml")
    plant = plant_of(case, truth)
    for entry in read(folder / "measurement.toml")["run"][:2]:
        data = np.array(list(np.load(folder / entry["file"]).values()))
        radial = 1e-3 * number(entry["radial_depth"])
        cut = Cut(
            number(entry["spindle_speed"]) * TURN / 60.0,
            1e-3 * number(entry["feed_per_tooth"]),
            1e-3 * number(entry["axial_depth"]),
            radial,
            *arc_of(entry["mode"], radial, plant.radius),
            number(entry["cut_time"]),
        )
        found = run(plant, cut, data[0, -1]).channels * np.array([1.0, 1.0, 1e6, 1e6])[:, None]
        error = np.sqrt(np.mean((found - data[2:]) ** 2, axis=1))
        # noise is the same in both directions of a pair, and 1.2 % of the larger one
        for pair in ((0, 1), (2, 3)):
            level = max(float(np.sqrt(np.mean(data[2 + i] ** 2))) for i in pair)
            probe = 0.06 if pair[0] == 2 else 0.0
            noise = np.hypot(0.012 * level, probe)
            assert max(error[i] for i in pair) < 1.6 * noise
