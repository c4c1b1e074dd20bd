"""Directional matrix and its averages against closed forms, Altintas' and brute quadrature."""

import math

import numpy as np
import pytest
from numba import njit

from cutting.engagement.immersion import engagement
from cutting.engagement.uncut_band import SLOT, band_beside_wall
from cutting.force.directional_coefficients import (
    directional_matrix,
    directional_table,
    mean_directional,
    mean_over_revolution,
)
from cutting.force.exponential import ExponentialLaw
from cutting.force.linear import LinearLaw
from cutting.process_damping.viscous import ViscousProcessDamping

KT, KR, KA = 600e6, 200e6, 80e6
LAW = LinearLaw((KT, KR, KA))
PLANE = np.eye(3)[:, :2]


def table_of(mode="down", ratio=0.3, law=LAW, directions=PLANE, damping=None):
    arc = engagement(band_beside_wall(mode, ratio * 10e-3, 5e-3), 5e-3)
    return directional_table(arc, law, 0.1e-3, directions, damping)


def mean(table, teeth, start, end, lag):
    out = np.empty_like(table.first_integral[:, 0])
    mean_directional(table, 2 * math.pi / teeth, start, end, lag, out)
    return out


def brute_mean(law, feed, arc, teeth, start, end, lag, count=400):
    """Midpoint rule over rotation and edge, straight from forces on tooth and motion."""
    total = np.zeros((3, 3))
    for rotation in np.linspace(start, end, count, endpoint=False) + 0.5 * (end - start) / count:
        trail = np.linspace(0.0, lag, count, endpoint=False) + 0.5 * lag / count
        for tooth in range(teeth):
            angle = np.mod(rotation + 2 * math.pi * tooth / teeth - trail, 2 * math.pi)
            angle = angle[(angle > arc.entry) & (angle < arc.exit)]
            if angle.size:
                slope = law.slope(feed * np.sin(angle))
                total += directional_matrix(angle, *slope).sum(axis=0)
    return total / count**2


def test_sign_against_force_of_a_displaced_tooth():
    # the definition: forces of the design's conventions at h = ft sin + dx sin + dy cos
    def force(phi, dx, dy):
        h = 0.1e-3 * math.sin(phi) + dx * math.sin(phi) + dy * math.cos(phi)
        ft, fr, fa = LAW.force(h)
        s, c = math.sin(phi), math.cos(phi)
        return np.array([-ft * c - fr * s, ft * s - fr * c, fa])

    for phi in (0.3, 1.2, 2.5):
        matrix = directional_matrix(np.array([phi]), KT, KR, KA)[0]
        d = 1e-7
        column_x = (force(phi, d, 0.0) - force(phi, 0.0, 0.0)) / d
        column_y = (force(phi, 0.0, d) - force(phi, 0.0, 0.0)) / d
        assert -matrix[:, 0] == pytest.approx(column_x, rel=1e-6)
        assert -matrix[:, 1] == pytest.approx(column_y, rel=1e-6)
        assert matrix[:, 2] == pytest.approx([0.0, 0.0, 0.0])


@pytest.mark.parametrize(("mode", "ratio"), [("up", 0.05), ("down", 0.5), ("slot", 1.0)])
def test_mean_over_turn_is_altintas_and_budak(mode, ratio):
    # Altintas and Budak 1995, eq. 15: alpha_xx = [cos 2phi - 2 Kr phi + Kr sin 2phi]/2, ...
    arc = engagement(band_beside_wall(mode, ratio * 10e-3, 5e-3), 5e-3)
    k = KR / KT

    def primitive(phi):
        return 0.5 * np.array(
            [
                [
                    math.cos(2 * phi) - 2 * k * phi + k * math.sin(2 * phi),
                    -math.sin(2 * phi) - 2 * phi + k * math.cos(2 * phi),
                ],
                [
                    -math.sin(2 * phi) + 2 * phi + k * math.cos(2 * phi),
                    -math.cos(2 * phi) - 2 * k * phi - k * math.sin(2 * phi),
                ],
            ]
        )

    teeth = 3
    alpha = teeth / (2 * math.pi) * (primitive(arc.exit) - primitive(arc.entry))
    got = mean_over_revolution(table_of(mode, ratio), teeth)[0]
    # their F = K_t/2 A0 (delta), ours dF = -H d
    assert got == pytest.approx(-0.5 * KT * alpha, rel=1e-12, abs=1e-3)


@pytest.mark.parametrize("teeth", [1, 2, 5])
@pytest.mark.parametrize("lag", [0.0, 5e-4, 0.02, 0.7, 4.0])
def test_means_against_brute_quadrature(teeth, lag):
    arc = engagement(band_beside_wall("down", 3e-3, 5e-3), 5e-3)
    table = table_of("down", 0.3, directions=np.eye(3))
    for start, end in [(0.0, 0.1), (0.9, 1.25), (0.2, 2.0)]:
        got = mean(table, teeth, start, end, lag)[0]
        expected = brute_mean(LAW, 0.1e-3, arc, teeth, start, end, lag)
        # the brute rule misplaces the ends of the arc by half an interval
        assert got == pytest.approx(expected, abs=0.004 * KT)


def test_means_of_parts_add_up():
    table = table_of("up", 0.4)
    whole = mean(table, 3, 0.3, 1.1, 0.25)
    parts = [mean(table, 3, a, b, 0.25) for a, b in ((0.3, 0.5), (0.5, 1.1))]
    assert 0.2 * parts[0] + 0.6 * parts[1] == pytest.approx(0.8 * whole, rel=1e-7, abs=1.0)


def test_small_and_tiny_lags_meet():
    # the straight edge at half the lag takes over below a thousandth of a radian
    table = table_of("down", 0.5)
    either_side = [mean(table, 2, 1.7, 2.1, lag) for lag in (0.999e-3, 1.001e-3)]
    # the mean itself moves by half the change of lag times the slope of H
    assert either_side[0] == pytest.approx(either_side[1], rel=0.0, abs=2e-6 * KT)


def test_full_turn_of_helix_has_constant_mean():
    # lag = k tooth pitches: every rotation sees the mean matrix (validation 1.7)
    table = table_of("up", 0.05)
    teeth = 2
    lag = 2 * math.pi / teeth
    expected = mean_over_revolution(table, teeth)
    for start in (0.0, 0.37, 2.1):
        assert mean(table, teeth, start, start + 0.05, lag) == pytest.approx(expected, rel=1e-6)


def test_size_effect_slope_is_integrable():
    # slope p K (h/h0)^(p-1) diverges at phi = 0; compare with an exact Beta-function integral
    from scipy.special import beta

    p, feed, h0 = 0.7, 0.1e-3, 0.1e-3
    law = ExponentialLaw((KT, 0.0, 0.0), h0, p)
    table = directional_table(engagement(SLOT, 5e-3), law, feed, PLANE)
    # H_yx = -Kt' sin^2: integral of sin^(p+1) over (0, pi) is B((p+2)/2, 1/2)
    expected = -p * KT * beta((p + 2) / 2, 0.5)
    assert table.first_integral[0, -1, 1, 0] == pytest.approx(expected, rel=1e-6)


def test_process_damping_is_a_radial_dashpot():
    # F_r = C (b/V) r_dot with r_dot = x_dot sin + y_dot cos: the mean over a turn of a slot
    # cutter with mu = 0 is N/(2 pi) C (pi/2) on the diagonal, and it takes energy away
    damping = ViscousProcessDamping(2e4)
    table = directional_table(engagement(SLOT, 5e-3), LAW, 1e-4, PLANE, damping)
    got = mean_over_revolution(table, 4)[1]
    assert got == pytest.approx(2e4 * np.eye(2), abs=1e-6)


def test_kernel_runs_compiled():
    compiled = njit(mean_directional)
    table = table_of("down", 0.5)
    out = np.empty_like(table.first_integral[:, 0])
    compiled(table, math.pi, 1.0, 1.3, 0.4, out)
    assert out == pytest.approx(mean(table, 2, 1.0, 1.3, 0.4), rel=1e-12)
