"""Process damping at speeds where a tooth period holds a dozen chatter waves.

The law is written out here once more, F_r = Krc b h + C (b/V) r' and F_t = Ktc b h + mu of the
second, and solved by semi-discretisation (Insperger and Stepan 2004, Int. J. Numer. Meth. Engng
61:117). Its delayed displacement is the mean of two samples: with few steps a wave that lowers the
regenerative force, and the limit comes out far too high where waves are many.
"""

import math

import numpy as np
import pytest
import scipy

from chatter.description.case import Case
from chatter.explain.stability_margin import limits_over

TEETH, RADIUS, KTC, KRC, C, FRICTION = 3, 0.01, 1.67e9, 0.61e9, 1.1e5, 0.3
#: frequency, Hz, damping ratio, mass, kg: along x and y
MODES = ((515.0, 0.028, 1.13), (569.0, 0.028, 1.19))
RPM = math.pi / 30.0
#: twelve and nine waves a tooth period
SPEEDS = np.array([962.0, 1340.0]) * RPM


def limits():
    """Limits (2,), m, of the program, down-milling at half immersion."""
    case = Case.from_dict(
        {
            "tool": {"teeth": TEETH, "diameter": 2.0 * RADIUS},
            "material": {"Ktc": KTC, "Krc": KRC},
            "cut": {
                "mode": "down",
                "spindle_speed": SPEEDS[0],
                "feed_per_tooth": 1e-4,
                "axial_depth": 1e-3,
                "radial_depth": RADIUS,
            },
            "process_damping": {"coefficient": C, "friction": FRICTION},
            "structure": {
                "mode": [
                    {"frequency": f, "damping": z, "mass": m, "direction": direction}
                    for (f, z, m), direction in zip(MODES, ([1, 0, 0], [0, 1, 0]), strict=True)
                ]
            },
        }
    )
    return limits_over(case, SPEEDS, np.geomspace(0.8e-3, 4e-3, 60))


def forces_of_teeth(spindle):
    """Forces on the tool a depth: by displacement (2, 2), N/m^2, and by velocity, times V."""
    by_displacement, by_velocity = np.zeros((2, 2)), np.zeros((2, 2))
    for tooth in range(TEETH):
        angle = (spindle + 2.0 * math.pi * tooth / TEETH) % (2.0 * math.pi)
        if not math.pi / 2.0 <= angle <= math.pi:
            continue
        into_work = np.array([math.sin(angle), math.cos(angle)])
        tangential = np.array([-math.cos(angle), math.sin(angle)])
        by_displacement += np.outer(KTC * tangential - KRC * into_work, into_work)
        by_velocity += C * np.outer(FRICTION * tangential - into_work, into_work)
    return by_displacement, by_velocity


def spectral_radius(speed, depth, steps, parts=8):
    """Spectral radius by semi-discretisation with so many steps a tooth period."""
    frequency, damping, mass = np.array(MODES).T
    natural, step = 2.0 * math.pi * frequency, 2.0 * math.pi / (TEETH * speed * steps)
    now, past = (np.eye(4 + 2 * steps)[rows] for rows in (slice(0, 4), slice(4, None)))
    past = [past[2 * k : 2 * k + 2] for k in range(steps)]  # latest first
    for k in range(steps):
        at = (k + (np.arange(parts) + 0.5) / parts) * step * speed
        each = [forces_of_teeth(angle) for angle in at]
        stiffness, dashpot = (np.mean([one[i] for one in each], axis=0) for i in range(2))
        gain = depth * stiffness / mass[:, None]
        rates = np.zeros((6, 6))
        rates[:2, 2:4] = np.eye(2)
        rates[2:4, :2] = gain - np.diag(natural**2)
        rates[2:4, 2:4] = depth / (speed * RADIUS) * dashpot / mass[:, None]
        rates[2:4, 2:4] -= np.diag(2.0 * damping * natural)
        rates[2:4, 4:] = -gain
        over = scipy.linalg.expm(step * rates)
        following = over[:4, :4] @ now + over[:4, 4:] @ (0.5 * (past[-1] + past[-2]))
        past, now = [now[:2], *past[:-1]], following
    return float(np.abs(np.linalg.eigvals(np.vstack([now, *past]))).max())


@pytest.mark.parametrize("number", [0, 1])
def test_limit_is_that_of_a_fine_semi_discretisation(number):
    speed, depth = SPEEDS[number], limits()[number]
    coarse, fine = (spectral_radius(speed, depth, steps) for steps in (150, 300))
    # the error falls with the square of the step
    assert fine + (fine - coarse) / 3.0 == pytest.approx(1.0, abs=2e-3)


def test_fifty_steps_a_tooth_period_hold_an_unstable_cut_for_stable():
    depth = 1.3 * limits()[0]
    assert spectral_radius(SPEEDS[0], depth, 50) < 0.95
    assert spectral_radius(SPEEDS[0], depth, 300) > 1.1
