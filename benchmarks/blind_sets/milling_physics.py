"""A milling cut in time: Runge-Kutta 4 on the modes, history by cubic Hermite polynomials.

Conventions of forces and chip thickness: x feed, y normal, phi clockwise from +y, forces on the
tool, the thinnest of the passes of the last turn counts. Every tooth is integrated over exactly
that part of its edge which is in the arc, so that entry and exit have no steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
TURN = 2.0 * np.pi
SAMPLING = 12800.0  # Hz
POINTS_ON_EDGE = 16
STEPS_A_TURN = 500
STEPS_A_VIBRATION = 60


class Plant(NamedTuple):
    """Tool, law, structure and sensor as they truly are; SI. A zero switches an effect off."""

    radius: float
    lag: float  # tan(helix)/radius, rad/m
    tooth_angle: Array  # (N,) on the tool, first 0, rising
    edge_share: Array  # (N,) edge force of a tooth over the common one
    frequency: Array  # (M,) Hz, at standstill
    damping: Array  # (M,)
    mass: Array  # (M,) kg
    direction: Array  # (M, 2)
    Ktc: float
    Krc: float
    Kte: float
    Kre: float
    h0: float = 1e-4
    exponent: float = 1.0
    frequency_slope: float = 0.0  # s/rad
    square_slope: float = 0.0  # of the frequency of one mode with the square of speed, s^2/rad^2
    square_mode: int = 0
    runout_offset: float = 0.0
    runout_angle: float = 0.0
    ploughing: float = 0.0  # C, N/m
    ploughing_friction: float = 0.3
    contact_stiffness: float = 0.0
    contact_damping: float = 0.0
    contact_share: float = 0.0  # 1: as far as the depth is engaged, 0: whole in the cut
    wear_tangential: float = 0.0  # N/m/s
    wear_radial: float = 0.0
    wear_cutting: float = 0.0  # 1/s
    wear_ploughing: float = 0.0  # N/m/s
    wear_saturation: float = 0.0  # time in which the growth dies away, s
    wear_step: float = 0.0  # cut time at which what grows linearly comes at once, s
    sensor_frequency: float = 0.0  # Hz
    sensor_damping: float = 0.0
    sensor_frequency_y: float = 0.0  # of Fy, where it is another one, Hz
    slide_mode: int = 0
    slide_friction: float = 0.0  # N
    slide_velocity: float = 1e-3  # m/s
    spot_amplitude: float = 0.0  # of the whole force, along the feed
    spot_wavelength: float = 1e-3
    spot_phase: float = 0.0
    drift_amplitude: float = 0.0
    drift_frequency: float = 1.0
    drift_phase: float = 0.0
    extra_force_x: float = 0.0
    extra_force_y: float = 0.0
    extra_frequency: float = 1.0
    extra_phase: float = 0.0
    extra_measured: float = 0.0
    cubic_stiffness: float = 0.0  # N/m^3, on every mode
    cross_stiffness: float = 0.0  # N/m, skew between x and y
    ripple_amplitude: float = 0.0
    ripple_frequency: float = 1.0
    crosstalk_xy: float = 0.0  # share of Fy in the measured Fx
    crosstalk_yx: float = 0.0


class Cut(NamedTuple):
    """Conditions of one run; SI."""

    speed: float  # rad/s
    feed: float  # per tooth, m
    depth: float
    radial_depth: float
    entry: float
    exit: float
    cut_time: float
    touches: float = -np.inf  # when the tool touches the straight front edge of the block, s


class Record(NamedTuple):
    """Signals of a run, (n,) each: s, rad, N, m."""

    time: Array
    angle: Array
    Fx: Array
    Fy: Array
    x: Array
    y: Array

    @property
    def channels(self) -> Array:
        """Measured signals (4, n)."""
        return np.stack([self.Fx, self.Fy, self.x, self.y])


@njit(cache=True, error_model="numpy")
def _hermite(t, step, known, u, v, out):
    """Displacement at an earlier time; at rest before the cut."""
    if t <= 0.0:
        out[0] = out[1] = 0.0
        return
    n = min(int(t / step), known - 1)
    s = t / step - n
    a = (1.0 + 2.0 * s) * (1.0 - s) ** 2
    b = s * (1.0 - s) ** 2 * step
    c = s * s * (3.0 - 2.0 * s)
    d = s * s * (s - 1.0) * step
    for i in range(2):
        out[i] = a * u[n, i] + b * v[n, i] + c * u[n + 1, i] + d * v[n + 1, i]


@njit(cache=True, error_model="numpy")
def _turned(t, p, c):
    """Angle of the spindle, with its ripple."""
    if p.ripple_amplitude == 0.0:
        return c.speed * t
    w = 2.0 * np.pi * p.ripple_frequency
    return c.speed * (t + p.ripple_amplitude / w * (1.0 - np.cos(w * t)))


@njit(cache=True, error_model="numpy")
def _when(angle, guess, p, c):
    """Time at which the spindle stood at an angle."""
    if p.ripple_amplitude == 0.0:
        return angle / c.speed
    w = 2.0 * np.pi * p.ripple_frequency
    t = guess
    for _ in range(6):
        rate = c.speed * (1.0 + p.ripple_amplitude * np.sin(w * t))
        t -= (_turned(t, p, c) - angle) / rate
    return t


@njit(cache=True, error_model="numpy")
def _worn_time(p, c):
    """Cut time that linear growth would have taken."""
    if p.wear_saturation > 0.0:
        return p.wear_saturation * (1.0 - np.exp(-c.cut_time / p.wear_saturation))
    if p.wear_step > 0.0:
        return p.wear_step if c.cut_time >= p.wear_step else 0.0
    return c.cut_time


@njit(cache=True, error_model="numpy")
def _cutting(t, now, vel, step, known, u, v, p, c, past, force):
    """Force of the cut on the tool at time t; returns the engaged share of the depth."""
    teeth = p.tooth_angle.shape[0]
    psi = _turned(t, p, c)
    feed_speed = c.feed * teeth * c.speed / (2.0 * np.pi)
    # front edge of the block ahead of the axis of the tool, which vibrates
    front = p.radius - feed_speed * (t - c.touches) - now[0]
    spots = 1.0 + p.spot_amplitude * np.sin(
        2.0 * np.pi * feed_speed * t / p.spot_wavelength + p.spot_phase
    )
    drift = 1.0 + p.drift_amplitude * np.sin(2.0 * np.pi * p.drift_frequency * t + p.drift_phase)
    cut_time = _worn_time(p, c)
    worn = 1.0 + p.wear_cutting * cut_time
    ktc, krc = p.Ktc * spots * drift * worn, p.Krc * spots * worn
    kte = (p.Kte + p.wear_tangential * cut_time) * spots
    kre = (p.Kre + p.wear_radial * cut_time) * spots
    ploughing = p.ploughing + p.wear_ploughing * cut_time
    force[0] = force[1] = 0.0
    engaged = 0.0
    for j in range(teeth):
        tip = psi + p.tooth_angle[j]
        looked = False
        first = int(np.floor((tip - p.lag * c.depth - c.exit) / (2.0 * np.pi)))
        last = int(np.floor((tip - c.entry) / (2.0 * np.pi))) + 1
        for turn in range(first, last + 1):
            begin, end = c.entry + 2.0 * np.pi * turn, c.exit + 2.0 * np.pi * turn
            if p.lag > 0.0:
                low, high = max(0.0, (tip - end) / p.lag), min(c.depth, (tip - begin) / p.lag)
            elif begin <= tip < end:
                low, high = 0.0, c.depth
            else:
                continue
            if high <= low:
                continue
            if not looked:
                looked = True
                for k in range(1, teeth + 1):
                    ahead = p.tooth_angle[(j + k) % teeth] - p.tooth_angle[j]
                    ahead += 2.0 * np.pi * ((j + k) // teeth)
                    before = _when(psi - ahead, t - ahead / c.speed, p, c)
                    _hermite(before, step, known, u, v, past[k])
                    past[k, 0] = now[0] - past[k, 0] + feed_speed * (t - before)
                    past[k, 1] = now[1] - past[k, 1]
                    mine = np.cos(p.runout_angle - p.tooth_angle[j])
                    other = np.cos(p.runout_angle - p.tooth_angle[(j + k) % teeth])
                    past[k, 2] = p.runout_offset * (mine - other)
            width = (high - low) / POINTS_ON_EDGE
            entering = front > -p.radius
            for i in range(POINTS_ON_EDGE):
                phi = tip - p.lag * (low + (i + 0.5) * width)
                sine, cosine = np.sin(phi), np.cos(phi)
                h = 1e9
                for k in range(1, teeth + 1):
                    h = min(h, past[k, 0] * sine + past[k, 1] * cosine + past[k, 2])
                if entering:
                    # the block is no thicker along the radius than as far as its front edge
                    h = min(h, p.radius - front / max(sine, 1e-9))
                if h <= 0.0:
                    continue
                engaged += width / c.depth
                law = h if p.exponent == 1.0 else p.h0 * (h / p.h0) ** p.exponent
                rub = ploughing / (c.speed * p.radius) * (vel[0] * sine + vel[1] * cosine)
                ft = ktc * law + kte * p.edge_share[j] + p.ploughing_friction * rub
                fr = krc * law + kre * p.edge_share[j] + rub
                force[0] += width * (-ft * cosine - fr * sine)
                force[1] += width * (ft * sine - fr * cosine)
    if engaged > 0.0:
        share = min(engaged, 1.0) if p.contact_share > 0.0 else 1.0
        for i in range(2):
            force[i] -= share * (p.contact_stiffness * now[i] + p.contact_damping * vel[i])
    return engaged


@njit(cache=True, error_model="numpy")
def _rates(t, state, step, known, u, v, p, c, past, force, measured, rate):
    """Time derivative of the modes (q, q') and of the sensor (f, f' of both directions)."""
    modes = p.mass.shape[0]
    now, vel = np.zeros(2), np.zeros(2)
    for m in range(modes):
        for i in range(2):
            now[i] += p.direction[m, i] * state[2 * m]
            vel[i] += p.direction[m, i] * state[2 * m + 1]
    _cutting(t, now, vel, step, known, u, v, p, c, past, force)
    swing = np.sin(2.0 * np.pi * p.extra_frequency * t + p.extra_phase)
    extra = np.array([p.extra_force_x * swing, p.extra_force_y * swing])
    for i in range(2):
        measured[i] = force[i] + p.extra_measured * extra[i]
        force[i] += extra[i]
    force[0] -= p.cross_stiffness * now[1]
    force[1] += p.cross_stiffness * now[0]
    for m in range(modes):
        q, w = state[2 * m], state[2 * m + 1]
        shift = p.frequency_slope * c.speed
        if m == p.square_mode:
            shift += p.square_slope * c.speed**2
        natural = 2.0 * np.pi * p.frequency[m] * (1.0 + shift)
        push = p.direction[m, 0] * force[0] + p.direction[m, 1] * force[1]
        push -= p.cubic_stiffness * q**3
        if m == p.slide_mode:
            push -= p.slide_friction * np.tanh(w / p.slide_velocity)
        rate[2 * m] = w
        rate[2 * m + 1] = push / p.mass[m] - 2.0 * p.damping[m] * natural * w - natural**2 * q
    if p.sensor_frequency > 0.0:
        for i in range(2):
            own = p.sensor_frequency_y if i == 1 and p.sensor_frequency_y > 0.0 else 0.0
            ws = 2.0 * np.pi * (own if own > 0.0 else p.sensor_frequency)
            s = 2 * modes + 2 * i
            rate[s] = state[s + 1]
            rate[s + 1] = (
                ws**2 * (measured[i] - state[s]) - 2.0 * p.sensor_damping * ws * state[s + 1]
            )


@njit(cache=True, error_model="numpy")
def _integrate(samples, sampling, fine, start, p, c):
    """Forces as measured and displacements at the samples, (samples, 4)."""
    modes = p.mass.shape[0]
    step = 1.0 / (sampling * fine)
    steps = (samples - 1) * fine
    u, v = np.zeros((steps + 2, 2)), np.zeros((steps + 2, 2))
    past = np.zeros((p.tooth_angle.shape[0] + 1, 3))
    force, measured = np.zeros(2), np.zeros(2)
    state, trial = start.copy(), start.copy()
    rate = np.zeros((4, state.shape[0]))
    out = np.zeros((samples, 4))
    for n in range(steps + 1):
        t = n * step
        u[n] = 0.0
        v[n] = 0.0
        for m in range(modes):
            for i in range(2):
                u[n, i] += p.direction[m, i] * state[2 * m]
                v[n, i] += p.direction[m, i] * state[2 * m + 1]
        _rates(t, state, step, n, u, v, p, c, past, force, measured, rate[0])
        if n % fine == 0:
            for i in range(2):
                shown = measured[i]
                if p.sensor_frequency > 0.0:
                    shown = state[2 * modes + 2 * i]
                out[n // fine, i] = shown
                out[n // fine, 2 + i] = u[n, i]
        for stage in range(1, 4):
            part = step if stage == 3 else 0.5 * step
            for i in range(state.shape[0]):
                trial[i] = state[i] + part * rate[stage - 1, i]
            _rates(t + part, trial, step, n, u, v, p, c, past, force, measured, rate[stage])
        for i in range(state.shape[0]):
            state[i] += step / 6.0 * (rate[0, i] + 2.0 * rate[1, i] + 2.0 * rate[2, i] + rate[3, i])
    return out


def arc_of(mode: str, radial_depth: float, radius: float) -> tuple[float, float]:
    """Entry and exit angle."""
    swept = float(np.arccos(np.clip(1.0 - radial_depth / radius, -1.0, 1.0)))
    return (0.0, swept) if mode == "up" else (np.pi - swept, np.pi)


def run(
    plant: Plant, cut: Cut, duration: float, start: Array | None = None, sampling: float = SAMPLING
) -> Record:
    """Signals of a cut that begins from rest (or from ``start``: q, q' of each mode)."""
    samples = round(duration * sampling) + 1
    turn = TURN / cut.speed
    fastest = max(float(plant.frequency.max()) * 1.2, plant.sensor_frequency)
    rubbing = plant.slide_friction / plant.slide_velocity / float(plant.mass.min())
    need = max(STEPS_A_TURN / turn, STEPS_A_VIBRATION * fastest, 1.5 * rubbing)
    fine = int(np.ceil(need / sampling))
    state = np.zeros(2 * len(plant.mass) + 4)
    if start is not None:
        state[: len(start)] = start
    out = _integrate(samples, sampling, fine, state, plant, cut)
    time = np.arange(samples) / sampling
    fx = out[:, 0] + plant.crosstalk_xy * out[:, 1]
    fy = out[:, 1] + plant.crosstalk_yx * out[:, 0]
    return Record(time, cut.speed * time, fx, fy, out[:, 2], out[:, 3])


def settles(record: Record, cut: Cut) -> bool:
    """Whether the displacement comes to repeat itself with the turn (stable), or grows small."""
    turn = TURN / cut.speed
    change = []
    size = 0.0
    for signal in (record.x, record.y):
        if not np.all(np.isfinite(signal)):
            return False
        earlier = np.interp(record.time - turn, record.time, signal)
        change.append((signal - earlier)[record.time > 1.05 * turn])
        size += float(np.var(signal[record.time > record.time[-1] - turn]))
    change = np.sqrt(np.sum(np.square(change), axis=0))
    part = max(1, len(change) // 4)
    early, late = (float(np.sqrt(np.mean(c**2))) for c in (change[:part], change[-part:]))
    level = np.sqrt(size) + 1e-9
    return late < 0.08 * level or (late < 0.4 * level and late < 0.3 * early)
