"""Three answers of the installation against what is known otherwise, within seconds."""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from chatter.description.case import Case
from chatter.engine.presets import CACHE_FOLDER
from chatter.simulation.simulate import simulate
from chatter.stability.check import check
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model

#: among the compiled code, once it holds what every question needs
_ASKED = CACHE_FOLDER / "self-check"
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
    """An answer beside what it should be; right is None where it was not asked for."""

    name: str
    found: str
    wanted: str
    right: bool | None
    seconds: float


def self_check() -> list[CheckedAnswer]:
    """Zeroth order against its closed form, two methods against each other, time against both.

    What would have to be compiled first, apart from the zeroth order, is not asked for.
    """
    if _ASKED.is_file():
        return compiled_self_check()
    first, *others = _QUESTIONS
    skipped = [CheckedAnswer(name, "not compiled yet", "", None, 0.0) for name in others]
    return [_QUESTIONS[first](_case(), first), *skipped]


def compiled_self_check() -> list[CheckedAnswer]:
    """Ask everything, whatever has to be compiled for it; afterwards `self_check` asks it too."""
    case = _case()
    answers = [answer(case, name) for name, answer in _QUESTIONS.items()]
    # without a place for compiled code all is compiled anew at every start
    with contextlib.suppress(OSError):
        _ASKED.touch()
    return answers


def _case() -> Case:
    return Case.from_dict(CASE, "self-check")


def _zeroth_order(case: Case, name: str) -> CheckedAnswer:
    started = time.perf_counter()
    speed = case.cut.spindle_speed
    # `check` asks other methods beside it
    found = float(zero_order_of(milling_model(case), np.array([speed])).critical_depth[0])
    return _compared(name, found, closed_form_limit(speed), 2e-3, started)


def _two_methods(case: Case, name: str) -> CheckedAnswer:
    started = time.perf_counter()
    exact = check(case, "collocation").critical_depth
    other = check(case, "semi-discretization").critical_depth
    return _compared(name, exact, other, 5e-3, started)


def _in_time(case: Case, name: str) -> CheckedAnswer:
    limit = check(case, "collocation").critical_depth
    started = time.perf_counter()
    verdicts = [
        simulate(case.patch({"cut.axial_depth": share * limit})).detection.verdict
        for share in (0.8, 1.2)
    ]
    seconds = time.perf_counter() - started
    right = verdicts == ["stable", "chatter"]
    return CheckedAnswer(name, " and ".join(verdicts), "stable and chatter", right, seconds)


_QUESTIONS: dict[str, Callable[[Case, str], CheckedAnswer]] = {
    "zeroth order, closed form": _zeroth_order,
    "collocation, semi-discretization": _two_methods,
    "in time, 20 % below and above": _in_time,
}


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
