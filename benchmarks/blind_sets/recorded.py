"""Milling sets as a shop records them: turned sensors, drift, unknown angle, speed a bit off.

The cuts are those of `milling`. A record begins in the air before the straight front edge of the
block, or in the middle of the cut; a low-pass filter stands before the converter.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.signal

from benchmarks.blind_sets.files import (
    folders,
    material_table,
    mode_tables,
    plain,
    write_signals,
    write_toml,
)
from benchmarks.blind_sets.machines import tool_table
from benchmarks.blind_sets.milling import (
    SEEN,
    CannotDrawError,
    Set,
    conditions_of,
    draw_set,
    effects_of,
)
from benchmarks.blind_sets.milling_effects import UNLISTED, Rng
from benchmarks.blind_sets.milling_physics import TURN, Array, Cut, Plant, run

#: rate of the record, Hz, and steps of the simulation a sample
RATE, _FINER = 10000.0, 4
#: orders and corners, Hz, of the filter before the converter
_ORDERS, _CORNERS = (4, 4, 6, 8), (3200.0, 4000.0)
#: largest share by which the speed is off
_SPEED_OFF = 0.004
#: in the air before the block, s; turns in full immersion; turns left out of a cut that goes on
_AIR, _TURNS, _LEFT_OUT = (0.01, 0.03), 10.0, 12.0
#: shares of the level: offset of a force, and its drift over the record
_OFFSET, _DRIFT = 0.05, 0.03
#: noise of forces, of accelerations and displacements, and of the tacho, as shares
_NOISE = (0.004, 0.012)
_TACHO, _PULSE, _TACHO_NOISE = 5.0, 0.04, 0.03
_MOST_TRIES = 20


class _Rig(NamedTuple):
    """How the cuts of a set are recorded."""

    begins: str  # "air" or "cut"
    axes: Array  # (2, 2), rows: directions of both sensors in the axes of the case
    motion: str  # "acceleration", "displacement" or ""
    tacho: bool
    noise: float
    filter_order: int
    corner: float  # of the filter, Hz


def _drawn_rig(rng: Rng) -> _Rig:
    turned = float(rng.choice([0.5 * np.pi * rng.integers(4), rng.uniform(0.0, TURN)]))
    axes = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
    if rng.random() < 0.3:
        axes[1] *= -1.0  # mirrored
    motion = str(rng.choice(["acceleration", "displacement", ""]))
    tacho = bool(motion == "" or rng.random() < 0.3)
    begins, noise = str(rng.choice(["air", "cut"])), float(rng.uniform(*_NOISE))
    order, corner = int(rng.choice(_ORDERS)), float(rng.uniform(*_CORNERS))
    return _Rig(begins, axes, motion, tacho, noise, order, corner)


def write_set(out: Path, number: int, rng: Rng, only: str | None = None) -> list[str]:
    """Draw a set, record it and write it; returns the names of its effects."""
    names = effects_of(rng, number, only)
    drawn, rig = _drawn_and_recorded(rng, names)
    place, truth = folders(out, number)
    entries = []
    for index, cut in enumerate(drawn.cuts[:8]):
        name = f"run{index + 1:02d}.csv"
        columns = _recorded(rng, drawn.plant, cut, rig)
        heading = [f"{key} [{unit}]" for key, unit in _units(rig).items()]
        formats = ["%.4f", *["%.5g"] * (len(heading) - 1)]
        write_signals(place / name, heading, columns, formats)
        entries.append({"file": name, **conditions_of(cut, drawn.mode)})
    title = f"set-{number:04d}"
    write_toml(place / "case.toml", _case(rng, title, drawn, entries[0]))
    about = {"title": f"{title}: cuts as recorded", "kind": "milling", "case": "case.toml"}
    record = {"begins": rig.begins, "spindle_angle": "unknown", "speed_tolerance": "0.5 %"}
    described = {"record": record, "channels": _channels(rig), "run": entries}
    write_toml(place / "measurement.toml", {**about, **described})
    unlisted = any(name in UNLISTED for name in names)
    expected = {one.name: one.expected for one in drawn.effects}
    for of_effect in expected.values():
        of_effect.pop("angle", None)  # of a runout: where the spindle stands is not known
    write_toml(
        truth / "truth.toml",
        {
            "kind": "recorded",
            "effects": [one.name for one in drawn.effects],
            "verdict": "unexplained" if unlisted else "explained" if names else "nothing-missing",
            "effect_size": drawn.sizes,
            "filter": [rig.filter_order, rig.corner],
            "true": {one.name: one.parameters for one in drawn.effects},
            "plant": plain(drawn.plant._asdict()),
            "expected": expected,
        },
    )
    return names


def _drawn_and_recorded(rng: Rng, names: list[str]) -> tuple[Set, _Rig]:
    """A set and how it is recorded: each effect is seen in what is recorded."""
    for _ in range(_MOST_TRIES):
        drawn, rig = draw_set(rng, names), _drawn_rig(rng)
        channels = 4 if rig.motion else 2  # forces, then displacements
        if all(max(sizes[:channels]) >= SEEN for sizes in drawn.sizes.values()):
            return drawn, rig
    raise CannotDrawError(f"{' and '.join(names)} is not seen in the channels recorded")


def _case(rng: Rng, title: str, drawn: Set, first: dict[str, str]) -> dict[str, Any]:
    lacking = drawn.lacking
    modes = mode_tables(rng, lacking.frequency, lacking.damping, lacking.mass, lacking.direction)
    coefficients = (lacking.Ktc, lacking.Krc, lacking.Kte, lacking.Kre)
    return {
        "title": title,
        "tool": tool_table(drawn.machine.kind),
        "material": material_table(rng, *coefficients),
        "cut": {key: value for key, value in first.items() if key not in ("file", "cut_time")},
        "structure": {"mode": modes},
    }


def _units(rig: _Rig) -> dict[str, str]:
    motion = {"acceleration": ("a", "m/s^2"), "displacement": ("d", "um")}.get(rig.motion)
    units = {"time": "s", "F1": "N", "F2": "N"}
    if motion:
        units |= {f"{motion[0]}{k}": motion[1] for k in (1, 2)}
    return units | ({"tacho": "V"} if rig.tacho else {})


def _channels(rig: _Rig) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name in _units(rig):
        if name == "tacho":
            found[name] = {"quantity": "once per revolution"}
        elif name != "time":
            quantity, on = ("force", "workpiece") if name[0] == "F" else (rig.motion, "tool")
            direction = [round(float(one), 5) for one in rig.axes[int(name[1]) - 1]] + [0]
            found[name] = {"quantity": quantity, "on": on, "direction": direction}
    return found


def _recorded(rng: Rng, plant: Plant, cut: Cut, rig: _Rig) -> list[Array]:
    """Columns of the record of a cut, its time first."""
    cut = cut._replace(speed=cut.speed * (1.0 + float(rng.uniform(-_SPEED_OFF, _SPEED_OFF))))
    turn = TURN / cut.speed
    feed_speed = cut.feed * len(plant.tooth_angle) / turn
    if rig.begins == "air":
        air, begin = float(rng.uniform(*_AIR)), 0.0
        cut = cut._replace(touches=air)
        end = air + plant.radius / feed_speed + _TURNS * turn
    else:
        begin = (_LEFT_OUT + float(rng.random())) * turn
        end = begin + max(_TURNS * turn, 0.1)
    # any angle at the first sample: a spindle that has turned before the time of the simulation
    turned = float(rng.uniform(0.0, TURN))
    plant = plant._replace(
        tooth_angle=plant.tooth_angle + turned, runout_angle=plant.runout_angle + turned
    )
    found = run(plant, cut, end, sampling=_FINER * RATE)
    force = -(rig.axes @ np.stack([found.Fx, found.Fy]))
    motion = rig.axes @ np.stack([found.x, found.y])
    if rig.motion == "acceleration":
        motion = np.gradient(np.gradient(motion, found.time, axis=1), found.time, axis=1)
    signals = np.vstack([force, motion] if rig.motion else [force])
    low_pass = scipy.signal.butter(rig.filter_order, rig.corner, fs=_FINER * RATE, output="sos")
    chosen = found.time >= begin
    signals = scipy.signal.sosfilt(low_pass, signals, axis=1)[:, chosen][:, ::_FINER]
    time = found.time[chosen][::_FINER]
    level = np.sqrt(np.mean(np.square(signals), axis=1))
    level = np.concatenate([np.full(2, level[:2].max()), level[2:]])
    signals = signals + rig.noise * level[:, None] * rng.standard_normal(signals.shape)
    share = (time - time[0]) / (time[-1] - time[0])
    for k in range(2):
        offset, drift = rng.uniform(-_OFFSET, _OFFSET), rng.uniform(-_DRIFT, _DRIFT)
        signals[k] += level[k] * (offset + drift * share)
    columns = [time - time[0], *signals[:2]]
    columns += [1e6 * one if rig.motion == "displacement" else one for one in signals[2:]]
    if rig.tacho:
        high = ((cut.speed * time + turned) % TURN) < _PULSE * TURN
        columns.append(_TACHO * high + _TACHO_NOISE * rng.standard_normal(time.size))
    return columns
