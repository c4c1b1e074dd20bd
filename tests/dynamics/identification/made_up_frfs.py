"""Made-up structures with known modes, measured with noise, for scoring the identification."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dynamics.frf.container import Frf, Point

AXES = ("x", "y", "z")


@dataclass(frozen=True)
class TrueMode:
    frequency: float  # Hz
    damping: float
    mass: float  # kg
    direction: tuple[float, float, float]


@dataclass(frozen=True)
class Case:
    kind: str
    seed: int
    frfs: tuple[Frf, ...]
    modes: tuple[TrueMode, ...]  # all, out of the band too
    noise: np.ndarray  # (n, k) standard deviation of the noise that was added
    clean: np.ndarray  # (n, k) without noise
    share: np.ndarray  # (modes, k) residues, 1/kg


def response(frequency, modes, residues, derivative):
    """FRF of modes given their residues (1/kg): sum of single-degree-of-freedom responses."""
    s = 2j * np.pi * frequency
    total = np.zeros(s.size, dtype=complex)
    for mode, residue in zip(modes, residues, strict=True):
        w = 2.0 * np.pi * mode.frequency
        total += residue / (w**2 + s**2 + 2.0 * mode.damping * w * s)
    return total * s**derivative


def measured(rng, kind, seed, frequency, modes, points, shapes, quantity, additive, relative):
    """Case from modes and shapes; `points` are (response, reference) pairs of Point."""
    derivative = {"receptance": 0, "mobility": 1, "accelerance": 2}[quantity]
    frfs, noises, cleans, shares = [], [], [], []
    for end, start in points:
        residues = np.array([shapes[r][end] * shapes[r][start] for r in range(len(modes))])
        clean = response(frequency, modes, residues, derivative)
        # the noise of an accelerometer is even in accelerance whatever the quantity of the file
        even = (2.0 * np.pi * frequency) ** (derivative - 2)
        accelerance = np.abs(clean) / even
        sigma = np.hypot(additive * np.max(accelerance) * even, relative * np.abs(clean))
        noise = sigma * (rng.standard_normal(sigma.size) + 1j * rng.standard_normal(sigma.size))
        values = clean + noise / np.sqrt(2.0)
        frfs.append(Frf(frequency, values, quantity, end, start, source=f"{kind} {seed}"))
        noises.append(sigma)
        cleans.append(clean)
        shares.append(residues)
    return Case(
        kind,
        seed,
        tuple(frfs),
        tuple(modes),
        np.stack(noises, axis=1),
        np.stack(cleans, axis=1),
        np.stack(shares, axis=1),
    )


def spread_modes(rng, count, lowest, highest, dampings, least_spacing=1.0):
    """Random modes, neighbours at least `least_spacing` mean half-power bandwidths apart."""
    while True:
        frequency = np.sort(rng.uniform(lowest, highest, count))
        damping = np.exp(rng.uniform(np.log(dampings[0]), np.log(dampings[1]), count))
        bandwidth = 2.0 * damping * frequency
        apart = np.diff(frequency) / (0.5 * (bandwidth[1:] + bandwidth[:-1]))
        if count == 1 or np.min(apart) > least_spacing:
            break
        count = max(1, count - int(rng.random() < 0.02))
    mass = np.exp(rng.uniform(np.log(0.1), np.log(3.0), count))
    return [
        TrueMode(float(f), float(z), float(m), (1.0, 0.0, 0.0))
        for f, z, m in zip(frequency, damping, mass, strict=True)
    ]


def drive_point(rng, kind, seed, frequency, modes, quantity, additive, relative):
    point = Point("1", "x")
    shapes = [{point: mode.mass**-0.5} for mode in modes]
    return measured(
        rng, kind, seed, frequency, modes, [(point, point)], shapes, quantity, additive, relative
    )


def axis_of(rng, highest=3000.0):
    lines = int(rng.choice([800, 1600, 3200]))
    return np.arange(1, lines + 1) * (highest / lines)


def noise_of(rng):
    """Even part relative to the peak, and part proportional to the function."""
    return float(np.exp(rng.uniform(np.log(2e-4), np.log(1e-2)))), float(
        np.exp(rng.uniform(np.log(1e-3), np.log(3e-2)))
    )


def many(rng, seed):
    """One to twelve modes at a drive point."""
    count = int(rng.integers(1, 13))
    modes = spread_modes(rng, count, 150.0, 2700.0, (0.003, 0.04))
    quantity = str(rng.choice(["receptance", "mobility", "accelerance"]))
    return drive_point(rng, "many", seed, axis_of(rng), modes, quantity, *noise_of(rng))


def close(rng, seed):
    """Two modes half to one bandwidth apart, a third elsewhere."""
    f, z = rng.uniform(400.0, 1200.0), rng.uniform(0.015, 0.035)
    apart = rng.uniform(0.5, 1.0) * 2.0 * z * f
    second = z * rng.uniform(0.8, 1.25)
    masses = np.exp(rng.uniform(np.log(0.4), np.log(1.2), 3))
    third = rng.uniform(1.5, 2.2) * f
    modes = [
        TrueMode(f, z, masses[0], (1.0, 0.0, 0.0)),
        TrueMode(f + apart, second, masses[1], (1.0, 0.0, 0.0)),
        TrueMode(third, rng.uniform(0.015, 0.035), masses[2], (1.0, 0.0, 0.0)),
    ]
    additive = float(np.exp(rng.uniform(np.log(5e-4), np.log(5e-3))))
    return drive_point(rng, "close", seed, axis_of(rng), modes, "accelerance", additive, 2e-3)


def out_of_band(rng, seed):
    """Modes below and above the measured lines."""
    inside = spread_modes(rng, int(rng.integers(2, 6)), 500.0, 1700.0, (0.005, 0.04))
    low = spread_modes(rng, 1, 60.0, 220.0, (0.01, 0.04))
    high = spread_modes(rng, 2, 2500.0, 4500.0, (0.01, 0.04))
    frequency = axis_of(rng, 2000.0)
    frequency = frequency[frequency > 300.0]
    modes = low + inside + high
    return drive_point(rng, "out of band", seed, frequency, modes, "accelerance", *noise_of(rng))


def heavy(rng, seed):
    """Heavily damped modes, spindle-like, with sharper ones among them."""
    modes = [
        TrueMode(rng.uniform(350, 700), rng.uniform(0.06, 0.12), rng.uniform(0.5, 2), (1.0, 0, 0)),
        TrueMode(
            rng.uniform(1200, 1600), rng.uniform(0.01, 0.12), rng.uniform(0.2, 1), (1.0, 0, 0)
        ),
        TrueMode(
            rng.uniform(2100, 2600), rng.uniform(0.01, 0.05), rng.uniform(0.2, 1), (1.0, 0, 0)
        ),
    ]
    quantity = str(rng.choice(["receptance", "accelerance"]))
    return drive_point(rng, "heavy", seed, axis_of(rng), modes, quantity, *noise_of(rng))


def tiny(rng, seed):
    """Small local modes on the flanks of large ones."""
    big = spread_modes(rng, 3, 400.0, 2400.0, (0.01, 0.03), least_spacing=8.0)
    small = []
    for mode in big[:2]:
        bandwidth = 2.0 * mode.damping * mode.frequency
        f = mode.frequency + rng.uniform(2.0, 5.0) * bandwidth
        z = rng.uniform(0.003, 0.01)
        small.append(
            TrueMode(f, z, mode.mass * mode.damping / z / rng.uniform(0.02, 0.08), (1.0, 0, 0))
        )
    modes = sorted(big + small, key=lambda m: m.frequency)
    additive, relative = 1e-3 * rng.uniform(0.2, 1.0), 1e-3 * rng.uniform(1.0, 10.0)
    return drive_point(rng, "tiny", seed, axis_of(rng), modes, "accelerance", additive, relative)


def cross(rng, seed):
    """Tool point in x and y with cross terms; some modes at the same frequency in both."""
    base = spread_modes(rng, int(rng.integers(2, 4)), 400.0, 2200.0, (0.015, 0.04), 3.0)
    modes = []
    for mode in base:
        angle = rng.uniform(0.0, np.pi)
        for turn in (0.0, 0.5 * np.pi)[: int(rng.integers(1, 3))]:
            direction = (float(np.cos(angle + turn)), float(np.sin(angle + turn)), 0.0)
            shift = float(rng.choice([0.0, 0.3, 1.0])) * 2.0 * mode.damping * mode.frequency
            f = mode.frequency + (shift if turn else 0.0)
            damping = mode.damping * (rng.uniform(0.8, 1.2) if turn else 1.0)
            modes.append(TrueMode(f, damping, mode.mass * rng.uniform(0.6, 1.5), direction))
    modes.sort(key=lambda m: m.frequency)
    ends = {name: Point("1", name) for name in "xy"}
    shapes = [
        {
            ends["x"]: mode.mass**-0.5 * mode.direction[0],
            ends["y"]: mode.mass**-0.5 * mode.direction[1],
        }
        for mode in modes
    ]
    pairs = [(ends[a], ends[b]) for a, b in ("xx", "xy", "yx", "yy")]
    if rng.random() < 0.5:
        pairs = pairs[:2] + pairs[3:]
    additive, relative = noise_of(rng)
    return measured(
        rng,
        "cross",
        seed,
        axis_of(rng),
        modes,
        pairs,
        shapes,
        "accelerance",
        0.3 * additive,
        0.3 * relative,
    )


def points(rng, seed):
    """One reference, several responses, the first a drive point."""
    modes = spread_modes(rng, int(rng.integers(2, 9)), 100.0, 2700.0, (0.002, 0.03))
    count = int(rng.integers(3, 7))
    ends = [Point(str(i + 1), "z") for i in range(count)]
    shapes = []
    for mode in modes:
        shape = rng.standard_normal(count)
        shape[0] = 1.0
        shapes.append({p: v * mode.mass**-0.5 for p, v in zip(ends, shape, strict=True)})
    pairs = [(end, ends[0]) for end in ends]
    return measured(
        rng, "points", seed, axis_of(rng), modes, pairs, shapes, "accelerance", *noise_of(rng)
    )


def noisy(rng, seed):
    """One to four modes under even noise of 2 to 5 % of the peak."""
    modes = spread_modes(rng, int(rng.integers(1, 5)), 300.0, 2600.0, (0.005, 0.05))
    quantity = str(rng.choice(["receptance", "accelerance"]))
    additive = float(rng.uniform(0.02, 0.05))
    return drive_point(rng, "noisy", seed, axis_of(rng), modes, quantity, additive, 0.01)


def light(rng, seed):
    """Damping so light that a resonance is about as narrow as the distance of lines."""
    modes = spread_modes(rng, int(rng.integers(2, 8)), 40.0, 950.0, (0.0003, 0.003), 30.0)
    frequency = np.arange(1.0, 1001.0)
    additive, relative = 1e-4 * rng.uniform(0.5, 3.0), 1e-2 * rng.uniform(0.1, 1.0)
    return drive_point(rng, "light", seed, frequency, modes, "accelerance", additive, relative)


def drifting(rng, seed):
    """Receptance integrated from an accelerance with an offset and a delay between channels."""
    modes = spread_modes(rng, int(rng.integers(2, 6)), 300.0, 2600.0, (0.01, 0.08))
    case = drive_point(rng, "drifting", seed, axis_of(rng), modes, "receptance", *noise_of(rng))
    frf = case.frfs[0]
    s = 2j * np.pi * frf.frequency
    accelerance = np.abs(case.clean[:, 0] * s**2)
    lag = np.exp(-s * rng.uniform(-10e-6, 10e-6))
    offset = rng.uniform(0.002, 0.02) * np.max(accelerance) / s**2
    values = frf.values * lag + offset
    return replace(case, frfs=(replace(frf, values=values),))


KINDS: dict[str, Callable] = {
    f.__name__: f
    for f in (many, close, out_of_band, heavy, tiny, cross, points, noisy, light, drifting)
}


def made_up_case(kind: str, seed: int) -> Case:
    return KINDS[kind](np.random.default_rng([seed, list(KINDS).index(kind)]), seed)


def attainable_std(case: Case, lowest: float, highest: float) -> np.ndarray:
    """Cramer-Rao bounds of frequency and damping, both relative, (modes, 2).

    Real residues of every FRF and three residual terms are unknown besides the poles; the noise
    is known. No unbiased estimator does better.
    """
    frequency = case.frfs[0].frequency
    inside = (frequency >= lowest) & (frequency <= highest)
    s = 2j * np.pi * frequency[inside]
    derivative = {"receptance": 0, "mobility": 1, "accelerance": 2}[case.frfs[0].quantity]
    w = 2.0 * np.pi * np.array([m.frequency for m in case.modes])
    z = np.array([m.damping for m in case.modes])
    unit = s[:, None] ** derivative / (w**2 + s[:, None] ** 2 + 2 * z * w * s[:, None])
    slope = -(unit**2) / s[:, None] ** derivative
    by_w = slope * (2 * w**2 + 2 * z * w * s[:, None])
    by_z = slope * 2 * z * w * s[:, None]
    total = np.zeros((2 * w.size, 2 * w.size))
    for k in range(len(case.frfs)):
        sigma = case.noise[inside, k, None]
        rest = [s[:, None] ** (derivative + p) for p in (-2, -1, 0)]
        linear = np.concatenate([unit, *rest], axis=1) / sigma
        poles = np.concatenate([by_w * case.share[:, k], by_z * case.share[:, k]], axis=1) / sigma
        linear = np.concatenate([linear.real, linear.imag])
        poles = np.concatenate([poles.real, poles.imag])
        linear = linear / np.linalg.norm(linear, axis=0)
        basis = np.linalg.qr(linear)[0]
        poles = poles - basis @ (basis.T @ poles)
        total += 2.0 * poles.T @ poles
    scale = np.sqrt(np.maximum(np.diag(total), 1e-300))
    inverse = np.linalg.pinv(total / scale[:, None] / scale, rcond=1e-13)
    std = np.sqrt(np.maximum(np.diag(inverse), 0.0)) / scale
    return std.reshape(2, -1).T


@dataclass(frozen=True)
class Score:
    attainable: int  # modes whose damping the data bear to 10 %
    found: int
    accurate: int  # 0.2 % and 5 %, or four attainable standard deviations
    false: int  # identified in the band without a true mode
    worst_error: float
    missed: tuple[str, ...]


def score(case: Case, fit) -> Score:
    """Compare a ModalFit with the true modes."""
    lowest, highest = case.frfs[0].frequency[0], case.frfs[0].frequency[-1]
    std = attainable_std(case, case.frfs[0].frequency[0], case.frfs[0].frequency[-1])
    left = list(fit.identified)
    attainable = found = accurate = 0
    missed = []
    order = np.argsort(std[:, 1])  # the best determined modes choose first
    for mode, (std_f, std_z) in ((case.modes[r], std[r]) for r in order):
        bandwidth = mode.damping * mode.frequency
        reach = max(bandwidth, min(5 * std_f * mode.frequency, 3 * bandwidth))
        near = [m for m in left if abs(m.frequency - mode.frequency) < reach]
        if near:
            best = min(
                near,
                key=lambda m: (
                    abs(m.frequency - mode.frequency) / bandwidth
                    + abs(np.log(m.damping / mode.damping))
                ),
            )
            left.remove(best)
        inside = lowest <= mode.frequency <= highest
        if not inside or std_z > 0.1 or std_f * mode.frequency > 0.2 * bandwidth:
            continue
        attainable += 1
        if not near:
            missed.append(f"{mode.frequency:.1f} Hz {mode.damping:.4f} std {std_z:.3f}")
            continue
        found += 1
        error_f = abs(best.frequency / mode.frequency - 1.0)
        error_z = abs(best.damping / mode.damping - 1.0)
        good = error_f < max(0.002, 4 * std_f) and error_z < max(0.05, 4 * std_z)
        accurate += good
        if not good:
            missed.append(
                f"{mode.frequency:.1f} Hz {mode.damping:.4f}: off {100 * error_f:.3f} % "
                f"(std {100 * std_f:.3f}), {100 * error_z:.1f} % (std {100 * std_z:.1f})"
            )
    false = [m for m in left if lowest <= m.frequency <= highest]
    missed += [f"false {m.frequency:.1f} Hz {m.damping:.4f} weight {m.weight:.3f}" for m in false]
    return Score(attainable, found, accurate, len(false), fit.worst_error, tuple(missed))
