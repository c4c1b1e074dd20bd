"""Equivalent stiffness and damping of friction laws under harmonic motion."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

_STEPS = 400
_CYCLES = 3
#: samples of a quarter of a cycle of a law without memory
_SAMPLES = 4000


def describing_function(
    force: Callable[..., float],
    advance: Callable[..., None],
    law: Any,
    amplitude: float,
    frequency: float,
) -> tuple[float, float]:
    """First harmonic of the steady cycle x = A sin(w t).

    By the leaves of the law, called with (law, row, motion, time), on a table with one row at rest,
    which is left in motion; amplitude in m, frequency in Hz. Stiffness, N/m, from the part of the
    force in phase with the displacement, and damping, N s/m, from the work of a cycle over pi A^2
    w: Krylov and Bogoliubov's harmonic balance (Nayfeh and Mook 1979, section 3.3).
    """
    if not (amplitude > 0.0 and frequency > 0.0):
        raise ValueError(
            f"amplitude and frequency must be above 0, not {amplitude} and {frequency}"
        )
    turn = 2.0 * math.pi / _STEPS
    time = 1.0 / (frequency * _STEPS)
    before, work, elastic = 0.0, 0.0, 0.0
    for step in range(1, _CYCLES * _STEPS + 1):
        after = amplitude * math.sin(turn * (step % _STEPS))
        if step > (_CYCLES - 1) * _STEPS:
            held = force(law, 0, after - before, time)
            work += held * (after - before)
            elastic += held * amplitude * math.sin(turn * (step - 0.5))
        advance(law, 0, after - before, time)
        before = after
    omega = 2.0 * math.pi * frequency
    stiffness = 2.0 * elastic / (_STEPS * amplitude**2)
    return float(stiffness), float(work / (math.pi * amplitude**2 * omega))


def memoryless_describing_function(
    steady_state_force: Callable[..., Any], amplitude: float, frequency: float
) -> tuple[float, float]:
    """First harmonic of x = A sin(w t), of a law whose force depends on velocity alone.

    Forces, N, of velocities, m/s; amplitude in m, frequency in Hz. Stiffness, 0, and damping, N
    s/m, the mean over the cycle.
    """
    peak = 2.0 * np.pi * frequency * amplitude
    angle = (np.arange(_SAMPLES) + 0.5) * (0.5 * np.pi / _SAMPLES)
    force = steady_state_force(peak * np.sin(angle))
    return 0.0, float(2.0 * np.mean(force * np.sin(angle)) / peak)
