"""Order of the scheme, energy, limits of the model, and the compiled loop."""

import math
import subprocess
import sys
import textwrap

import numpy as np
import pytest

from chatter import Case
from chatter.errors import RunError
from chatter.simulation.engine import run as compiled
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
    stride = steps // 180
    assert found.setup.resolution.stride == 1
    return np.hstack([found.force[::stride] * 1e-8, found.displacement[::stride]])


def order_in_step(**given):
    """Order between steps of 1/360 and 1/720 turn, against sixteen times finer ones."""
    truth = signals(720 * 16, **given)
    errors = np.array([np.sqrt(np.mean((signals(n, **given) - truth) ** 2, axis=0))
                       for n in (360, 720)])  # fmt: skip
    moving = np.abs(truth).max(axis=0) > 0.0
    size = np.sqrt(np.mean(truth[:, moving] ** 2, axis=0))
    return np.log2(errors[0, moving] / errors[1, moving]), errors[1, moving] / size


@pytest.mark.parametrize("mode", ["down", "up", "slot"])
def test_second_order_in_the_step(mode):
    order, error = order_in_step(cut={"mode": mode})
    assert np.all(order > 1.7)
    # the displacement follows smoothly; forces gain from points where the error changes sign
    assert np.median(order) < 2.5
    assert error.max() < 2e-3


def test_second_order_with_unequal_pitch_and_workpiece_mode_of_three_directions():
    modes = [{**MODES[0], "direction": [0.48, 0.6, 0.64]}, MODES[1]]
    order, error = order_in_step(
        modes=modes, tool={"pitch": ["85 deg", "95 deg", "88 deg", "92 deg"]}
    )
    assert np.all(order > 1.7)
    assert error.max() < 2e-3


def test_process_damping_is_of_second_order_too():
    order, error = order_in_step(process_damping={"coefficient": 1e5, "friction": 0.3})
    assert np.all(order > 1.6)
    assert error.max() < 3e-3


def test_halving_the_step_matters_little_by_default():
    coarse = simulate(case(material={"Kte": 2e4, "Kre": 3e4}))
    steps = coarse.setup.resolution.steps_a_turn
    fine = simulate(case(material={"Kte": 2e4, "Kre": 3e4}, simulation={"steps": 8 * steps}))
    for name in ("force", "displacement"):
        one, other = getattr(coarse, name), getattr(fine, name)[::8]
        difference = np.sqrt(np.mean((one - other) ** 2, axis=0))
        size = np.sqrt(np.mean(other**2, axis=0))
        assert np.all(difference < 2e-3 * size + 1e-15)


def test_slices_converge_to_high_order_in_a_vibrating_cut():
    truth = signals(720, 64)
    errors = [np.sqrt(np.mean((signals(720, n) - truth) ** 2)) for n in (1, 2, 4)]
    # two Gauss points a slice are of fourth order where the chip stays positive
    assert np.log2(errors[0] / errors[1]) > 1.8
    assert np.log2(errors[1] / errors[2]) > 1.8


# 40 % of the feed in vibration and an edge term, so that edges leave the work within a slice
@pytest.mark.parametrize("mode", ["up", "down"])
def test_slices_converge_where_edges_leave_the_work(mode):
    soft = [{**MODES[0], "stiffness": 1.5e6, "frequency": "101 Hz"}]
    given = {
        "modes": soft,
        "cut": {"mode": mode, "radial_depth": "1.6 mm", "axial_depth": "4 mm"},
        "material": {"Kte": 4e4, "Kre": 3e4},
    }
    truth = signals(1440, 128, **given)
    size = np.sqrt(np.mean(truth**2, axis=0))
    moving = size > 0.0
    errors = [
        np.max(np.sqrt(np.mean((signals(1440, n, **given) - truth) ** 2, axis=0))[moving]
               / size[moving])
        for n in (4, 8, 16)
    ]  # fmt: skip
    assert errors[0] < 5e-3
    assert errors[2] < errors[0] / 6.0


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
    assert np.trapezoid(power, found.time) == pytest.approx(found.energy["work"], rel=1e-3)


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
    assert found.turns == pytest.approx(2.5)


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

    with pytest.raises(KeyboardInterrupt):
        simulate(given, interrupt)
    assert np.array_equal(simulate(given).rows, whole.rows)


def test_progress_counts_to_the_end():
    seen = []
    simulate(case(simulation={"revolutions": 100, "steps": 720}), lambda *at: seen.append(at))
    assert len(seen) >= 3
    assert seen[-1] == (72000, 72000)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_same_case_twice_gives_the_same_bits():
    assert np.array_equal(simulate(case()).rows, simulate(case()).rows)


def test_numbers_and_counts_do_not_compile_again():
    simulate(case())
    before = len(compiled.signatures)
    simulate(case(tool={"teeth": 3, "helix": "12 deg"}, cut={"axial_depth": "0.7 mm"}))
    simulate(case(modes=MODES[:1], cut={"mode": "slot"}, simulation={"steps": 1200, "slices": 3}))
    simulate(case(tool={"helix": ["30 deg", "35 deg", "30 deg", "35 deg"]}))
    simulate(case(tool={"runout": {"offset": "10 um", "angle": "20 deg"}}))
    variation = {"amplitude": 0.1, "frequency": "10 Hz"}
    simulate(case(cut={"speed_variation": variation}))
    assert len(compiled.signatures) == before


def test_the_loop_counts_no_references():
    simulate(case())
    for code in compiled.inspect_llvm().values():
        assert "NRT_incref" not in code
        assert "NRT_Allocate" not in code


TINY = """
    import sys
    import numpy as np
    from chatter import Case
    from chatter.simulation.simulate import simulate
    found = simulate(Case.from_dict({
        "title": "tiny",
        "tool": {"kind": "end mill", "teeth": 2, "diameter": "10 mm", "helix": "30 deg",
                 "runout": {"offset": "5 um", "angle": "40 deg"}, "clearance_angle": "6 deg",
                 "flank_wear": "0.05 mm"},
        "material": {"law": "exponential", "Ktc": 8e8, "Krc": 3e8, "Kre": 1e4, "h0": "0.1 mm",
                     "exponent": 0.8},
        "cut": {"mode": "up", "spindle_speed": "5000 rpm", "feed_per_tooth": "0.1 mm",
                "axial_depth": "2 mm", "radial_depth": "4 mm"},
        "process_damping": PROCESS,
        "contact": {"stiffness": 1e6, "damping": 50.0},
        "structure": {"mode": [{"frequency": "700 Hz", "damping": 0.03, "stiffness": 1e7,
                                "direction": [0.6, 0.8, 0]}]},
        "simulation": {"revolutions": 1.5, "steps": 120},
    }))
    sys.stdout.write(np.array2string(found.rows[::3].ravel(), threshold=10**6,
                                     formatter={"float": float.hex}, max_line_width=10**9))
"""


@pytest.mark.parametrize(
    "process", [{"coefficient": 1e5, "friction": 0.3}, {"indentation_force": 1e14}]
)
def test_interpreted_and_compiled_agree(process):
    script = textwrap.dedent(TINY).replace("PROCESS", repr(process))
    rows = []
    for flag in ("0", "1"):
        done = subprocess.run(
            [sys.executable, "-W", "ignore", "-c", script],
            env={**__import__("os").environ, "NUMBA_DISABLE_JIT": flag},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        rows.append(
            np.array([float.fromhex(word) for word in done.stdout.strip("[]\n").split()])
        )
    compiled_rows, interpreted = (found.reshape(-1, 7) for found in rows)
    size = np.abs(interpreted).max(axis=0) + 1e-300
    assert np.all(np.abs(compiled_rows - interpreted).max(axis=0) < 1e-12 * size)
    assert math.isfinite(size.sum())
