"""Process damping against exact limits of turning and of the average tooth angle.

Four straight teeth in a slot: two are in the cut at any time, a quarter turn apart, so that
sin^2 + cos^2 = 1 makes the directional coefficient of a tool that gives way along x constant, Krc,
and its process damping C b / V. Milling with the tooth period and cutting speed of a turning
operation then is that operation, and its characteristic equation gives the exact limit.
"""

import math

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.studies.whatif.whatif_study import whatif

RPM = math.pi / 30.0
TEETH = 4
#: tooth passings of the turning tool a turn: one
TURNING = {"mass": 0.561, "damping": 145.0, "stiffness": 6.48e6, "Kf": 1384e6, "C": 6.11e5}
TURNING_DIAMETER = 0.035


def slot_case(mass, damping, stiffness, Kf, passings_per_turn, diameter, to):
    """Slot whose teeth pass as often, and as fast, as those of the other operation."""
    natural = math.sqrt(stiffness / mass)
    slower = passings_per_turn / TEETH
    case = {
        "tool": {"teeth": TEETH, "diameter": diameter / slower},
        "material": {"Ktc": 0.3 * Kf, "Krc": Kf},
        "cut": {
            "mode": "slot",
            "spindle_speed": 100.0 * slower,
            "feed_per_tooth": 1e-4,
            "axial_depth": 1e-4,
        },
        "structure": {
            "mode": [
                {
                    "frequency": natural / (2.0 * math.pi),
                    "damping": damping / (2.0 * mass * natural),
                    "mass": mass,
                    "direction": [1.0, 0.0, 0.0],
                }
            ]
        },
        "lobes": {"depths": {"to": to, "count": 40}},
    }
    return Case.from_dict(case), slower


def limits_mm(case, slower, coefficient, speeds_rpm):
    """Critical depths by a what-if study over speed."""
    patched = case.patch({"process_damping.coefficient": coefficient})
    speeds = [rpm * slower * RPM for rpm in speeds_rpm]
    study = whatif(patched, {"cut.spindle_speed": speeds}, "critical depth")
    return study.values()


def exact_limit(mass, damping, stiffness, Kf, speed, diameter, period, C):
    """First b with a root s = i w of m s^2 + (c + C b/V) s + k + Kf b (1 - exp(-s T)) = 0, mm.

    With w given, the imaginary part gives b and the real part is a function of w alone.
    """
    velocity = 0.5 * diameter * speed

    def depth(w):
        return -damping * w / (C * w / velocity + Kf * np.sin(w * period))

    def real_part(w):
        return stiffness - mass * w**2 + Kf * depth(w) * (1.0 - np.cos(w * period))

    natural = math.sqrt(stiffness / mass)
    w = np.linspace(0.5 * natural, 3.0 * natural, 2_000_001)
    left, right = real_part(w[:-1]), real_part(w[1:])
    cross = (left * right < 0.0) & (np.abs(left) < stiffness) & (np.abs(right) < stiffness)
    found = depth(w[:-1][cross] - left[cross] * (w[1] - w[0]) / (right - left)[cross])
    found = found[found > 0.0]
    return float(found.min()) * 1e3 if found.size else math.inf


def turning_case():
    mass, damping, stiffness, Kf = (TURNING[k] for k in ("mass", "damping", "stiffness", "Kf"))
    return slot_case(mass, damping, stiffness, Kf, 1, TURNING_DIAMETER, 1.5e-3)


# validation 1.6 (Altintas, Eynian and Onozuka 2008: AISI 1045)
WITHOUT = {500: 0.373937, 1000: 0.370363, 1500: 0.384913, 2000: 0.371674, 3000: 0.472420,
           5000: 0.370186}  # fmt: skip
WITH = {1500: 0.975588, 2000: 0.735469, 3000: 0.593802, 5000: 0.450280}


def test_turning_without_process_damping_has_its_exact_limits():
    case, slower = turning_case()
    found = limits_mm(case, slower, 0.0, WITHOUT)
    assert found == pytest.approx(list(WITHOUT.values()), rel=1e-3)


def test_turning_with_process_damping_has_its_exact_limits():
    case, slower = turning_case()
    found = limits_mm(case, slower, TURNING["C"], WITH)
    assert found == pytest.approx(list(WITH.values()), rel=1e-3)


def test_turning_at_low_speed_has_no_limit_with_process_damping():
    case, slower = turning_case()
    study = whatif(
        case.patch({"process_damping.coefficient": TURNING["C"], "lobes.depths.count": 25}),
        {"cut.spindle_speed": [500 * slower * RPM, 1000 * slower * RPM]},
        "critical depth",
    )
    assert study.values() == [None, None]
    assert any("above 1.5 mm" in sentence for sentence in study.sentences())


def test_low_speed_stability_rises_with_the_coefficient_as_the_exact_solution_does():
    case, slower = turning_case()
    case = case.patch({"cut.spindle_speed": 2000 * slower * RPM})
    coefficients = [0.0, 1e5, 2e5, 4e5, 6.11e5]
    study = whatif(case, {"process_damping.coefficient": coefficients}, "critical depth")
    mass, damping, stiffness, Kf = (TURNING[k] for k in ("mass", "damping", "stiffness", "Kf"))
    exact = [
        exact_limit(mass, damping, stiffness, Kf, 2000 * RPM, TURNING_DIAMETER, 0.03, C)
        for C in coefficients
    ]
    assert exact[-1] == pytest.approx(WITH[2000], rel=1e-4)
    assert study.values() == pytest.approx(exact, rel=1e-3)
    assert np.all(np.diff(study.values()) > 0.0)


# validation 5.4: average tooth angle, two modes alike; at 45 degrees half of C acts along each
AVERAGE_ANGLE = {1000: (1.12969, 1.25394), 2000: (1.52452, 1.58125), 4000: (1.16598, 1.19640),
                 7500: (1.80279, 1.82581)}  # fmt: skip


def test_average_tooth_angle_with_process_damping():
    stiffness, natural, ratio = 9e6, 2.0 * math.pi * 900.0, 0.03
    mass = stiffness / natural**2
    oriented = 2000e6 * 0.75 * (0.640856 - 0.298836)
    damping = 2.0 * ratio * mass * natural
    case, slower = slot_case(mass, damping, stiffness, oriented, 3, 0.019, 2.5e-3)
    for place, coefficient in enumerate((0.0, 0.5 * 2e4)):
        found = limits_mm(case, slower, coefficient, AVERAGE_ANGLE)
        exact = [limits[place] for limits in AVERAGE_ANGLE.values()]
        assert found == pytest.approx(exact, rel=1e-3)
