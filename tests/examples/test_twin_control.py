"""The machines of Twin-Control of the examples, against its chapter 3 and by themselves."""

import numpy as np
import pytest

import chatter
from chatter.compile.machine_parts import assembled_machine
from chatter.engine.loop_stability import least_stable_motion
from chatter.simulation.virtual_tests.frf import peaks
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "machine-twin-control"


@pytest.fixture(scope="module")
def run():
    return example_module("machine-twin-control")


@pytest.fixture(scope="module")
def comau():
    return chatter.load_machine(EXAMPLE / "comau.toml")


@pytest.fixture(scope="module")
def gepro():
    return chatter.load_machine(EXAMPLE / "gepro.toml")


@pytest.fixture(scope="module")
def hammered(comau):
    return chatter.frf(comau)


@pytest.fixture(scope="module")
def tests(comau, hammered, run):
    return {
        name: run.HammerTest(run.held(comau, name).harmonic, hammered[name])
        for name in run.PUBLISHED
    }


def test_peaks_lie_where_published(tests, run):
    for name, published in run.PUBLISHED.items():
        for frequency in published:
            for frf in tests[name].both().values():
                found = run.peak_near(frf, frequency)["frequency_Hz"]
                # the chapter's own model is within 10 % of its measurement
                assert found == pytest.approx(frequency, rel=0.03), name


def test_running_loops_damp_the_frame_where_springs_do_not(tests, run):
    springs, running = (
        run.peak_near(one, 110.0)["magnitude"] for one in tests["frame_x"].both().values()
    )
    assert running < 0.5 * springs


def test_blow_in_time_agrees_with_the_linearised_loops(hammered, run):
    for curve in hammered.curves:
        assert np.median(run.difference(curve)) < 2e-3
        assert np.percentile(run.difference(curve), 95.0) < 1.2e-2
        for one in peaks(curve.harmonic):
            level = np.interp(
                one["frequency_Hz"], curve.tested.frequency, np.abs(curve.tested.values)
            )
            assert level == pytest.approx(one["magnitude"], rel=2e-2)


def test_fastest_move_has_the_published_error_and_its_own_force(comau):
    move = chatter.move(comau, "fast")
    assert np.max(np.abs(move.tracking_error)) == pytest.approx(28e-6, rel=0.02)
    # it comes while accelerating, and is gone at the end
    assert abs(move.tracking_error[-1, 0]) < 0.5e-6
    masses = sum(comau.get(f"body.{one}.mass") for one in ("y_frame", "z_frame"))
    assert np.max(move.effort) == pytest.approx((masses + 32.0) * 15.0, rel=0.06)


def test_loops_are_stable(comau, gepro):
    for machine in (comau, gepro):
        assert least_stable_motion(assembled_machine(machine), machine.step).stable


def test_four_drives_in_parallel_carry_the_gantry(gepro, run):
    # its nodding on the guides lowers the mode a little
    assert run.drive_mode(gepro) == pytest.approx(run.of_springs(gepro), rel=0.05)
    stiff = gepro.patch({"connector.guide.stiffness.z": 1e12})
    assert run.drive_mode(stiff) == pytest.approx(run.of_springs(stiff), rel=0.01)


def test_preload_closes_over_the_teeth_and_torque_is_shared(gepro, run):
    gentle, fast = (run.teeth_in(gepro, name) for name in ("gentle", "fast"))
    still = gentle.teeth[gentle.time < 0.58][-1]
    travel = 0.060 / 20.0
    assert still == pytest.approx(12.0 / travel * np.array([1.0, -1.0, 1.0, -1.0]), rel=1e-3)
    begun = gentle.time > 0.6
    assert np.all(gentle.teeth[begun][:, [0, 2]] > 0.0)
    assert np.all(gentle.teeth[begun][:, [1, 3]] < 0.0)
    assert np.min(fast.teeth[fast.time > 0.6][:, 0]) < 0.0
    # while the acceleration is constant the teeth carry m a
    accelerating = (fast.time > 0.75) & (fast.time < 0.80)
    pushing = np.mean(np.sum(fast.teeth[accelerating], axis=1))
    assert pushing == pytest.approx(12_000.0 * 2.0, rel=0.02)
    assert np.ptp(fast.torque - fast.torque[:, :1], axis=0) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("preload", "gap"), [(12.0, 0), (1.0, 0), (0.8, 35e-6), (0.0, 35e-6)])
def test_a_reversal_loses_the_gap_where_the_preload_is_less_than_the_load(gepro, run, preload, gap):
    """1200 N of friction are 300 N at each of four pinions: 0.9 N m at a motor, at 3 mm/rad.

    Coupling, gearbox and mesh in a row, four times in parallel, strain by F/K either way.
    """
    assert gepro.get("axis.X.drive.backlash") == pytest.approx(35e-6)
    soft = 0.003**2 / 20e3 + 0.06**2 / 400e3 + 1.0 / 500e6
    expected = gap + 2.0 * 1200.0 * soft / 4.0
    found = run.lost_motion(run.reversal(gepro, preload))
    assert found == pytest.approx(expected, rel=2e-3)
    assert run.lost_motion_by_hand(gepro, preload) == pytest.approx(expected, rel=1e-9)


def test_heights_at_the_tip_are_near_those_of_the_chapter(tests, run):
    """Within a factor of 1.3 of its model by springs; running loops damp them further."""
    for name, frequency, model in run.HEIGHTS:
        for frf, factor in zip(tests[name].both().values(), (1.3, 2.0), strict=True):
            height = run.peak_near(frf, frequency)["magnitude"] / 9.81
            assert 1.0 / factor < height / model < factor, (name, frequency)


def test_the_frame_in_six_configurations(comau, run):
    assert len(run.CONFIGURATIONS) == 6
    for test in run.in_configurations(comau):
        for frequency in run.PUBLISHED["frame_x"]:
            found = [run.peak_near(one, frequency)["frequency_Hz"] for one in test.both().values()]
            # the chapter's own margin, and a little for positions that it does not give
            assert found[0] == pytest.approx(frequency, rel=0.12)
            assert found[1] == pytest.approx(found[0], rel=0.05)
