"""Scatter of FRFs that were measured again and again, against the one that made them."""

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement import Measurement, Run

CASE = """
[tool]
teeth = 2
diameter = "12 mm"
[[structure.mode]]
frequency = "568 Hz"
damping = 0.025
mass = "1.18 kg"
direction = [1, 0, 0]
"""
LINES = np.arange(30.0, 1700.0, 3.6)


def receptance():
    omega, own = 2.0 * np.pi * LINES, 2.0 * np.pi * 568.0
    return 1.0 / 1.18 / (own**2 - omega**2 + 2j * 0.025 * own * omega)


def prepared(scatter, repetitions, seed):
    """Measurement of repetitions that scatter by so much in real and imaginary part."""
    random, exact, runs = np.random.default_rng(seed), receptance(), []
    for number in range(repetitions):
        noise = random.standard_normal((2, LINES.size)) * scatter
        signals = {"frequency": LINES, "real": exact.real + noise[0], "imag": exact.imag + noise[1]}
        runs.append(Run(f"x{number}", {}, signals, condition="idle", direction="x"))
    case = loads(CASE)
    return KINDS["frf"].prepared(Measurement("frf", "taps", case.folder, case, tuple(runs), {}))


@pytest.mark.parametrize(("floor", "share"), [(0.005, 0.0), (0.0, 0.02), (0.003, 0.05)])
@pytest.mark.parametrize("repetitions", [2, 4])
def test_scatter_is_that_of_a_sensor_a_share_of_the_response_or_both(floor, share, repetitions):
    """Taken as a share alone, that of a sensor was a third of what is true at the band's end."""
    exact = np.abs(receptance())
    scatter = np.hypot(floor * exact.max(), share * exact)
    levels = []
    for seed in range(20):
        for run in prepared(scatter, repetitions, seed).runs:
            real = (run.signals["real"] - receptance().real) / run.record.scatter
            levels.append([np.sqrt(np.mean(part**2)) for part in np.array_split(real, 4)])
    # of each quarter of the band, on the average; and of none by far
    assert np.mean(levels, axis=0) == pytest.approx(1.0, abs=0.12)
    assert np.max(levels) < 1.7
