"""Effects of a cut: parameters drawn at random, and what they do to the plant.

A drawn effect is a dictionary with the name, the parameters as a truth file shows them, and the
fields of the plant that it sets. ``strength`` (about 1) scales its size; the generator raises or
lowers it until the effect is seen in the signals, but does not swamp them.
"""

# ruff: noqa: ARG001
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from benchmarks.blind_sets.milling_physics import TURN, Plant

Rng = np.random.Generator


@dataclass(frozen=True)
class Drawn:
    """One effect with its parameters."""

    name: str
    parameters: dict[str, object]
    changes: dict[str, object] = field(repr=False)
    expected: dict[str, float] = field(default_factory=dict)  # SI, by the names of explanation.json

    def applied(self, plant: Plant) -> Plant:
        """Plant with the effect."""
        return plant._replace(**self.changes)


Draw = Callable[[Rng, Plant, "Conditions", float], Drawn]


@dataclass(frozen=True)
class Conditions:
    """What effects are scaled by: typical values of the runs, SI."""

    speed: float  # highest, rad/s
    feed: float
    depth: float
    force: float  # rms, N
    displacement: float  # rms, m
    cut_time: float  # of all runs
    slowest_turn: float


def _stiffness(plant: Plant) -> np.ndarray:
    return plant.mass * (TURN * plant.frequency) ** 2


def runout(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    offset = float(strength * rng.uniform(0.12, 0.4) * about.feed)
    angle = float(rng.uniform(0.0, TURN))
    shown = {"offset_um": 1e6 * offset, "angle_deg": float(np.degrees(angle))}
    return Drawn(
        "runout",
        shown,
        {"runout_offset": offset, "runout_angle": angle},
        {"offset": offset, "angle": angle},
    )


def edge_force(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    """The plant's own edge force is the effect: the declared case lacks it."""
    changes = {"Kte": plant.Kte, "Kre": plant.Kre}
    return Drawn("edge_force", dict(changes), changes, changes)


def process_damping(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    # as a share of the damping of the mode that it acts on, at the typical speed
    natural = TURN * float(np.max(plant.frequency))
    own = 2.0 * float(np.median(plant.damping)) * natural * float(np.min(plant.mass))
    surface_speed = 0.7 * about.speed * plant.radius
    value = float(strength * rng.uniform(0.7, 3.0) * own * surface_speed / about.depth)
    return Drawn(
        "process_damping",
        {"coefficient_N_per_m": value},
        {"ploughing": value},
        {"coefficient": value},
    )


def chip_exponent(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    exponent = float(1.0 - np.clip(strength * rng.uniform(0.12, 0.3), 0.05, 0.5))
    return Drawn(
        "chip_exponent", {"exponent": exponent}, {"exponent": exponent}, {"exponent": exponent}
    )


def missing_mode(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    along_y = bool(rng.random() < 0.5)
    while True:
        frequency = float(rng.uniform(0.35, 1.9) * rng.choice(plant.frequency))
        if np.min(np.abs(np.log(plant.frequency / frequency))) > 0.12:
            break
    stiffness = float(np.min(_stiffness(plant)) * rng.uniform(0.8, 3.0) / strength)
    damping = float(rng.uniform(0.025, 0.04))
    mass = stiffness / (TURN * frequency) ** 2
    direction = [0.0, 1.0] if along_y else [1.0, 0.0]
    shown = {
        "frequency_Hz": frequency,
        "direction": "y" if along_y else "x",
        "mass_kg": mass,
        "damping": damping,
    }
    changes = {
        "frequency": np.append(plant.frequency, frequency),
        "damping": np.append(plant.damping, damping),
        "mass": np.append(plant.mass, mass),
        "direction": np.vstack([plant.direction, direction]),
    }
    expected = {
        "frequency": frequency,
        "damping": damping,
        "compliance": 1.0 / stiffness,
        "mass": mass,
    }
    return Drawn("missing_mode", shown, changes, expected)


def mode_shift(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    share = float(np.clip(strength * rng.uniform(0.04, 0.12), 0.02, 0.3)) * rng.choice([-1.0, 1.0])
    slope = float(share / about.speed)
    shown = {"slope_s_per_rad": slope, "at_highest_speed": float(share)}
    return Drawn("mode_shift", shown, {"frequency_slope": slope}, {"slope": slope})


def pitch(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    teeth = len(plant.tooth_angle)
    size = np.radians(rng.uniform(1.0, 4.0, teeth - 1)) * strength
    off = np.clip(size, 0.0, 0.12) * rng.choice([-1.0, 1.0], teeth - 1)
    places = plant.tooth_angle.copy()
    places[1:] += off
    shown: dict[str, object] = {f"tooth_{j + 2}_rad": float(off[j]) for j in range(teeth - 1)}
    shown["pitch_deg"] = np.degrees(np.diff(np.append(places, TURN))).tolist()
    expected = {f"tooth_{j + 2}": float(off[j]) for j in range(teeth - 1)}
    return Drawn("pitch", shown, {"tooth_angle": places}, expected)


def wear(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    edge_t, edge_r = plant.Kte, plant.Kre
    rates = {
        "edge_tangential": float(strength * rng.uniform(0.4, 1.2) * edge_t / about.cut_time),
        "edge_radial": float(strength * rng.uniform(0.6, 1.8) * edge_r / about.cut_time),
        "cutting": float(strength * rng.uniform(0.03, 0.2) / about.cut_time),
    }
    changes = {
        "wear_tangential": rates["edge_tangential"],
        "wear_radial": rates["edge_radial"],
        "wear_cutting": rates["cutting"],
    }
    return Drawn("wear", dict(rates), changes, rates)


def wear_of_all(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    """All coefficients and the process damping, steadily, saturating or at once."""
    drawn = wear(rng, plant, about, strength)
    changes = dict(drawn.changes)
    natural = TURN * float(np.max(plant.frequency))
    own = 2.0 * float(np.median(plant.damping)) * natural * float(np.min(plant.mass))
    ploughing = strength * rng.uniform(0.2, 1.0) * own * 0.7 * about.speed * plant.radius
    changes["wear_ploughing"] = float(ploughing / about.depth / about.cut_time)
    shape = str(rng.choice(["rising", "saturating", "step"]))
    if shape == "saturating":
        changes["wear_saturation"] = float(rng.uniform(0.15, 0.5) * about.cut_time)
    if shape == "step":
        changes["wear_step"] = float(rng.uniform(0.3, 0.7) * about.cut_time)
    return Drawn("wear", {**changes, "shape": shape}, changes)


def mode_shift_of_one(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    """One mode, with the square of the speed."""
    share = float(np.clip(strength * rng.uniform(0.05, 0.15), 0.02, 0.3)) * rng.choice([-1.0, 0.6])
    mode = int(rng.integers(len(plant.frequency)))
    changes = {"square_slope": float(share / about.speed**2), "square_mode": mode}
    return Drawn("mode_shift", {**changes, "at_highest_speed": share}, changes)


def dynamometer_of_two(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    """Another resonance in each direction."""
    drawn = dynamometer(rng, plant, about, strength)
    first = float(drawn.changes["sensor_frequency"])
    changes = {**drawn.changes, "sensor_frequency_y": first * float(rng.uniform(1.15, 1.6))}
    return Drawn("dynamometer", dict(changes), changes)


def contact(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    stiffness = float(strength * rng.uniform(0.08, 0.25) * np.min(_stiffness(plant)))
    slowest = TURN * float(np.min(plant.frequency))
    damping = float(stiffness / slowest * rng.uniform(0.2, 1.0))
    share = float(rng.random() < 0.5)
    shown = {
        "stiffness_N_per_m": stiffness,
        "damping_Ns_per_m": damping,
        "acts": "with the engaged share of the depth" if share else "whole while in the cut",
    }
    changes = {"contact_stiffness": stiffness, "contact_damping": damping, "contact_share": share}
    return Drawn("contact", shown, changes, {"stiffness": stiffness, "damping": damping})


def dynamometer(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    frequency = float(rng.uniform(900.0, 2600.0) / np.sqrt(strength))
    damping = float(rng.uniform(0.02, 0.06))
    shown = {"frequency_Hz": frequency, "damping": damping}
    changes = {"sensor_frequency": frequency, "sensor_damping": damping}
    return Drawn("dynamometer", shown, changes, {"frequency": frequency, "damping": damping})


def slide_friction(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    mode = int(rng.integers(len(plant.mass)))
    force = float(strength * rng.uniform(0.1, 0.3) * about.force)
    velocity = float(rng.uniform(0.1, 0.3) * about.displacement * TURN * plant.frequency[mode])
    shown = {"mode": mode, "coulomb_N": force, "velocity_m_per_s": velocity}
    changes = {"slide_mode": mode, "slide_friction": force, "slide_velocity": velocity}
    expected = {"force": force, "velocity": velocity}
    return Drawn("slide_friction", shown, changes, expected)


# effects that are in no list ---------------------------------------------------------------------


def hard_spots(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    amplitude = float(np.clip(strength * rng.uniform(0.15, 0.35), 0.05, 0.8))
    wavelength = float(rng.uniform(2.5, 9.0) * about.feed)
    shown = {"amplitude": amplitude, "wavelength_mm": 1e3 * wavelength}
    changes = {"spot_amplitude": amplitude, "spot_wavelength": wavelength}
    return Drawn("hard_spots", shown, {**changes, "spot_phase": float(rng.uniform(0.0, TURN))})


def coefficient_drift(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    amplitude = float(np.clip(strength * rng.uniform(0.12, 0.3), 0.05, 0.8))
    frequency = float(rng.uniform(0.3, 1.7) / about.slowest_turn)
    changes = {
        "drift_amplitude": amplitude,
        "drift_frequency": frequency,
        "drift_phase": float(rng.uniform(0.0, TURN)),
    }
    return Drawn("coefficient_drift", {"amplitude": amplitude, "frequency_Hz": frequency}, changes)


def extra_force(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    amplitude = strength * rng.uniform(0.15, 0.4) * about.force
    direction = rng.uniform(0.0, TURN)
    frequency = float(rng.uniform(0.3, 0.9) * np.min(plant.frequency))
    measured = float(rng.random() < 0.5)
    changes = {
        "extra_force_x": float(amplitude * np.cos(direction)),
        "extra_force_y": float(amplitude * np.sin(direction)),
        "extra_frequency": frequency,
        "extra_phase": float(rng.uniform(0.0, TURN)),
        "extra_measured": measured,
    }
    shown = {"amplitude_N": float(amplitude), "frequency_Hz": frequency, "measured": bool(measured)}
    return Drawn("extra_force", shown, changes)


def cubic_stiffness(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    share = strength * rng.uniform(0.05, 0.2)
    value = float(share * np.min(_stiffness(plant)) / about.displacement**2)
    return Drawn("cubic_stiffness", {"N_per_m3": value}, {"cubic_stiffness": value})


def cross_stiffness(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    value = float(strength * rng.uniform(0.08, 0.2) * np.min(_stiffness(plant)))
    return Drawn("cross_stiffness", {"N_per_m": value}, {"cross_stiffness": value})


def speed_ripple(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    amplitude = float(np.clip(strength * rng.uniform(0.03, 0.08), 0.01, 0.3))
    frequency = float(rng.uniform(0.25, 0.8) / about.slowest_turn)
    changes = {"ripple_amplitude": amplitude, "ripple_frequency": frequency}
    return Drawn("speed_ripple", {"amplitude": amplitude, "frequency_Hz": frequency}, changes)


def crosstalk(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    share = strength * rng.uniform(0.08, 0.2, 2) * rng.choice([-1.0, 1.0], 2)
    changes = {"crosstalk_xy": float(share[0]), "crosstalk_yx": float(share[1])}
    return Drawn("crosstalk", dict(changes), changes)


def dull_tooth(rng: Rng, plant: Plant, about: Conditions, strength: float) -> Drawn:
    share = np.ones(len(plant.tooth_angle))
    tooth = int(rng.integers(len(share)))
    share[tooth] += strength * rng.uniform(0.8, 2.0)
    shown = {"tooth": tooth + 1, "edge_force_share": float(share[tooth])}
    return Drawn("dull_tooth", shown, {"edge_share": share})


KNOWN: dict[str, Draw] = {
    one.__name__: one
    for one in (
        runout,
        edge_force,
        process_damping,
        chip_exponent,
        missing_mode,
        mode_shift,
        pitch,
        wear,
        contact,
        dynamometer,
        slide_friction,
    )
}
#: members of families beyond the simplest, under the name of the family
FAMILIES: dict[str, Draw] = {
    one.__name__: one for one in (wear_of_all, mode_shift_of_one, dynamometer_of_two)
}
UNLISTED: dict[str, Draw] = {
    one.__name__: one
    for one in (
        hard_spots,
        coefficient_drift,
        extra_force,
        cubic_stiffness,
        speed_ripple,
        crosstalk,
        dull_tooth,
        cross_stiffness,
    )
}
