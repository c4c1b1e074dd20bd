"""Fourier series of the force on a rigid tool: against closed forms and direct sums over edges."""

import math

import numpy as np
import pytest

from cutting.engagement.uncut_band import band_beside_wall
from cutting.force.exponential import ExponentialLaw
from cutting.force.force_spectrum import RigidCut
from cutting.force.linear import LinearLaw
from cutting.process_damping.viscous import ViscousProcessDamping
from cutting.tool.cutter import Cutter

LAW = LinearLaw((800e6, 250e6, 100e6), (12e3, 14e3, 2e3))


def cutter(teeth=3, helix_deg=30.0, pitch=None, **more):
    even = (2.0 * math.pi / teeth,) * teeth
    return Cutter(16e-3, (math.radians(helix_deg),) * teeth, pitch or even, **more)


def rigid(tool, mode="down", width=5e-3, feed=1e-4, depth=4e-3, highest=40, law=LAW):
    band = band_beside_wall(mode, width, tool.radius)
    return RigidCut(tool, [law] * tool.teeth, band, feed, depth, highest)


def direct(tool, theta, entry, leave, feed, depth, law=LAW, slices=4000):
    """Force and torque of all edges at an angle of the spindle, summed over thin slices."""
    height = (np.arange(slices) + 0.5) * depth / slices
    total = np.zeros(4)
    for tooth, place in enumerate(tool.tooth_angles):
        phi = np.mod(theta + place - height * math.tan(tool.helix[0]) / tool.radius, 2 * math.pi)
        inside = (phi > entry) & (phi < leave)
        s, c = np.sin(phi[inside]), np.cos(phi[inside])
        # the tooth that stands ahead has left the surface, a pitch ago
        chip = feed * tool.teeth * tool.pitch[tooth] / (2 * math.pi) * s
        t, r, a = law.force(chip) * depth / slices
        total += np.sum([-t * c - r * s, t * s - r * c, a, t * tool.radius], axis=1)
    return total


def at(spectrum, theta):
    weight = np.where(spectrum.harmonic == 0, 1.0, 2.0) * np.exp(1j * spectrum.harmonic * theta)
    return np.append(weight @ spectrum.force, weight @ spectrum.torque).real


def test_mean_torque_is_that_of_the_volume_removed():
    # linear law without edges: torque x 2 pi = K_tc x volume of a turn, whatever helix and pitch
    law = LinearLaw((800e6, 250e6, 0.0))
    for tool in (cutter(), cutter(4, 10.0, (1.2, 1.9, 1.3, 2.0 * math.pi - 4.4))):
        spectrum = rigid(tool, law=law).force(np.arange(1))
        volume = 1e-4 * tool.teeth * 4e-3 * 5e-3
        assert spectrum.torque[0].real * 2.0 * math.pi == pytest.approx(800e6 * volume, rel=1e-9)


def test_forces_of_a_straight_slot_have_their_known_means():
    # N f a K / 4 across, and N a K_e / pi of the edge (Altintas 2012, eq. 2.96), forces on the tool
    tool = cutter(4, 0.0)
    force = rigid(tool, "slot", 16e-3).force(np.arange(1)).force[0].real
    n, a, f = 4, 4e-3, 1e-4
    x = -n * a * f / 4.0 * 250e6 - n * a / math.pi * 14e3
    y = n * a * f / 4.0 * 800e6 + n * a / math.pi * 12e3
    z = n * a * f / math.pi * 100e6 + n * a / 2.0 * 2e3
    assert force == pytest.approx([x, y, z], rel=1e-9)


@pytest.mark.parametrize("mode", ["up", "down"])
@pytest.mark.parametrize("pitch_deg", [(120, 120, 120), (100, 125, 135)])
def test_series_gives_the_force_at_every_angle(mode, pitch_deg):
    tool = cutter(3, 40.0, tuple(np.radians(pitch_deg)))
    arc = math.acos(1.0 - 5e-3 / 8e-3)
    ends = (0.0, arc) if mode == "up" else (math.pi - arc, math.pi)
    spectrum = rigid(tool, mode, highest=600).force(np.arange(601))
    angles = np.linspace(0.1, 6.2, 23)
    wanted = np.array([direct(tool, theta, *ends, 1e-4, 4e-3) for theta in angles])
    found = np.array([at(spectrum, theta) for theta in angles])
    assert np.all(np.abs(found - wanted).max(axis=0) < 3e-3 * np.abs(wanted).max(axis=0))


def test_teeth_that_are_alike_leave_harmonics_of_the_tooth_passing_alone():
    spectrum = rigid(cutter(3)).force(np.arange(10))
    size = np.linalg.norm(spectrum.force, axis=1)
    assert size[[1, 2, 4, 5, 7, 8]] == pytest.approx(0.0, abs=1e-9 * size[0])
    # runout lets the turn of the spindle show
    out = rigid(cutter(3, runout_offset=1e-5)).force(np.arange(10))
    assert abs(out.force[1, 1]) > 1e-2 * size[0]


def test_runout_does_not_change_the_volume():
    law = LinearLaw((800e6, 250e6, 0.0))
    mean = [
        rigid(cutter(3, runout_offset=offset), law=law).force(np.arange(1)).torque[0].real
        for offset in (0.0, 1e-5)
    ]
    assert mean[1] == pytest.approx(mean[0], rel=2e-3)


@pytest.mark.parametrize("law", [LAW, ExponentialLaw((800e6, 250e6, 50e6), 1e-4, 0.7)])
def test_coupling_is_the_change_of_the_force_with_the_feed(law):
    # a tool that is pulled a little further along x at every tooth takes so much more feed
    tool, step = cutter(3, 25.0), 1e-9
    harmonic = np.arange(0, 13, 3)
    coupling = rigid(tool, law=law, highest=12).coupling(harmonic, np.eye(3), None)
    low, high = (
        rigid(tool, feed=1e-4 + change, law=law, highest=12).force(harmonic).force
        for change in (-step, step)
    )
    slope = (high - low) / (2.0 * step)
    assert coupling.delay == pytest.approx([2.0 * math.pi / 3.0], abs=1e-8)
    scale = np.abs(slope).max()
    assert coupling.regeneration[0][:, :, 0] == pytest.approx(slope, abs=2e-3 * scale)


def test_flank_resists_the_radial_velocity():
    # a straight slot: half of every tooth's dashpot acts along each axis
    flank = ViscousProcessDamping(2e5)
    found = rigid(cutter(2, 0.0), "slot", 16e-3).coupling(np.arange(1), np.eye(3), flank)
    half = -2.0 * 2e5 * 4e-3 / 8e-3 / 4.0
    wanted = np.diag([half, half, 0.0])
    assert found.damping[0].real == pytest.approx(wanted, abs=1e-6 * abs(half))
