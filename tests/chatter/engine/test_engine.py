"""Order of the scheme, energy, limits of the model, and the compiled loop."""

import itertools
import math
import os
import subprocess
import sys

import numpy as np
import pytest
import scipy.integrate
from numba import njit

from chatter import Case
from chatter.description.errors import RunError
from chatter.engine.loop import run as compiled
from chatter.engine.presets import TIME_LOOP
from chatter.engine.record import COLUMNS
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup, simulate

MODES = [
    {"frequency": "410 Hz", "damping": 0.03, "stiffness": 9e6, "direction": [1, 0, 0]},
    {
        "frequency": "530 Hz", "damping": 0.02, "stiffness": 1.4e7, "direction": [0.6, 0.8, 0],
        "side": "workpiece",
    },
]  # fmt: skip


def case(modes=MODES, tool=None, material=None, cut=None, simulation=None, **sections):
    """Stable cut with helix and more than one tooth in it; no tooth leaves the work."""
    return Case.from_dict(
        {
            "title": "a smooth cut",
            "tool": {
                "kind": "end mill", "teeth": 4, "diameter": "16 mm", "helix": "35 deg",
                **(tool or {}),
            },
            "material": {"law": "linear", "Ktc": 8e8, "Krc": 3e8, "Kac": 1e8, **(material or {})},
            "cut": {
                "mode": "down",
                "spindle_speed": "4000 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1.5 mm",
                "radial_depth": "6 mm",
                **(cut or {}),
            },
            "structure": {"mode": modes},
            "simulation": {"revolutions": 3, **(simulation or {})},
            **sections,
        }
    )  # fmt: skip


def signals(steps, slices=8, **given):
    found = simulate(case(simulation={"steps": steps, "slices": slices}, **given))
    assert found.setup.resolution.stride == 1
    stride = steps // 180
    return np.hstack([found.force[::stride] * 1e-8, found.displacement[::stride]])


#: with 720 steps a turn all entries, exits and ends of slices fall on steps, as the order of a
#: sum over kinks shows only where they keep their place within a step
ALIGNED_DEPTH = math.pi / 18.0 * 8e-3 / math.tan(math.radians(35.0))


def order_in_step(mode, width, coarsest=360, **given):
    """Order from the changes between four step sizes, each half the one before."""
    cut = {"mode": mode, "radial_depth": width, "axial_depth": ALIGNED_DEPTH}
    runs = [signals(coarsest * 2**i, 5, cut=cut, **given) for i in range(4)]
    moving = np.abs(runs[-1]).max(axis=0) > 0.0
    changes = np.array([
        np.sqrt(np.mean((fine - coarse)[:, moving] ** 2, axis=0))
        for coarse, fine in itertools.pairwise(runs)
    ])  # fmt: skip
    size = np.sqrt(np.mean(runs[-1][:, moving] ** 2, axis=0))
    return np.log2(changes[:-1] / changes[1:]), changes[-1] / size


@pytest.mark.parametrize(
    ("mode", "width"), [("down", "4 mm"), ("up", "8 mm"), ("slot", "16 mm"), ("up", "4 mm")]
)
def test_second_order_in_the_step(mode, width):
    order, change = order_in_step(mode, width)
    # displacement strictly; forces take on a little where the chip vanishes at the end of the arc
    assert np.all(np.abs(order[:, 3:] - 2.0) < 0.1)
    assert np.all(np.abs(order - 2.0) < 0.5)
    assert change.max() < 5e-4


def test_second_order_with_unequal_pitch_and_motion_in_three_directions():
    modes = [{**MODES[0], "direction": [0.48, 0.6, 0.64]}, MODES[1]]
    order, change = order_in_step(
        "up", "4 mm", modes=modes, tool={"pitch": ["80 deg", "100 deg", "90 deg", "90 deg"]}
    )
    assert np.all(np.abs(order - 2.0) < 0.3)
    assert change.max() < 5e-4


def test_process_damping_is_of_second_order_too():
    order, change = order_in_step(
        "up", "4 mm", process_damping={"coefficient": 1e5, "friction": 0.3}
    )
    assert np.all(np.abs(order - 2.0) < 0.3)
    assert change.max() < 5e-4


def test_halving_the_step_matters_little_by_default():
    coarse = simulate(case(material={"Kte": 2e4, "Kre": 3e4}))
    steps = coarse.setup.resolution.steps_per_revolution
    fine = simulate(case(material={"Kte": 2e4, "Kre": 3e4}, simulation={"steps": 8 * steps}))
    for name in ("force", "displacement"):
        one, other = getattr(coarse, name), getattr(fine, name)[::8]
        difference = np.sqrt(np.mean((one - other) ** 2, axis=0))
        size = np.sqrt(np.mean(other**2, axis=0))
        assert np.all(difference < 2e-3 * size + 1e-15)


def test_slices_converge_with_the_fourth_power_in_a_vibrating_cut():
    given = {"cut": {"axial_depth": "12 mm"}, "modes": [{**MODES[0], "stiffness": 9e7}]}
    truth = signals(720, 32, **given)
    errors = [np.sqrt(np.mean((signals(720, n, **given) - truth) ** 2)) for n in (2, 4, 8)]
    # two Gauss points a slice, where the chip stays positive; ends of the arc take a little
    assert np.log2(errors[0] / errors[1]) > 3.5
    assert np.log2(errors[1] / errors[2]) > 3.0


def test_slices_converge_where_edges_leave_the_work():
    """Waves of all earlier teeth meet where the chip vanishes; the edge terms end with it."""
    root = [0.814, 0.581, 0.0]
    given = {
        "modes": [{"frequency": "101.3 Hz", "damping": 0.016, "mass": 70.7, "direction": root}],
        "tool": {"teeth": 3, "diameter": "7.25 mm", "helix": "22.4 deg"},
        "material": {"Ktc": 2.02e9, "Krc": 5.9e8, "Kac": 4e8, "Kte": 4e4, "Kre": 3.2e4},
        "cut": {
            "mode": "up", "spindle_speed": "1032 rpm", "feed_per_tooth": "86.6 um",
            "axial_depth": "7.25 mm", "radial_depth": "1.437 mm",
        },
        "simulation": {"revolutions": 12, "steps": 720},
    }  # fmt: skip

    def moved(slices):
        given["simulation"]["slices"] = slices
        return simulate(case(**given)).displacement[:, :2]

    truth = moved(80)
    default = moved(9)
    size = np.sqrt(np.mean(truth**2, axis=0))
    assert np.all(np.sqrt(np.mean((default - truth) ** 2, axis=0)) < 2e-3 * size)


def imbalance(steps, **given):
    found = simulate(case(simulation={"steps": steps, "slices": 8, "revolutions": 5}, **given))
    energy = found.energy
    assert energy["dissipated"] > 0.0
    assert energy["stored"] > 0.0
    return abs(energy["work"] - energy["dissipated"] - energy["stored"]) / energy["work"]


def test_work_is_what_is_stored_and_dissipated():
    assert imbalance(2880) < 1e-6
    assert imbalance(5760) < 2e-8


def test_energy_balance_is_of_fourth_order():
    errors = np.array([imbalance(steps) for steps in (720, 1440, 2880)])
    assert np.all(np.abs(np.log2(errors[:-1] / errors[1:]) - 4.0) < 0.5)


def test_work_on_the_structure_is_the_integral_of_force_times_velocity():
    found = simulate(case(simulation={"steps": 5760, "slices": 8}))
    velocity = np.gradient(found.displacement, found.time, axis=0, edge_order=2)
    power = np.sum(found.force * velocity, axis=1)
    work = scipy.integrate.trapezoid(power, found.time)
    assert work == pytest.approx(found.energy["work"], rel=1e-3)


def test_static_deflection_under_the_mean_force():
    # far above the mode the tool sees only the mean force
    modes = [{"frequency": "1 Hz", "damping": 0.9, "stiffness": 1e6, "direction": [0, 1, 0]}]
    found = simulate(case(modes=modes, simulation={"revolutions": 400, "steps": 180}))
    last = slice(-180 * 4 - 1, -1)
    assert found.displacement[last, 1].mean() == pytest.approx(
        found.force[last, 1].mean() / 1e6, rel=1e-3
    )
    assert np.all(found.displacement[:, 0] == 0.0)


def test_side_of_a_mode_changes_nothing():
    tool = simulate(case(modes=[{**mode, "side": "tool"} for mode in MODES]))
    work = simulate(case(modes=[{**mode, "side": "workpiece"} for mode in MODES]))
    assert np.array_equal(tool.rows, work.rows)


def test_start_is_at_rest():
    found = simulate(case())
    assert np.all(found.displacement[0] == 0.0)
    assert np.any(found.force[0] != 0.0)


def test_rows_and_times():
    found = simulate(case(simulation={"revolutions": 2.5, "steps": 360}))
    assert found.time.size == 901
    assert found.time[-1] == pytest.approx(2.5 * 60.0 / 4000.0)
    assert found.revolutions == pytest.approx(2.5)


VERY_SOFT = [{"frequency": "300 Hz", "damping": 0.01, "stiffness": 2e4, "direction": [0, 1, 0]}]


def test_a_far_too_soft_structure_stops_with_a_sentence():
    with pytest.raises(RunError) as caught:
        simulate(case(modes=VERY_SOFT, cut={"axial_depth": "15 mm"}))
    text = str(caught.value)
    assert "displaced by more than" in text
    assert "mm" in text
    assert "\n" not in text


def test_what_was_recorded_before_the_stop_is_finite():
    setup = set_up(case(modes=VERY_SOFT, cut={"axial_depth": "15 mm"}))
    found, done = run_setup(setup)
    assert 0 < done < setup.resolution.steps
    assert not found.complete
    assert len(found.rows) == done // setup.resolution.stride + 1
    assert np.all(np.isfinite(found.rows))
    assert np.abs(found.displacement).max() <= setup.furthest


def test_chatter_is_bounded_by_loss_of_contact():
    found = simulate(case(cut={"axial_depth": "9 mm"}, simulation={"revolutions": 60}))
    assert np.all(np.isfinite(found.rows))
    amplitude = np.abs(found.displacement[-2000:, :2]).max()
    assert 1e-5 < amplitude < 2e-3


def test_interrupt_between_chunks_leaves_the_next_run_as_it_was():
    given = case(simulation={"revolutions": 100, "steps": 720})
    whole = simulate(given)

    def interrupt(done, total):
        if done > 0:
            raise KeyboardInterrupt

    part = simulate(given, progress=interrupt)
    assert part.interrupted
    assert 0 < part.revolutions < 100
    assert np.array_equal(part.rows, whole.rows[: len(part.rows)])
    assert any("interrupted" in note for note in part.summary()["notes"])
    assert np.array_equal(simulate(given).rows, whole.rows)


def test_progress_counts_to_the_end():
    seen = []
    simulate(
        case(simulation={"revolutions": 100, "steps": 720}), progress=lambda *at: seen.append(at)
    )
    assert len(seen) >= 3
    assert seen[-1] == (72000, 72000)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_same_case_twice_gives_the_same_bits():
    assert np.array_equal(simulate(case()).rows, simulate(case()).rows)


def test_numbers_and_counts_do_not_compile_again():
    simulate(case())
    before = len(compiled.signatures)
    simulate(case(tool={"teeth": 3, "helix": "12 deg"}, cut={"axial_depth": "0.7 mm"}))
    simulate(case(modes=MODES[:1], cut={"mode": "up"}, simulation={"steps": 1200, "slices": 3}))
    simulate(case(tool={"helix": ["30 deg", "35 deg", "30 deg", "35 deg"]}))
    simulate(case(tool={"runout": {"offset": "10 um", "angle": "20 deg"}}))
    variation = {"amplitude": 0.1, "frequency": "10 Hz"}
    simulate(case(cut={"speed_variation": variation}))
    assert len(compiled.signatures) == before


def test_the_loop_counts_no_references():
    # cached code cannot be looked at: compile it anew
    simulate(case())
    fresh = njit(**{**TIME_LOOP, "cache": False})(compiled.py_func)
    fresh.compile(compiled.signatures[0])
    (code,) = fresh.inspect_llvm().values()
    assert "NRT_incref" not in code
    assert "NRT_Allocate" not in code


TINY = {
    "title": "tiny",
    "tool": {
        "kind": "end mill", "teeth": 2, "diameter": "10 mm", "helix": "30 deg",
        "runout": {"offset": "5 um", "angle": "40 deg"}, "clearance_angle": "6 deg",
        "flank_wear": "0.05 mm",
    },
    "material": {"law": "linear", "Ktc": 8e8, "Krc": 3e8, "Kac": 1e8, "Kre": 1e4},
    "cut": {
        "mode": "up", "spindle_speed": "5000 rpm", "feed_per_tooth": "0.1 mm",
        "axial_depth": "2 mm", "radial_depth": "4 mm",
    },
    "structure": {
        "mode": [
            {"frequency": "700 Hz", "damping": 0.03, "stiffness": 1e7, "direction": [0.6, 0.8, 0]}
        ]
    },
    "process_damping": {"indentation_force": 1e14, "friction": 0.3},
    "simulation": {"revolutions": 1.25, "steps": 120},
}  # fmt: skip

SCRIPT = """
import sys
from chatter import Case
from chatter.simulation.simulate import simulate
rows = simulate(Case.from_dict(eval(sys.argv[1]))).rows
print(" ".join(float(value).hex() for value in rows.ravel()))
"""


def test_interpreted_and_compiled_agree():
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", SCRIPT, repr(TINY)],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    interpreted = np.array([float.fromhex(word) for word in done.stdout.split()])
    rows = simulate(Case.from_dict(TINY)).rows
    size = np.abs(rows).max(axis=0)
    still = np.array(COLUMNS) == "z"
    assert np.all(size[~still] > 0.0)
    assert np.all(np.abs(rows - interpreted.reshape(rows.shape)) <= 1e-12 * size)
