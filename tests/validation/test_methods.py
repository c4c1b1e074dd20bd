"""Every method against published values, and against one another where theory makes them agree."""

import math

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.description.progress import no_progress
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.multi_frequency.harmonics import harmonics_at
from chatter.stability.methods.semi_discretization.arrays import milling_arrays
from chatter.stability.methods.semi_discretization.multipliers import multipliers
from chatter.stability.methods.semi_discretization.step_schemes import (
    FIRST_ORDER,
    FULL_DISCRETIZATION,
    SECOND_ORDER,
    ZEROTH_ORDER,
)
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS
from dynamics.modal.modes import receptance_matrix

RPM = math.pi / 30.0


def mode(frequency, damping, axis="x", **inertia):
    direction = [float(axis == name) for name in "xyz"]
    return {"frequency": frequency, "damping": damping, "direction": direction, **inertia}


def model_of(modes, tool, cut, kt, kr, **sections):
    tool = {"teeth": 2, "diameter": 16e-3, **tool}
    cut = {"spindle_speed": 1000.0, "feed_per_tooth": 1e-4, "axial_depth": 1e-3, **cut}
    material = {"Ktc": kt, "Krc": kr}
    data = {"tool": tool, "material": material, "cut": cut, "structure": {"mode": modes}}
    return milling_model(Case.from_dict(data | sections))


def tool_922(degrees_of_freedom, immersion, cut, **tool):
    modes = [mode(922.0, 0.011, axis, mass=0.03993) for axis in "xy"[:degrees_of_freedom]]
    width = immersion * tool.get("diameter", 16e-3)
    return model_of(modes, tool, {"mode": cut, "radial_depth": width}, 600e6, 200e6)


def altintas_engin_budak(helix_deg=0.0, pitch=(70, 110, 70, 110)):
    """validation 4."""
    modes = [
        mode(441.64, 0.028722, mass=11.125),
        mode(563.6, 0.055801, mass=1.4986),
        mode(778.56, 0.058996, mass=13.063),
        mode(516.21, 0.025004, "y", mass=1.199),
    ]
    tool = {
        "teeth": 4,
        "diameter": 19.05e-3,
        "helix": math.radians(helix_deg),
        "pitch": [math.radians(angle) for angle in pitch],
    }
    cut = {"mode": "down", "radial_depth": 0.5 * 19.05e-3}
    return model_of(modes, tool, cut, 697e6, 255.8e6)


# --- validation 2.1: what every scheme gives with 40 steps a tooth period ----------------------


@pytest.mark.parametrize(
    ("scheme", "published", "printed"),
    [
        (ZEROTH_ORDER, 1.29412, 6e-6),
        (FIRST_ORDER, 1.35026, 6e-6),
        # the published code averages the coefficients in another way
        (FULL_DISCRETIZATION, 1.33585, 2e-4),
    ],
)
def test_forty_steps_of_every_scheme(scheme, published, printed):
    arrays = milling_arrays(tool_922(1, 1.0, "down"))
    point = np.array([5000 * RPM]), np.array([1e-3])
    assert abs(multipliers(arrays, *point, 40, scheme=scheme)[0]) == pytest.approx(
        published, abs=printed
    )


@pytest.mark.parametrize("scheme", [ZEROTH_ORDER, FIRST_ORDER, SECOND_ORDER, FULL_DISCRETIZATION])
def test_every_scheme_converges_to_the_exact_multiplier(scheme):
    arrays = milling_arrays(tool_922(1, 0.1, "up"))
    point = np.array([10000 * RPM]), np.array([2e-3])
    errors = [
        abs(abs(multipliers(arrays, *point, steps, scheme=scheme)[0]) - 1.1773892490)
        for steps in (80, 160, 320, 640)
    ]
    order = math.log2(errors[1] / errors[3]) / 2.0
    assert errors[-1] < 1e-4
    assert order == pytest.approx(2.0, abs=0.3)


def test_a_parabola_is_nearer_than_a_line_and_a_line_than_a_constant():
    arrays = milling_arrays(tool_922(1, 1.0, "down"))
    point = np.array([5000 * RPM]), np.array([0.5e-3])
    schemes = (SECOND_ORDER, FIRST_ORDER, ZEROTH_ORDER)
    errors = [
        abs(abs(multipliers(arrays, *point, 60, scheme=scheme)[0]) - 1.07397558668)
        for scheme in schemes
    ]
    assert errors == sorted(errors)


# --- collocation ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("freedom", "immersion", "cut", "rpm", "depth_mm", "exact"),
    [
        # validation 2.1 and 2.2
        (1, 1.0, "down", 5000, 0.2, 0.81974278427),
        (1, 1.0, "down", 5000, 1.0, 1.40647352539),
        (1, 0.05, "up", 20000, 4.0, 1.0543980187),
        (2, 0.05, "down", 20000, 5.0, 1.3010108332),
        (2, 0.5, "down", 15000, 2.0, 2.1027785910),
        (2, 1.0, "down", 25000, 1.0, 1.3703102592),
    ],
)
def test_collocation_meets_the_exact_multipliers(freedom, immersion, cut, rpm, depth_mm, exact):
    model = tool_922(freedom, immersion, cut)
    point = np.array([rpm * RPM]), np.array([depth_mm * 1e-3])
    plain = abs(collocation.multipliers(element_cut(model, 10e-3), *point)[0])
    assert plain == pytest.approx(exact, rel=3e-5)
    fine = abs(collocation.multipliers(element_cut(model, 10e-3, 12, 0.7), *point)[0])
    assert fine == pytest.approx(exact, rel=1e-9)


def test_limits_of_unequal_pitch():
    """validation 4: 70 and 110 degrees, no helix; and with helix."""
    rpms = np.array([3000, 4000, 5000, 6000, 8000, 10000])
    depths = np.linspace(0.0, 8e-3, 41)[1:]
    model = altintas_engin_budak()
    found = collocation.limit_curve(element_cut(model, 8e-3), rpms * RPM, depths)
    exact = (3.9037, 1.7965, 6.1649, 3.0954, 4.9829, 2.5674)
    assert found.critical_depth * 1e3 == pytest.approx(exact, rel=1e-4)
    model = altintas_engin_budak(30.0)
    found = collocation.limit_curve(element_cut(model, 8e-3), np.array([5000, 8000]) * RPM, depths)
    # computed there with a coarser solver
    assert found.critical_depth * 1e3 == pytest.approx((6.09418, 4.95246), rel=5e-4)
    half_turn = collocation.multipliers(
        element_cut(altintas_engin_budak(), 4e-3), np.array([5000 * RPM]), np.array([4e-3])
    )
    assert abs(half_turn[0]) == pytest.approx(0.62113485, abs=5e-6)


@pytest.mark.parametrize(
    ("rpm", "expected", "kinds"),
    [
        (18800, (1.14676, 1.98935, 4.62804), "flip"),
        (19000, (1.60997, 2.50485, 5.17385), "flip"),
        (19500, (6.51482,), "hopf"),
        (20000, (5.46111, 6.56189, 8.03844), "flip"),
    ],
)
def test_islands_of_a_helical_tool(rpm, expected, kinds):
    """validation 3.1: stable again between the island and the next limit."""
    model = tool_922(1, 0.05, "up", diameter=8e-3, helix=math.radians(45.0))
    depths = np.linspace(0.0, 9e-3, 61)[1:]
    curve = collocation.limit_curve(element_cut(model, 9e-3), np.array([rpm * RPM]), depths)
    assert curve.crossings[0] * 1e3 == pytest.approx(expected, rel=1e-5)
    assert curve.bifurcation == (kinds,)
    if kinds == "flip":
        # an odd multiple of half the tooth-passing frequency
        assert (curve.chatter_frequency[0] / (rpm / 60.0)) % 2.0 == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("rpm", "depth_mm", "published"),
    [(15000, 3, 0.4701), (15000, 6, 0.3396), (20000, 2, 0.975), (10000, 3, 0.163)],
)
def test_flutes_of_different_helix(rpm, depth_mm, published):
    """validation 3.3, to the tolerance that it states."""
    angles = [math.radians(30.0), math.radians(45.0)]
    model = tool_922(1, 0.05, "down", helix=angles)
    point = np.array([rpm * RPM]), np.array([depth_mm * 1e-3])
    found = abs(collocation.multipliers(element_cut(model, 6e-3), *point)[0])
    assert found == pytest.approx(published, rel=0.015)


def test_runout_without_effect_and_with():
    """Less than the feed leaves the period of a turn; at twice the feed a tooth cuts no more."""
    speed, depth = np.array([12000 * RPM]), np.array([0.5e-3])
    even = tool_922(1, 0.1, "up")
    small = tool_922(1, 0.1, "up", runout={"offset": 1e-10, "angle": 0.0})
    a, b = (
        abs(collocation.multipliers(element_cut(m, 1e-3), speed, depth)[0]) for m in (even, small)
    )
    # at the entry the chip vanishes, so that some of the arc is another tooth's
    assert b == pytest.approx(a**2, rel=1e-4)
    one = tool_922(1, 0.1, "up", runout={"offset": 1e-3, "angle": 0.0})
    # one tooth left: a cut with a single tooth, whose period is a turn
    single = tool_922(1, 0.1, "up", teeth=1)
    a, b = (
        abs(collocation.multipliers(element_cut(m, 1e-3), speed, depth)[0]) for m in (single, one)
    )
    assert b == pytest.approx(a, rel=1e-9)


def test_a_slow_variation_of_the_speed_stabilizes():
    """validation 1.4: less growth over the same time with the variation than without."""
    modes = [mode(922.0, 0.011, mass=0.03993)]
    cut = {"mode": "slot", "spindle_speed": 6000 * RPM, "axial_depth": 0.5e-3}
    varied = cut | {"speed_variation": {"amplitude": 0.1, "frequency": 10.0}}
    speed, depth = np.array([6000 * RPM]), np.array([0.5e-3])
    still = element_cut(model_of(modes, {}, cut, 6e8, 2e8), 1e-3)
    moving = element_cut(model_of(modes, {}, varied, 6e8, 2e8), 1e-3)
    tooth_periods = 100.0 / 10.0 * 2.0
    growth = math.log(abs(collocation.multipliers(still, speed, depth)[0])) * tooth_periods
    assert growth > 0.0
    assert math.log(abs(collocation.multipliers(moving, speed, depth)[0])) < growth


# --- multi-frequency ------------------------------------------------------------------------------


def test_multi_frequency_finds_flip_lobes_and_islands():
    """validation 2.4 and 3.1, straight from the FRFs."""
    depths = np.linspace(0.0, 5e-3, 26)[1:]
    model = tool_922(2, 0.05, "up")
    curve = METHODS["multi-frequency"].limits(
        model, np.array([15000, 20000]) * RPM, depths, None, no_progress
    )
    assert curve.critical_depth * 1e3 == pytest.approx((1.651214, 3.250386), rel=1e-3)
    assert curve.bifurcation == ("hopf", "flip")
    model = tool_922(1, 0.05, "up", diameter=8e-3, helix=math.radians(45.0))
    curve = METHODS["multi-frequency"].limits(
        model, np.array([19000]) * RPM, depths, None, no_progress
    )
    assert curve.crossings[0] * 1e3 == pytest.approx((1.60997, 2.50485), rel=1e-3)


def test_multi_frequency_takes_unequal_pitch():
    depths = np.linspace(0.0, 6e-3, 13)[1:]
    model = altintas_engin_budak(30.0)
    curve = METHODS["multi-frequency"].limits(
        model, np.array([8000.0]) * RPM, depths, None, no_progress
    )
    assert curve.critical_depth * 1e3 == pytest.approx([4.95246], rel=1e-3)


@pytest.mark.parametrize("pitch", [None, (1.0, 2.0 * math.pi - 1.0)])
def test_multi_frequency_refuses_what_its_harmonics_do_not_reach(pitch):
    """Far below the modes it would take every cut for stable."""
    tool = {} if pitch is None else {"pitch": list(pitch)}
    model, depths = tool_922(1, 0.25, "down", **tool), np.linspace(0.0, 4e-3, 41)[1:]
    repeats = 2 if pitch is None else 1
    with pytest.raises(RunError, match="harmonics"):
        METHODS["multi-frequency"].limits(
            model, np.array([922.0 / repeats / 80.0]) * RPM * 60, depths, None,
                           no_progress)  # fmt: skip
    # sixty of them reach the highest mode just so
    speed = np.array([922.0 / repeats / 48.0]) * RPM * 60
    curves = [
        METHODS[name].limits(model, speed, depths, None, no_progress)
        for name in ("multi-frequency", "collocation")
    ]
    assert curves[0].critical_depth == pytest.approx(curves[1].critical_depth, rel=4e-3)


def test_multi_frequency_does_not_step_over_a_narrow_resonance():
    """At one and a half times the frequency of a mode of little damping a cut grows slowly."""
    modes = [mode(1676.8, 0.0034, stiffness=1.6e6)]
    modes[0]["direction"] = [0.25, math.sqrt(1.0 - 0.25**2), 0.0]
    tool = {"teeth": 3, "diameter": 21.35e-3}
    cut = {"mode": "down", "radial_depth": 0.09e-3}
    model = model_of(modes, tool, cut, 1.5e9, 0.4e9)
    speed, depths = np.array([1676.8 * 1.501 / 3.0 * 2.0 * math.pi]), np.linspace(0, 4e-3, 17)[1:]
    curves = [
        METHODS[name].limits(model, speed, depths, None, no_progress)
        for name in ("multi-frequency", "collocation")
    ]
    assert np.isfinite(curves[1].critical_depth).all()
    # so short a cut holds more harmonics than are kept: 0.11 %
    assert curves[0].critical_depth == pytest.approx(curves[1].critical_depth, rel=2e-3)
    assert curves[0].chatter_frequency == pytest.approx(curves[1].chatter_frequency, rel=1e-3)


@pytest.mark.parametrize("exponent", [0.4, 0.65])
def test_multi_frequency_with_a_size_effect(exponent):
    """In a slot the chip vanishes at both ends of the arc, where the slope is infinite."""
    modes = [mode(900.0, 0.03, axis, stiffness=8e6) for axis in "xy"]
    case = {
        "tool": {"teeth": 1, "diameter": 16e-3},
        "material": {"law": "exponential", "Ktc": 9e8, "Krc": 4e8, "h0": 1e-4,
                     "exponent": exponent},
        "cut": {"mode": "slot", "spindle_speed": 1300.0, "feed_per_tooth": 1e-4,
                "axial_depth": 1e-3},
        "structure": {"mode": modes},
    }  # fmt: skip
    model = milling_model(Case.from_dict(case))
    speeds, depths = np.array([1300.0, 2400.0]), np.linspace(0.0, 10e-3, 21)[1:]
    curves = [
        METHODS[name].limits(model, speeds, depths, None, no_progress)
        for name in ("multi-frequency", "collocation")
    ]
    assert np.isfinite(curves[1].critical_depth).all()
    assert curves[0].critical_depth == pytest.approx(curves[1].critical_depth, rel=2e-3)


def test_multi_frequency_of_a_serrated_edge():
    """Many pieces, but no more delays than there are teeth: memory goes with these."""
    wave = {"depth": 0.15e-3, "wavelength": 1.5e-3}
    model = tool_922(2, 0.3, "up", teeth=3, serration=wave)
    speed, depths = np.array([12000.0]) * RPM, np.linspace(0.0, 4e-3, 9)[1:]
    curves = [
        METHODS[name].limits(model, speed, depths, None, no_progress)
        for name in ("multi-frequency", "collocation")
    ]
    assert np.isfinite(curves[0].critical_depth).all()
    assert curves[0].critical_depth == pytest.approx(curves[1].critical_depth, rel=2e-3)
    assert harmonics_at(model.cut(4e-3), 4e-3, 3).delay.size == 3


def test_zero_order_of_unequal_pitch_makes_the_determinant_vanish():
    model = altintas_engin_budak()
    speeds = np.array([3000, 5000, 8000]) * RPM
    limit = zero_order_of(model, speeds)
    delays, means = model.averaged_coefficients
    for speed, depth, frequency in zip(
        speeds, limit.critical_depth, limit.chatter_frequency, strict=True
    ):
        receptance = receptance_matrix(model.structure.modes, [frequency])[0][:2, :2]
        phase = np.exp(-2j * np.pi * frequency * delays / speed)
        regenerated = np.einsum("g,gij->ij", 1.0 - phase, means)
        assert abs(np.linalg.det(np.eye(2) + depth * receptance @ regenerated)) < 5e-3


def test_methods_for_like_teeth_say_so():
    model = altintas_engin_budak()
    for name in ("semi-discretization", "semi-discretization-0", "full-discretization"):
        with pytest.raises(InputError, match="uniform-pitch"):
            METHODS[name].limits(
                model, np.array([500.0]), np.array([1e-3, 2e-3]), None, no_progress
            )
