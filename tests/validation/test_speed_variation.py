"""Spindle speed that varies: turning with a varying delay, and growth in simulated cuts.

Turning is a milling cut whose edges lag by one tooth pitch over the depth of cut: as one tooth
leaves at a height the next one enters there, and the directional matrix stays what it is.
"""

import math

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.simulation.perturbation.lyapunov_verdict import lyapunov_verdict
from chatter.simulation.perturbation.multiplier import motion_of
from chatter.simulation.setup import delayed, set_up
from chatter.simulation.structure_in_time import modes_of
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import converged_multiplier, multipliers
from chatter.stability.model import milling_model
from chatter.stability.registry import COLLOCATION
from cutting.edge_segments.segments import period_angle
from tests.validation.reference.turning import delay_of_a_spindle, spectral_radius

# --- validation 1.4: turning -------------------------------------------------------------------

#: x'' + z x' + (1 + kw) x = kw x(t - tau); ten delays are a period of the variation
CUT, DAMPING, DELAYS = 0.2, 0.1, 10
DELAY = 2.0 * math.pi / 0.3
PERIOD = DELAYS * DELAY


def turning_case(variation=None):
    """Mode of 100 Hz and two helical flutes of 8 mm that make the turning of the benchmark."""
    frequency, stiffness, diameter, ratio = 100.0, 1e6, 8e-3, 0.3
    arc, depth = math.acos(1.0 - 2.0 * 0.05), 0.5 * math.pi * diameter
    mean = 0.5 * math.sin(arc) ** 2 + ratio * 0.5 * (arc - math.sin(arc) * math.cos(arc))
    tooth_period = DELAY / (2.0 * math.pi * frequency)
    ktc = CUT * stiffness / (2.0 * depth * mean / (2.0 * math.pi))
    cut = {
        "mode": "up",
        "spindle_speed": math.pi / tooth_period,
        "feed_per_tooth": 1e-4,
        "axial_depth": depth,
        "radial_depth": 0.05 * diameter,
    }
    if variation:
        amplitude, shape = variation
        of = {"amplitude": amplitude, "frequency": 1.0 / (DELAYS * tooth_period), "shape": shape}
        cut["speed_variation"] = of
    mode = {"frequency": frequency, "damping": 0.5 * DAMPING, "stiffness": stiffness}
    return Case.from_dict(
        {
            "tool": {"teeth": 2, "diameter": diameter, "helix": "45 deg"},
            "material": {"Ktc": ktc, "Krc": ratio * ktc},
            "cut": cut,
            "structure": {"mode": [mode | {"direction": [1, 0, 0]}]},
        }
    )


def radius_of(case, depth=None):
    """|mu| as the product has it, at the depth of the case or another one."""
    model, cut = milling_model(case), case.cut
    depth = depth or cut.axial_depth
    found = converged_multiplier(
        lambda points, waves: element_cut(model, depth, points, waves), cut.spindle_speed, depth
    )
    return abs(found.value)


def test_the_reference_meets_the_published_multiplier():
    """The delay itself varies as a sine there: no sine of the speed has such a delay."""
    found = spectral_radius(
        lambda t: DELAY * (1.0 + 0.1 * math.sin(2.0 * math.pi * t / PERIOD)), PERIOD, DAMPING, CUT
    )
    assert found == pytest.approx(4.4761683830912320, rel=1e-6)


def test_turning_at_a_constant_speed():
    assert radius_of(turning_case()) ** DELAYS == pytest.approx(20.3155523, rel=1e-6)


@pytest.mark.parametrize(
    ("amplitude", "shape"), [(0.02, "sine"), (0.1, "sine"), (0.1, "triangle"), (0.4, "triangle")]
)
def test_turning_with_a_varying_speed(amplitude, shape):
    delay = delay_of_a_spindle(DELAY, amplitude, 1.0 / PERIOD, shape == "triangle")
    expected = spectral_radius(delay, PERIOD, DAMPING, CUT)
    assert radius_of(turning_case((amplitude, shape))) == pytest.approx(expected, rel=5e-6)


# --- milling cuts against their own simulation ----------------------------------------------------


def mode(frequency, damping, stiffness, axis):
    direction = [float(axis == name) for name in "xyz"]
    return {"frequency": frequency, "damping": damping, "stiffness": stiffness,
            "direction": direction}  # fmt: skip


ONE_MODE = [mode(922.0, 0.011, 1.34e6, "x")]
TWO_MODES = [mode(900.0, 0.02, 8e6, "x"), mode(980.0, 0.025, 1e7, "y")]
THREE_MODES = [
    mode(600.0, 0.03, 2e7, "x"), mode(650.0, 0.03, 1.6e7, "y"), mode(1500.0, 0.02, 3e7, "x"),
]  # fmt: skip
SLOT = ("slot", 1.0)


def end_mill(teeth, diameter, **others):
    return {"teeth": teeth, "diameter": diameter} | others


#: tool; modes; mode of cutting and immersion; waves of the first mode from tooth to tooth;
#: amplitude, turns and shape of a variation; other sections
CUTS = {
    "one mode, two teeth": (
        end_mill(2, 16e-3), ONE_MODE, SLOT, 5.25, (0.1, 4, "sine"), {},
    ),
    "straight": (end_mill(4, 16e-3), TWO_MODES, SLOT, 4.25, (0.15, 2, "triangle"), {}),
    "at the peak of a lobe": (end_mill(4, 16e-3), TWO_MODES, SLOT, 3.0, (0.2, 2, "sine"), {}),
    "six teeth": (
        end_mill(6, 20e-3, helix="30 deg"), THREE_MODES, SLOT, 3.25, (0.2, 1, "sine"), {},
    ),
    "half immersion": (
        end_mill(3, 12e-3, helix="45 deg"), TWO_MODES, ("down", 0.5), 5.5, (0.1, 2, "sine"), {},
    ),
    "ball, half immersion": (
        end_mill(2, 10e-3, helix="25 deg", kind="ball"), TWO_MODES, ("up", 0.5), 6.25,
        (0.1, 3, "sine"), {},
    ),
    "ball": (
        end_mill(4, 10e-3, helix="25 deg", kind="ball"), TWO_MODES, SLOT, 6.25, (0.1, 1, "sine"),
        {},
    ),
    "bull nose with runout": (
        end_mill(4, 12e-3, helix="30 deg", kind="bull nose", corner_radius=2e-3,
                 runout={"offset": "4 um", "angle": "30 deg"}),
        TWO_MODES, SLOT, 3.25, (0.1, 2, "triangle"), {},
    ),
    "variable pitch": (
        end_mill(4, 16e-3, helix="30 deg", pitch=["88 deg", "92 deg", "87 deg", "93 deg"]),
        THREE_MODES, SLOT, 4.25, (0.1, 2, "sine"), {},
    ),
    "variable helix": (
        end_mill(4, 16e-3, helix=["38 deg", "42 deg", "38 deg", "42 deg"]),
        THREE_MODES, SLOT, 3.3, (0.15, 2, "sine"), {},
    ),
    "exponential law": (
        end_mill(4, 12e-3, helix="40 deg"), TWO_MODES, SLOT, 4.3, (0.15, 2, "triangle"),
        {"material": {"law": "exponential", "h0": "0.1 mm", "exponent": 0.8}},
    ),
    "inserted": (
        end_mill(6, 50e-3, kind="inserted", cutting_edge_angle="60 deg"), THREE_MODES, SLOT, 2.25,
        (0.2, 2, "triangle"), {},
    ),
    "process damping": (
        end_mill(4, 16e-3), TWO_MODES, SLOT, 6.25, (0.15, 1, "sine"),
        {"process_damping": {"coefficient": 2e4, "friction": 0.3}},
    ),
}  # fmt: skip
#: forced vibration, which no linear theory holds, is much of the feed in these
INTERRUPTED = {"half immersion", "ball, half immersion"}
#: periods of the variation in which the cut takes hold, and that are watched
RAMP, WATCHED = 2, 5


def milling_case(name, varied=True):
    """Case of a cut, with its variation or at a constant speed."""
    tool, modes, (kind, immersion), waves, (amplitude, turns, shape), others = CUTS[name]
    speed = 2.0 * math.pi * modes[0]["frequency"] / (waves * tool["teeth"])
    cut = {
        "mode": kind, "spindle_speed": speed, "feed_per_tooth": 1e-4, "axial_depth": 1e-3,
        "radial_depth": immersion * tool["diameter"],
    }  # fmt: skip
    if varied:
        frequency = speed / (2.0 * math.pi * turns)
        cut["speed_variation"] = {"amplitude": amplitude, "frequency": frequency, "shape": shape}
    material = {"Ktc": "800 MPa", "Krc": "300 MPa", "Kac": "100 MPa"} | others.get("material", {})
    document = {"tool": tool, "cut": cut, "structure": {"mode": modes}} | others
    return Case.from_dict(document | {"material": material})


def first_limit(case):
    depths = np.linspace(0.0, 0.49 * case.tool.diameter, 41)[1:]
    speed = np.array([case.cut.spindle_speed])
    found = COLLOCATION.limits(milling_model(case), speed, depths, None, no_progress)
    return found.critical_depth[0]


def predicted(case, turns, depth):
    """|mu| by collocation over a number of turns, which are a period of the variation."""
    radius = radius_of(case, depth)
    if case.cut.speed_variation is not None:
        return radius
    return radius ** (turns * round(2.0 * math.pi / period_angle(milling_model(case).cutter)))


def simulated(case, turns, depth):
    """The same from two simulated cuts, of which one starts with a push of 0.1 um."""
    case = delayed(case.patch({"cut.axial_depth": depth}))
    runs, steps = [], 0
    for push in (0.0, 1e-7):
        setup = set_up(case)
        steps = turns * setup.resolution.steps_per_revolution
        motion, done = motion_of(setup, (RAMP + WATCHED) * steps, RAMP * steps, push)
        assert done > (RAMP + WATCHED) * steps
        runs.append(motion[RAMP * steps : -1].reshape(WATCHED, -1))
    size = np.linalg.norm(runs[1] - runs[0], axis=1)
    largest = np.abs(runs[0]).max(axis=1)
    # as long as the motion itself has not grown out of the chip
    small = np.flatnonzero(largest[1:] < 1.2 * largest[0])
    last = int(small[-1]) if small.size else 0
    return size[last + 1] / size[last]


@pytest.mark.parametrize("name", list(CUTS))
def test_growth_in_a_simulated_cut(name):
    case, turns = milling_case(name), CUTS[name][4][1]
    limit = first_limit(case)
    for share, sign in ((0.8, -1.0), (1.25, 1.0)):
        wanted = math.log(predicted(case, turns, share * limit))
        found = math.log(simulated(case, turns, share * limit))
        assert sign * wanted > 0.15
        assert sign * found > 0.15
        if name not in INTERRUPTED:
            assert found == pytest.approx(wanted, abs=0.08)


@pytest.mark.parametrize("name", list(CUTS))
def test_what_the_variation_is_good_for(name):
    """Between the limits with the variation and without, one cut grows and the other dies out."""
    turns = CUTS[name][4][1]
    varied, constant = milling_case(name), milling_case(name, varied=False)
    limits = first_limit(varied), first_limit(constant)
    depth = math.sqrt(limits[0] * limits[1])
    gain = limits[0] / limits[1] - 1.0
    assert (gain > 0.0) == (name != "at the peak of a lobe")
    for case, sign in ((varied, -gain), (constant, gain)):
        wanted = predicted(case, turns, depth)
        found = simulated(case, turns, depth)
        assert sign * math.log(wanted) > 0.0
        assert sign * math.log(found) > 0.0


# --- the verdict of `simulate`: chatter that is full is chatter -----------------------------------


def verdict_of(case, depth):
    case = case.patch({"cut.axial_depth": depth})
    return lyapunov_verdict(case, modes_of(case)[0])


@pytest.mark.parametrize(
    "name", ["bull nose with runout", "straight", "one mode, two teeth", "process damping"]
)
def test_verdict_of_a_simulated_cut(name):
    """Full chatter attracts, and forgets a push: small vibration before it tells."""
    case, turns = milling_case(name), CUTS[name][4][1]
    limit = first_limit(case)
    for share in (0.8, 0.95):
        found = verdict_of(case, share * limit)
        wanted = math.log(predicted(case, turns, share * limit)) / turns
        assert found.verdict == "stable"
        assert found.rate == pytest.approx(wanted, abs=0.03)
    for share in (1.1, 1.25, 2.0, 4.0):
        found = verdict_of(case, share * limit)
        assert found.verdict == "chatter"
        assert found.rate > 0.0
        if share < 1.2:
            # growth that begins while the cut takes hold is less than in the full cut
            wanted = math.log(predicted(case, turns, share * limit)) / turns
            assert found.rate < 1.1 * wanted


def test_verdict_where_speed_varies_slowly():
    """Within a period of 25 turns chatter comes and goes."""
    case = milling_case("straight")
    frequency = case.cut.spindle_speed / (2.0 * math.pi * 25)
    case = case.patch({"cut.speed_variation.frequency": frequency})
    limit = first_limit(case)
    for share, verdict in ((0.9, "stable"), (1.1, "chatter"), (2.0, "chatter")):
        assert verdict_of(case, share * limit).verdict == verdict


def test_a_run_from_rest_that_does_not_come_to_the_forced_motion_chatters():
    """Small pushes die out below the limit, but the jump into the full cut is none."""
    speed = 406.5
    variation = {"amplitude": 0.136, "frequency": speed / (20.0 * math.pi), "shape": "sine"}
    case = Case.from_dict(
        {
            "tool": end_mill(4, 12e-3),
            "material": {"Ktc": "800 MPa", "Krc": "396 MPa", "Kac": "100 MPa"},
            "cut": {
                "mode": "slot", "spindle_speed": speed, "feed_per_tooth": 1e-4,
                "axial_depth": 1e-3, "speed_variation": variation,
            },
            "structure": {"mode": [mode(1332.0, 0.02156, 1.2413e7, "x")]},
        }
    )  # fmt: skip
    depth = 0.8 * first_limit(case)
    found = verdict_of(case, depth)
    assert found.verdict == "chatter"
    assert "from rest" in found.reason
    assert found.rate == pytest.approx(math.log(predicted(case, 10, depth)) / 10, abs=0.02)


# --- slow variation: growth is the mean of that at the speeds gone through ------------------------


@pytest.mark.parametrize(
    ("depth", "turns", "difference"),
    [
        (0.3e-3, 10, 3e-3), (0.55e-3, 10, 3e-3), (0.8e-3, 10, 3e-3),
        (0.3e-3, 40, 2e-4), (0.55e-3, 40, 2e-4), (0.8e-3, 40, 2e-4),
        # a multiplier above 1e154: squares of it are no numbers
        (0.8e-3, 300, 2e-5),
    ],
)  # fmt: skip
def test_slow_variation_is_a_mean_over_the_speeds(depth, turns, difference):
    """The difference falls with the square of the period, as of an adiabatic change."""
    constant = milling_case("straight", varied=False)
    mean, amplitude = constant.cut.spindle_speed, 0.05
    of = {"amplitude": amplitude, "frequency": mean / (2.0 * math.pi * turns)}
    varied = constant.patch({f"cut.speed_variation.{key}": value for key, value in of.items()})
    point = np.array([mean]), np.array([depth])
    radius = float(np.abs(multipliers(element_cut(milling_model(varied), depth), *point))[0])
    phase = 2.0 * math.pi * (np.arange(64) + 0.5) / 64
    speeds = mean * (1.0 + amplitude * np.sin(phase))
    cut = element_cut(milling_model(constant), depth)
    radii = np.abs(multipliers(cut, speeds, np.full(speeds.size, depth)))
    a_turn = constant.tool.teeth * np.mean(np.log(radii) * speeds / mean)
    assert radius > 0.0
    assert math.log(radius) / turns == pytest.approx(a_turn, abs=difference)
