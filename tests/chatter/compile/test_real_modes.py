"""Real modes fitted to the receptance of a machine with loops."""

import numpy as np
import pytest

import chatter
from chatter.compile.least_squares_modes import (
    ModeBounds,
    WantedReceptance,
    _at,
    _normal_equations,
    refined,
)
from chatter.compile.real_modes import largest_misfit, lines_around, real_modes
from dynamics.modal.modes import Mode, receptance_matrix
from tests.places import EXAMPLES

MODES = (
    Mode(52.0, 0.013, 250.0, (0.0, 0.98, 0.2)),
    Mode(125.0, 0.06, 220.0, (0.1, 0.3, 0.95)),
    Mode(330.0, 0.014, 45.0, (1.0, 0.0, 0.0)),
)
#: the same with their loops open, as the fit begins
OPEN = (
    Mode(50.0, 0.005, 250.0, (0.0, 0.97, 0.25)),
    Mode(122.0, 0.08, 240.0, (0.0, 0.3, 0.95)),
    Mode(331.0, 0.014, 45.0, (1.0, 0.0, 0.0)),
)


def table_of(modes) -> np.ndarray:
    """Rows of logarithms and mass-normalised directions."""
    rows = [
        [np.log(2 * np.pi * m.frequency), np.log(m.damping), *np.array(m.direction) / m.mass**0.5]
        for m in modes
    ]
    return np.array(rows)


def wanted(modes, lines) -> WantedReceptance:
    return WantedReceptance(
        2.0 * np.pi * lines, receptance_matrix(modes, lines), np.full(lines.shape, 1e8)
    )


def test_modes_that_loops_have_moved_are_found():
    lines = lines_around(OPEN, 1.0, 500.0)
    fitted = real_modes(lines, receptance_matrix(MODES, lines), OPEN)
    assert largest_misfit(fitted, lines, receptance_matrix(MODES, lines)) < 2e-3
    for mode in MODES:
        near = min(fitted, key=lambda one: abs(np.log(one.frequency / mode.frequency)))
        assert near.frequency == pytest.approx(mode.frequency, rel=1e-3)
        assert near.damping == pytest.approx(mode.damping, rel=2e-2)
        assert near.stiffness == pytest.approx(mode.stiffness, rel=2e-2)


def test_slope_of_the_normal_equations_is_that_of_the_sum_of_squares():
    """Central differences of the sum and of the residual itself."""
    goal = wanted(MODES, np.geomspace(1.0, 500.0, 60))
    table = table_of(OPEN)
    normal, slope = _normal_equations(_at(table, goal), goal)
    columns = []
    for index in np.ndindex(table.shape):
        apart = np.zeros_like(table)
        apart[index] = 1e-6 * max(1e-2, abs(table[index]))
        more, less = goal.missing(table + apart), goal.missing(table - apart)
        columns.append(((less - more) / (2.0 * apart[index])).ravel())
    jacobian = np.array(columns).T
    jacobian = np.vstack([jacobian.real, jacobian.imag])
    missing = goal.missing(table).ravel()
    expected = jacobian.T @ np.concatenate([missing.real, missing.imag])
    size = np.sqrt(np.diag(normal))
    np.testing.assert_allclose(slope / size, expected / size, atol=1e-5 * np.linalg.norm(missing))
    np.testing.assert_allclose(
        normal / np.outer(size, size), (jacobian.T @ jacobian) / np.outer(size, size), atol=1e-5
    )


def test_bounds_hold():
    goal = wanted(MODES, lines_around(MODES, 1.0, 500.0))
    bounds = ModeBounds.of(3, (2.0 * np.pi, 2.0 * np.pi * 300.0), (0.02, 0.95))
    table, _ = refined(table_of(OPEN), bounds, goal, 200, 1e-6)
    assert np.exp(table[:, 0]).max() <= 2.0 * np.pi * 300.0 * (1.0 + 1e-12)
    assert np.exp(table[:, 1]).min() >= 0.02 * (1.0 - 1e-12)


def test_compliance_above_the_band_is_no_resonance():
    """A mode above the last line leaves stiffness in the band; nobody sees its damping."""
    above = Mode(1500.0, 0.01, 1.0, (0.0, 0.0, 1.0))
    lines = lines_around(OPEN, 1.0, 500.0)
    receptance = receptance_matrix((*MODES, above), lines)
    fitted = real_modes(lines, receptance, OPEN)
    assert largest_misfit(fitted, lines, receptance) < 5e-3
    assert all(mode.damping >= 0.3 for mode in fitted if mode.frequency > 500.0)


def test_power_that_a_loop_feeds_in_bends_no_resonance():
    """Below 4 Hz a loop feeds power in, which no damped mode does; peaks are as true as without."""
    lines = lines_around(OPEN, 1.0, 500.0)
    receptance = receptance_matrix(MODES, lines)
    fed_in = 0.3 * np.abs(receptance).max() * 1j / (1.0 + (lines / 2.0) ** 4)
    receptance[:, 0, 0] += fed_in
    fitted = real_modes(lines, receptance, OPEN)
    near = lines > 30.0
    apart = receptance_matrix(fitted, lines[near]) - receptance[near]
    assert np.abs(apart).max() < 5e-3 * np.abs(receptance).max()


def test_limit_by_modes_is_that_by_the_receptance_itself():
    """Multi-frequency takes the receptance as it is, collocation the modes fitted to it."""
    case = chatter.load(EXAMPLES / "face-mill-chatter/case.toml")
    limits = [
        chatter.check(case.patch({"lobes.method": method})).critical_depth
        for method in ("collocation", "multi-frequency")
    ]
    assert limits[0] == pytest.approx(limits[1], rel=0.01)
