"""Survey of `chatter detect`: false alarms on idle and stable recordings, chatter that is missed.

Cuts of a face mill, an indexable cutter and end mills by a regenerative model of two modes along
x and y with runout and loss of contact, integrated here: nothing of the package makes them. What
chatters is told by the scatter of the once-per-revolution positions without noise. A recording has
noise, lines of the machine, unbalance, air before and after, entry and exit; some have a spindle
that runs up. Each is judged as it is, at another gain, resampled and cropped, with the speed stated
right, one and two per cent off, and not at all:

    python -m benchmarks.false_alarms --seeds 2 --first 100
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import resample_poly

from benchmarks.stated_speeds import survey_arguments
from chatter.detection.spectral.recording import Recording
from chatter.monitoring.detect import detect

Array = NDArray[np.float64]

RATE, CUT = 20_000.0, 3.0  # Hz, s
#: scatter of the once-per-revolution positions over the vibration: of chatter, and of a stable cut,
#: which scatters as teeth enter between two steps
_CHATTERS, _STABLE = 0.3, 0.1
#: earlier passes that may have left the surface, of a tooth that was out of the cut
_PASSES = 10
#: stated speed over the true one; nan: none is stated
STATED = (1.0, 0.98, 0.99, 1.01, 1.02, math.nan)


class Cutter(NamedTuple):
    """A cutter, and the range of its spindle speeds, rpm, and of its modes, Hz."""

    name: str
    teeth: tuple[int, ...]
    speeds: tuple[float, float]
    modes: tuple[float, float]


CUTTERS = (
    Cutter("6-tooth face mill", (6,), (500.0, 2500.0), (250.0, 1200.0)),
    Cutter("25 mm indexable cutter", (2,), (1500.0, 6000.0), (400.0, 1500.0)),
    Cutter("half-inch end mill", (2, 3, 4, 5), (2000.0, 9000.0), (700.0, 2500.0)),
)


@njit(error_model="numpy")
def _vibration(
    steps, step, turn, teeth, entry, leave, runout, gain, radial, omega, damping, unit, force_noise
):  # pragma: no cover - compiled
    """Positions (n, 2) of a tool of one mode along x and one along y, semi-implicit Euler."""
    found = np.zeros((steps, 2))
    position, velocity = np.zeros(2), np.zeros(2)
    delay = round(2.0 * np.pi / (teeth * turn * step))
    ramp = 0.05 / step
    for now in range(steps):
        force = np.zeros(2)
        grip = min(now / ramp, 1.0)
        for tooth in range(teeth):
            angle = (turn * now * step + 2.0 * np.pi * tooth / teeth) % (2.0 * np.pi)
            if not entry < angle < leave:
                continue
            sine, cosine = np.sin(angle), np.cos(angle)
            chip = np.inf
            for passes in range(1, _PASSES + 1):  # the thinnest over all earlier passes
                earlier = now - passes * delay
                before = found[earlier] if earlier >= 0 else np.zeros(2)
                chip = min(
                    chip,
                    passes * unit * sine
                    + runout[tooth]
                    - runout[(tooth - passes) % teeth]
                    + (position[0] - before[0]) * sine
                    + (position[1] - before[1]) * cosine,
                )
            if chip <= 0.0:
                continue
            tangential = gain * grip * chip * (1.0 + force_noise[now])
            force[0] += -tangential * cosine - radial * tangential * sine
            force[1] += tangential * sine - radial * tangential * cosine
        for axis in range(2):
            acceleration = (
                force[axis]
                - 2.0 * damping[axis] * omega[axis] * velocity[axis]
                - omega[axis] ** 2 * position[axis]
            )
            velocity[axis] += step * acceleration
            position[axis] += step * velocity[axis]
        found[now] = position
    return found


class Made(NamedTuple):
    """A recording and its truth."""

    recording: Recording
    verdict: str  # "chatter", "stable" or "idle"
    revolution: float  # Hz, at the end of a run up
    teeth: int
    frequency: float  # Hz, of chatter; nan without
    name: str


def cut(random: Generator, cutter: Cutter) -> Made | None:
    """A cut of random depth; None where it is neither stable nor chatters clearly."""
    teeth = int(random.choice(cutter.teeth))
    revolution = random.uniform(*cutter.speeds) / 60.0
    modes = random.uniform(*cutter.modes, size=2)
    omega = 2.0 * np.pi * modes
    immersion = random.uniform(0.2, 0.7) * math.pi
    arc = (math.pi - immersion, math.pi) if random.uniform() < 0.7 else (0.0, immersion)
    # tangential stiffness over the mass, in the square of the natural frequency
    gain = random.choice((0.05, 0.2, 1.2, 2.4)) / teeth * float(omega.min()) ** 2
    damping = random.uniform(0.015, 0.05, size=2)
    feed = 1e-4
    runout = 0.2 * feed * random.standard_normal(teeth) * random.choice((0.1, 1.0))
    turn, oversampling = 2.0 * math.pi * revolution, 2
    step = 1.0 / (RATE * oversampling)
    steps = int(CUT / step)

    def vibration(noise: Array) -> Array:
        return _vibration(
            steps, step, turn, teeth, *arc, runout, gain, 0.4, omega, damping, feed, noise
        )

    exact = vibration(np.zeros(steps))
    if not np.all(np.isfinite(exact)) or np.abs(exact).max() > 30.0 * feed:
        return None
    late = exact[steps // 2 :]
    at = np.arange(0.0, len(late) - 1.0, 1.0 / (revolution * step))
    sections = [np.interp(at, np.arange(len(late)), axis).std() for axis in late.T]
    scatter = float(max(sections) / late.std(axis=0).max())
    if _STABLE < scatter < _CHATTERS:
        return None
    position = vibration(0.1 * random.standard_normal(steps))[::oversampling]
    frequency = _off_harmonics(exact[steps // 2 :: oversampling], revolution)
    verdict = "chatter" if scatter >= _CHATTERS else "stable"
    heard = np.gradient(np.gradient(position[:, int(random.integers(2))]))
    recording = _recorded(random, heard / heard.std(), revolution)
    return Made(recording, verdict, revolution, teeth, frequency, cutter.name)


def _off_harmonics(position: Array, revolution: float) -> float:
    """Largest line of the acceleration off the harmonics of the spindle, Hz."""
    signal = np.gradient(np.gradient(position, axis=0), axis=0) * np.hanning(len(position))[:, None]
    power = np.sum(np.abs(np.fft.rfft(signal, axis=0)) ** 2, axis=1)
    frequency = np.fft.rfftfreq(len(position), 1.0 / RATE)
    apart = np.abs(frequency - np.round(frequency / revolution) * revolution)
    free = apart > 3.0 * RATE / len(position)
    return float(frequency[np.argmax(np.where(free, power, 0.0))])


def _machine(random: Generator, count: int, revolution: Array) -> Array:
    """Noise, hum, a pump, an inverter, and unbalance of a spindle of some speed, Hz, (n,)."""
    time = np.arange(count) / RATE
    angle = 2.0 * np.pi * np.cumsum(revolution) / RATE
    found = random.standard_normal(count)
    for line in (50.0, 150.0, random.uniform(200.0, 600.0), random.uniform(800.0, 3000.0)):
        found += random.uniform(0.2, 1.5) * np.cos(2.0 * np.pi * line * time + random.uniform(0, 6))
    for order in (1, 2, random.integers(3, 9)):
        found += random.uniform(0.2, 1.0) * np.cos(order * angle)
    return found / found.std()


def _recorded(random: Generator, heard: Array, revolution: float) -> Recording:
    """A cut with air before and after, in half of them, and the machine beside it."""
    air = int(0.8 * RATE) if random.uniform() < 0.5 else 0
    cutting = np.concatenate([np.zeros(air), heard, np.zeros(air)])
    machine = _machine(random, cutting.size, np.full(cutting.size, revolution))
    return _of(cutting + random.choice((0.05, 0.2, 0.5)) * machine)


def _of(values: Array) -> Recording:
    return Recording("made", 1.0 / RATE, ("a",), ("acceleration",), values[:, None])


def idle(random: Generator, cutter: Cutter) -> Made:
    """A spindle in the air, of which every second one runs up first."""
    revolution = random.uniform(*cutter.speeds) / 60.0
    speed = np.full(int(CUT * RATE), revolution)
    if random.uniform() < 0.5:
        speed *= np.clip(np.arange(speed.size) / RATE / random.uniform(0.5, 2.0), 0.05, 1.0)
    recording = _of(_machine(random, speed.size, speed))
    teeth = int(random.choice(cutter.teeth))
    return Made(recording, "idle", revolution, teeth, math.nan, f"idle, {cutter.name}")


def versions(random: Generator, recording: Recording) -> list[Recording]:
    """The recording, the same at another gain, resampled, and cropped at both ends."""
    values = recording.values
    first, last = int(random.uniform(0.0, 0.4) * len(values)), len(values)
    last -= int(random.uniform(0.0, 0.3) * last)
    resampled = resample_poly(values, 12, 25)
    return [
        recording,
        replace(recording, values=10.0 ** random.uniform(-4.0, 4.0) * values),
        replace(recording, values=resampled, time_step=recording.time_step * 25.0 / 12.0),
        replace(recording, values=values[first:last]),
    ]


def main() -> None:
    """Print which verdict is given how often, by what is true and by how the speed is stated."""
    given = survey_arguments(__doc__)
    counts: Counter[tuple[str, str, str]] = Counter()
    apart = []
    for seed in range(given.first, given.first + given.seeds):
        random = np.random.default_rng(seed)
        made = [cut(random, cutter) for cutter in CUTTERS for _ in range(4)]
        made += [idle(random, cutter) for cutter in CUTTERS]
        for one in filter(None, made):
            for number, recording in enumerate(versions(random, one.recording)):
                factor = float(random.choice(STATED))
                speed = None if math.isnan(factor) else f"{60.0 * factor * one.revolution} rpm"
                found = detect(recording, speed, one.teeth)
                counts[one.verdict, _stated(factor), found.verdict] += 1
                if one.verdict == found.verdict == "chatter":
                    apart.append(_apart(found.chatter_frequency, one))
                is_wrong = {one.verdict, found.verdict} >= {"chatter"} and (
                    found.verdict not in (one.verdict, "not judged")
                )
                if given.each and is_wrong:
                    print(seed, one.name, one.verdict, found.headline, number, factor,
                          round(one.revolution, 2), one.teeth, one.frequency,
                          found.chatter_frequency, *found.notes, flush=True)  # fmt: skip
    for (true, stated, verdict), number in sorted(counts.items()):
        print(f"{true:>8}  {stated:>12}  {verdict:>10}  {number}")
    number = sum(one < 0.01 for one in apart)
    print(f"the chatter frequency or a sideband of it within 1 %: {number} of {len(apart)}")


def _apart(found: float, made: Made) -> float:
    """Relative difference of a frequency from that of chatter, or a sideband next to it.

    In an acceleration along one axis a sideband may be larger than in the position of the tool.
    """
    difference = (found - made.frequency) / made.revolution
    return abs(difference - round(difference)) * made.revolution / made.frequency


def _stated(factor: float) -> str:
    if math.isnan(factor):
        return "not stated"
    return "right" if factor == 1.0 else f"{abs(factor - 1.0):.0%} off"


if __name__ == "__main__":
    main()
