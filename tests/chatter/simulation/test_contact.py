"""Contact and ploughing in a simulated cut."""

import math

import numpy as np
import pytest

from chatter import Case
from chatter.simulation.simulate import simulate

FREQUENCY, DAMPING, STIFFNESS = 700.0, 0.02, 5e6
MASS = STIFFNESS / (2.0 * math.pi * FREQUENCY) ** 2


def case(material=None, tool=None, structure=True, mode="slot", **sections):
    """Slot with two straight teeth, of which one is in the cut; next to no regeneration."""
    document = {
        "title": "contact",
        "tool": {"kind": "end mill", "teeth": 2, "diameter": "16 mm", **(tool or {})},
        "material": material or {"law": "linear", "Ktc": 1e3, "Kre": 500.0},
        "cut": {
            "mode": mode,
            "spindle_speed": "6000 rpm",
            "feed_per_tooth": "0.2 mm",
            "axial_depth": "2 mm",
            **({"radial_depth": "8 mm"} if mode != "slot" else {}),
        },
        "simulation": {"revolutions": 12, "steps": 1440},
        **sections,
    }
    if structure:
        document["structure"] = {
            "mode": [
                {
                    "frequency": f"{FREQUENCY} Hz", "damping": DAMPING, "stiffness": STIFFNESS,
                    "direction": direction,
                }
                for direction in ([1, 0, 0], [0, 1, 0])
            ]
        }  # fmt: skip
    return Case.from_dict(document)


def oscillator(found, axis=0):
    """Frequency (rad/s) and decay rate of free vibration, from the change over a tooth period."""
    resolution = found.setup.resolution
    period = resolution.steps_per_revolution // resolution.stride // found.case.tool.teeth
    change = found.displacement[period:, axis] - found.displacement[:-period, axis]
    change = change[np.abs(change) > 0.0][: 4 * period]
    gap = period // 18
    now, before, first = change[2 * gap :], change[gap:-gap], change[: -2 * gap]
    a, b = np.linalg.lstsq(np.stack([before, first], axis=1), now, rcond=None)[0]
    root = np.log(np.roots([1.0, -a, -b])[0]) / (gap * found.time[1])
    return abs(root), -root.real


def test_free_vibration_without_contact():
    natural, decay = oscillator(simulate(case()))
    assert natural == pytest.approx(2.0 * math.pi * FREQUENCY, rel=1e-4)
    assert decay == pytest.approx(DAMPING * 2.0 * math.pi * FREQUENCY, rel=1e-2)


@pytest.mark.parametrize("axis", [0, 1])
def test_contact_stiffens_and_damps_while_in_the_cut(axis):
    stiffness, damping = 2e6, 60.0
    found = simulate(case(contact={"stiffness": stiffness, "damping": damping}))
    natural, decay = oscillator(found, axis)
    assert natural == pytest.approx(math.sqrt((STIFFNESS + stiffness) / MASS), rel=1e-3)
    own = 2.0 * DAMPING * MASS * 2.0 * math.pi * FREQUENCY
    assert decay == pytest.approx((own + damping) / (2.0 * MASS), rel=2e-2)


def test_contact_acts_for_the_time_in_the_cut():
    """Up-milling to half the diameter: a quarter of a turn of two, half of the time."""
    stiffness = 1e5
    found = simulate(case(mode="up", contact={"stiffness": stiffness}))
    natural, _ = oscillator(found)
    # a weak spring counts with its mean, as the vibration is fast against the tooth
    assert natural == pytest.approx(math.sqrt((STIFFNESS + 0.5 * stiffness) / MASS), rel=2e-3)
    assert natural > 2.0 * math.pi * FREQUENCY * 1.002


def test_contact_is_part_of_the_force_on_the_tool():
    # in the cut the force and its impulse balance: mean deflection is force over own stiffness
    found = simulate(case(material={"law": "linear", "Ktc": 4e7, "Krc": 3e7, "Kre": 2e4},
                          contact={"stiffness": 2e6, "damping": 100.0}))  # fmt: skip
    last = slice(-1440 * 3 - 1, -1)
    for axis in (0, 1):
        mean = found.force[last, axis].mean()
        assert found.displacement[last, axis].mean() == pytest.approx(mean / STIFFNESS, rel=2e-2)


PLOUGHING = {
    "tool": {"clearance_angle": "6 deg", "flank_wear": "0.1 mm"},
    "process_damping": {"indentation_force": 1e14, "friction": 0.2},
    "wear": {"flank_pressure": 0.0},  # the flank ploughs, and presses on nothing else
}
CUTTING = {"law": "linear", "Ktc": 8e8, "Krc": 3e8}


def test_ploughing_of_a_rigid_tool_is_nothing():
    bare = simulate(case(CUTTING, structure=False, mode="up"))
    worn = simulate(case(CUTTING, structure=False, mode="up", **PLOUGHING))
    assert np.allclose(worn.force, bare.force, rtol=0.0, atol=1e-6 * np.abs(bare.force).max())


@pytest.mark.parametrize("steps", [1440, 11520])
def test_ploughing_takes_the_energy_of_its_viscous_form(steps):
    """A worn land damps on the way in alone, however long a step.

    Beside the forced vibration of every tooth, 3.5 waves, that is more than C = K L^2/4 of the
    mean: 124.2 /s by a Runge-Kutta integration of a dashpot K L^2/2 that only pushes.
    """
    weak = {"law": "linear", "Ktc": 1e3, "Kre": 30.0}
    coefficient = 0.25 * 1e14 * (0.1e-3) ** 2
    simulation = {"revolutions": 4, "steps": steps}
    bare, worn, damped = (
        oscillator(simulate(case(weak, simulation=simulation, **sections)))[1]
        for sections in ({}, PLOUGHING, {"process_damping": {"coefficient": coefficient}})
    )
    # the dashpot turns with the tooth in the cut: half of it along each axis
    speed = 8e-3 * 200.0 * math.pi
    wanted = 0.5 * coefficient * 2e-3 / speed / (2.0 * MASS)
    assert damped - bare == pytest.approx(wanted, rel=0.2)
    assert worn - bare == pytest.approx(124.2, rel=0.08)
