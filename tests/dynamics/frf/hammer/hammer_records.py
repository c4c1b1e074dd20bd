"""Made hammer records for tests: exact modal response to hits, sensor noise, injected faults."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import cont2discrete, lfilter

from dynamics.frf.hammer.record import HammerRecord

SAMPLING_RATE = 25600.0
OVERSAMPLING = 8


@dataclass(frozen=True)
class Structure:
    """Modes as (frequency Hz, damping ratio, modal mass kg) at a drive point."""

    modes: tuple[tuple[float, float, float], ...]

    def accelerance(self, frequency):
        omega = 2 * np.pi * np.asarray(frequency)
        return sum(
            -(omega**2) / (m * ((2 * np.pi * f) ** 2 - omega**2 + 4j * np.pi * z * f * omega))
            for f, z, m in self.modes
        )


#: three modes, two of them close
CLOSE = Structure(((660.0, 0.018, 0.57), (700.0, 0.029, 1.03), (1479.0, 0.021, 0.21)))


@dataclass(frozen=True)
class Hit:
    """One blow: start s, duration s, peak N, and exponent of sin (1 half-sine, 2 smooth)."""

    start: float
    duration: float
    peak: float
    exponent: float = 2.0

    def force(self, time):
        phase = (time - self.start) / self.duration
        inside = (phase > 0) & (phase < 1)
        return np.where(
            inside, self.peak * np.sin(np.pi * np.clip(phase, 0, 1)) ** self.exponent, 0.0
        )


def random_structure(rng: np.random.Generator) -> Structure:
    """Three modes from 300 to 3000 Hz, two of them 2 to 8 % apart, damping 1 to 4 %."""
    low = rng.uniform(300.0, 1500.0)
    third = low * rng.uniform(1.5, 2.5) if rng.random() < 0.7 else low / rng.uniform(1.5, 2.5)
    frequencies = (low, low * rng.uniform(1.02, 1.08), float(np.clip(third, 250.0, 3000.0)))
    return Structure(
        tuple((f, rng.uniform(0.01, 0.04), rng.uniform(0.2, 1.2)) for f in frequencies)
    )


def response_to(
    structure: Structure, hits: Sequence[Hit], samples: int, rate: float = SAMPLING_RATE
):
    """Sampled force and acceleration; the modal response is exact for a force linear between
    points eight times as dense as the samples."""
    step = 1.0 / (rate * OVERSAMPLING)
    time = np.arange(samples * OVERSAMPLING) * step
    force = sum(hit.force(time) for hit in hits)
    acceleration = np.zeros_like(force)
    for frequency, damping, mass in structure.modes:
        natural = 2 * np.pi * frequency
        numerator, denominator, _ = cont2discrete(
            ([1.0 / mass, 0.0, 0.0], [1.0, 2 * damping * natural, natural**2]), step, method="foh"
        )
        acceleration += lfilter(np.ravel(numerator), denominator, force)
    return force[::OVERSAMPLING].copy(), acceleration[::OVERSAMPLING].copy()


@dataclass(frozen=True)
class Noise:
    """Sensor imperfections, each as a share of the channel's own peak."""

    force: float = 0.0015
    response: float = 0.002
    offset: float = 0.0
    hum: float = 0.0
    bits: int = 0

    def on(self, rng, signal, level, time):
        peak = np.max(np.abs(signal))
        noisy = signal + level * peak * rng.standard_normal(signal.size)
        noisy += self.offset * peak * rng.uniform(-1, 1)
        noisy += self.hum * peak * np.sin(2 * np.pi * 50.0 * time + rng.uniform(0, 6.28))
        if self.bits:
            step = 2.0 * 1.5 * peak / 2**self.bits
            noisy = np.round(noisy / step) * step
        return noisy


def random_hit(rng: np.random.Generator) -> Hit:
    return Hit(
        start=rng.uniform(0.006, 0.014),
        duration=rng.uniform(0.0004, 0.0009),
        peak=rng.uniform(80.0, 450.0),
        exponent=rng.choice([1.5, 2.0, 2.5]),
    )


def record_of(
    rng: np.random.Generator,
    structure: Structure,
    hits: Sequence[Hit],
    noise: Noise,
    name: str,
    samples: int = 12800,
    gain: float = 1.0,
) -> HammerRecord:
    force, response = response_to(structure, hits, samples)
    time = np.arange(samples) / SAMPLING_RATE
    return HammerRecord(
        name=name,
        sampling_rate=SAMPLING_RATE,
        force=np.round(noise.on(rng, force, noise.force, time), 3),
        response=np.round(gain * noise.on(rng, response, noise.response, time), 4),
        quantity="accelerance",
    )


# ---------------------------------------------------------------------------- faults


@dataclass(frozen=True)
class Made:
    """A record with what was done to it."""

    record: HammerRecord
    fault: str = ""
    severity: str = ""


Fault = Callable[[np.random.Generator, Structure, Hit, Noise, str], Made]


def _log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _channel(rng, record):
    return "force" if rng.random() < 0.5 else "response"


def _hit_end(hit):
    return int(np.ceil((hit.start + hit.duration) * SAMPLING_RATE))


def double_hit(rng, structure, hit, noise, name) -> Made:
    share = _log_uniform(rng, 0.05, 0.9)
    delay = _log_uniform(rng, 0.0015, 0.08)
    second = Hit(hit.start + hit.duration + delay, rng.uniform(0.0004, 0.0009), share * hit.peak)
    return Made(
        record_of(rng, structure, [hit, second], noise, name),
        "double_hit",
        f"share {share:.3f} after {delay * 1e3:.1f} ms",
    )


def clipped(rng, structure, hit, noise, name) -> Made:
    record = record_of(rng, structure, [hit], noise, name)
    channel = _channel(rng, record) if rng.random() < 0.4 else "response"
    signal = getattr(record, channel).copy()
    share = rng.uniform(0.3, 0.93)
    limit = share * np.max(np.abs(signal))
    low = -limit if rng.random() < 0.8 or np.max(signal) < 1.05 * limit else -np.inf
    signal = np.clip(signal, low, limit)
    style = rng.random()
    if style < 0.2:  # the noise comes behind the stage that clips
        peak = np.max(np.abs(signal))
        signal = signal + 0.0005 * peak * rng.standard_normal(signal.size)
    return Made(
        replace(record, **{channel: np.round(signal, 4)}),
        "clipped",
        f"{channel} at {share:.2f}{' noisy top' if style < 0.2 else ''}",
    )


def dropout(rng, structure, hit, noise, name) -> Made:
    record = record_of(rng, structure, [hit], noise, name)
    channel = "response" if rng.random() < 0.7 else "force"
    signal = getattr(record, channel).copy()
    peak = np.max(np.abs(signal))
    length = int(rng.integers(1, 6))
    start = int(rng.integers(_hit_end(hit) + 40, signal.size - 50))
    style = rng.choice(["rail", "spike", "zero"], p=[0.4, 0.4, 0.2])
    if style == "zero":  # lost samples where there is something to lose
        length = int(rng.integers(3, 30))
        start = _hit_end(hit) + int(rng.integers(0, 200))
        channel, signal = "response", record.response.copy()
        signal[start : start + length] = 0.0
        share = 0.0
    else:
        share = _log_uniform(rng, 0.06, 1.8) * rng.choice([-1.0, 1.0])
        added = 0.0 if style == "rail" else signal[start : start + length]
        signal[start : start + length] = added + share * peak
    at = (start - hit.start * SAMPLING_RATE) / SAMPLING_RATE
    return Made(
        replace(record, **{channel: signal}),
        "dropout",
        f"{channel} {style} {share:.2f} x{length} {at * 1e3:.0f} ms after the hit",
    )


def drift(rng, structure, hit, noise, name) -> Made:
    record = record_of(rng, structure, [hit], noise, name)
    channel = "response" if rng.random() < 0.75 else "force"
    signal = getattr(record, channel).copy()
    peak = np.max(np.abs(signal))
    size = _log_uniform(rng, 0.02, 0.6) * rng.choice([-1.0, 1.0])
    x = record.time / record.time[-1]
    style = rng.choice(["ramp", "exponential", "step", "decaying", "wave"])
    shape = {
        "ramp": x,
        "exponential": 1 - np.exp(-x / rng.uniform(0.1, 0.6)),
        "step": (x > rng.uniform(0.05, 0.9)) * 1.0,
        "decaying": np.where(x > 0.03, np.exp(-(x - 0.03) / rng.uniform(0.1, 0.5)), 0.0),
        "wave": np.sin(np.pi * x) ** 2,
    }[style]
    return Made(
        replace(record, **{channel: signal + size * peak * shape}),
        "drift",
        f"{channel} {style} {size:.3f}",
    )


def wrong_gain(rng, structure, hit, noise, name) -> Made:
    factor = rng.choice([0.1, 0.5, 2.0, 9.80665, rng.uniform(0.6, 0.92), rng.uniform(1.08, 1.6)])
    record = record_of(rng, structure, [hit], noise, name)
    channel = _channel(rng, record)
    return Made(
        replace(record, **{channel: factor * getattr(record, channel)}),
        "wrong_gain",
        f"{channel} {factor:.3f}",
    )


def polarity(rng, structure, hit, noise, name) -> Made:
    record = record_of(rng, structure, [hit], noise, name)
    channel = _channel(rng, record)
    return Made(replace(record, **{channel: -getattr(record, channel)}), "wrong_gain", "sign")


def stuck(rng, structure, hit, noise, name) -> Made:
    record = record_of(rng, structure, [hit], noise, name)
    channel = "response" if rng.random() < 0.8 else "force"
    signal = getattr(record, channel).copy()
    length = int(_log_uniform(rng, 8, 1500))
    if channel == "response" and rng.random() < 0.7:
        start = _hit_end(hit) + int(rng.integers(-10, 400))
    else:
        start = int(rng.integers(_hit_end(hit), signal.size - length - 1))
    signal[start : start + length] = signal[start]
    return Made(
        replace(record, **{channel: signal}),
        "stuck",
        f"{channel} {length} samples {(start - _hit_end(hit)) / 25.6:.0f} ms after the hit",
    )


def skew(rng, structure, hit, noise, name) -> Made:
    shift = int(rng.choice([-1, 1]) * round(_log_uniform(rng, 1, 60)))
    record = record_of(rng, structure, [hit], noise, name)
    channel = _channel(rng, record)
    return Made(
        replace(record, **{channel: np.roll(getattr(record, channel), shift)}),
        "skew",
        f"{channel} {shift} samples",
    )


def late_bump(rng, structure, hit, noise, name) -> Made:
    record = record_of(rng, structure, [hit], noise, name)
    peak = np.max(np.abs(record.response))
    size = _log_uniform(rng, 0.04, 0.8)
    at = _log_uniform(rng, 0.02, 0.44)
    style = rng.choice(["elsewhere", "pulse", "slow"])
    if style == "elsewhere":  # struck at another place: the same modes, other shares
        other = Structure(
            tuple(
                (f, z, m * rng.choice([-1, 1]) * rng.uniform(0.5, 3)) for f, z, m in structure.modes
            )
        )
        blow = Hit(hit.start + at, rng.uniform(0.0005, 0.002), 1.0)
        _, bump = response_to(other, [blow], record.response.size)
    else:
        width = rng.uniform(0.0008, 0.003) if style == "pulse" else rng.uniform(0.003, 0.03)
        bump = Hit(hit.start + at, width, 1.0).force(record.time)
        if style == "slow":
            bump = bump * np.sin(2 * np.pi * rng.uniform(100, 600) * record.time)
    bump = bump / np.max(np.abs(bump)) * size * peak
    return Made(
        replace(record, response=record.response + bump),
        "late_bump",
        f"{style} {size:.3f} {at * 1e3:.0f} ms after the hit",
    )


def no_coherence(rng, structure, hit, noise, name) -> Made:
    record = record_of(rng, structure, [hit], noise, name)
    peak, rms = np.max(np.abs(record.response)), np.std(record.response)
    style = rng.choice(["noise", "decaying", "added", "dead", "other"])
    white = rng.standard_normal(record.response.size)
    after = np.clip(record.time - hit.start, 0, None)
    share = _log_uniform(rng, 0.08, 1.0)
    response = {
        "noise": white * rms,
        "decaying": white * peak / 3 * np.exp(-after * 100.0) * (after > 0) + 0.002 * peak * white,
        "added": record.response + share * peak * white,
        "dead": 0.003 * peak * white,
        "other": record.response,
    }[style]
    if style == "other":
        other = record_of(rng, random_structure(rng), [hit], noise, name)
        response = other.response * peak / np.max(np.abs(other.response))
    detail = f" {share:.3f}" if style == "added" else ""
    return Made(replace(record, response=response), "no_coherence", f"{style}{detail}")


FAULTS: dict[str, Fault] = {
    "double_hit": double_hit,
    "clipped": clipped,
    "dropout": dropout,
    "drift": drift,
    "wrong_gain": wrong_gain,
    "polarity": polarity,
    "stuck": stuck,
    "skew": skew,
    "late_bump": late_bump,
    "no_coherence": no_coherence,
}


def random_noise(rng: np.random.Generator, *, sensors: str = "white") -> Noise:
    """Noise of a set; ``"real"`` adds offsets, mains hum and the steps of a converter."""
    level = _log_uniform(rng, 0.5, 4.0)
    noise = Noise(0.0015 * level, 0.002 * level * rng.uniform(0.7, 1.4))
    if sensors == "real":
        noise = replace(
            noise,
            offset=rng.uniform(0, 0.01),
            hum=rng.uniform(0, 0.002),
            bits=int(rng.choice([0, 16, 24])),
        )
    return noise


def random_set(
    rng: np.random.Generator,
    *,
    faults: Sequence[str] | None = None,
    sensors: str = "white",
    scatter: float = 0.0,
    count: int | None = None,
) -> tuple[Structure, list[Made]]:
    """Six to nine records of one structure, none to three of them faulty.

    Parameters
    ----------
    faults : sequence of str, optional
        Which faults to inject; none to three at random where not given.
    sensors : str
        ``"white"`` noise alone, or ``"real"`` sensors.
    scatter : float
        Standard deviation of the gain from record to record (an unsteady hand).
    count : int, optional
        Number of records.
    """
    structure = random_structure(rng)
    noise = random_noise(rng, sensors=sensors)
    count = int(rng.integers(6, 10)) if count is None else count
    if faults is None:
        faults = rng.choice(list(FAULTS), size=rng.integers(0, 4))
    which = dict(zip(rng.permutation(count)[: len(faults)], faults, strict=True))
    made = []
    for index in range(count):
        hit, name = random_hit(rng), f"tap{index + 1:02d}.csv"
        if index in which:
            made.append(FAULTS[which[index]](rng, structure, hit, noise, name))
        else:
            gain = 1.0 + scatter * rng.standard_normal()
            made.append(Made(record_of(rng, structure, [hit], noise, name, gain=gain)))
    return structure, made
