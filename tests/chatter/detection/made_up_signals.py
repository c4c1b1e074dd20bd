"""Small milling simulator that makes records of known verdict.

Straight edges, one mode along x and optionally one along y, chip thickness against all earlier
passes, loss of contact. The spindle angle is the independent variable, so the speed may vary.
"""

import math
from typing import NamedTuple

import numba
import numpy as np


class Cut(NamedTuple):
    """Parameters of a simulated cut; lags are steps from the first tooth back to each tooth."""

    stiffness: tuple  # (2,) N/m; inf: rigid
    frequency: tuple  # (2,) Hz
    damping: tuple
    Ktc: float
    Krc: float
    speed: float  # rad/s
    feed: float
    entry: float
    leave: float
    lags: tuple
    runout: tuple
    steps: int = 720
    swing: float = 0.0  # share of the speed that varies, three turns a period

    @property
    def tooth_angles(self):
        return 2.0 * np.pi * np.array(self.lags) / self.steps


@numba.njit(cache=False)
def _march(
    turns, depth, mass, k, c, Ktc, Krc, speed, feed, entry, leave, lags, runout, steps, swing, lin
):
    """March; with `lin` the variational equation, chip against the last pass only.

    Returns time, positions, forces (a row a step) and, if linear, log of the norm a turn.
    """
    n = turns * steps
    teeth = len(lags)
    time = np.zeros(n + 1)
    pos = np.zeros((n + 1, 2))
    vel = np.zeros(2)
    force = np.zeros((n + 1, 2))
    logs = np.zeros(turns)
    scale = 0.0
    if lin:
        vel[0] = 1.0 if mass[0] > 0 else 0.0
        vel[1] = 0.7 if mass[1] > 0 else 0.0
    dphi = 2.0 * np.pi / steps
    for i in range(n):
        fx = 0.0
        fy = 0.0
        for j in range(teeth):
            phi = ((i - lags[j]) % steps) * dphi
            if phi < entry or phi > leave:
                continue
            s = math.sin(phi)
            co = math.cos(phi)
            here = pos[i, 0] * s + pos[i, 1] * co
            h = 1e9
            most = 1 if lin else 2 * teeth
            for m in range(1, most + 1):
                other = (j - m) % teeth
                back = lags[j] - lags[other]
                back += steps * ((m - j + teeth - 1) // teeth if m > j else 0)
                past = i - back
                # lags rise with the tooth number: an earlier tooth passed `back` steps ago
                there = 0.0
                if past >= 0:
                    there = pos[past, 0] * s + pos[past, 1] * co
                chip = here - there
                if not lin:
                    chip += feed * teeth * back / steps * s + runout[j] - runout[other]
                h = min(h, chip)
            if h > 0.0 or lin:
                ft = Ktc * depth * h
                fr = Krc * depth * h
                fx += -ft * co - fr * s
                fy += ft * s - fr * co
        force[i, 0] = fx
        force[i, 1] = fy
        dt = dphi / (speed * (1.0 + swing * math.sin(2.0 * np.pi * i / (3.0 * steps))))
        time[i + 1] = time[i] + dt
        for d in range(2):
            if mass[d] <= 0.0:
                continue
            f = force[i, d]
            acc = (f - c[d] * vel[d] - k[d] * pos[i, d]) / mass[d]
            vel[d] += acc * dt
            pos[i + 1, d] = pos[i, d] + vel[d] * dt
        if lin and (i + 1) % steps == 0:
            turn = i // steps
            size = 0.0
            for q in range(i + 1 - steps, i + 1):
                size += pos[q, 0] ** 2 + pos[q, 1] ** 2
            size = math.sqrt(size)
            logs[turn] = scale + math.log(size + 1e-300)
            scale += math.log(size + 1e-300)
            # the state is the history of one turn
            for q in range(i + 2 - steps, i + 2):
                pos[q, 0] /= size
                pos[q, 1] /= size
            vel /= size
    force[n] = force[n - 1]
    return time, pos, force, logs


def _arguments(cut):
    k = np.array([0.0 if math.isinf(v) else v for v in cut.stiffness])
    omega = 2.0 * np.pi * np.array(cut.frequency)
    mass = k / omega**2
    c = 2.0 * np.array(cut.damping) * mass * omega
    return mass, k, c


def _run(cut, depth, turns, linear):
    mass, k, c = _arguments(cut)
    return _march(
        turns, depth, mass, k, c, cut.Ktc, cut.Krc, cut.speed, cut.feed, cut.entry, cut.leave,
        np.array(cut.lags, dtype=np.int64), np.array(cut.runout, dtype=float), cut.steps,
        cut.swing, linear,
    )  # fmt: skip


def simulate(cut, depth, turns):
    """Time, spindle angle, displacements (n, 2), forces (n, 3) from rest."""
    time, pos, force, _ = _run(cut, depth, turns, False)
    angle = 2.0 * np.pi / cut.steps * np.arange(len(time))
    return time, angle, pos, np.column_stack([force, np.zeros(len(time))])


def growth_a_turn(cut, depth, turns=120):
    """Natural logarithm of the dominant multiplier over a turn, of the linear equation."""
    *_, logs = _run(cut, depth, turns, True)
    half = turns // 2
    return float(np.polyfit(np.arange(half, turns), logs[half:], 1)[0])


def limit_depth(cut, deepest=0.05):
    """Lowest depth found at which the linear equation does not decay, by a scan and bisection."""
    grid = np.geomspace(deepest / 1e3, deepest, 24)
    low = grid[0] / 2
    for depth in grid:
        if growth_a_turn(cut, depth, 60) > 0.0:
            break
        low = depth
    high = depth
    for _ in range(8):
        middle = math.sqrt(low * high)
        if growth_a_turn(cut, middle, 100) > 0.0:
            high = middle
        else:
            low = middle
    return high


def uniform(cut, time, angle, displacements, forces, noise, rng, samples_a_turn=400):
    """Resample to a uniform time step and add white noise of a share of the rms."""
    n = int((angle[-1] / (2 * np.pi)) * samples_a_turn)
    t = np.linspace(0.0, time[-1], n, endpoint=False)

    def channel(values):
        out = np.column_stack([np.interp(t, time, values[:, d]) for d in range(values.shape[1])])
        size = np.sqrt(np.mean((out - out.mean(0)) ** 2, axis=0).max())
        return out + noise * size * rng.standard_normal(out.shape)

    return t, np.interp(t, time, angle), channel(displacements), channel(forces)


def random_cut(rng, kind="any"):
    """A cut at a random place; `kind` "odd", "even", "unequal" or "any" sets the teeth."""
    teeth = int(rng.choice({"odd": [1, 3], "even": [2, 4]}.get(kind, [2, 3, 4])))
    steps = 720
    lags = np.arange(teeth) * (steps // teeth)
    if kind == "unequal":
        lags = lags + np.concatenate([[0], rng.integers(-40, 41, teeth - 1)])
    frequency = rng.uniform(300.0, 1200.0)
    tooth_rate = frequency / rng.uniform(0.4, 4.0)
    speed = 2.0 * np.pi * tooth_rate / teeth
    immersion = rng.choice([rng.uniform(0.05, 0.3), rng.uniform(0.3, 1.0), 2.0])
    span = math.acos(1.0 - immersion)
    entry, leave = (0.0, span) if rng.random() < 0.5 else (math.pi - span, math.pi)
    stiff = 10 ** rng.uniform(6.0, 7.3)
    two = rng.random() < 0.6
    return Cut(
        stiffness=(stiff, stiff * rng.uniform(0.8, 3.0) if two else math.inf),
        frequency=(frequency, frequency * rng.uniform(0.8, 1.6)),
        damping=(rng.uniform(0.008, 0.05), rng.uniform(0.008, 0.05)),
        Ktc=rng.uniform(600e6, 2000e6),
        Krc=rng.uniform(150e6, 700e6),
        speed=speed,
        feed=rng.uniform(0.04e-3, 0.2e-3),
        entry=entry,
        leave=leave,
        lags=tuple(int(v) for v in lags),
        runout=(0.0,) * teeth,
        steps=steps,
    )


def with_runout(cut, rng, largest=1.0):
    """The cut with an eccentric tool, offset up to `largest` times the feed per tooth."""
    offset = cut.feed * rng.uniform(0.2, largest)
    return cut._replace(runout=tuple(offset * np.cos(rng.uniform(0, 2 * np.pi) - cut.tooth_angles)))
