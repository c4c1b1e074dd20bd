"""Recordings of cuts whose spindle speed is stated wrong: no cut that chatters may be stable.

Teeth hit the work with a pulse each, of unequal height where the tool runs out; pulses and noise
shake a few modes; chatter is a limit cycle that sounds louder while a tooth cuts, which gives it
sidebands one tooth passing frequency apart. Nothing of the package makes the signals:

    python -m benchmarks.stated_speeds --seeds 3
"""

from __future__ import annotations

import argparse
import itertools
from collections import Counter
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import lfilter

from chatter.detection.spectral.recording import Recording
from chatter.monitoring.detect import detect

Array = NDArray[np.float64]

RATE, SECONDS = 10_000.0, 3.0  # Hz, s
FACTORS = (0.5, 0.8, 0.9, 1.0, 1.1, 1.2, 1.5, 2.0)
TEETH = (1, 2, 3, 4, 5, 6)
#: speed, rpm, and standard deviation of the heights of the teeth: from ground to badly set ones
SPEEDS, RUNOUTS = (1500.0, 12_000.0), (0.0, 0.05, 0.3)
#: frequencies, Hz, and damping ratios of what rings
MODES = ((430.0, 0.04), (1080.0, 0.03), (2300.0, 0.02))
#: share of a tooth period that a tooth cuts, duration of its pulse over the period
_IMMERSION, _PULSE = 0.4, 0.15
NOISE = 0.1
#: part of a revolution that chatter is off the harmonics: on them no spectrum shows it
OFF = (0.15, 0.85)


class Cut(NamedTuple):
    """A cut as it truly is."""

    revolution: float  # Hz
    teeth: int
    runout: float
    chatter: float  # power of chatter over that of the teeth; 0 for a stable cut

    def record(self, random: Generator) -> Recording:
        """What a microphone hears of it."""
        time = np.arange(int(SECONDS * RATE)) / RATE
        values = self._teeth(random, time)
        if self.chatter > 0.0:
            values = values + np.sqrt(self.chatter) * self._chatter(random, time)
        values = values + NOISE * random.standard_normal(time.size)
        return Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])

    def _teeth(self, random: Generator, time: Array) -> Array:
        """Pulses of the teeth through the modes, of unit power."""
        heights = 1.0 + self.runout * random.standard_normal(self.teeth)
        passed = time * self.revolution * self.teeth
        tooth, phase = np.divmod(passed, 1.0)
        pulse = np.where(phase < _PULSE, np.sin(np.pi * phase / _PULSE) ** 2, 0.0)
        force = heights[tooth.astype(int) % self.teeth] * pulse
        force = force - force.mean() + 0.03 * random.standard_normal(time.size)
        signal = sum((_through(force, *mode) for mode in MODES), 2.0 * _unit(force))
        return _unit(signal)

    def _chatter(self, random: Generator, time: Array) -> Array:
        """A limit cycle near a mode, off the harmonics, of unit power."""
        order = np.floor(random.choice(MODES)[0] * random.uniform(1.0, 1.1) / self.revolution)
        frequency = (order + random.uniform(*OFF)) * self.revolution
        tooth = self.revolution * self.teeth
        cutting = ((time * tooth) % 1.0 < _IMMERSION).astype(float)
        smooth = lfilter([0.2], [1.0, -0.8], random.standard_normal(time.size))
        slow = np.interp(time, np.linspace(0.0, SECONDS, 25), random.standard_normal(25))
        phase = 2.0 * np.pi * frequency * time + 0.05 * np.cumsum(smooth) / np.sqrt(RATE)
        return _unit((1.0 + 0.1 * slow) * (0.6 + 0.8 * cutting) * np.cos(phase))


def _through(force: Array, frequency: float, damping: float) -> Array:
    pole = 2.0 * np.pi * frequency / RATE
    radius = np.exp(-damping * pole)
    return _unit(lfilter([1.0], [1.0, -2.0 * radius * np.cos(pole), radius**2], force))


def _unit(signal: Array) -> Array:
    return signal / signal.std()


def cuts(random: Generator) -> list[tuple[Cut, str]]:
    """A cut of each number of teeth and runout, stable and chattering, at speeds by chance."""
    return [
        (Cut(random.uniform(*SPEEDS) / 60.0, teeth, runout, chatter), verdict)
        for teeth, runout in itertools.product(TEETH, RUNOUTS)
        for chatter, verdict in ((0.0, "stable"), (random.uniform(1.5, 6.0), "chatter"))
    ]


def survey_arguments(description: str) -> argparse.Namespace:
    """Arguments of a survey of seeds; its description is the first line of a docstring."""
    parser = argparse.ArgumentParser(description=description.split("\n", 1)[0])
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--each", action="store_true", help="print each that is wrong")
    return parser.parse_args()


def main() -> None:
    """Print how often which verdict is given, by factor and by what is true."""
    given = survey_arguments(__doc__)
    counts: Counter[tuple[float, str, str]] = Counter()
    for seed in range(given.first, given.first + given.seeds):
        random = np.random.default_rng(seed)
        for number, (cut, true) in enumerate(cuts(random)):
            recording = cut.record(random)
            for factor in FACTORS:
                stated = f"{60.0 * factor * cut.revolution} rpm"
                found = detect(recording, stated, cut.teeth)
                counts[factor, true, found.verdict] += 1
                if given.each and found.verdict not in (true, "not judged"):
                    print(seed, number, factor, true, found.verdict, cut, *found.notes, flush=True)
    print(f"{'stated':>7} {'true':>8}   verdicts")
    for factor, true in itertools.product(FACTORS, ("stable", "chatter")):
        of = {v: n for (f, t, v), n in sorted(counts.items()) if (f, t) == (factor, true)}
        print(f"{factor:7.2f} {true:>8}   {of}")


if __name__ == "__main__":
    main()
