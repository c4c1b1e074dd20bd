"""Multipliers of stable cuts against motion whose multipliers are known."""

import math

import numpy as np
import pytest

from chatter import InputError
from chatter.description.case import loads
from chatter.explain.stability_margin import CuttingTests, response_of_tests
from chatter.learning.learn import learn
from chatter.learning.stable_cuts import multiplier_of

SAMPLING = 5000.0


def excited(multiplier: complex, periods: int, samples: int, seed: int) -> np.ndarray:
    """Motion of a multiplier, kicked once a period, with forced vibration and noise on top."""
    random = np.random.default_rng(seed)
    shape = np.exp(np.linspace(0.0, np.log(multiplier), samples, endpoint=False))
    state, parts = 0.0 + 0.0j, []
    for _ in range(periods):
        state = multiplier * state + random.normal() + 1j * random.normal()
        parts.append((shape * state).real)
    motion = np.concatenate(parts)
    phase = 2.0 * math.pi * np.arange(motion.size) / samples
    # runout repeats with the revolution of two teeth
    forced = 20.0 * np.cos(phase) + 8.0 * np.cos(0.5 * phase + 0.4)
    return motion + forced + 0.3 * random.standard_normal(motion.size)


@pytest.mark.parametrize(("magnitude", "angle"), [(0.9, 2.0), (0.7, 0.8), (0.8, math.pi)])
def test_the_multiplier_of_excited_motion_is_found(magnitude, angle):
    samples = 40
    signal = excited(magnitude * np.exp(1j * angle), 3000, samples, 1)
    found = multiplier_of(signal, SAMPLING, samples / SAMPLING, 2)
    assert found.magnitude == pytest.approx(magnitude, abs=4.0 * found.deviation)
    assert found.angle == pytest.approx(angle, abs=0.08)
    assert found.deviation == pytest.approx(math.sqrt((1.0 - magnitude**2) / 3000), rel=0.2)


CASE = """
[tool]
kind = "end mill"
teeth = 2
diameter = "16 mm"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "240 MPa"
[cut]
mode = "down"
spindle_speed = "8200 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "0.7 mm"
radial_depth = "8 mm"
[[structure.mode]]
frequency = "900 Hz"
damping = 0.02
stiffness = "6 N/um"
direction = [0, 1, 0]
"""


def cut_with_noise(depth: float, periods: int) -> tuple[np.ndarray, float, float]:
    """Motion (n,) of the cut above under random forces, by small exact steps of its own."""
    period, steps = 60.0 / 8200.0 / 2.0, 100
    h, w, ratio, mass = period / steps, 2.0 * math.pi * 900.0, 0.02, 6e6 / (1800.0 * math.pi) ** 2
    damped = w * math.sqrt(1.0 - ratio**2)
    decay, c, s = math.exp(-ratio * w * h), math.cos(damped * h), math.sin(damped * h)
    free = decay * np.array(
        [
            [c + ratio * w / damped * s, s / damped],
            [-(w**2) / damped * s, c - ratio * w / damped * s],
        ]
    )
    push = np.array([(1.0 - free[0, 0]) / w**2, -free[1, 0] / w**2]) / mass
    # down-milling at half immersion: from 90 to 180 degrees; the next tooth after half a turn
    angle = (np.arange(steps) + 0.5) / steps * math.pi
    cutting = angle > 0.5 * math.pi
    along = 8e8 * np.sin(angle) - 2.4e8 * np.cos(angle)
    gain = np.where(cutting, depth * along * np.cos(angle), 0.0)
    random = np.random.default_rng(2)
    noise = random.standard_normal(periods * steps)
    state, before = np.zeros(2), np.zeros(steps + 1)
    out = np.empty(periods * steps)
    for k in range(periods * steps):
        i = k % steps
        middle = 0.5 * (before[i] + before[i + 1]) if k >= steps else 0.0
        now = state[0] + 0.5 * h * state[1]
        out[k] = state[0]
        state = free @ state + push * (gain[i] * (now - middle) + noise[k])
        before[i] = out[k]
        if i == steps - 1:
            before[steps] = state[0]
    return out, 1.0 / h, period


def test_a_simulated_cut_shows_the_multiplier_that_is_predicted():
    depth = 0.7e-3
    signal, sampling, period = cut_with_noise(depth, 1500)
    speed = np.array([8200.0 * math.pi / 30.0])
    predicted = response_of_tests(loads(CASE), CuttingTests(speed, np.array([depth]), {}))
    found = multiplier_of(signal, sampling, period, 2)
    assert found.magnitude == pytest.approx(math.exp(predicted.rate[0]), abs=0.05)
    assert found.angle == pytest.approx(predicted.angle[0], abs=0.06)


def test_the_limit_is_learnt_from_a_stable_cut_alone(tmp_path):
    """One stable cut, and a frequency that is declared 4 % too low."""
    signal, sampling, _ = cut_with_noise(0.7e-3, 600)
    time = np.arange(signal.size) / sampling
    rows = "\n".join(f"{t:.7f},{1e6 * x:.8g}" for t, x in zip(time, signal, strict=True))
    (tmp_path / "record-1.csv").write_text("time [s],y [um]\n" + rows + "\n")
    (tmp_path / "cuts.csv").write_text(
        "spindle_speed [rpm],axial_depth [mm],stable,record\n8200,0.7,1,1\n"
    )
    text = CASE.replace('"900 Hz"', '"864 +- 36 Hz"')
    assert text != CASE
    found = learn(loads(text), tmp_path / "cuts.csv", particles=48)
    frequency = found.after.columns()["structure.mode[0].frequency"]
    assert np.median(frequency) == pytest.approx(900.0, abs=9.0)
    assert frequency.std() < 12.0


def test_a_record_that_is_missing_is_named(tmp_path):
    (tmp_path / "cuts.csv").write_text(
        "spindle_speed [rpm],axial_depth [mm],stable,record\n8200,0.7,1,3\n"
    )
    with pytest.raises(InputError, match=r"record-3\.csv"):
        learn(loads(CASE), tmp_path / "cuts.csv")


def test_a_record_that_is_too_short_tells_nothing():
    assert multiplier_of(np.zeros(400), SAMPLING, 0.01, 2) is None
