"""Time-domain engine and jitcdde on the same delay equations: errors, and times at equal errors.

jitcdde (Ansmann 2018), a compiled integrator of general delay differential equations, is no
dependency of the project.
"""

from __future__ import annotations

import contextlib
import math
import os
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

from benchmarks.one_core import show, timed
from chatter.description.case import Case
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup

FREQUENCY, DAMPING, MASS, STRAIGHT_TEETH = 900.0, 0.02, 0.3, 2
TANGENTIAL, RADIAL, DEPTH, DELAYED_FEED, RPM = 600e6, 200e6, 0.2e-3, 0.1e-3, 6000.0
AGREEMENT_DEPTHS = (0.2e-3, 0.5e-3, 1e-3)
PERIOD = 60.0 / RPM / STRAIGHT_TEETH  # s, of a tooth
PERIODS = 40
SAMPLES = 12  # in half a tooth period
ENGINE_STEPS = (720, 1440, 2880, 5760, 11520)
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)


def straight_case(steps: int, depth: float) -> Case:
    """Half immersion, down, two straight teeth, linear law: the case of the delay equation."""
    flexible = {"frequency": FREQUENCY, "damping": DAMPING, "mass": MASS}
    return Case.from_dict(
        {
            "tool": {"teeth": STRAIGHT_TEETH, "diameter": "10 mm", "helix": 0.0},
            "material": {"Ktc": TANGENTIAL, "Krc": RADIAL},
            "cut": {
                "mode": "down",
                "spindle_speed": f"{RPM} rpm",
                "feed_per_tooth": DELAYED_FEED,
                "axial_depth": depth,
                "radial_depth": "5 mm",
            },
            "structure": {
                "mode": [{**flexible, "direction": [1, 0, 0]}, {**flexible, "direction": [0, 1, 0]}]
            },
            "simulation": {"revolutions": PERIODS / STRAIGHT_TEETH, "slices": 1, "steps": steps},
        }
    )


def engine_motion(case: Case) -> np.ndarray:
    """Displacement (samples, 2) by the engine, m."""
    result, _ = run_setup(set_up(case))
    at = np.arange(1, 2 * SAMPLES * PERIODS + 1) * PERIOD / (2 * SAMPLES)
    row = np.round(at / result.time[1]).astype(int)
    return result.displacement[row, :2]


@contextlib.contextmanager
def empty_folder():
    """Work in an empty folder: jitcdde's build reads a pyproject.toml where there is one."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def chip_after(passes: int):
    """Chip of a delay equation against the surface of an earlier pass, in feeds a tooth.

    Its sign is that of the sine: it is written for one tooth and serves both.
    """
    import symengine
    from jitcdde import t, y

    sine, cosine = symengine.sin(math.pi * t), symengine.cos(math.pi * t)
    across, along = y(0) - y(0, t - passes), y(1) - y(1, t - passes)
    return passes * sine + across * sine + along * cosine


def chip_with_loss_of_contact():
    """Chip against the outer surface of the two last passes, none in the air."""
    import symengine
    from jitcdde import t
    from jitcxde_common.symbolic import conditional

    sine = symengine.sin(math.pi * t)
    last, before = chip_after(1), chip_after(2)
    outer = conditional((before - last) * sine, 0.0, before, last, width=1e-7)
    return conditional(outer * sine, 0.0, 0.0, outer, width=1e-7)


def chip_without_vibration():
    """Chip of a rigid tool."""
    import symengine
    from jitcdde import t

    return symengine.sin(math.pi * t)


def delay_equation(chip, depth: float):
    """Compile the delay equation; time in tooth periods, displacement in feeds a tooth.

    In half immersion one of two teeth is in the cut at most, and the force repeats with each
    tooth. The screen is a parameter, changed at entry and exit, so that no step goes across them.
    """
    import symengine
    from jitcdde import jitcdde, t, y

    screen = symengine.Symbol("screen")
    sine, cosine = symengine.sin(math.pi * t), symengine.cos(math.pi * t)
    force = screen * chip * depth * PERIOD**2 / MASS
    turn = 2 * math.pi * FREQUENCY * PERIOD
    equation = [
        y(2),
        y(3),
        -force * (RADIAL * sine + TANGENTIAL * cosine) - 2 * DAMPING * turn * y(2) - turn**2 * y(0),
        force * (TANGENTIAL * sine - RADIAL * cosine) - 2 * DAMPING * turn * y(3) - turn**2 * y(1),
    ]
    integrator = jitcdde(equation, control_pars=[screen], max_delay=2.0, verbose=False)
    with empty_folder(), contextlib.redirect_stdout(None), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        integrator.compile_C(simplify=False)
    return integrator


def jitcdde_motion(integrator, tolerance: float, samples: int) -> np.ndarray:
    """Displacement (samples, 2) by jitcdde from rest, m, sampled within each half tooth period."""
    integrator.purge_past()
    integrator.constant_past(np.zeros(4), time=0.0)
    integrator.set_parameters(0.0)
    integrator.reset_integrator()
    integrator.set_integration_parameters(
        rtol=tolerance, atol=1e-3 * tolerance, first_step=0.01, max_step=0.2, min_step=1e-12
    )
    motion = []
    for half in range(2 * PERIODS):
        integrator.set_parameters(float(half % 2))
        # drops what was integrated beyond the event, and takes the new slope
        integrator.jump(0.0, 0.5 * half, 1e-7)
        with warnings.catch_warnings():
            # samples within a step are interpolated, as wanted
            warnings.simplefilter("ignore")
            for i in range(1, samples + 1):
                motion.append(integrator.integrate(0.5 * (half + i / samples))[:2].copy())
    return np.array(motion) * DELAYED_FEED


def error(motion: np.ndarray, reference: np.ndarray) -> float:
    """Root mean square difference over the standard deviation of the reference."""
    return float(np.sqrt(np.mean((motion - reference) ** 2)) / np.std(reference))


def delay_equations() -> list[dict]:
    """Engine and jitcdde on one case: errors, times a revolution and their ratio."""
    start = time.perf_counter()
    integrator = delay_equation(chip_after(1), DEPTH)
    compiled = time.perf_counter() - start
    reference = jitcdde_motion(integrator, 1e-9, SAMPLES)
    revolutions = PERIODS / STRAIGHT_TEETH
    engine, general = [], []
    for steps in ENGINE_STEPS:
        case = straight_case(steps, DEPTH)
        assert set_up(case).resolution.steps_per_revolution == steps
        taken = timed(lambda case=case: run_setup(set_up(case)))
        engine.append((error(engine_motion(case), reference), taken, f"{steps} steps"))
    for tolerance in TOLERANCES:
        taken = timed(lambda rtol=tolerance: jitcdde_motion(integrator, rtol, 1))
        difference = error(jitcdde_motion(integrator, tolerance, SAMPLES), reference)
        general.append((difference, taken, f"tolerance {tolerance:.0e}"))
    rows = []
    for name, own, others in (("engine", engine, general), ("jitcdde", general, engine)):
        for difference, taken, setting in own:
            good = [other[1].shortest for other in others if other[0] <= difference]
            rows.append(
                (
                    name,
                    setting,
                    f"{difference:.1e}",
                    f"{taken.shortest * 1e6 / revolutions:.1f}",
                    f"{taken.median * 1e6 / revolutions:.1f}",
                    f"{min(good) / taken.shortest:.2f}" if good else "none as good",
                )
            )
    print(f"\njitcdde compiled in {compiled:.1f} s, not counted")
    return show(
        f"3. Two straight teeth, half immersion, {revolutions:g} revolutions from rest; NRMSE of "
        "the displacement against jitcdde at 1e-9;\n   ratio: fastest of the other program that "
        "is at least as accurate, over this",
        "program|setting|NRMSE|us a revolution|median|other / this",
        rows,
    )


def agreement() -> list[dict]:
    """Differences of the engine from three delay equations, at depths where contact is lost."""
    rows = []
    equations = (
        ("loss of contact", chip_with_loss_of_contact),
        ("always in contact", lambda: chip_after(1)),
        ("rigid tool's chip", chip_without_vibration),
    )
    for depth in AGREEMENT_DEPTHS:
        motions = [engine_motion(straight_case(steps, depth)) for steps in ENGINE_STEPS]
        for name, chip in equations:
            reference = jitcdde_motion(delay_equation(chip(), depth), 1e-7, SAMPLES)
            differences = (f"{error(motion, reference):.1e}" for motion in motions)
            rows.append((f"{depth * 1e3:g} mm", name, *differences))
    return show(
        "4. The same cut at three depths: NRMSE of the engine against jitcdde (1e-7) with three "
        "delay equations",
        "|".join(["depth", "equation", *[f"{steps} steps" for steps in ENGINE_STEPS]]),
        rows,
    )
