"""Receptance coupling against direct solutions, exact beams and published numbers."""

import numpy as np
import pytest
import scipy.optimize

from dynamics.beam.shaft import BeamLine, Material, Segment
from dynamics.frf.container import MeasurementError
from dynamics.receptance.coupling import (
    Component,
    PointPort,
    component,
    coupled,
    coupled_at,
    free_beam,
    joint_stiffness,
    receptance_with_residual,
    without_tool,
)
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Connector, Point
from dynamics.structure.linear_structure import StructureError

STEEL = Material(young=200e9, density=7800.0, poisson=0.29)
EULER = {"shear_coefficient": 1e9}


def oscillator(lines, mass, damping, stiffness):
    omega = 2 * np.pi * np.asarray(lines)
    return (1.0 / (stiffness - mass * omega**2 + 1j * omega * damping))[:, None, None]


def in_plane(point):
    """Deflection along x and slope dx/dz of a beam along z."""
    return [PointPort(point, np.eye(6)[0]), PointPort(point, np.eye(6)[4])]


def beams(cut, length=0.3, stiffness=None):
    """Beam along z, held by a soft spring at its root; in one piece or joined at a place."""
    held = Connector("held", "near", "ground", (0, 0, 0), [1e6] * 3 + [1e3] * 3, [20.0] * 6)
    near = BeamLine("near", [Segment(cut, 0.03, STEEL, elements=6)], stiffness_damping=1e-6)
    far = BeamLine(
        "far",
        [Segment(length - cut, 0.016, STEEL, elements=6)],
        origin=(0, 0, cut),
        stiffness_damping=1e-6,
    )
    if stiffness is None:
        whole = BeamLine("near", [*near.segments, *far.segments], stiffness_damping=1e-6)
        return assemble([], [held], [Point("tip", "near", (0, 0, length))], [whole])
    joint = Connector("joint", "near", "far", (0, 0, cut), stiffness, [5.0] * 6)
    return assemble([], [held, joint], [Point("tip", "far", (0, 0, length))], [near, far])


def spindle(cut, lines):
    """Receptance (m, 2, 2) of the held near piece at its end."""
    held = Connector("held", "near", "ground", (0, 0, 0), [1e6] * 3 + [1e3] * 3, [20.0] * 6)
    line = BeamLine("near", [Segment(cut, 0.03, STEEL, elements=6)], stiffness_damping=1e-6)
    structure = assemble([], [held], [Point("end", "near", (0, 0, cut))], [line])
    return receptance_with_residual(structure, lines, in_plane("end"))


def tool(length, lines):
    """Free far piece; near end is the tip."""
    line = BeamLine("far", [Segment(length, 0.016, STEEL, elements=6)], stiffness_damping=1e-6)
    points = [Point("joint", "far", (0, 0, 0)), Point("tip", "far", (0, 0, length))]
    structure = assemble([], [], points, [line], allowed_rigid_motions=6)
    return component(structure, lines, in_plane("tip"), in_plane("joint"))


LINES = np.linspace(20.0, 3000.0, 60)


def test_lumped_benchmark():
    lines = [100.0, 120.0, 130.0, 150.0]
    first = oscillator(lines, 3.0, 200.0, 2e6)
    second = oscillator(lines, 2.0, 100.0, 1e6)
    found = coupled_at(first, second, joint_stiffness(lines, [5e5]))[:, 0, 0]
    published = [
        1.87042327e-06 - 2.89512685e-07j,
        2.79538430e-06 - 6.27030254e-06j,
        -2.12037573e-06 - 1.69848549e-06j,
        4.42341147e-07 - 9.83020765e-07j,
    ]
    assert found == pytest.approx(np.array(published), rel=3e-8)


def test_rigid_joint_is_the_limit_of_a_stiff_one_and_no_joint_leaves_the_component():
    first, second = oscillator(LINES, 3.0, 200.0, 2e6), oscillator(LINES, 2.0, 100.0, 1e6)
    rigid = coupled_at(first, second)
    stiff = coupled_at(first, second, joint_stiffness(LINES, [1e14]))
    assert stiff == pytest.approx(rigid, rel=1e-5)
    assert rigid == pytest.approx(oscillator(LINES, 5.0, 300.0, 3e6), rel=1e-9)
    assert coupled_at(first, second, joint_stiffness(LINES, [0.0])) == pytest.approx(second)


@pytest.mark.parametrize("stiffness", [None, [4e6, 4e6, 1e7, 2e3, 2e3, 1e4]])
def test_two_beams_coupled_equal_the_assembled_ones(stiffness):
    joint = None
    if stiffness is not None:
        joint = joint_stiffness(LINES, [stiffness[0], stiffness[4]], [5.0, 5.0])
    exact = receptance_with_residual(beams(0.18, stiffness=stiffness), LINES, in_plane("tip"))
    held = spindle(0.18, LINES)
    none = np.zeros((len(LINES), 2, 0))
    base = Component(np.zeros((len(LINES), 0, 0)), np.swapaxes(none, 1, 2), none, held)
    found = coupled(base, tool(0.12, LINES).turned(), joint).far
    assert np.max(abs(found - exact) / abs(exact)) < 1e-6
    assert np.max(abs(found - np.swapaxes(found, 1, 2)) / abs(found)) < 1e-6


@pytest.mark.parametrize("elastic", [False, True])
def test_taking_the_tool_off_gives_the_holder_back(elastic):
    joint = joint_stiffness(LINES, [2e7, 2e4], [50.0, 1.0]) if elastic else None
    held, free = spindle(0.18, LINES), tool(0.12, LINES)
    none = np.zeros((len(LINES), 2, 0))
    base = Component(np.zeros((len(LINES), 0, 0)), np.swapaxes(none, 1, 2), none, held)
    assembly = coupled(base, free.turned(), joint).far
    found = without_tool(assembly, free, joint)
    assert np.max(abs(found - held) / abs(held)) < 1e-5


def test_taking_off_what_holds_nothing_is_refused():
    free = tool(0.12, LINES)
    with pytest.raises(MeasurementError, match="does not tell what holds the tool"):
        without_tool(free.near, free)
    with pytest.raises(MeasurementError, match="as many directions"):
        without_tool(free.near[:, :1, :1], free)
    spoilt = free.near.copy()
    spoilt[3] = np.nan
    with pytest.raises(MeasurementError, match="finite"):
        without_tool(spoilt, free)


@pytest.mark.parametrize("length", [0.05, 0.3])
def test_free_beam_equals_a_fine_model(length):
    lines = np.array([5.0, 90.0, 800.0, 2500.0])
    segment = Segment(length, 0.010, STEEL, elements=40, **EULER)
    exact = free_beam(lines, segment)
    line = BeamLine("beam", [segment])
    points = [Point("near", "beam", (0, 0, 0)), Point("far", "beam", (0, 0, length))]
    structure = assemble([], [], points, [line], allowed_rigid_motions=6)
    found = component(structure, lines, in_plane("near"), in_plane("far"))
    # rotary inertia, which a Euler-Bernoulli beam lacks, is of the order of (d / length)^2 / 16
    bound = 4.0 * (0.01 / length) ** 2
    for block in ("near", "near_far", "far_near", "far"):
        own, other = getattr(exact, block), getattr(found, block)
        scale = np.sqrt(abs(np.einsum("mii->mi", exact.near)))
        error = abs(own - other) / (scale[:, :, None] * scale[:, None, :])
        assert np.max(error[:2]) < bound


def test_free_beam_at_low_frequency_is_a_rigid_body():
    length, diameter, line = 0.02, 0.016, 1.0
    beam = free_beam([line], Segment(length, diameter, STEEL))
    mass = np.pi / 4 * diameter**2 * length * STEEL.density
    inertial = -1.0 / (mass * (2 * np.pi * line) ** 2)
    near = np.array([[4.0, -6.0 / length], [-6.0 / length, 12.0 / length**2]])
    across = np.array([[-2.0, -6.0 / length], [6.0 / length, 12.0 / length**2]])
    assert beam.near[0] == pytest.approx(inertial * near, rel=1e-6)
    assert beam.far[0] == pytest.approx(inertial * abs(near), rel=1e-6)
    assert beam.near_far[0] == pytest.approx(inertial * across, rel=1e-6)


def test_beam_functions_do_not_jump_where_the_series_ends():
    segment = Segment(0.1, 0.010, STEEL)
    area, bending = np.pi / 4 * 0.01**2, 200e9 * np.pi * 0.01**4 / 64
    line = 100.0 * np.sqrt(bending / (STEEL.density * area)) / (2 * np.pi)
    beam = free_beam(line * np.array([1 - 1e-9, 1 + 1e-9]), segment, loss_factor=1e-12)
    for block in (beam.near, beam.near_far, beam.far):
        assert block[0] == pytest.approx(block[1], rel=1e-7)


def test_clamped_and_free_resonances_are_those_of_the_textbook():
    segment = Segment(0.125, 0.010, STEEL)

    def clamped(line):
        """Zero where the held far end needs loads without any at the tip."""
        return np.linalg.det(free_beam([line], segment).far[0]).real

    published = [453.37604, 2841.25913, 7955.60784]
    # narrow, as the third lies 0.04 % above a free resonance, where the determinant has a pole
    found = [scipy.optimize.brentq(clamped, 0.9998 * one, 1.0002 * one) for one in published]
    assert found == pytest.approx(published, rel=1e-7)
    free_free = 453.37604 * (4.730040744862704 / 1.8751040687119178) ** 2
    around = free_beam(free_free * np.array([0.999999, 1.000001]), segment).near[:, 0, 0].real
    assert around[0] * around[1] < 0.0


def test_two_halves_of_a_beam_couple_to_the_whole():
    halves = [free_beam(LINES, Segment(length, 0.016, STEEL), 0.003) for length in (0.14, 0.05)]
    whole = free_beam(LINES, Segment(0.19, 0.016, STEEL), 0.003)
    found = coupled(*halves)
    for block in ("near", "near_far", "far_near", "far"):
        exact = getattr(whole, block)
        assert np.max(abs(getattr(found, block) - exact) / abs(exact)) < 1e-6


def test_high_frequencies_do_not_overflow():
    beam = free_beam([1e12], Segment(1.0, 0.01, STEEL), 0.01)
    assert np.all(np.isfinite(beam.near))
    assert np.max(abs(beam.near_far)) < np.max(abs(beam.near))


def test_power_into_a_coupled_assembly_is_dissipated():
    found = coupled(*(free_beam(LINES, Segment(0.1, d, STEEL), 0.01) for d in (0.02, 0.01)))
    lossy = (found.near - np.conj(np.swapaxes(found.near, 1, 2))) / 2j
    assert np.all(np.linalg.eigvalsh(-lossy) >= -1e-9 * np.max(abs(lossy), axis=(1, 2))[:, None])


def test_refusals():
    with pytest.raises(StructureError, match="above 0 Hz"):
        free_beam([0.0], Segment(0.1, 0.01, STEEL))
    with pytest.raises(StructureError, match="loss_factor"):
        free_beam([1.0], Segment(0.1, 0.01, STEEL), -0.1)
    with pytest.raises(StructureError, match="not negative"):
        joint_stiffness([1.0], [-1.0, 1.0])
    with pytest.raises(StructureError, match="cannot be joined"):
        coupled_at(np.zeros((1, 2, 2)), np.zeros((1, 2, 2)))
    with pytest.raises(StructureError, match="do not fit"):
        Component(np.zeros((1, 2, 2)), np.zeros((1, 2, 3)), np.zeros((1, 2, 2)), np.eye(3)[None])
    with pytest.raises(StructureError, match="direction must be 3 finite"):
        PointPort("tip", [1.0, 0.0])
    free = tool(0.12, LINES)
    hinge = joint_stiffness(LINES, [1e7, 0.0])
    with pytest.raises(StructureError, match="without stiffness"):
        without_tool(0.9 * free.near, free, hinge)
