"""Members of families put their numbers into the case; what is not determined is not reported."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.signal

from chatter.compile.cutter import force_law, process_damping_of
from chatter.description.case import loads
from chatter.explain.effects.cutting_force import ChipExponent, ProcessDamping
from chatter.explain.effects.dynamometer import Dynamometer, DynamometerOfAxes, DynamometerOfTwo
from chatter.explain.effects.effect_list import candidates
from chatter.explain.effects.missing_mode import MissingMode
from chatter.explain.effects.structure import ModeShift, ModeShiftOf, ModeShiftOfEach
from chatter.explain.effects.tool import (
    Chipping,
    ChippingOfAll,
    Runout,
    SaturatingWear,
    Wear,
    WearOfAll,
)
from chatter.explain.fitting import LeastSquares
from chatter.explain.measurement import Measurement, Run
from chatter.explain.reported_effects import parameters_of
from chatter.explain.selection.evidence import probabilities, whittle, whittle_of_repeated
from chatter.explain.selection.problem import Problem

CASE = loads("""
title = "a cut"
[tool]
kind = "end mill"
teeth = 2
diameter = "12 mm"
helix = "30 deg"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "200 MPa"
Kte = "10 N/mm"
[cut]
mode = "down"
spindle_speed = "6000 rpm"
feed_per_tooth = "0.05 mm"
axial_depth = "0.5 mm"
radial_depth = "6 mm"
[[structure.mode]]
frequency = "700 Hz"
damping = 0.03
mass = "0.6 kg"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "800 Hz"
damping = 0.03
mass = "0.6 kg"
direction = [0, 1, 0]
""")
SPEED = CASE.cut.spindle_speed


def cuts() -> Measurement:
    runs = tuple(
        Run(f"run{k}.csv", {"cut.spindle_speed": f"{5000 + 500 * k} rpm"}, {}, cut_time=2.0 * k)
        for k in range(5)
    )
    return Measurement("milling", "made up", None, CASE, runs)


def test_one_mode_shifts_with_the_square_of_speed():
    effect = ModeShiftOf(1, square=1)
    patched = CASE.patch(effect.patch(CASE, {"square_2": -0.05}))
    first, second = patched.structure.mode
    assert first == CASE.structure.mode[0]
    for share in (0.5, 0.93, 1.4):
        expected = 800.0 * (1.0 - 0.05 * share**2)
        assert second.frequency_at(share * SPEED) == pytest.approx(expected, rel=1e-4)
    assert effect.reported({"square_2": -0.05})["mode"] == (2.0, "")


def test_simple_members_come_first_and_richer_ones_once_they_are_found():
    shifts = [one for one in candidates(cuts()) if isinstance(one, ModeShift)]
    counts = [len(one.parameters(cuts())) for one in shifts]
    assert set(counts) == {1}
    assert len(shifts) == 5  # all alike, two modes by the speed or its square
    (richer,) = shifts[0].richer
    assert isinstance(richer, ModeShiftOfEach)
    assert len(richer.parameters(cuts())) == 4
    assert [type(one) for one in Wear().richer] == [SaturatingWear, Chipping, WearOfAll]
    assert [type(one) for one in Dynamometer().richer] == [DynamometerOfTwo]


def test_chip_exponent_is_one_for_all_directions_or_one_for_radial_forces():
    common = ChipExponent()
    (own,) = common.richer
    linear = force_law(CASE, 0.0)
    h = np.array([2e-5, 5e-5, 2e-4])
    unchanged = force_law(CASE.patch(own.patch(CASE, own.nothing(cuts()))), 0.0)
    assert unchanged.force(h) == pytest.approx(linear.force(h))
    levels_off = own.patch(CASE, {"exponent": 0.9, "radial_exponent": 0.5})
    tangential, radial, _ = force_law(CASE.patch(levels_off), 0.0).force(4e-4)
    # by hand: K h0 4^p, h0 = 0.1 mm; the edge force stays
    assert tangential == pytest.approx(800e6 * 1e-4 * 4.0**0.9 + 10e3)
    assert radial == pytest.approx(200e6 * 1e-4 * 2.0)
    both = force_law(CASE.patch(common.patch(CASE, {"exponent": 0.5})), 0.0)
    assert both.force(4e-4)[0] == pytest.approx(800e6 * 1e-4 * 2.0 + 10e3)


def test_wear_comes_at_once_or_dies_away():
    chipping = Chipping()
    assert [start["time"] for start in chipping.starts(cuts())] == [1.0, 3.0, 5.0, 7.0]
    values = {"edge_tangential": 4e3, "edge_radial": 0.0, "cutting": 0.1, "time": 3.0}
    wear = CASE.patch(chipping.patch(CASE, values)).wear
    assert [wear.increase("cutting", time) for time in (2.0, 4.0)] == [0.0, 0.1]
    values = {"edge_tangential": 0.0, "edge_radial": 0.0, "cutting": 0.1, "saturation_time": 2.0}
    wear = CASE.patch(SaturatingWear().patch(CASE, values)).wear
    assert wear.increase("cutting", 100.0) == pytest.approx(0.2)


def test_every_coefficient_wears_by_itself():
    """Also a process damping that a sharp tool does not have."""
    effect = WearOfAll()
    names = [one.name for one in effect.parameters(cuts())]
    rates = {
        "edge_tangential": 1e3, "edge_radial": 2e3, "cutting": 0.02, "cutting_radial": 0.05,
        "ploughing": 3e3,
    }  # fmt: skip
    assert set(names) == set(rates)
    worn = CASE.patch({**effect.patch(CASE, rates), "cut.cut_time": 4.0})
    law = force_law(worn, 0.0)
    assert law.cutting[:2] == pytest.approx((800e6 * 1.08, 200e6 * 1.2))
    assert law.edge[:2] == pytest.approx((10e3 + 4e3, 8e3))
    assert process_damping_of(worn).coefficient == pytest.approx(12e3)
    assert process_damping_of(worn.patch({"cut.cut_time": 0.0})) is None
    # all alike where the radial one is not named
    alike = {key: value for key, value in rates.items() if key != "cutting_radial"}
    law = force_law(CASE.patch({**effect.patch(CASE, alike), "cut.cut_time": 4.0}), 0.0)
    assert law.cutting[:2] == pytest.approx((800e6 * 1.08, 200e6 * 1.08))
    chipped = {**rates, "time": 3.0}
    worn = CASE.patch({**ChippingOfAll().patch(CASE, chipped), "cut.cut_time": 4.0})
    assert process_damping_of(worn).coefficient == pytest.approx(3e3)


def test_effects_are_put_in_one_after_the_other():
    """A mode that is added does not take back what shifts the others."""
    problem = Problem(cuts(), None, {}, (ModeShift(), MissingMode()))
    mode = {"frequency": 300.0, "damping": 0.03, "compliance": 1e-8, "angle": 0.0}
    values = {"mode_shift.slope": 1e-5, **{f"missing_mode.{key}": v for key, v in mode.items()}}
    modes = problem.case(values).structure.mode
    assert [one.frequency_slope for one in modes] == [1e-5, 1e-5, 0.0]
    assert modes[2].frequency == 300.0


def test_runout_is_sought_from_little_and_from_where_one_tooth_hardly_cuts():
    """5 µm, and a quarter of the median feed per tooth, 40 µm, in directions of one pitch."""
    runs = [
        replace(
            run, overrides={"cut.feed_per_tooth": feed}, record=SimpleNamespace(knows_tooth=False)
        )
        for run, feed in zip(cuts().runs, ("20 um", "40 um", "200 um"), strict=False)
    ]
    starts = Runout().starts(cuts().with_runs(runs))
    offsets = [np.hypot(one["across"], one["along"]) for one in starts]
    assert offsets == pytest.approx([5e-6] * 3 + [10e-6] * 3)
    angles = [np.degrees(np.arctan2(one["along"], one["across"])) for one in starts]
    pitch = 360.0 / CASE.tool.teeth
    assert angles == pytest.approx([0.0, pitch / 3.0, 2.0 * pitch / 3.0] * 2)
    # where the tooth is known: nothing, and little in the four directions of the tool
    nothing, *around = Runout().starts(cuts())
    assert nothing == {}
    assert {(one["across"], one["along"]) for one in around} == {
        (5e-6, 0.0), (-5e-6, 0.0), (0.0, 5e-6), (0.0, -5e-6),
    }  # fmt: skip


def test_two_teeth_show_the_difference_of_their_radii_alone():
    effect = Runout()
    parameters = [replace(one, name=f"runout.{one.name}") for one in effect.parameters(cuts())]

    def residuals(values):
        across, along = values * 1e6
        # next to nothing of the part across, as the model curves
        return np.full(400, 20.0 * (along - 11.5) + 1e-9 * across**2)

    found = LeastSquares(parameters, residuals).fit(np.zeros(2))
    reported = parameters_of(found, effect)
    assert reported["offset"]["value"] == pytest.approx(11.5e-6, rel=0.01)  # the smallest
    low, high = reported["offset"]["ci95"]
    assert low < 11.6e-6
    assert high > 1e-3  # as far as the bounds go
    low, high = reported["along"]["ci95"]
    assert 11.4e-6 < low < 11.5e-6 < high < 11.6e-6


def test_evidence_of_what_a_spectrum_hides_is_small():
    rng = np.random.default_rng(2)
    noise, time = rng.standard_normal(2000), np.arange(2000)
    assert whittle(noise) == pytest.approx(-1000.0, rel=0.1)
    ripple = 30.0 * np.sin(2.0 * np.pi * 0.05 * time)
    step = 1.0 * (time > 1000)
    beside, alone = whittle(noise + ripple + step), whittle(noise + ripple)
    # a step at low frequencies is seen beside a ripple at others
    assert alone - beside > 10.0
    # a change at the ripple's own frequency is not
    assert abs(whittle(noise + 1.01 * ripple) - alone) < 1.0
    assert probabilities([0.0, -np.log(3.0)]) == pytest.approx([0.75, 0.25])


def test_what_repeats_counts_once_however_long_it_was_recorded():
    """Harmonics of a revolution of 97.3 samples, halved: the gain is that of the harmonics."""
    rng, turn, orders = np.random.default_rng(5), 97.3, np.arange(1, 41)
    phases = rng.uniform(0.0, 2.0 * np.pi, orders.size)
    gains = []
    for size in (4000, 16000):
        time, noise = np.arange(size), rng.standard_normal(size)
        waves = np.cos(2.0 * np.pi * np.outer(time, orders) / turn + phases).sum(axis=1)
        more, less = (whittle_of_repeated(noise + a * waves, turn) for a in (20.0, 10.0))
        gains.append(less - more)
    # half the amplitude of a harmonic: the logarithm of a quarter of its power
    expected = orders.size * np.log(4.0)
    assert gains == pytest.approx([expected, expected], rel=0.1)
    # of noise alone it is no other than without a revolution
    noise = rng.standard_normal(4000)
    assert whittle_of_repeated(noise, turn) == pytest.approx(-2000.0, rel=0.1)


def test_one_small_harmonic_does_not_outweigh_what_is_gained_beside_it():
    time, turn = np.arange(8000), 100.0
    noise = np.random.default_rng(6).standard_normal(time.size)

    def residual(large, small):
        tooth = np.cos(2.0 * np.pi * np.outer(time, np.arange(2, 40, 2)) / turn).sum(axis=1)
        runout = np.cos(2.0 * np.pi * np.outer(time, np.arange(1, 40, 2)) / turn).sum(axis=1)
        return noise + large * tooth + small * runout

    # a third of the large ones gained, the small ones lost twofold
    before, after = residual(30.0, 1.0), residual(20.0, 2.0)
    assert whittle_of_repeated(after, turn) > whittle_of_repeated(before, turn) + 10.0
    assert whittle(after) < whittle(before)


def test_a_sensor_has_a_resonance_along_each_axis_that_is_measured():
    time = 1e-4 * np.arange(10)
    signals = {"time": time, "Fx": time, "Fy": time}
    measured = cuts().with_runs([replace(run, signals=signals) for run in cuts().runs])
    members = [one for one in candidates(measured) if one.name == "dynamometer"]
    assert [type(one).__name__ for one in members] == ["Dynamometer", "DynamometerOfAxes"]
    effect = members[1]
    names = [one.name for one in effect.parameters(measured)]
    assert names == ["frequency_x", "damping_x", "frequency_y", "damping_y"]
    case = CASE.patch(effect.patch(CASE, dict(zip(names, (780.0, 0.05, 990.0, 0.04), strict=True))))
    (along_x,), (along_y,) = case.dynamometer.along("x"), case.dynamometer.along("y")
    assert (along_x.frequency, along_x.damping, along_x.share) == (780.0, 0.05, 1.0)
    assert (along_y.frequency, along_y.damping) == (990.0, 0.04)
    assert case.dynamometer.along("z") == ()
    # from rest the residual proposes them; in settled cuts both orders of any two are tried
    assert effect.starts(measured) == []
    settled = measured.with_runs([replace(run, record=object()) for run in measured.runs])
    starts = {(one["frequency_x"], one["frequency_y"]) for one in effect.starts(settled)}
    assert {(y, x) for x, y in starts} == starts
    assert len(starts) == 100
    assert not DynamometerOfAxes().applies(measured.with_case(case))


def seen_through(force, time, resonances):
    """Force through resonances by shares, by another integration of the oscillators."""
    total = np.zeros_like(force)
    for frequency, damping, share in resonances:
        omega = 2.0 * np.pi * frequency
        system = scipy.signal.lti([omega**2], [1.0, 2.0 * damping * omega, omega**2])
        total += share * scipy.signal.lsim(system, force, time)[1]
    return total


def test_frequencies_of_a_sensor_are_proposed_axis_by_axis():
    """What forces before the sensor become, axis by axis; two resonances share the force of x."""
    random, time = np.random.default_rng(3), np.arange(4000) / 12.8e3
    sensors = {"Fx": [(620.0, 0.03, 0.6), (1500.0, 0.05, 0.4)], "Fy": [(1100.0, 0.04, 1.0)]}
    runs, predicted = [], {}
    for run in cuts().runs:
        forces = {name: np.cumsum(random.standard_normal(time.size)) for name in sensors}
        seen = {name: seen_through(forces[name], time, sensors[name]) for name in sensors}
        runs.append(replace(run, signals={"time": time, **seen}))
        predicted[run.name] = forces
    measured = cuts().with_runs(runs)
    step = 1.2 * 6400.0 / 400.0
    grid = step ** (1.0 / 35.0)
    best = DynamometerOfAxes().proposed(measured, predicted)[0]
    assert best["frequency_y"] == pytest.approx(1100.0, rel=grid - 1.0)
    (pair,) = DynamometerOfTwo().proposed(measured, predicted)
    found = sorted((pair["frequency_x_1"], pair["frequency_x_2"]))
    assert found == pytest.approx([620.0, 1500.0], rel=grid - 1.0)
    low = pair["share_x_1"] if pair["frequency_x_1"] < 1000.0 else 1.0 - pair["share_x_1"]
    assert low == pytest.approx(0.6, abs=0.1)
    case = CASE.patch(DynamometerOfTwo().patch(CASE, {**pair, **{
        f"damping_{axis}_{k}": 0.03 for axis in "xy" for k in (1, 2)
    }}))  # fmt: skip
    assert sum(one.share for one in case.dynamometer.along("x")) == pytest.approx(1.0)


def test_the_process_damping_of_a_heavy_slow_machine_is_known_as_well_as_that_of_a_light_one():
    """At 700 rpm and 50 Hz 1e7 N/m is as usual as 1e5 N/m elsewhere; it is known to 8 percent."""
    heavy = CASE.patch(
        {
            "tool.diameter": "50 mm",
            "material.Ktc": "2200 MPa",
            "cut.spindle_speed": "700 rpm",
            "structure.mode[0].frequency": "50 Hz",
        }
    )
    effect, true, deviation = ProcessDamping(), 1e7, 8e5
    (own,) = effect.parameters(SimpleNamespace(case=heavy))
    own = replace(own, name=f"{effect.name}.{own.name}")
    found = LeastSquares([own], lambda values: (values - true) / deviation).fit(np.zeros(1))
    reported = parameters_of(found, effect)["coefficient"]
    assert reported["value"] == pytest.approx(true, rel=0.02)
    assert reported["ci95"] == pytest.approx(
        [true - 1.96 * deviation, true + 1.96 * deviation], rel=0.03
    )


def test_the_power_and_the_mode_of_a_shift_are_chosen_and_have_no_interval():
    """Three members are tried with whole powers; no data give one of them 0.4 percent."""
    effect, true, deviation = ModeShiftOf(1, square=1), -0.12, 0.004
    (own,) = effect.parameters(SimpleNamespace(case=CASE))
    own = replace(own, name=f"{effect.name}.{own.name}")
    found = LeastSquares([own], lambda values: (values - true) / deviation).fit(np.zeros(1))
    reported = parameters_of(found, effect)
    assert (reported["power"]["value"], reported["power"]["ci95"]) == (2.0, None)
    assert (reported["mode"]["value"], reported["mode"]["ci95"]) == (2.0, None)
    assert reported["change"]["ci95"] == pytest.approx(
        [true - 1.96 * deviation, true + 1.96 * deviation], rel=0.01
    )
