"""Sets of axis moves: effects with random parameters, moves, writing."""

# ruff: noqa: ARG001
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.blind_sets.axis_physics import SAMPLING, Axis, move
from benchmarks.blind_sets.files import (
    declared,
    folders,
    plain,
    quantity,
    write_signals,
    write_toml,
)

Rng = np.random.Generator
Array = np.ndarray
POSITION_NOISE, VELOCITY_NOISE, FORCE_NOISE = 20e-9, 2e-5, 2.0
#: share of the force, or times the noise, that an effect must make up
_SEEN_SHARE, _SEEN_NOISE = 0.02, 1.0
_MOST_TRIES = 30


@dataclass(frozen=True)
class Drawn:
    """One effect: fields of the axis, and what they are called in explanation.json."""

    name: str
    changes: dict[str, float]
    expected: dict[str, float]


Draw = Callable[[Rng, Axis, float], Drawn]


def coulomb_friction(rng: Rng, axis: Axis, strength: float) -> Drawn:
    """The axis has it anyway; the declared case lacks it."""
    return Drawn("coulomb_friction", {}, {"coulomb_friction": axis.coulomb})


def stribeck(rng: Rng, axis: Axis, strength: float) -> Drawn:
    above = float(strength * rng.uniform(0.25, 0.8) * axis.coulomb)
    velocity = float(rng.uniform(2e-3, 15e-3))
    expected = {"above": above, "stribeck_velocity": velocity}
    return Drawn("stribeck", {"above": above, "stribeck_velocity": velocity}, expected)


def presliding(rng: Rng, axis: Axis, strength: float) -> Drawn:
    way = float(strength * rng.uniform(1.5e-5, 8e-5))
    stiffness = axis.coulomb / way
    damping = float(rng.uniform(0.05, 0.4) * 2.0 * np.sqrt(stiffness * axis.mass) * 0.5)
    changes = {"bristle_stiffness": stiffness, "bristle_damping": damping}
    expected = {"presliding_stiffness": stiffness, "presliding_damping": damping}
    return Drawn("presliding", changes, expected)


def asymmetry(rng: Rng, axis: Axis, strength: float) -> Drawn:
    value = float(strength * rng.uniform(0.08, 0.3) * axis.coulomb * rng.choice([-1.0, 1.0]))
    return Drawn("asymmetry", {"asymmetry": value}, {"asymmetry": value})


def offset(rng: Rng, axis: Axis, strength: float) -> Drawn:
    value = float(strength * rng.uniform(0.08, 0.4) * axis.coulomb * rng.choice([-1.0, 1.0]))
    return Drawn("offset", {"offset": value}, {"offset": value})


def cogging(rng: Rng, axis: Axis, strength: float) -> Drawn:
    amplitude = float(strength * rng.uniform(8.0, 40.0))
    period = float(rng.uniform(3e-3, 30e-3))
    changes = {
        "cogging_amplitude": amplitude,
        "cogging_period": period,
        "cogging_phase": float(rng.uniform(0.0, 2.0 * np.pi)),
    }
    return Drawn("cogging", changes, {"amplitude": amplitude, "period": period})


def backlash(rng: Rng, axis: Axis, strength: float) -> Drawn:
    way = float(strength * rng.uniform(1e-5, 6e-5))
    return Drawn("backlash", {"backlash": way}, {"backlash": way})


def quadratic_drag(rng: Rng, axis: Axis, strength: float) -> Drawn:
    value = float(strength * rng.uniform(2e3, 1.2e4))
    return Drawn("quadratic_drag", {"quadratic_drag": value}, {"quadratic_drag": value})


def warm_up(rng: Rng, axis: Axis, strength: float) -> Drawn:
    share, time = float(strength * rng.uniform(0.3, 1.0)), float(rng.uniform(10.0, 40.0))
    return Drawn(
        "warm_up", {"warm_up_share": share, "warm_up_time": time}, {"share": share, "time": time}
    )


def warm_up_each_move(rng: Rng, axis: Axis, strength: float) -> Drawn:
    """Friction that falls within a move and is back at the next."""
    share, time = float(strength * rng.uniform(0.3, 1.0)), float(rng.uniform(0.5, 4.0))
    changes = {"warm_up_share": share, "warm_up_time": time, "warm_up_each_move": 1.0}
    return Drawn("warm_up", changes, {"share": share, "time": time})


# effects that are in no list


def place_dependent_viscous(rng: Rng, axis: Axis, strength: float) -> Drawn:
    changes = {"viscous_slope": float(strength * rng.uniform(8.0, 25.0) * rng.choice([-0.4, 1.0]))}
    return Drawn("place_dependent_viscous", changes, {})


def unbalanced_pulley(rng: Rng, axis: Axis, strength: float) -> Drawn:
    changes = {
        "pulley_amplitude": float(strength * rng.uniform(4e3, 1.5e4)),
        "pulley_circumference": float(rng.uniform(15e-3, 60e-3)),
    }
    return Drawn("unbalanced_pulley", changes, {})


def cable_hysteresis(rng: Rng, axis: Axis, strength: float) -> Drawn:
    changes = {
        "cable_force": float(strength * rng.uniform(15.0, 50.0)),
        "cable_length": float(rng.uniform(2e-3, 10e-3)),
    }
    return Drawn("cable_hysteresis", changes, {})


def cubic_friction(rng: Rng, axis: Axis, strength: float) -> Drawn:
    return Drawn("cubic_friction", {"cubic_friction": float(strength * rng.uniform(3e4, 1e5))}, {})


def sticky_place(rng: Rng, axis: Axis, strength: float) -> Drawn:
    changes = {
        "sticky_force": float(strength * rng.uniform(0.3, 1.0) * axis.coulomb),
        "sticky_place": float(rng.uniform(8e-3, 22e-3)),
        "sticky_width": float(rng.uniform(1e-3, 4e-3)),
    }
    return Drawn("sticky_place", changes, {})


KNOWN: dict[str, Draw] = {
    one.__name__: one
    for one in (
        coulomb_friction, stribeck, presliding, asymmetry, offset, cogging, backlash,
        quadratic_drag, warm_up,
    )
}  # fmt: skip
#: members of families beyond the simplest, under the name of the family
FAMILIES: dict[str, Draw] = {"warm_up_each_move": warm_up_each_move}
UNLISTED: dict[str, Draw] = {
    one.__name__: one
    for one in (
        place_dependent_viscous, unbalanced_pulley, cable_hysteresis, cubic_friction, sticky_place,
    )
}  # fmt: skip
_AFTER_THE_KNOWN = ("none", *("unlisted", "pair") * 3, "none", "unlisted", "pair", "unlisted")
#: the gap hides the presliding; an asymmetry is an offset once both are free
_NEVER_TOGETHER = ({"asymmetry", "offset"}, {"backlash", "presliding"})


def effects_of(rng: Rng, number: int, only: str | None) -> list[str]:
    """Names for set ``number``: first each known effect, then none, unlisted and pairs."""
    if only is not None:
        return [] if only == "none" else only.split("+")
    known, unlisted = list(KNOWN), list(UNLISTED)
    turn = (number - 1) % (len(known) + len(_AFTER_THE_KNOWN))
    if turn < len(known):
        return [known[turn]]
    what = _AFTER_THE_KNOWN[turn - len(known)]
    if what == "none":
        return []
    if what == "unlisted":
        return [unlisted[(number // 2) % len(unlisted)]]
    while True:
        pair = {str(name) for name in rng.choice(known, 2, replace=False)}
        if pair not in _NEVER_TOGETHER:
            return sorted(pair)


# moves -------------------------------------------------------------------------------------------


def sine(travel: float, top_speed: float, seconds: float) -> Array:
    """There and back as a cosine, m."""
    t = np.arange(round(seconds * SAMPLING)) / SAMPLING
    return 0.5 * travel * (1.0 - np.cos(2.0 * top_speed / travel * t))


def strokes(speeds: Array, half: float, smoothing: float) -> Array:
    """Forth and back at each speed, ``half`` s each way; the corners rounded, m."""
    n, width = round(half * SAMPLING), max(2, round(smoothing * SAMPLING))
    speed = np.concatenate([np.concatenate([np.full(n, v), np.full(n, -v)]) for v in speeds])
    speed[:2] = 0.0
    padded = np.concatenate([np.zeros(2 * width), speed])
    window = np.hanning(2 * width + 1)
    rounded = np.convolve(padded, window / window.sum())[2 * width : 2 * width + len(speed)]
    return np.concatenate([[0.0], np.cumsum(0.5 * (rounded[1:] + rounded[:-1]))]) / SAMPLING


def draw_moves(rng: Rng) -> list[Array]:
    """Eight moves as a test engineer would choose them, and two more to be predicted."""
    u = rng.uniform
    ladder = np.array([0.05, 0.1, 0.2, 0.5, 1.0])
    return [
        sine(u(25e-3, 35e-3), u(14e-3, 20e-3), 4.0),
        sine(u(25e-3, 35e-3), u(45e-3, 60e-3), 4.0),
        strokes(u(80e-3, 120e-3) * ladder, 0.8, 0.04),
        strokes(np.full(5, u(60e-3, 90e-3)), 0.6, 0.04),
        sine(0.4e-3, 0.08e-3, 16.0),
        strokes(u(30e-3, 50e-3) * ladder, 0.8, 0.04),
        sine(u(35e-3, 45e-3), u(80e-3, 120e-3), 4.0),
        strokes(np.full(3, u(15e-3, 25e-3)), 1.4, 0.04),
        sine(u(30e-3, 40e-3), u(30e-3, 80e-3), 4.0),
        strokes(u(50e-3, 90e-3) * np.array([0.15, 0.5, 1.0]), 0.8, 0.04),
    ]


def motions(axis: Axis, moves: list[Array]) -> list[Array]:
    """Position, speed of the motor, force along every move, one after the other; (n, 3) each."""
    begun, done = 0.0, []
    for command in moves:
        speed = np.gradient(command, 1.0 / SAMPLING)
        acceleration = np.gradient(speed, 1.0 / SAMPLING)
        done.append(move(axis, command, speed, acceleration, begun))
        begun += len(command) / SAMPLING
    return done


def force_along(axis: Axis, moves: list[Array]) -> Array:
    return np.concatenate([one[:, 2] for one in motions(axis, moves)])


# sets --------------------------------------------------------------------------------------------


def draw_axis(rng: Rng) -> Axis:
    return Axis(
        mass=float(rng.uniform(120.0, 270.0)),
        viscous=float(rng.uniform(600.0, 1300.0)),
        coulomb=float(rng.uniform(60.0, 180.0)),
    )


def draw_effects(rng: Rng, names: list[str], axis: Axis, moves: list[Array]) -> list[Drawn]:
    """Effects that are all seen in the force; their sizes are checked one by one."""
    effects = []
    for name in names:
        strength = 1.0
        for _ in range(_MOST_TRIES):
            effect = {**KNOWN, **FAMILIES, **UNLISTED}[name](rng, axis, strength)
            if name == "coulomb_friction" or _size(axis, effect, moves) >= 1.0:
                effects.append(effect)
                break
            strength *= 1.3
        else:
            raise RuntimeError(f"{name} cannot be seen on this axis")
    return effects


def _size(axis: Axis, effect: Drawn, moves: list[Array]) -> float:
    """Change of the force over what counts as seen; 1 or more is seen."""
    some = moves[1:4]
    without, present = force_along(axis, some), force_along(axis._replace(**effect.changes), some)
    if not np.all(np.isfinite(present)):
        return 0.0
    level = float(np.sqrt(np.mean(without**2)))
    change = float(np.sqrt(np.mean((present - without) ** 2)))
    return change / max(_SEEN_SHARE * level, _SEEN_NOISE * FORCE_NOISE)


def write_set(out: Path, number: int, rng: Rng, only: str | None = None) -> list[str]:
    """Draw a set and write it; returns the names of its effects."""
    names = effects_of(rng, number % 1000, only)
    axis, moves = draw_axis(rng), draw_moves(rng)
    effects = draw_effects(rng, names, axis, moves)
    true = axis
    for one in effects:
        true = true._replace(**one.changes)
    place, truth = folders(out, number)
    title = f"set-{number:04d}"
    lines = {
        "moving_mass": quantity(declared(rng, axis.mass, 0.03), "kg"),
        "viscous_friction": quantity(declared(rng, axis.viscous, 0.03), "N*s/m"),
    }
    if "coulomb_friction" not in names:
        lines["coulomb_friction"] = quantity(declared(rng, axis.coulomb, 0.03), "N")
    case = {"title": title, "axis": lines}
    apart = truth / "unseen"
    apart.mkdir()
    runs, unseen = [], []
    for place_in_set, (command, done) in enumerate(zip(moves, motions(true, moves), strict=True)):
        seen = place_in_set < len(moves) - 2
        name = f"move{place_in_set + 1:02d}.csv" if seen else f"unseen{place_in_set + 1:02d}.csv"
        _write_move(rng, (place if seen else apart) / name, command, done)
        (runs if seen else unseen).append({"file": name})
    about = {"title": f"{title}: feed-axis moves", "kind": "axis", "case": "case.toml"}
    for folder, entries in ((place, runs), (apart, unseen)):
        write_toml(folder / "case.toml", case)
        write_toml(folder / "measurement.toml", {**about, "run": entries})
    unlisted = any(name in UNLISTED for name in names)
    write_toml(
        truth / "truth.toml",
        {
            "kind": "axis",
            "effects": [one.name for one in effects],
            "verdict": "unexplained" if unlisted else "explained" if names else "nothing-missing",
            "expected": {one.name: one.expected for one in effects},
            "plant": plain(true._asdict()),
        },
    )
    return names


def _write_move(rng: Rng, path: Path, command: Array, done: Array) -> None:
    noise = np.array([POSITION_NOISE, VELOCITY_NOISE, FORCE_NOISE])
    position, velocity, force = (done + noise * rng.standard_normal(done.shape)).T
    heading = ["time [s]", "command [mm]", "position [mm]", "velocity [mm/s]", "force [N]"]
    time = np.arange(len(command)) / SAMPLING
    columns = [time, 1e3 * command, 1e3 * position, 1e3 * velocity, force]
    write_signals(path, heading, columns, ["%.4f", "%.6f", "%.6f", "%.4f", "%.3f"])
