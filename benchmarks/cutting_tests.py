"""Unseen sets of cutting tests for `chatter explain`, and how many it gets right.

Limits come from integration in time (`benchmarks.blind_sets.stability_physics`), chatter
frequencies from semi-discretization written here; neither shares code with the package:

    python -m benchmarks.cutting_tests OUT --wear 12 --effects 12 --seed 1

writes the sets to OUT/sets, explains each and prints verdict, names and errors of limits.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from benchmarks.blind_sets.stability_physics import LinearCut, limit_depth

#: steps in the period of the highest natural frequency
_STEPS = 12
_IDLE = 180.0


@dataclass(frozen=True)
class Mill:
    """Straight-toothed end mill on modes in the plane of the cut, SI."""

    teeth: int
    diameter: float
    width: float
    kt: float
    kr: float
    kte: float
    kre: float
    modes: tuple[tuple[float, float, float, float], ...]  # Hz, ratio, kg, rad from x
    damping: float = 0.0  # process damping C, N/m
    friction: float = 0.3
    slope: float = 0.0  # of the frequencies over the spindle speed, s/rad
    wear: dict = field(default_factory=dict)

    def at(self, share: float) -> Mill:
        """The tool at a share of its cutting time."""
        if not self.wear or self.wear["form"] == "none":
            return self
        form = self.wear["form"]
        grown = share
        if form == "saturates":
            grown = (1.0 - math.exp(-share / self.wear["constant"])) / (
                1.0 - math.exp(-1.0 / self.wear["constant"])
            )
        elif form == "chips":
            grown = float(share >= self.wear["at"])
        cut = 1.0 + self.wear["cutting"] * grown
        return replace(
            self,
            kt=self.kt * cut,
            kr=self.kr * cut,
            kte=self.kte * (1.0 + self.wear["edge"] * grown),
            damping=self.damping * (1.0 + self.wear["damping"] * grown),
        )


def dominant(mill: Mill, speed: float, depth: float) -> tuple[float, float]:
    """Log of the spectral radius over a tooth period, and chatter frequency, Hz.

    First-order semi-discretization (Insperger and Stepan 2011) of down-milling; speed in rad/s.
    """
    period = 2.0 * math.pi / (mill.teeth * speed)
    natural = np.array([2.0 * math.pi * m[0] for m in mill.modes]) * (1.0 + mill.slope * speed)
    ratio, mass = (np.array([m[k] for m in mill.modes]) for k in (1, 2))
    shape = np.array([[math.cos(m[3]), math.sin(m[3])] for m in mill.modes])  # (n, 2)
    n = len(mill.modes)
    k = max(24, math.ceil(period * natural.max() / (2.0 * math.pi) * _STEPS))
    h = period / k
    size = 2 * n + 2 * k
    whole = np.eye(size)
    edge_speed = 0.5 * mill.diameter * speed
    entry = math.pi - math.acos(1.0 - 2.0 * mill.width / mill.diameter)
    pitch = 2.0 * math.pi / mill.teeth
    state, history = whole[: 2 * n], [whole[2 * n + 2 * j : 2 * n + 2 * j + 2] for j in range(k)]
    fine = 2
    for i in range(k):
        force, dash = np.zeros((2, 2)), np.zeros((2, 2))
        for part in range(fine):
            angle = speed * h * (i + (part + 0.5) / fine)
            for tooth in range(mill.teeth):
                phi = (angle + tooth * pitch) % (2.0 * math.pi)
                if not entry <= phi <= math.pi:
                    continue
                s, c = math.sin(phi), math.cos(phi)
                normal = np.array([s, c])
                push = mill.kt * np.array([-c, s]) + mill.kr * np.array([-s, -c])
                # chip h = f s - n.(u - u_delayed) with n towards the work turned: thickness
                # grows as the tool moves along +n
                force += np.outer(push, normal) / fine
                drag = mill.damping / edge_speed
                rub = drag * (np.array([-s, -c]) + mill.friction * np.array([-c, s]))
                dash += np.outer(rub, normal) / fine
        force, dash = force * depth, dash * depth
        # q'' = -2 z w q' - w^2 q + shape/m . (force (u - u_d) + dash u')
        gain = shape / mass[:, None]
        a = np.zeros((2 * n, 2 * n))
        a[:n, n:] = np.eye(n)
        a[n:, :n] = -np.diag(natural**2) + gain @ force @ shape.T
        a[n:, n:] = -np.diag(2.0 * ratio * natural) + gain @ dash @ shape.T
        b = np.zeros((2 * n, 2))
        b[n:] = -gain @ force
        # u_d between the samples a period before: linear, mean of both over the step
        big = np.zeros((2 * n + 2, 2 * n + 2))
        big[: 2 * n, : 2 * n], big[: 2 * n, 2 * n :] = a * h, b * h
        moved = _exponential(big)
        delayed = 0.5 * (history[0] + (history[1] if k > 1 else history[0]))
        now = shape.T @ state[:n]
        state = moved[: 2 * n, : 2 * n] @ state + moved[: 2 * n, 2 * n :] @ delayed
        history = [*history[1:], now]
    final = np.vstack([state, *history])
    values = np.linalg.eigvals(final)
    top = values[np.argmax(np.abs(values))]
    base, turn = abs(np.angle(top)) / (2.0 * math.pi * period), 1.0 / period
    orders = np.arange(-400, 400)
    around = np.concatenate([base + orders * turn, -base + orders * turn])
    weight = sum(
        1.0 / (m * np.abs(w**2 - (2 * math.pi * around) ** 2 + 4j * math.pi * z * w * around))
        for w, z, m in zip(natural, ratio, mass, strict=True)
    )
    around_positive = around > 0.0
    weight = np.where(around_positive, weight, 0.0)
    return math.log(max(abs(top), 1e-12)), float(around[np.argmax(weight)])


def _exponential(matrix: np.ndarray) -> np.ndarray:
    """Exponential of a small matrix, by scaling and squaring of a series."""
    scale = max(0, math.ceil(math.log2(max(np.abs(matrix).sum(axis=1).max(), 1e-9))) + 3)
    small, total, term = matrix / 2.0**scale, np.eye(len(matrix)), np.eye(len(matrix))
    for order in range(1, 9):
        term = term @ small / order
        total = total + term
    for _ in range(scale):
        total = total @ total
    return total


def straight(mill: Mill, speed: float) -> LinearCut:
    """The cut as the integration in time knows it."""
    frequency, damping, mass, angle = np.array(mill.modes).T
    return LinearCut(
        mill.teeth, 0.5 * mill.diameter,
        math.pi - math.acos(1.0 - 2.0 * mill.width / mill.diameter), math.pi,
        mill.kt, mill.kr, mill.damping, mill.friction, frequency * (1.0 + mill.slope * speed),
        damping.copy(), mass.copy(), np.column_stack([np.cos(angle), np.sin(angle)]),
    )  # fmt: skip


def limit(mill: Mill, speed: float, most: float) -> float:
    """Lowest depth (m) at which the cut chatters, up to `most`, by integration in time."""
    start = 1e-6 * np.random.default_rng(5).standard_normal(2 * len(mill.modes))
    start[1::2] = 0.0
    found = limit_depth(straight(mill, speed), speed, most, start)
    return found if found < 0.98 * most else math.inf


def power(mill: Mill, speed: float, depth: float, feed: float) -> float:
    """Mean power of the cut, W."""
    arc = math.acos(1.0 - 2.0 * mill.width / mill.diameter)
    turns = speed / (2.0 * math.pi)
    removed = mill.kt * depth * mill.width * feed * mill.teeth * turns
    rubbed = mill.kte * depth * 0.5 * mill.diameter * speed * mill.teeth * arc / (2.0 * math.pi)
    return removed + rubbed


def machine(random: np.random.Generator, low_speed: bool) -> Mill:
    """Draw a tool on two modes."""
    teeth = int(random.integers(2, 5))
    diameter = float(random.choice([0.012, 0.016, 0.02]))
    kt = float(np.exp(random.uniform(math.log(6e8), math.log(1.9e9))))
    first = float(random.uniform(480.0, 950.0))
    modes = tuple(
        (
            first if axis == 0 else first * float(random.uniform(1.02, 1.18)),
            float(random.uniform(0.02, 0.035)),
            float(random.uniform(0.3, 1.2)),
            0.5 * math.pi * axis,
        )
        for axis in range(2)
    )
    damping = float(random.uniform(4e4, 1.2e5)) if low_speed else 0.0
    return Mill(
        teeth, diameter, 0.5 * diameter, kt, kt * float(random.uniform(0.2, 0.38)),
        float(random.uniform(1.5e4, 4e4)), float(random.uniform(1.5e4, 4e4)), modes, damping,
    )  # fmt: skip


def declared(mill: Mill, random: np.random.Generator) -> Mill:
    """What is declared of a tool: a few percent off, process damping by a factor."""

    def off(share: float) -> float:
        return float(1.0 + share * random.normal())

    kept = tuple((f * off(0.004), z * off(0.07), m * off(0.03), a) for f, z, m, a in mill.modes)
    return replace(
        mill, kt=mill.kt * off(0.04), kr=mill.kr * off(0.04), kte=mill.kte * off(0.05),
        modes=kept, damping=mill.damping * float(np.exp(0.25 * random.normal())), wear={},
        slope=0.0,
    )  # fmt: skip


def tests(mill: Mill, random: np.random.Generator, count: int, speeds: tuple[float, float]):
    """Draw tests near the limit: speed, depth, verdict, time share, frequency, power, feed."""
    rows = []
    middle = np.exp(np.linspace(math.log(speeds[0]), math.log(speeds[1]), 24))
    lowest = min(limit(mill, s, 0.06) for s in middle[::2])
    for k in range(count):
        share = k / (count - 1)
        own = mill.at(share)
        speed = float(np.exp(random.uniform(math.log(speeds[0]), math.log(speeds[1]))))
        critical = min(limit(own, speed, 0.06), 12.0 * lowest)
        depth = float(critical * np.exp(random.normal() * 0.45))
        wet = depth * math.exp(0.05 * random.normal())
        stable = wet < limit(own, speed, 0.06)
        frequency = 0.0 if stable else dominant(own, speed, wet)[1]
        if stable and random.random() < 0.02:
            stable, frequency = False, own.modes[0][0]
        feed = float(random.uniform(4e-5, 1.5e-4))
        measured = (power(own, speed, depth, feed) + _IDLE) * (1.0 + 0.02 * random.normal())
        frequency *= 1.0 + 0.004 * random.normal()
        rows.append((speed, depth, feed, 60.0 * k, stable, frequency, measured))
    return rows


def speeds_of(mill: Mill, low: bool) -> tuple[float, float]:
    """Range of speeds: over the lobes of low or of high order, rad/s."""
    base = 2.0 * math.pi * mill.modes[0][0] / mill.teeth
    return (base / 9.0, base / 1.4) if low else (base / 5.0, base * 1.2)


def write(folder: Path, name: str, given: Mill, rows, columns: str, unit: float = 1.0) -> None:
    """Write a set: case, tests, and what goes with them."""
    folder.mkdir(parents=True, exist_ok=True)
    modes = "".join(
        f'\n[[structure.mode]]\nfrequency = "{f:.4f} Hz"\ndamping = {z:.5f}\nmass = "{m:.5f} kg"\n'
        f"direction = [{math.cos(a):.6f}, {math.sin(a):.6f}, 0]\n"
        for f, z, m, a in given.modes
    )
    damping = (
        f'\n[process_damping]\ncoefficient = "{given.damping:.4g} N/m"\nfriction = 0.3\n'
        if given.damping
        else ""
    )
    first = rows[0]
    (folder / "case.toml").write_text(
        f'title = "{name}"\n[tool]\nkind = "end mill"\nteeth = {given.teeth}\n'
        f'diameter = "{given.diameter * 1e3:g} mm"\nhelix = "0 deg"\n[material]\nlaw = "linear"\n'
        f'Ktc = "{given.kt / 1e6:.3f} MPa"\nKrc = "{given.kr / 1e6:.3f} MPa"\n'
        f'Kte = "{given.kte / 1e3:.4f} N/mm"\nKre = "{given.kre / 1e3:.4f} N/mm"\n[cut]\n'
        f'mode = "down"\nspindle_speed = "{first[0] * 30 / math.pi:.1f} rpm"\n'
        f'feed_per_tooth = "0.1 mm"\naxial_depth = "1 mm"\n'
        f'radial_depth = "{given.width * 1e3:g} mm"\n{modes}{damping}'
    )
    more = f'idle_power = "{_IDLE:g} W"\n' if columns == "all" else ""
    (folder / "measurement.toml").write_text(
        f'title = "{name}"\nkind = "stability"\ncase = "case.toml"\npoints = "points.csv"\n{more}'
    )
    heading = "spindle_speed [rpm],axial_depth [mm],stable"
    power_unit = "W" if unit == 1.0 else "kW"
    if columns == "all":
        heading += (
            f",feed_per_tooth [mm],cut_time [s],chatter_frequency [Hz],spindle_power [{power_unit}]"
        )
    lines = [heading]
    for speed, depth, feed, at, stable, frequency, watt in rows:
        line = f"{speed * 30 / math.pi:.1f},{depth * 1e3:.4f},{int(stable)}"
        if columns == "all":
            heard = "" if stable else f"{frequency:.1f}"
            line += f",{feed * 1e3:.4f},{at:.1f},{heard},{watt * unit:.5f}"
        lines.append(line)
    (folder / "points.csv").write_text("\n".join(lines) + "\n")


def wear_set(folder: Path, seed: int) -> dict:
    """Write a set of a tool that wears, or not."""
    random = np.random.default_rng([seed, 1])
    form = ("rises", "saturates", "chips", "none")[seed % 4]
    mill = machine(random, True)
    wear = {
        "form": form, "cutting": float(random.uniform(0.25, 0.6)),
        "damping": float(random.uniform(0.8, 2.5)), "constant": float(random.uniform(0.15, 0.4)),
        "at": float(random.uniform(0.3, 0.7)),
    }  # fmt: skip
    wear["edge"] = wear["cutting"] * float(random.uniform(0.8, 2.2))
    mill = replace(mill, wear=wear)
    speeds = speeds_of(mill, True)
    rows = tests(mill, random, 28, speeds)
    if seed % 3 == 1:
        bad = int(random.integers(4, 24))
        rows[bad] = (*rows[bad][:6], rows[bad][6] * float(random.choice([0.05, 3.0, 10.0])))
    write(folder, folder.name, declared(mill, random), rows, "all", 1e-3 if seed % 5 == 2 else 1.0)
    told = np.exp(np.linspace(math.log(speeds[0]), math.log(speeds[1]), 12))
    limits = [
        [s * 30 / math.pi, *(1e3 * limit(mill.at(share), s, 0.03) for share in (0.0, 1.0))]
        for s in told
    ]
    truth = {"effects": [] if form == "none" else ["wear"], "limits": limits, "wear": wear}
    (folder / "truth.json").write_text(json.dumps(truth))
    return truth


def effect_set(folder: Path, seed: int, tests_wanted: int = 60) -> dict:
    """Write a set of verdicts with one effect, or none."""
    random = np.random.default_rng([seed, 2])
    name = ("process_damping", "mode_shift", "missing_mode", "")[seed % 4]
    mill = machine(random, False)
    told = declared(mill, random)
    if name == "process_damping":
        mill = replace(mill, damping=float(random.uniform(2e5, 6e5)))
    if name == "mode_shift":
        top = speeds_of(mill, False)[1]
        mill = replace(mill, slope=-float(random.uniform(0.05, 0.1)) / top)
    if name == "missing_mode":
        f, z, m, a = mill.modes[0]
        more = (f * float(random.uniform(0.6, 1.6)), z, m * float(random.uniform(0.5, 1.2)), a)
        mill = replace(mill, modes=(*mill.modes, more))
    rows = tests(mill, random, tests_wanted, speeds_of(mill, name == "process_damping"))
    write(folder, folder.name, told, rows, "few")
    truth = {"effects": [name] if name else []}
    (folder / "truth.json").write_text(json.dumps(truth))
    return truth


def judged(folder: Path) -> str:
    """Explain a set and put what is found beside the truth."""
    from chatter.explain.explanation import explain

    truth, begin = json.loads((folder / "truth.json").read_text()), time.perf_counter()
    found = explain(folder).summary()
    names = [one["name"] for one in found["effects"]]
    wanted = "explained" if truth["effects"] else "nothing-missing"
    right = names == truth["effects"] and found["verdict"] == wanted
    part = [one["name"] for one in found.get("partial", ())]
    line = (
        f"{folder.name}: {'right' if right else 'WRONG'}: {truth['effects']} -> {found['verdict']} "
        f"{names} {part}, {time.perf_counter() - begin:.0f} s"
    )
    if "limits" in found and "limits" in truth:
        true = np.array(truth["limits"])
        for column, key in ((1, "first"), (2, "last")):
            depths = np.array(found["limits"]["critical_depth_mm"][key], dtype=float)
            ours = np.interp(true[:, 0], found["limits"]["spindle_speed_rpm"], depths)
            both = np.isfinite(ours) & np.isfinite(true[:, column])
            error = np.abs(ours[both] / true[both, column] - 1.0)
            line += f", {key} limits {100 * float(np.median(error)):.1f} %"
    return line


def main() -> None:
    """Write sets and judge them."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("out", type=Path)
    options.add_argument("--wear", type=int, default=12)
    options.add_argument("--effects", type=int, default=12)
    options.add_argument("--seed", type=int, default=1)
    given = options.parse_args()
    sets = [(wear_set, f"wear-{given.seed}-{k}", given.seed * 100 + k) for k in range(given.wear)]
    sets += [
        (effect_set, f"effect-{given.seed}-{k}", given.seed * 100 + k) for k in range(given.effects)
    ]
    for make, name, seed in sets:
        folder = given.out / "sets" / name
        if not (folder / "truth.json").exists():
            make(folder, seed)
        print(judged(folder), flush=True)


if __name__ == "__main__":
    main()
