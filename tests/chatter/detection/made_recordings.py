"""Recordings with known truth, summed from lines and noise: nothing of the package makes them."""

import numpy as np
from scipy.signal import lfilter

RATE = 10_000.0
NOISE = 0.1


def clock(duration):
    return np.arange(int(duration * RATE)) / RATE


def forced_cut(random, time, revolution, teeth, runout=0.2, mode=900.0, damping=0.03):
    """Impacts of unequal teeth through a mode: lines at the harmonics of the spindle alone."""
    heights = 1.0 + runout * random.standard_normal(teeth)
    signal = np.zeros_like(time)
    for order in range(1, int(0.4 * RATE / revolution)):
        frequency = order * revolution
        line = np.sum(heights * np.exp(-2j * np.pi * order * np.arange(teeth) / teeth))
        line *= np.exp(-((order / (6.0 * teeth)) ** 2))
        ratio = frequency / mode
        line *= 0.3 + 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)
        signal += np.real(line * np.exp(2j * np.pi * frequency * time))
    return signal / signal.std()


def chatter_line(random, time, frequency, tooth, depth=0.3):
    """A line that wanders in amplitude, with sidebands one tooth passing frequency apart."""
    knots = np.linspace(time[0], time[-1], max(int(10 * time[-1]), 4))
    wander = 1.0 + 0.15 * np.interp(time, knots, random.standard_normal(knots.size))
    modulation = 1.0 + depth * np.cos(2.0 * np.pi * tooth * time + 0.5)
    modulation += 0.5 * depth * np.cos(4.0 * np.pi * tooth * time + 1.0)
    signal = wander * modulation * np.cos(2.0 * np.pi * frequency * time)
    return signal / signal.std()


def ringing(random, time, mode, damping):
    """Noise through a lightly damped mode: a structure that the cut shakes."""
    pole = 2.0 * np.pi * mode / RATE
    radius = np.exp(-damping * pole)
    signal = lfilter(
        [1.0], [1.0, -2.0 * radius * np.cos(pole), radius**2], random.standard_normal(time.size)
    )
    return signal / signal.std()


def machine(random, time, revolution):
    """Hum, a pump and an inverter at steady frequencies, unbalance."""
    lines = (50.0, 100.0, 150.0, 387.3, 1212.7, 3021.0, revolution, 2.0 * revolution)
    signal = sum(
        random.uniform(0.3, 1.0) * np.cos(2.0 * np.pi * f * time + random.uniform(0.0, 6.0))
        for f in lines
    )
    return signal / signal.std()


def noise(random, time, size=NOISE):
    return size * random.standard_normal(time.size)


def during(time, begin, end, rise=0.05):
    """1 from begin to end, 0 elsewhere."""
    return np.clip((time - begin) / rise, 0.0, 1.0) * np.clip((end - time) / rise, 0.0, 1.0)
