"""Milling sets: cuts drawn and run, stable ones only, written with noise; unseen runs as truth."""

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
from benchmarks.blind_sets.milling_effects import FAMILIES, KNOWN, UNLISTED, Conditions, Drawn, Rng
from benchmarks.blind_sets.milling_physics import TURN, Cut, Plant, Record, arc_of, run, settles

#: share of the signals that an effect must make up to be seen, and may at the most (by channel)
SEEN, SWAMPS = 0.07, 0.75
UNSEEN_RUNS = 3
_CLASSES_FOR = {
    "process_damping": ("steel", "face"),  # the slow ones
    "mode_shift": ("small", "middle"),
    "mode_shift_of_one": ("small", "middle"),  # the fast ones, over a wide range of speeds
    "slide_friction": ("middle", "steel", "face"),
}
#: pairs that no measurement of this kind could tell from one another, or that exclude each other
_NEVER_TOGETHER = ({"edge_force", "wear"}, {"contact", "slide_friction"})
_AFTER_THE_KNOWN = ("none", *("pair", "unlisted") * 4, "none", "pair", "unlisted", "none")
#: noise of force and displacement alike as a share of the larger of both directions, m beside it
_NOISE, _PROBE_NOISE = (0.009, 0.015), 0.06e-6
_MOST_TRIES = 60


class CannotDrawError(RuntimeError):
    """No set came out with these draws; other ones may."""


@dataclass(frozen=True)
class Set:
    """A drawn set before it is written."""

    machine: Machine
    mode: str
    cuts: list[Cut]
    plant: Plant  # with all effects
    lacking: Plant  # as the declared case has it
    effects: list[Drawn]
    records: list[Record]
    sizes: dict[str, list[float]]


def effects_of(rng: Rng, number: int, only: str | None = None) -> list[str]:
    """Names for set ``number``: first each known effect, then none, pairs and unlisted in turn."""
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
        return [unlisted[(number // 2) % len(unlisted)]]  # one after the other
    while True:
        pair = {str(name) for name in rng.choice(known, 2, replace=False)}
        if pair not in _NEVER_TOGETHER:
            return sorted(pair)


def draw_set(rng: Rng, names: list[str]) -> Set:
    """A set with these effects, each of which is seen in the signals."""
    for _ in range(_MOST_TRIES):
        try:
            return _drawn(rng, names)
        except CannotDrawError:
            continue
    raise CannotDrawError(f"no set with {' and '.join(names) or 'no effect'} after many draws")


def _drawn(rng: Rng, names: list[str]) -> Set:
    allowed = [set(_CLASSES_FOR[name]) for name in names if name in _CLASSES_FOR]
    classes = (
        sorted(set.intersection(*allowed)) if allowed else ["small", "middle", "steel", "face"]
    )
    if not classes:
        raise CannotDrawError
    machine = draw_machine(rng, tuple(classes))
    whole = _plant(machine)
    base = whole._replace(Kte=0.0, Kre=0.0) if "edge_force" in names else whole
    mode = str(rng.choice(["up", "down"]))
    cuts, records = _stable_cuts(rng, machine, base, mode, int(rng.integers(7, 11)) + UNSEEN_RUNS)
    about = _conditions(cuts, records)
    effects: list[Drawn] = []
    plant = base
    for name in names:
        draw = {**KNOWN, **FAMILIES, **UNLISTED}[name]
        effect = _seen(rng, draw, plant, whole, about, cuts)
        effects.append(effect)
        plant = effect.applied(plant)
    signals = [_run(plant, cut) for cut in cuts]
    unlisted = any(name in UNLISTED for name in names)
    if not all(np.all(np.isfinite(one.channels)) for one in signals):
        raise CannotDrawError
    if not unlisted and not all(settles(one, cut) for one, cut in zip(signals, cuts, strict=True)):
        raise CannotDrawError
    sizes = {}
    for effect in effects:
        without = base
        for other in effects:
            without = without if other is effect else other.applied(without)
        sizes[effect.name] = effect_size(signals, [_run(without, cut) for cut in cuts])
        if not SEEN <= max(sizes[effect.name]) <= SWAMPS:
            raise CannotDrawError
    return Set(machine, mode, cuts, plant, base, effects, signals, sizes)


def _seen(rng, draw, plant, whole, about, cuts) -> Drawn:
    """An effect of a strength drawn over the visible range."""
    strength = 1.0
    some = cuts[:: max(1, len(cuts) // 3)]
    known = [_run(plant, cut) for cut in some]
    low = float(rng.uniform(SEEN * 1.2, 0.15))
    for _ in range(6):
        source = whole if draw.__name__ == "edge_force" else plant
        effect = draw(rng, source, about, strength)
        size = max(effect_size([_run(effect.applied(plant), cut) for cut in some], known))
        if low <= size <= 0.9 * SWAMPS:
            return effect
        strength *= 1.7 if size < low else 0.6
    raise CannotDrawError


def _plant(machine: Machine) -> Plant:
    kind = machine.kind
    teeth = kind.teeth
    return Plant(
        0.5 * kind.diameter,
        float(np.tan(np.radians(kind.helix_deg)) / (0.5 * kind.diameter)),
        np.arange(teeth) * TURN / teeth,
        np.ones(teeth),
        machine.frequency,
        machine.damping,
        machine.mass,
        machine.direction,
        machine.Ktc,
        machine.Krc,
        machine.Kte,
        machine.Kre,
    )


def _stable_cuts(rng, machine, plant, mode, count) -> tuple[list[Cut], list[Record]]:
    """Cuts of the declared kind that do not chatter; the tool has cut in all those before."""
    kind = machine.kind
    cuts: list[Cut] = []
    records: list[Record] = []
    spent = 0.0
    for _ in range(40 * count):
        rpm = round(float(rng.uniform(*kind.rpm)))
        radial = round(float(rng.uniform(*kind.radial_depth)) * 1e5) / 1e5
        entry, leave = arc_of(mode, radial, plant.radius)
        cut = Cut(
            rpm * TURN / 60.0,
            round(float(rng.uniform(*kind.feed)) * 1e6) / 1e6,
            round(float(rng.uniform(*kind.depth)) * 1e5) / 1e5,
            radial,
            entry,
            leave,
            float(f"{spent:.6g}"),
        )
        record = _run(plant, cut)
        if settles(record, cut):
            cuts.append(cut)
            records.append(record)
            spent += duration_of(cut)
        if len(cuts) == count:
            return cuts, records
    raise CannotDrawError


def duration_of(cut: Cut) -> float:
    """Ten revolutions, but from 0.08 s to 0.5 s."""
    return float(np.clip(10.0 * TURN / cut.speed, 0.08, 0.5))


def _run(plant: Plant, cut: Cut) -> Record:
    return run(plant, cut, duration_of(cut))


def _conditions(cuts: list[Cut], records: list[Record]) -> Conditions:
    levels = np.array([np.sqrt(np.mean(np.square(one.channels), axis=1)) for one in records])
    return Conditions(
        max(cut.speed for cut in cuts),
        float(np.mean([cut.feed for cut in cuts])),
        float(np.mean([cut.depth for cut in cuts])),
        float(np.median(levels[:, :2].max(axis=1))),
        float(np.median(levels[:, 2:].max(axis=1))),
        cuts[-1].cut_time,
        TURN / min(cut.speed for cut in cuts),
    )


def effect_size(present: list[Record], absent: list[Record]) -> list[float]:
    """Root mean square of the change over that of the signal, by channel, median of the runs."""
    shares = []
    for one, other in zip(present, absent, strict=True):
        change = np.sqrt(np.mean(np.square(one.channels - other.channels), axis=1))
        shares.append(change / np.sqrt(np.mean(np.square(one.channels), axis=1)))
    return [float(f"{share:.4g}") for share in np.nan_to_num(np.median(shares, axis=0), nan=1e9)]


# writing -----------------------------------------------------------------------------------------


def write_set(out: Path, number: int, rng: Rng, only: str | None = None) -> list[str]:
    """Draw a set and write it; returns the names of its effects."""
    names = effects_of(rng, number, only)
    drawn = draw_set(rng, names)
    place, truth = folders(out, number)
    noise = float(rng.uniform(*_NOISE))
    noisy, shares = [], []
    for record in drawn.records:
        shown, share = _with_noise(rng, record, noise)
        noisy.append(shown)
        shares.append(share)
    seen = len(drawn.cuts) - UNSEEN_RUNS
    # the wear of the unseen runs lies between those that are seen, in any order
    order = rng.permutation(len(drawn.cuts))
    shown_runs, hidden = sorted(order[:seen]), sorted(order[seen:])
    entries = []
    for place_in_set, index in enumerate(shown_runs):
        name = f"run{place_in_set + 1:02d}.csv"
        _write_record(place / name, noisy[index])
        entries.append({"file": name, **conditions_of(drawn.cuts[index], drawn.mode)})
    unseen = []
    apart = truth / "unseen"
    apart.mkdir()
    for place_in_set, index in enumerate(hidden):
        name = f"unseen{place_in_set + 1:02d}.csv"
        _write_record(apart / name, noisy[index])
        unseen.append({"file": name, **conditions_of(drawn.cuts[index], drawn.mode)})
    title = f"set-{number:04d}"
    first = dict(entries[0])
    first.pop("file"), first.pop("cut_time")
    modes = slice(0, len(drawn.lacking.mass))
    case = {
        "title": title,
        "tool": tool_table(drawn.machine.kind),
        "material": material_table(
            rng, drawn.lacking.Ktc, drawn.lacking.Krc, drawn.lacking.Kte, drawn.lacking.Kre
        ),
        "cut": first,
        "structure": {
            "mode": mode_tables(
                rng, drawn.lacking.frequency[modes], drawn.lacking.damping[modes],
                drawn.lacking.mass[modes], drawn.lacking.direction[modes],
            )
        },
    }  # fmt: skip
    write_toml(place / "case.toml", case)
    about = {
        "title": f"{title}: milling runs on a dynamometer with displacement probes",
        "kind": "milling",
        "case": "case.toml",
    }
    write_toml(place / "measurement.toml", {**about, "run": entries})
    write_toml(apart / "case.toml", case)
    write_toml(apart / "measurement.toml", {**about, "run": unseen})
    unlisted = [name for name in names if name in UNLISTED]
    write_toml(
        truth / "truth.toml",
        {
            "kind": "milling",
            "effects": [one.name for one in drawn.effects],
            "verdict": "unexplained" if unlisted else "explained" if names else "nothing-missing",
            "noise": np.median(shares, axis=0).round(5),
            "effect_size": drawn.sizes,
            "true": {one.name: one.parameters for one in drawn.effects},
            "plant": plain(drawn.plant._asdict()),
            "expected": {one.name: one.expected for one in drawn.effects},
            "noise_seen": [shares[index] for index in shown_runs],
            "noise_unseen": [shares[index] for index in hidden],
        },
    )
    return names


def _with_noise(rng: Rng, record: Record, noise: float) -> tuple[Record, list[float]]:
    """Record with white noise, and the noise over the signal by channel."""
    levels = np.sqrt(np.mean(np.square(record.channels), axis=1))
    force, probe = noise * levels[:2].max(), np.hypot(noise * levels[2:].max(), _PROBE_NOISE)
    sizes = np.array([force, force, probe, probe])
    fx, fy, x, y = record.channels + sizes[:, None] * rng.standard_normal(record.channels.shape)
    return Record(record.time, record.angle, fx, fy, x, y), (sizes / levels).round(5).tolist()


def _write_record(path: Path, record: Record) -> None:
    heading = ["time [s]", "spindle_angle [rad]", "Fx [N]", "Fy [N]", "x [um]", "y [um]"]
    columns = [record.time, record.angle, record.Fx, record.Fy, 1e6 * record.x, 1e6 * record.y]
    write_signals(path, heading, columns, ["%.7f", "%.5f", "%.3f", "%.3f", "%.4f", "%.4f"])


def conditions_of(cut: Cut, mode: str) -> dict[str, str]:
    """Overrides of a run as a measurement file has them."""
    return {
        "spindle_speed": f"{round(cut.speed * 60.0 / TURN)} rpm",
        "feed_per_tooth": f"{cut.feed * 1e3:.6g} mm",
        "axial_depth": f"{cut.depth * 1e3:.6g} mm",
        "radial_depth": f"{cut.radial_depth * 1e3:.6g} mm",
        "mode": mode,
        "cut_time": f"{cut.cut_time:.6g} s",
    }
