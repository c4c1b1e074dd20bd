"""Ploughing: geometry of the flank, and the force on it in a small wave."""

import math

import numpy as np
import pytest

from cutting.process_damping.ploughing import (
    Ploughing,
    clear_surface_history,
    ploughing_force,
    store_surface_history,
)

CLEARANCE = math.radians(7.0)
SPEED_STEP = 2e-6  # m of cutting path in a step
FORCE = 4e13
SEPARATION = math.radians(37.6)


def worn(land=80e-6, **given):
    return Ploughing(FORCE, CLEARANCE, flank_wear=land, **given)


def honed(radius=40e-6, **given):
    return Ploughing(FORCE, CLEARANCE, edge_radius=radius, **given)


def test_profile_of_a_worn_land():
    s = np.array([0.0, 40e-6, 80e-6, 100e-6, 180e-6])
    depth = worn().profile(s)
    assert np.allclose(depth[:3], 0.0, atol=1e-18)
    assert np.allclose(depth[3:], -np.tan(CLEARANCE) * np.array([20e-6, 100e-6]))
    assert worn().contact_length == pytest.approx(80e-6)


def test_profile_of_a_rounded_edge():
    radius = 40e-6
    law = honed(radius)
    lowest = radius * math.sin(SEPARATION)
    depth = radius * (1.0 - math.cos(SEPARATION))
    # the parting point lies on the line of the new surface, the lowest point below it
    assert law.profile(np.array([0.0]))[0] == pytest.approx(0.0, abs=1e-18)
    assert law.profile(np.array([lowest]))[0] == pytest.approx(depth)
    # on the circle until the clearance angle, along the flank from there
    x = np.linspace(0.0, lowest + radius * math.sin(CLEARANCE), 50)
    centre = radius - depth
    assert np.allclose((x - lowest) ** 2 + (law.profile(x) + centre) ** 2, radius**2)
    far = law.profile(np.array([200e-6, 300e-6]))
    assert far[1] - far[0] == pytest.approx(-100e-6 * math.tan(CLEARANCE))


def test_profile_is_smooth_where_arc_and_flank_meet():
    s = np.linspace(0.0, 150e-6, 30001)
    slope = np.diff(honed().profile(s)) / np.diff(s)
    assert np.abs(np.diff(slope)).max() < 1e-3


def test_contact_length_ends_where_the_flank_leaves_the_surface():
    law = honed(40e-6, flank_wear=30e-6)
    just = law.profile(np.array([law.contact_length * 0.9, law.contact_length * 3.0]))
    assert just[0] > 0.0 > just[1]


class Edge:
    """One edge that runs straight on and moves along its normal."""

    def __init__(self, law, step=SPEED_STEP):
        radius = 10e-3
        self.flank = law.table(np.array([radius]), 1, step / radius)
        # counters are arrays: the kernels change them in place
        self.step = step

    def run(self, place):
        """Radial and tangential force (n, 2) along the places of the edge, m outwards."""
        forces = []
        for here in place:
            tangential, radial = ploughing_force(self.flank, 0, 0, here, 0.0, 0.0, 1.0)
            forces.append((radial, tangential))
            store_surface_history(self.flank, 0, 0, here)
        return np.array(forces)


@pytest.mark.parametrize("law", [worn(), honed(), worn(30e-6, edge_radius=25e-6)])
def test_a_still_tool_feels_nothing(law):
    assert np.all(Edge(law).run(np.full(300, 3e-6)) == 0.0)


def wave(amplitude, length, step=SPEED_STEP, waves=3):
    """Place and velocity per unit cutting speed of a sinusoidal wave."""
    s = np.arange(0.0, waves * length, step)
    k = 2.0 * math.pi / length
    return s, amplitude * np.sin(k * s), amplitude * k * np.cos(k * s)


def dissipated(law, amplitude, length, step=SPEED_STEP):
    """Mean of radial force times velocity over whole waves, over the mean square velocity.

    The viscous coefficient C (N/m) that takes the same energy.
    """
    s, place, rate = wave(amplitude, length, step)
    radial = Edge(law, step).run(place)[:, 0]
    whole = s >= length
    return np.mean((radial * rate)[whole]) / np.mean(rate[whole] ** 2)


def test_worn_land_in_a_shallow_wave_is_one_sided_damping():
    # outward motion at slope a: the land cuts a triangle a L^2/2; inward motion: none
    land = 80e-6
    wanted = 0.5 * FORCE * 0.5 * land**2
    assert dissipated(worn(land), 0.2e-6, 2.4e-3) == pytest.approx(wanted, rel=0.05)


def test_rounded_edge_in_a_very_shallow_wave_damps_both_ways():
    # displaced at rest along the contact, so that either slope changes the volume by a L^2/2
    radius = 40e-6
    law = honed(radius)
    s = np.linspace(0.0, 2.0 * law.contact_length, 200001)
    contact = s[np.flatnonzero(law.profile(s) > 0.0)[-1]]
    wanted = 0.5 * FORCE * contact**2
    assert dissipated(law, 0.01e-6, 2e-3, 1e-6) == pytest.approx(wanted, rel=0.08)


def test_damping_grows_with_the_square_of_the_land():
    small, large = (dissipated(worn(land), 0.2e-6, 2.4e-3) for land in (50e-6, 100e-6))
    assert large / small == pytest.approx(4.0, rel=0.1)


def test_force_is_proportional_to_the_indentation_force():
    one = Edge(worn()).run(wave(1e-6, 2e-3)[1])
    two = Edge(Ploughing(2.0 * FORCE, CLEARANCE, flank_wear=80e-6)).run(wave(1e-6, 2e-3)[1])
    assert np.allclose(two, 2.0 * one)


def test_friction_is_the_share_of_the_tangential_force():
    found = Edge(worn(friction=0.3)).run(wave(1e-6, 2e-3)[1])
    assert np.abs(found[:, 0]).max() > 0.0
    assert np.allclose(found[:, 1], 0.3 * found[:, 0])


def test_ramp_into_the_work_displaces_a_triangle():
    # steady slope a below the clearance angle: area a L^2/2, and the clearance behind the land
    slope, land = 0.02, 80e-6
    place = slope * SPEED_STEP * np.arange(400)
    radial = Edge(worn(land)).run(place)[:, 0]
    height = slope * land
    behind = height / (math.tan(CLEARANCE) - slope)
    wanted = FORCE * (0.5 * height * land + 0.5 * height * behind)
    assert radial[-1] == pytest.approx(wanted, rel=0.03)


def test_ramp_out_of_the_work_frees_the_land():
    place = -0.02 * SPEED_STEP * np.arange(400)
    assert np.all(np.abs(Edge(worn()).run(place)[:, 0]) < 1e-9)


def test_force_climbs_steeply_where_the_slope_exceeds_the_clearance():
    def at(slope):
        # a hundred steps of slope after a flat start: the whole way since then is displaced
        place = np.concatenate([np.zeros(50), slope * SPEED_STEP * np.arange(1, 201)])
        return Edge(worn()).run(place)[-1, 0]

    below, beyond = at(0.5 * math.tan(CLEARANCE)), at(1.5 * math.tan(CLEARANCE))
    assert beyond > 6.0 * below


def test_wear_and_clearance_order_the_force():
    place = wave(2e-6, 1e-3)[1]
    largest = [np.abs(Edge(worn(land)).run(place)).max() for land in (20e-6, 60e-6, 120e-6)]
    assert largest == sorted(largest)
    blunt, sharp = (
        np.abs(Edge(Ploughing(FORCE, math.radians(a), flank_wear=60e-6)).run(place)).max()
        for a in (2.0, 12.0)
    )
    assert blunt > sharp


def test_samples_of_the_wave_do_not_shape_the_force():
    coarse, fine = (dissipated(worn(), 0.5e-6, 1.6e-3, step) for step in (4e-6, 1e-6))
    assert coarse == pytest.approx(fine, rel=0.03)


def test_a_wave_is_seen_within_the_shortest_contact():
    """Beside the integral over all of the wave that the edge has left."""
    law, step = worn(10e-6), 0.25e-6
    place = wave(0.05e-6, 0.3e-3, step, waves=2)[1]
    behind = step * np.arange(len(place))
    profile = law.profile(behind)
    wanted = [
        FORCE * np.trapezoid(np.maximum(here - place[at::-1] + profile[: at + 1], 0.0), dx=step)
        for at, here in enumerate(place)
    ]
    radial = Edge(law, step).run(place)[:, 0]
    settled = len(place) // 2
    assert np.allclose(radial[settled:], wanted[settled:], atol=0.04 * max(wanted[settled:]))


def test_an_edge_that_left_the_cut_starts_anew():
    edge = Edge(worn())
    edge.run(wave(2e-6, 1e-3)[1][:200])
    clear_surface_history(edge.flank, 0, 0)
    assert edge.run(np.array([5e-6]))[0, 0] == 0.0


@pytest.mark.parametrize("law", [worn(), honed(), worn(30e-6, edge_radius=25e-6)])
def test_a_tool_displaced_but_still_ploughs_nothing(law):
    """The circle of its edge is shifted, and so is the surface that it has left."""
    radius, displacement = 10e-3, (30e-6, -20e-6)
    edge = Edge(law)
    forces = []
    for angle in np.arange(0.0, 1.0, SPEED_STEP / radius):
        sine, cosine = math.sin(angle), math.cos(angle)
        place = displacement[0] * sine + displacement[1] * cosine
        turning = displacement[0] * cosine - displacement[1] * sine
        forces.append(ploughing_force(edge.flank, 0, 0, place, turning, 0.0, 1.0)[1])
        store_surface_history(edge.flank, 0, 0, place)
    # a vibration of a hundredth of this displacement at 800 Hz and 100 m/min
    pressed = law.small_vibration.coefficient * 0.3e-6 * 5000.0 / 1.7
    assert np.abs(forces).max() < 0.01 * pressed
