"""Exact Timoshenko beams: against Euler and Bernoulli, elements, textbook roots, and themselves."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.beam.element import Material, Segment
from dynamics.beam.shaft import BeamLine
from dynamics.receptance.coupling import coupled, coupled_at, free_beam, without_tool
from dynamics.receptance.timoshenko import (
    line_receptance,
    near_end_on,
    rotations_from_translations,
    timoshenko_beam,
)

STEEL = Material(210e9, 7800.0, 0.29)
LINES = np.linspace(20.0, 5000.0, 200)


def test_slender_beam_is_that_of_euler_and_bernoulli():
    slender = Segment(1.0, 0.001, STEEL)
    frequency = np.linspace(1.0, 40.0, 60)
    exact = timoshenko_beam(frequency, slender, 0.02)
    closed = free_beam(frequency, slender, 0.02)
    for one, other in zip(vars(exact).values(), vars(closed).values(), strict=True):
        assert np.max(np.abs(one - other) / np.max(np.abs(other), axis=0)) < 2e-3


def test_beam_cut_in_two_and_coupled_is_the_whole():
    whole = timoshenko_beam(LINES, Segment(0.2, 0.03, STEEL), 0.01)
    first = timoshenko_beam(LINES, Segment(0.07, 0.03, STEEL), 0.01)
    second = timoshenko_beam(LINES, Segment(0.13, 0.03, STEEL), 0.01)
    joined = coupled(first, second)
    for one, other in zip(vars(joined).values(), vars(whole).values(), strict=True):
        assert np.max(np.abs(one - other) / np.abs(other)) < 1e-6
    taken_off = without_tool(whole.near, first)
    assert np.max(np.abs(taken_off - second.near) / np.abs(second.near)) < 1e-6


def test_stepped_line_is_that_of_beam_elements():
    segments = [Segment(0.05, 0.012, STEEL), Segment(0.06, 0.03, STEEL), Segment(0.1, 0.05, STEEL)]
    fine = [Segment(s.length, s.outer_diameter, STEEL, elements=24) for s in segments]
    line = BeamLine("line", fine, axis=(0.0, 0.0, -1.0))
    omega = 2.0 * np.pi * np.array([900.0, 2100.0, 3300.0])
    tip = line.motion_at(line.position(0.0))[[0, 4]]  # along x, about y
    exact = line_receptance(omega / (2.0 * np.pi), segments, np.zeros((3, 2, 2), complex))
    for k, w in enumerate(omega):
        stiffness = line.stiffness_matrix - w**2 * line.mass_matrix
        elements = tip @ np.linalg.solve(stiffness, tip.T)
        assert exact[k, 0, 0].real == pytest.approx(elements[0, 0], rel=1e-3)
        assert abs(exact[k, 0, 1]) == pytest.approx(abs(elements[0, 1]), rel=1e-3)
        assert exact[k, 1, 1].real == pytest.approx(elements[1, 1], rel=1e-3)


def test_static_deflection_of_a_cantilever_with_shear():
    segment = Segment(0.06, 0.02, STEEL)
    wall = np.tile(np.diag([1e14, 1e11]).astype(complex), (1, 1, 1))
    tip = near_end_on(timoshenko_beam([1.0], segment), wall)[0]
    inertia = np.pi * 0.02**4 / 64.0
    shear = segment.kappa * STEEL.shear_modulus * segment.area
    assert tip[0, 0].real == pytest.approx(
        0.06**3 / (3.0 * 210e9 * inertia) + 0.06 / shear, rel=1e-4
    )
    # the far end lies along +: a force along + at the near end turns it against the axis
    assert tip[1, 0].real == pytest.approx(-(0.06**2) / (2.0 * 210e9 * inertia), rel=1e-4)


def test_first_bending_mode_of_a_cantilever():
    """beta L = 1.8751 for a slender beam."""
    segment = Segment(0.5, 0.01, STEEL)
    expected = 1.87510407**2 / (2 * np.pi * 0.25) * np.sqrt(210e9 * 0.01**2 / 16.0 / 7800.0)
    frequency = np.linspace(0.98 * expected, 1.02 * expected, 4001)
    wall = np.tile(np.diag([1e12, 1e10]).astype(complex), (4001, 1, 1))
    tip = near_end_on(timoshenko_beam(frequency, segment, 1e-4), wall)[:, 0, 0]
    assert frequency[np.argmax(np.abs(tip))] == pytest.approx(expected, rel=1e-3)


def test_standard_holder_taken_off_and_another_tool_put_on():
    """Prediction from a measured blank: 16 mm beam of 190 mm to 140 mm with 50 mm of 10 mm."""
    aluminium = Material(71e9, 2810.0, 0.33)
    wall = np.tile(np.diag([4e7, 4e4]).astype(complex), (LINES.size, 1, 1))
    base = line_receptance(LINES, [Segment(0.14, 0.016, aluminium)], wall, 0.01)
    blank = line_receptance(LINES, [Segment(0.19, 0.016, aluminium)], wall, 0.01)
    removed = timoshenko_beam(LINES, Segment(0.05, 0.016, aluminium), 0.01)
    found = without_tool(blank, removed)
    assert np.max(np.abs(found - base) / np.max(np.abs(base), axis=0)) < 1e-6
    tool = timoshenko_beam(LINES, Segment(0.05, 0.010, aluminium), 0.01)
    predicted = near_end_on(tool, np.linalg.inv(found))
    direct = line_receptance(
        LINES, [Segment(0.05, 0.01, aluminium), Segment(0.14, 0.016, aluminium)], wall, 0.01
    )
    assert np.max(np.abs(predicted - direct) / np.max(np.abs(direct), axis=0)) < 1e-6
    assert np.allclose(
        coupled_at(found, tool.far)[:, 0, 0],
        np.linalg.inv(np.linalg.inv(found) + np.linalg.inv(tool.far))[:, 0, 0],
        rtol=1e-6,
    )


def test_rotations_from_two_translations_of_a_rigid_body():
    """A rigid body on springs is exact: slope (cross - direct) / distance."""
    k, kt, mass, inertia = 3e7, 5e4, 2.0, 1e-3
    w2 = (2.0 * np.pi * LINES) ** 2
    x, turn = 1.0 / (k - w2 * mass), 1.0 / (kt - w2 * inertia)
    arm = 0.08  # the end lies 80 mm before the centre, the cross point 50 mm behind the end
    direct, cross = x + arm**2 * turn, x + arm * (arm - 0.05) * turn
    found = rotations_from_translations(direct.astype(complex), cross.astype(complex), 0.05)
    assert found[:, 0, 1] == pytest.approx(-arm * turn)
    assert found[:, 1, 1] == pytest.approx((arm * turn) ** 2 / direct)
    behind = (x + (arm - 0.05) ** 2 * turn).astype(complex)
    found = rotations_from_translations(direct.astype(complex), cross.astype(complex), 0.05, behind)
    assert found[:, 1, 1] == pytest.approx(turn)
