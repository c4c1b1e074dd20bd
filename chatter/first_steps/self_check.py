"""Three answers of the installation against what is known otherwise, within seconds."""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import numpy as np

from chatter.description.case import Case
from chatter.simulation.simulate import simulate
from chatter.stability.check import check

_FREQUENCY, _DAMPING, _MASS = 922.0, 0.011, 0.03993
_KTC, _RATIO, _TEETH = 600e6, 1.0 / 3.0, 2
#: Insperger and Stepan (2004): a tool that gives way along the feed alone, half immersion, down
CASE = {
    "tool": {"kind": "end mill", "teeth": _TEETH, "diameter": "16 mm"},
    "material": {"law": "linear", "Ktc": _KTC, "Krc": _RATIO * _KTC},
    "cut": {
        "mode": "down",
        "spindle_speed": "10000 rpm",
        "feed_per_tooth": "0.1 mm",
        "axial_depth": "1 mm",
        "radial_depth": "8 mm",
    },
    "structure": {
        "mode": [
            {
                "frequency": _FREQUENCY,
                "damping": _DAMPING,
                "mass": _MASS,
                "direction": [1.0, 0.0, 0.0],
            }
        ]
    },
}


class CheckedAnswer(NamedTuple):
    """An answer beside what it should be."""

    name: str
    found: str
    wanted: str
    right: bool
    seconds: float


def self_check() -> list[CheckedAnswer]:
    """Zeroth order against its closed form, two methods against each other, time against both."""
    case = Case.from_dict(CASE, "self-check")
    started = time.perf_counter()
    found = check(case, "zero-order").zero_order_depth
    wanted = closed_form_limit(case.cut.spindle_speed)
    rows = [_compared("zeroth order, closed form", found, wanted, 2e-3, started)]
    started = time.perf_counter()
    exact = check(case, "collocation").critical_depth
    other = check(case, "semi-discretization").critical_depth
    rows.append(_compared("collocation, semi-discretization", exact, other, 5e-3, started))
    started = time.perf_counter()
    verdicts = [
        simulate(case.patch({"cut.axial_depth": share * exact})).detection.verdict
        for share in (0.8, 1.2)
    ]
    told = " and ".join(verdicts)
    right = verdicts == ["stable", "chatter"]
    seconds = time.perf_counter() - started
    rows.append(
        CheckedAnswer("in time, 20 % below and above", told, "stable and chatter", right, seconds)
    )
    return rows


def closed_form_limit(speed: float) -> float:
    """Zeroth-order limit of one mode along the feed at a speed, rad/s (Altintas and Budak 1995).

    The lowest over the lobes of 2 pi / (N Ktc alpha Re G), where the chatter frequency is that of
    the lobe; half immersion in down-milling, from 90 to 180 degrees.
    """

    def primitive(angle: float) -> float:
        return 0.5 * (math.cos(2 * angle) - 2 * _RATIO * angle + _RATIO * math.sin(2 * angle))

    alpha = primitive(math.pi) - primitive(0.5 * math.pi)
    stiffness = _MASS * (2.0 * math.pi * _FREQUENCY) ** 2
    # an even count: no line falls on the resonance itself, where Re G is zero
    ratio = np.linspace(0.5, 1.5, 400000)
    g = 1.0 / (stiffness * (1.0 - ratio**2 + 2j * _DAMPING * ratio))
    depth = 2.0 * math.pi / (_TEETH * _KTC * alpha * g.real)
    # 1 + alpha b N Ktc / (4 pi) (1 - exp(-i w T)) G = 0 by its phase: w T = pi + 2 arg, 2 pi k
    phase = np.pi - 2.0 * np.arctan2(-g.imag, -np.sign(alpha) * -g.real)
    passes = ratio * 2.0 * math.pi * _FREQUENCY * 2.0 * math.pi / (speed * _TEETH)
    miss = np.sin(0.5 * (passes - phase))
    crossed = np.flatnonzero((miss[:-1] * miss[1:] <= 0.0) & (depth[:-1] > 0.0))
    return float(depth[crossed].min())


def _compared(
    name: str, found: float, wanted: float, within: float, started: float
) -> CheckedAnswer:
    right = abs(found / wanted - 1.0) < within
    seconds = time.perf_counter() - started
    return CheckedAnswer(name, f"{1e3 * found:.5g} mm", f"{1e3 * wanted:.5g} mm", right, seconds)
